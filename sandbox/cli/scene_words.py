"""What SCENE and the options beside it stand for: a scene, a scene file, a lesson, or a run of a sweep.

Light at the top, as the command line is.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from core.errors import InputError
from sandbox.cli import arguments

if TYPE_CHECKING:
    from sandbox.lessons.lesson import Lesson
    from sandbox.session.session import Session
    from sandbox.sweep.tables import Made


def sessions_of(options: argparse.Namespace) -> list[Session]:
    """One session, or one for each packing to be compared."""
    if options.compare is None:
        return [_session(options)]
    if options.packing is not None:
        raise InputError("--packing and --compare: give one of them")
    from sandbox.session.session import Session

    options.packing = None if _is_file(options.scene) else options.compare[0]
    first = _session(options)
    kinds = [first.scene.check_packing(kind) for kind in options.compare]
    if first.file is not None:
        return [Session.from_file(first.file.of_kind(kind)) for kind in kinds]
    name, seed, settings = first.scene.name, first.seed, first.settings
    return [Session(name, kind, seed, settings) for kind in kinds]


def _session(options: argparse.Namespace) -> Session:
    """The session that the options describe, checked but not built."""
    from sandbox.session.session import Session

    if lesson_of(options.scene) is not None:
        raise InputError(f"{options.scene} is a lesson: write play {options.scene}")
    row = row_of(options.scene)
    if row is not None:
        for name in ("packing", "seed", "set", "compare"):
            if getattr(options, name) not in (None, []):
                raise InputError(f"--{name}: a run of a sweep brings its own; leave this out")
        return Session(row.job.scene, row.job.packing, row.job.seed, row.job.settings)
    if _is_file(options.scene):
        for name, value in (("packing", options.packing), ("seed", options.seed)):
            if value is not None:
                raise InputError(f"--{name}: a scene file brings its own; leave this out")
        if options.set:
            raise InputError(
                "--set: a scene file brings its own settings; change them in the window"
            )
        from sandbox.files.scene_file import read_scene

        return Session.from_file(read_scene(options.scene))
    settings = arguments.assignments(options.set)
    return Session(options.scene, packing_of(options), seed_of(options), settings)


def row_of(scene: str | None) -> Made | None:
    """The run of a sweep, where the words are DIR#ROW of one."""
    folder, mark, row = (scene or "").rpartition("#")
    if not (mark and folder):
        return None
    from sandbox.sweep.tables import is_sweep, made

    if is_sweep(folder):
        return made(Path(folder), row)
    words = f"{folder}#{row}"
    if not Path(words).exists():
        if Path(folder).is_dir():
            raise InputError(f"{words}: the folder {folder} holds no sweep")
        if row.isdecimal():
            raise InputError(f"{words}: there is no folder {folder}")
    return None


def lesson_of(scene: str | None) -> Lesson | None:
    """The lesson of that name, or in that file; None where it is something else."""
    from sandbox.lessons import classroom
    from sandbox.lessons.reading import is_meant, read_lesson

    if scene in classroom.names():
        return classroom.lesson(scene)
    return read_lesson(scene) if scene is not None and is_meant(Path(scene)) else None


def _is_file(scene: str) -> bool:
    """A scene file, whatever it is called, and not the name of a scene."""
    from sandbox.files.scene_file import SUFFIXES
    from scenes import registry

    if scene in registry.names():
        return False
    return scene.lower().endswith(SUFFIXES) or (os.sep in scene) or Path(scene).is_file()


def packing_of(options: argparse.Namespace) -> str:
    return "mixed" if options.packing is None else str(options.packing)


def seed_of(options: argparse.Namespace) -> int:
    return 1 if options.seed is None else int(options.seed)


def check_packing_of_some_scene(name: str) -> None:
    from scenes import registry

    known = {
        packing: None for scene in registry.names() for packing in registry.get(scene).packings
    }
    if name not in known:
        raise InputError(f"unknown packing {name!r}: choose {', '.join(known)}")
