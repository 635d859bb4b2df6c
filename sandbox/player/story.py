"""What happened in a run, in plain words, made from its numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sandbox.draw.marks import marks
from sandbox.draw.numbers import decimals_for, number
from sandbox.player.tape import Tape
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.words import words
from sandbox.words.words import Section

TOLD = 5  # events of a kind; of more the number is told
FINAL = ("locked", "clog")  # events of which the last one counts
PLAYER = Section("player")


def story(tape: Tape) -> list[str]:
    """Paragraphs in the present language: what was run, then what each packing did."""
    frames = tape.last
    first = frames[0]
    names = [mark.name for mark in marks(frames)]
    head = PLAYER["story_one" if len(frames) == 1 else "story_several"].format(
        title=words.title(first.scene, first.title),
        packings=listed(names),
        grains=_count([kept.size for kept in tape.moments[0]]),
        seed=first.seed,
        increments=tape.increments,
    )
    if len(tape.moments) <= tape.increments:
        head += " " + PLAYER["story_thinned"].format(count=len(tape.moments))
    return [head, *map(_of, frames, names)]


def _count(sizes: Sequence[int]) -> str:
    """``160``, or ``1–2`` where packings differ."""
    return "–".join(map(str, sorted({min(sizes), max(sizes)})))


def listed(items: Sequence[str]) -> str:
    """``a, b and c``."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {PLAYER['and']} {items[-1]}"


def label_parts(label: str) -> tuple[str, str]:
    """A name and its unit: ``stroke [R]``."""
    name, bracket, unit = label.rpartition(" [")
    return (name, unit.removesuffix("]")) if bracket else (label, "")


def _of(frame: Frame, name: str) -> str:
    said = [_force(frame)]
    if frame.grains_out:
        said.append(PLAYER["story_out"].format(count=frame.grains_out))
    said += _events(frame.events)
    if not frame.events:
        said.append(PLAYER["story_quiet"])
    if frame.notices:
        first, *others = (_sentence(words.say(notice)) for notice in frame.notices)
        text = " ".join([first, *map(_capital, others)])
        said.append(PLAYER["story_end"].format(text=text))
    return f"{_capital(name)}: {' '.join(said)}"


def _force(frame: Frame) -> str:
    stroke, force = frame.curve_stroke, frame.curve_force
    known = np.isfinite(stroke) & np.isfinite(force)
    if np.count_nonzero(known) < 2:
        return PLAYER["story_still"]
    stroke, force = stroke[known], force[known]
    highest = int(np.argmax(np.abs(force)))
    x, x_unit = label_parts(words.say(frame.stroke_label))
    y, y_unit = label_parts(words.say(frame.curve_label))
    return PLAYER["story_force"].format(
        stroke=x,
        end=_value(float(stroke[-1]), float(np.ptp(stroke)), x_unit),
        force=_capital(y),
        mean=_value(float(force[1:].mean()), float(np.ptp(force)), y_unit),
        most=_value(float(force[highest]), float(np.ptp(force)), y_unit),
        at=_value(float(stroke[highest]), float(np.ptp(stroke)), x_unit),
    )


def _value(value: float, spread: float, unit: str) -> str:
    """Three digits or so of what varies that much."""
    return f"{number(value, decimals_for(spread / 100.0))} {unit}".rstrip()


def _events(events: Sequence[Event]) -> list[str]:
    """What locked or clogged in its own words, of other kinds when it happened."""
    said = []
    for kind in dict.fromkeys(event.kind for event in events):
        of_kind = [event for event in events if event.kind == kind]
        if kind in FINAL:
            last = of_kind[-1]
            text = _sentence(words.say(last.text))
            said.append(PLAYER["story_event"].format(increment=last.increment, text=text))
            continue
        when = [str(event.increment) for event in of_kind[:TOLD]]
        if len(of_kind) > TOLD:
            when.append(PLAYER["story_more"].format(count=len(of_kind) - TOLD))
        kind_said = _capital(words.EVENTS.get(kind, kind))
        said.append(PLAYER["story_events"].format(kind=kind_said, increments=listed(when)))
    return said


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _sentence(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."
