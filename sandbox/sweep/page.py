"""A static page of a sweep: its pictures, and a grid whose cells open one of their runs, or say how to."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from sandbox.draw.theme import CIVIDIS
from sandbox.files.folder import prepare_folder, write_text
from sandbox.sweep.outcome import FAILED
from sandbox.sweep.pictures import View, axis_label
from sandbox.sweep.request import Request
from sandbox.sweep.summary import SHARES_OF, Cell

PAGE, PLAYERS = "index.html", "players"
TOLD = (
    "In each cell: how often the grains stopped, with Wilson's interval of 95 %, of how many runs, and one of all with the "
    f"outcome that most of them have. {SHARES_OF}. In the map hatching marks intervals wider than 0.3, close hatching wider than "
    "0.5."
)
STYLE = """
body { font: 16px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: 0 1em; color: #111; }
img { max-width: 100%; } table { border-collapse: collapse; margin: 0.4em 0 1.6em; }
th, td { padding: 0.35em 0.6em; text-align: center; } th { font-weight: 600; }
td { border: 2px solid #fff; min-width: 6em; } td a { color: inherit; } small { display: block; }
code { background: #eee; padding: 0 0.3em; } td code { background: none; padding: 0; font-size: 0.8em; }
"""


def write_page(
    folder: Path,
    request: Request,
    cells: Sequence[Cell],
    pictures: Sequence[str],
    players: Mapping[int, str],
) -> None:
    """``players``: pages of runs by their rows. Raises InputError if it cannot be written."""
    title = f"{request.scene}: {sum(len(cell.runs) for cell in cells)} runs"
    body = [
        f"<h1>{escape(title)}</h1>",
        f"<p>{escape(_asked(request))}</p>",
        *(f'<p><img src="{name}" alt="{name.removesuffix(".png")}"></p>' for name in pictures),
        "<h2>Runs</h2>",
        f"<p>{TOLD}</p>",
    ]
    for name, some in View(request, cells, 2).groups():
        body += [f"<h3>{escape(name)}</h3>", _grid(folder, request, some, players)]
    html = (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style></head><body>\n" + "\n".join(body) + "\n</body></html>\n"
    )
    write_text(folder / PAGE, html)


def write_players(folder: Path, request: Request, cells: Sequence[Cell]) -> dict[int, str]:
    """A page that plays one run of each cell, by its row; one that is there stays. Raises InputError if it cannot be written."""
    from sandbox.record.record import Output, record
    from sandbox.session.session import Session

    prepare_folder(str(folder), PLAYERS)
    found = {}
    for cell in cells:
        row = cell.example
        name = f"{PLAYERS}/{row['row']}.html"
        if row["outcome"] != FAILED and not (folder / name).exists():
            job = request.job(int(row["row"]))
            session = Session(job.scene, job.packing, job.seed, job.settings)
            record([session], int(row["increments"]), Output(None, None, page=folder / name))
        if (folder / name).exists():
            found[int(row["row"])] = name
    return found


def _asked(request: Request) -> str:
    first, last = request.seeds
    words = [f"seeds {first} to {last}", *(f"{name} {value:g}" for name, value in request.settings)]
    return ", ".join([*request.packings, *words])


def _grid(folder: Path, request: Request, some: Sequence[Cell], players: Mapping[int, str]) -> str:
    """The first axis across, the second downwards, largest on top as in the picture."""
    axes = request.axes[:2]
    rows: dict[object, list[str]] = {}
    for cell in some:
        key = cell.values[1] if len(axes) > 1 else ""
        rows.setdefault(key, []).append(_cell(folder, cell, players))
    head = ""
    if axes:
        first = "".join(f"<th>{value:g}</th>" for value in axes[0].values)
        corner = axis_label(request, 0) + (
            f" → {axis_label(request, 1)} ↑" if len(axes) > 1 else ""
        )
        head = f"<tr><th>{escape(corner)}</th>{first}</tr>"
    lines = [
        f"<tr><th>{key if key == '' else format(key, 'g')}</th>{''.join(line)}</tr>"
        for key, line in reversed(rows.items())
    ]
    return f"<table>{head}{''.join(lines)}</table>"


def _cell(folder: Path, cell: Cell, players: Mapping[int, str]) -> str:
    row = cell.example
    number = int(row["row"])
    command = f"play {shlex.quote(str(folder))}#{number}"
    where = players.get(number)
    what = (
        f"<code>{escape(command)}</code>"
        if where is None
        else f'<a href="{where}">{escape(row["outcome"])}</a>'
    )
    share = cell.stopped
    if share is None:
        return (
            f"<td>{escape(cell.told)}<small>{len(cell.runs)} runs</small><small>{what}</small></td>"
        )
    low, high = share.interval()
    ground = int(CIVIDIS[round(255 * share.value)])
    colour = "#fff" if share.value < 0.5 else "#000"
    return (
        f'<td style="background:#{ground:06X};color:{colour}">{share.value:.2f}'
        f"<small>{low:.2f} to {high:.2f}, {share.count} runs</small><small>{what}</small></td>"
    )
