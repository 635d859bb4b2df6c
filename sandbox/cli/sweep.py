"""The command ``sweep``: from its options to a folder of runs. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.cli.arguments import argument
from sandbox.cli.exit_codes import FAILED, INTERRUPTED, OK

if TYPE_CHECKING:
    from sandbox.sweep.request import Request
    from sandbox.sweep.summary import Cell

ASKING = ("vary", "packing", "seeds", "set", "until", "steps", "out")  # what a folder brings itself


def add_options(sweep: argparse.ArgumentParser) -> None:
    """All of them."""
    text: dict[str, dict[str, Any]] = {
        "--vary": {
            "action": "append",
            "default": [],
            "metavar": "NAME=A:B:STEP|v1,v2,…",
            "help": "a parameter along an axis, both ends included; may be repeated: all combinations",
        },
        "--packing": {
            "metavar": "NAME,…",
            "help": "kinds of grains: regular, auxetic, mixed (default), or several",
        },
        "--seeds": {"metavar": "N|A:B", "help": "seeds 1 to N, or A to B (default: 10)"},
        "--set": {
            "action": "append",
            "default": [],
            "metavar": "NAME=VALUE",
            "help": "set a parameter of the scene in all runs; may be repeated",
        },
        "--until": {
            "metavar": "clog,…",
            "help": "what ends a run early: locked, clog, empty (default: locked,empty; under gravity clog as well)",
        },
        "--steps": {
            "type": argument(arguments.whole_number(1, arguments.MOST_STEPS)),
            "metavar": "N",
            "help": "increments of a run at most (default: the scene's whole protocol; under gravity 400 R of fall)",
        },
        "--out": {"metavar": "DIR", "help": "folder for the tables; what is there is kept"},
        "--more-seeds": {
            "type": argument(arguments.whole_number(1, 1_000_000)),
            "default": 0,
            "metavar": "N",
            "help": "so many more than the folder was asked for",
        },
        "--jobs": {
            "type": argument(arguments.whole_number(1, 256)),
            "default": 2,
            "metavar": "N",
            "help": "runs at the same time (default: 2)",
        },
        "--executor": {
            "default": "local",
            "metavar": "WHERE",
            "help": "local: processes here (default); dask://HOST:PORT: a Dask cluster",
        },
    }
    sweep.add_argument(
        "scene",
        metavar="SCENE|DIR",
        help="one of the names that `list` prints, or the folder of a sweep to go on with",
    )
    for name, rest in text.items():
        sweep.add_argument(name, **rest)
    sweep.add_argument(
        "--pictures",
        action="store_true",
        help="draw probabilities and avalanche sizes, and write index.html (extra study)",
    )
    sweep.add_argument(
        "--players",
        action="store_true",
        help="the same, and a page that plays one run of each cell",
    )
    sweep.add_argument(
        "--parquet",
        action="store_true",
        help="write both tables as Parquet as well (extra parquet)",
    )


def sweep(options: argparse.Namespace) -> int:
    """Carry a sweep out, or go on with one, and print what it came to."""
    from sandbox.extras import require_matplotlib
    from sandbox.sweep import export, workers
    from sandbox.sweep.tables import is_sweep

    folder, request = _asked(options)
    workers.check(options.executor)
    if options.parquet:
        export.require_pyarrow()
    if options.pictures or options.players:
        require_matplotlib()
    try:
        return _carried_out(options, folder, request)
    except KeyboardInterrupt:  # before or after the runs
        there = f": python -m sandbox sweep {quote(str(folder))} goes on from there"
        there = there if is_sweep(str(folder)) else ": nothing was written"
        print(f"stopped{there}", file=sys.stderr)
        return INTERRUPTED


def _carried_out(options: argparse.Namespace, folder: Path, request: Request) -> int:
    from sandbox.sweep import export, summary
    from sandbox.sweep.sweep import Ways
    from sandbox.sweep.sweep import sweep as carry_out
    from sandbox.sweep.tables import Tables

    ways = Ways(options.executor, options.jobs)
    tables = Tables(folder, request)
    try:
        whole = carry_out(tables, ways)
    finally:
        tables.close()
    found = summary.cells(tables)
    print(summary.as_text(request, found))
    if not whole:
        done = f"stopped after {len(tables.runs)} of {request.runs} runs"
        print(
            f"{done}: python -m sandbox sweep {quote(str(folder))} goes on from there",
            file=sys.stderr,
        )
        return INTERRUPTED
    if options.parquet:
        export.write_parquet(folder)
    if options.pictures or options.players:
        print(f"page: {_draw(folder, request, found, options.players)}")
    print(
        f"tables: {folder / 'runs.csv'}, avalanches.csv; a run: python -m sandbox play {quote(str(folder))}#ROW"
    )
    return FAILED if any(cell.outcomes["failed"] for cell in found) else OK


def _draw(folder: Path, request: Request, found: Sequence[Cell], players: bool) -> Path:
    """Pictures and the page that shows them, with a player for each cell if wanted."""
    from sandbox.sweep import page
    from sandbox.sweep.pictures import draw_all

    played = page.write_players(folder, request, found) if players else {}
    page.write_page(folder, request, found, draw_all(request, found, folder), played)
    return folder / page.PAGE


def _asked(options: argparse.Namespace) -> tuple[Path, Request]:
    """Folder and request, checked, of a new sweep or of one to go on with."""
    from sandbox.sweep.asking import ask
    from sandbox.sweep.tables import is_sweep, read_request
    from scenes import registry

    if is_sweep(options.scene):
        for name in ASKING:
            if getattr(options, name) not in (None, []):
                raise InputError(
                    f"--{name}: the folder brings its own; only --more-seeds changes it"
                )
        folder = Path(options.scene)
        return folder, read_request(folder).with_more_seeds(options.more_seeds)
    if Path(options.scene).is_dir():
        raise InputError(f"{options.scene}: this folder holds no sweep")
    try:
        registry.get(options.scene)
    except InputError as error:
        raise InputError(f"there is no folder {options.scene}, and {error}") from None
    if not options.out:
        raise InputError("--out DIR is needed: where shall the tables go?")
    request = ask(
        options.scene,
        options.vary,
        options.packing,
        "10" if options.seeds is None else options.seeds,
        arguments.assignments(options.set),
        options.until,
        options.steps,
    ).with_more_seeds(options.more_seeds)
    folder = Path(options.out)
    if is_sweep(options.out):
        there = read_request(folder)
        if there.key() != request.key() or there.seeds[1] > request.seeds[1]:
            raise InputError(
                f"--out {folder}: another sweep is there; give another folder, or go on with: sweep {quote(str(folder))}"
            )
    return folder, request
