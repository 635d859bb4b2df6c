"""Worksheets to print: a page a scene, with its question, room for a prediction, a table to fill in, and room to explain."""

from __future__ import annotations

import html
from collections.abc import Sequence

from sandbox.player.pieces import marked
from sandbox.player.tape import Tape
from sandbox.site.markup import SHOWN, SITE, document, link, said, title_of
from sandbox.words import language, words
from sandbox.words.words import Section

SHEET = Section("worksheet")
LINES = 4  # to write an explanation on
WIDE, HIGH, SQUARE = 760, 240, 20  # of the grid for a sketch, in its own units
FILE = "worksheets.html"


def worksheets(tapes: dict[str, Tape]) -> str:
    """One page that holds all of them; a link to one shows that one alone."""
    sheets = [_section(scene, tape) for scene, tape in tapes.items()]
    intro = (
        f'<div class="intro">{said("worksheets", "h1")}{said("worksheets_intro", "p")}'
        f"{said('print_hint', 'p')}</div>"
    )
    trail = [link("index.html", said("all_scenes")), link(FILE, said("all_worksheets"))]
    return document(lambda: SITE["worksheets"], intro + "".join(sheets), trail)


def _section(scene: str, tape: Tape) -> str:
    sheet = marked(lambda: _sheet(scene, tape), SHOWN)
    return f'<section class="sheet" id="{scene}">{sheet}</section>'


def _sheet(scene: str, tape: Tape) -> str:
    """One in the present language."""
    own = language.find("worksheets", scene) or {}
    first = tape.last[0]
    force, stroke = words.say(first.curve_label), words.say(first.stroke_label)
    packings = [words.PACKINGS.get(frame.packing, frame.packing) for frame in tape.last]
    parts = [
        f"<h2>{_text(title_of(scene)())}</h2>",
        f'<p class="who"><span>{_text(SHEET["name"])}</span><span>{_text(SHEET["date"])}</span></p>',
        f'<p class="asked">{_text(words.question(scene))}</p>',
        f"<h3>{_text(SHEET['prediction'])}</h3><p>{_text(own.get('predict', ''))} {_text(SHEET['sketch'])}</p>",
        _grid(force, stroke),
        f"<h3>{_text(SHEET['measurement'])}</h3><p>{_text(own.get('measure', ''))}</p>",
        _table(packings, force, stroke),
        f"<h3>{_text(SHEET['explanation'])}</h3><p>{_text(own.get('explain', ''))}</p>",
        '<p class="rules"></p>' * LINES,
    ]
    return "".join(parts)


def _table(packings: Sequence[str], force: str, stroke: str) -> str:
    heads = [
        SHEET["packing"],
        SHEET["largest"].format(force=force),
        SHEET["at"].format(stroke=stroke),
        SHEET["event"],
        SHEET["own"],
    ]
    head = "".join(f'<th scope="col">{_text(text)}</th>' for text in heads)
    empty = "<td></td>" * (len(heads) - 1)
    rows = "".join(f'<tr><th scope="row">{_text(name)}</th>{empty}</tr>' for name in packings)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _grid(force: str, stroke: str) -> str:
    """Squared paper with named axes."""
    left, top, foot = 24, 24, 24
    columns = range(left, left + WIDE + 1, SQUARE)
    rows = range(top, top + HIGH + 1, SQUARE)
    lines = "".join(f"M{x} {top}V{top + HIGH}" for x in columns)
    lines += "".join(f"M{left} {y}H{left + WIDE}" for y in rows)
    bottom = top + HIGH
    return (
        f'<svg viewBox="0 0 {left + WIDE + 10} {bottom + foot}" role="img" aria-label="{_text(force)}, {_text(stroke)}">'
        f'<path d="{lines}" stroke="currentColor" stroke-opacity="0.35" fill="none"/>'
        f'<path d="M{left} {top - 8}V{bottom}H{left + WIDE + 8}" stroke="currentColor" stroke-width="2" fill="none"/>'
        f'<text x="{left}" y="12" font-size="14" fill="currentColor">{_text(force)}</text>'
        f'<text x="{left + WIDE}" y="{bottom + 18}" font-size="14" fill="currentColor" text-anchor="end">{_text(stroke)}</text>'
        "</svg>"
    )


def _text(text: str) -> str:
    return html.escape(text)
