"""The command ``lesson``: a lesson for paper. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.cli.exit_codes import OK


def add_options(lesson: argparse.ArgumentParser) -> None:
    """All but the language, which other commands have as well."""
    lesson.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="one that the program brings along, or a file LESSON.toml",
    )
    lesson.add_argument(
        "--out", metavar="DIR", help="folder for the pages, which any browser prints"
    )


def lesson(options: argparse.Namespace) -> int:
    """Write a lesson's pages, or say which lessons there are."""
    from sandbox.lessons import classroom, sheets

    if options.name is None:
        if options.out:
            raise InputError(f"--out needs a lesson: {arguments.any_of(classroom.names())}")
        for name in classroom.names():
            found = classroom.lesson(name)
            print(f"{name}: {found.title} ({found.minutes} minutes)")
        return OK
    found = classroom.named(options.name)
    if options.out is None:
        raise InputError(f"nothing to write: give --out DIR, or write play {options.name}")
    from sandbox.files.folder import prepare_folder

    folder = prepare_folder(options.out, "")
    source = (
        classroom.path_of(options.name) if options.name in classroom.names() else Path(options.name)
    )
    codes = (options.language,) if options.language else ()
    for path in [sheets.copy_lesson(source, folder), *sheets.write_sheets(found, folder, codes)]:
        print(path)
    return OK
