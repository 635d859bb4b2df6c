"""Where a run is to be written: --out, --data and --trajectory, checked before anything begins.

Light at the top, as the command line is.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any

from core.errors import InputError
from sandbox.cli import arguments

if TYPE_CHECKING:
    from sandbox.files.table import Spelling
    from sandbox.record.record import Output

MOVING_SUFFIXES = (".mp4", ".webm", ".gif")
FILM_SUFFIXES = (*MOVING_SUFFIXES, ".png")
PAGE_SUFFIXES = (".html", ".htm")
TRAJECTORY_SUFFIXES = (".xyz", ".extxyz", ".npz", ".vtp", ".pvd")

# How it is written, where nothing else is said.
DEFAULTS: Mapping[str, Any] = {
    "view": "kind",
    "theme": "dark",
    "size": (1280, 720),
    "fps": 30.0,
    "every": 1,
    "gif": "loop",
    "csv": "plain",
}
_PICTURE = "there is no picture; give --out FILE.mp4"
# Which files have use for each of these, and what is said where none is written.
_USES: Mapping[str, tuple[Sequence[str], str]] = {
    "view": ((*FILM_SUFFIXES, *PAGE_SUFFIXES), _PICTURE),
    "theme": ((*FILM_SUFFIXES, *PAGE_SUFFIXES), _PICTURE),
    "size": (FILM_SUFFIXES, _PICTURE),
    "fps": (MOVING_SUFFIXES, "there is no film; give --out FILE.mp4"),
    "every": ((*FILM_SUFFIXES, *PAGE_SUFFIXES, *TRAJECTORY_SUFFIXES), _PICTURE),
    "gif": ((".gif",), "there is no animation; give --out FILE.gif"),
    "csv": ((".csv",), "there is no table; give --data FILE.csv"),
}


def output_of(
    options: argparse.Namespace, size: tuple[int, int], fps: float, every: int = 1
) -> Output | None:
    """Where to write, checked; None if nothing is asked for."""
    from sandbox.record.record import Output
    from sandbox.words import language

    language.use(options.language or language.SOURCE)
    film: Path | None = None
    table: Path | None = None
    page: Path | None = None
    trajectory: Path | None = None
    if options.out and options.out.lower().endswith(PAGE_SUFFIXES):
        page = arguments.output_file("--out", options.out, PAGE_SUFFIXES)
    elif options.out:
        from sandbox import environment

        film = arguments.output_file("--out", options.out, (*FILM_SUFFIXES, *PAGE_SUFFIXES[:1]))
        arguments.check_fps(fps, film.suffix.lower())
        arguments.check_size(size, film.suffix.lower())
        environment.require_pygame_ce()
        if film.suffix.lower() == ".webm":
            from sandbox.record.video import webm_codec

            webm_codec()  # raises where there is none
    if options.data:
        table = arguments.output_file("--data", options.data, [".csv"])
    if options.trajectory:
        trajectory = _trajectory(options.trajectory)
    files = {"--out": film or page, "--data": table, "--trajectory": trajectory}
    _check_use(options, {path.suffix.lower() for path in files.values() if path})
    arguments.check_different(files)
    if not any(files.values()):
        return None
    look = size, fps, options.view, options.theme
    return Output(film, table, *look, every, _spelling(options.csv), page, trajectory, options.gif)


def _check_use(options: argparse.Namespace, suffixes: Set[str]) -> None:
    """Raise InputError for an option that nothing of what is written has use for."""
    for name, (having_use, why) in _USES.items():
        value = getattr(options, name, DEFAULTS[name])
        if value != DEFAULTS[name] and suffixes.isdisjoint(having_use):
            raise InputError(f"--{name}: {why}")


def _trajectory(text: str) -> Path:
    path = arguments.output_file("--trajectory", text, TRAJECTORY_SUFFIXES)
    if path.suffix.lower() != ".vtp":
        return path
    # Of those there are three a frame; this names them.
    return arguments.output_file("--trajectory", str(path.with_suffix(".pvd")), [".pvd"])


def _spelling(name: str) -> Spelling:
    from sandbox.files.table import PLAIN, for_excel
    from sandbox.words import words

    return for_excel(words.decimal_sign(), words.say) if name == "excel" else PLAIN
