"""The command ``play``: the window. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.cli.scene_words import (
    check_packing_of_some_scene,
    lesson_of,
    packing_of,
    row_of,
    seed_of,
    sessions_of,
)

if TYPE_CHECKING:
    from sandbox.session.beginning import SceneFile


def play(options: argparse.Namespace) -> int:
    """Open the window, with a scene or the menu."""
    from sandbox import environment
    from sandbox.lessons.answers import Answers
    from sandbox.words import language

    language.use(options.language or language.of_environment())
    log = arguments.output_file("--log", options.log, [".jsonl"]) if options.log else None
    lesson = lesson_of(options.scene)
    if lesson is not None:
        for name in ("packing", "seed", "set", "compare"):
            if getattr(options, name) not in (None, []):
                raise InputError(f"--{name}: a lesson brings its own; leave this out")
    if options.scene is None or lesson is not None:
        if options.set:
            raise InputError("--set needs a scene: write play SCENE --set NAME=VALUE")
        if options.compare:
            raise InputError("--compare needs a scene: write play SCENE --compare NAME,NAME")
        check_packing_of_some_scene(packing_of(options))
        settings: dict[str, object] = {}
        scene: str | SceneFile | None = None
    else:
        session = sessions_of(options)[0]
        settings = dict(session.settings)
        scene = session.file or session.scene.name
        if session.file and options.compare:
            raise InputError("--compare: open the scene file without it, then press C")
        options.packing, options.seed = session.packing, session.seed
    answers = Answers(
        arguments.output_file("--answers", options.answers, [".csv"]) if options.answers else None
    )
    environment.require_pygame_ce()
    environment.require_display()
    from sandbox.window import app
    from sandbox.window.display import Looks

    return app.run(
        scene,
        packing_of(options),
        seed_of(options),
        settings,
        log=log,
        packings=options.compare or (),
        script=row_of(options.scene) is not None,
        lesson=lesson,
        answers=answers,
        looks=Looks(
            options.size,
            options.scale,
            options.theme,
            options.view,
            options.display,
            options.fullscreen,
        ),
    )
