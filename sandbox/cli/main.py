"""The command line: list, play, record, replay, sweep, bench, study, site, web, lesson, prepare.

Only light modules are imported at the top: ``--help`` answers at once, and a mistake is found
before anything is compiled.
"""

from __future__ import annotations

import argparse
import errno
import os
import sys
from collections.abc import Callable, Sequence

from core.errors import InputError, nearest
from core.own_process import OWN
from sandbox import __version__
from sandbox.cli import arguments, listing, publish, streams
from sandbox.cli import bench as benching
from sandbox.cli import lesson as lessons
from sandbox.cli import play as playing
from sandbox.cli import prepare as preparing
from sandbox.cli import record as recording
from sandbox.cli import study as studies
from sandbox.cli import sweep as sweeps
from sandbox.cli.arguments import Parser, argument
from sandbox.cli.exit_codes import INTERRUPTED, OK, USER_MISTAKE
from sandbox.cli.output_words import DEFAULTS
from sandbox.files.pipes import let_go
from sandbox.interrupts import hear_no_more, stop_like_ctrl_c
from scenes.parameter import LARGEST_SEED

PROGRAM = "python -m sandbox"
Command = Callable[[str, Callable[[argparse.Namespace], int], str], Parser]
NO_ROOM = {errno.ENOSPC, errno.EDQUOT}  # a full disk, a full share of it


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return the exit code."""
    with streams.prepared(), stop_like_ctrl_c():
        try:
            return _run(list(sys.argv[1:] if argv is None else argv))
        finally:
            let_go()


def program() -> int:
    """``main`` for a process that ends with it."""
    OWN.set()
    with stop_like_ctrl_c():
        code = main()
        hear_no_more()
    return code


def _run(words: list[str]) -> int:
    try:
        options = parse(words)
        command: Callable[[argparse.Namespace], int] = options.run
        code = command(options)
        sys.stdout.flush()
        return code
    except InputError as error:
        print(f"error: {arguments.one_line(str(error))}", file=sys.stderr)
        return USER_MISTAKE
    except KeyboardInterrupt:
        print("stopped: nothing was written", file=sys.stderr)  # who has written something says so
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output (head, a pager) has seen enough. Python flushes once more at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OK
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            name = arguments.one_line(f"error: this name is too long: {error.filename}")
            print(name, file=sys.stderr)
            return USER_MISTAKE
        if error.errno not in NO_ROOM:
            raise
        where = f" for {error.filename}" if error.filename else ""
        print(f"error: no room left on the disk{where}: free some and try again", file=sys.stderr)
        return USER_MISTAKE


def parse(words: Sequence[str]) -> argparse.Namespace:
    """The options of the command, with ``run`` the function that carries it out."""
    parser, commands = parsers()
    first = words[0] if words else "play"
    if not first.startswith("-") and first not in commands:
        raise InputError(f"unknown command {first!r}{_meant_command(first, commands)}")
    options, leftovers = parser.parse_known_args(words or ["play"])
    if "command" not in options or options.command is None:
        parser.refuse_leftovers(leftovers)
        raise InputError(f"no command given: use {', '.join(commands)}; see {PROGRAM} --help")
    commands[options.command].refuse_leftovers(leftovers)
    return options


def parsers() -> tuple[Parser, dict[str, Parser]]:
    """The parser of the whole command line, and that of each command."""
    parser = Parser(
        prog=PROGRAM,
        description="Push and pull deformable grains, regular and auxetic, and watch the forces.",
        epilog="Without a command: play, starting with the menu of scenes.",
    )
    parser.add_argument("--version", action="version", version=f"auxetic-sandbox {__version__}")
    choices = parser.add_subparsers(dest="command", metavar="COMMAND", parser_class=Parser)
    commands: dict[str, Parser] = {}

    def command(name: str, run: Callable[[argparse.Namespace], int], text: str) -> Parser:
        commands[name] = choices.add_parser(name, help=text, description=text)
        commands[name].set_defaults(run=run)
        return commands[name]

    for add in (
        _add_listing,
        _add_play,
        _add_record,
        _add_replay,
        _add_sweep,
        _add_bench,
        _add_study,
        _add_site,
        _add_web,
        _add_lesson,
        _add_prepare,
    ):
        add(command)
    return parser, commands


def _add_listing(command: Command) -> None:
    scenes = command(
        "list", listing.list_scenes, "Print the scenes, their packings and their parameters."
    )
    scenes.add_argument("--json", action="store_true", help="print the same as JSON")


def _add_play(command: Command) -> None:
    play = command("play", playing.play, "Open a window; grab a handle with the mouse and move it.")
    play.add_argument(
        "scene",
        nargs="?",
        metavar="SCENE",
        help="name or file of a scene or a lesson (FILE.scene, LESSON.toml), or a run DIR#ROW of a sweep; without it: a menu",
    )
    _add_scene_options(play)
    _add_compare(play)
    play.add_argument(
        "--log",
        metavar="FILE.jsonl",
        help="write down what is done, for replay; each further run of the window, of another scene, tour or file, beside it: "
        "FILE-2.jsonl, FILE-3.jsonl, …",
    )
    play.add_argument(
        "--answers",
        metavar="FILE.csv",
        help="what is predicted in lessons, a row each, added to what is there; no names",
    )
    _add_size(play, None, "by the screen's size")
    play.add_argument(
        "--display",
        type=argument(arguments.whole_number(1, 16)),
        default=1,
        metavar="N",
        help="which screen the window is on, counted from 1 (default: 1)",
    )
    play.add_argument(
        "--fullscreen", action="store_true", help="take all of the screen, as F11 does"
    )
    play.add_argument(
        "--scale",
        type=argument(arguments.number(0.5, 4.0)),
        metavar="FACTOR",
        help="size of letters and controls, 0.5 to 4 (default: by the size of screen and window)",
    )
    _add_look(play, "that of this computer, if there is a choice")


def _add_record(command: Command) -> None:
    record = command(
        "record", recording.record, "Run a scene by itself, and write a film, a table or both."
    )
    record.add_argument(
        "scene",
        metavar="SCENE",
        help="one of the names that `list` prints, a scene file FILE.scene, or a run DIR#ROW of a sweep",
    )
    record.add_argument(
        "--out",
        metavar="FILE",
        help="film (.mp4, .webm), animation (.gif), last frame (.png), or a page that plays the run (.html)",
    )
    _add_gif(record)
    _add_data(record)
    _add_scene_options(record)
    _add_compare(record)
    record.add_argument(
        "--steps",
        type=argument(arguments.whole_number(1, arguments.MOST_STEPS)),
        metavar="N",
        help="increments to run, a frame each (default: the scene's whole protocol)",
    )
    _add_size(record)
    _add_look(record)
    record.add_argument(
        "--fps",
        type=argument(arguments.number(1.0, max(arguments.HIGHEST_FPS.values()))),
        default=DEFAULTS["fps"],
        metavar="N",
        help="frames a second (default: 30)",
    )

    record.add_argument(
        "--every",
        type=argument(arguments.whole_number(1, 1000)),
        default=DEFAULTS["every"],
        metavar="N",
        help="a frame of the film or page for every N increments (default: 1)",
    )


def _add_replay(command: Command) -> None:
    replay = command(
        "replay", recording.replay, "Repeat a logged run; say whether it came out the same."
    )
    replay.add_argument("log", metavar="LOG.jsonl", help="a file that `play --log` has written")
    replay.add_argument("--out", metavar="FILE", help="film, animation, last frame or page")
    _add_gif(replay)
    _add_data(replay)
    _add_look(replay)


def _add_sweep(command: Command) -> None:
    sweeps.add_options(
        command("sweep", sweeps.sweep, "Run a scene many times, along axes and over seeds: tables.")
    )


def _add_bench(command: Command) -> None:
    bench = command("bench", benching.bench, "Measure how fast the program is on this machine.")
    bench.add_argument("--json", metavar="FILE.json", help="write all numbers down")
    bench.add_argument("--markdown", metavar="FILE.md", help="write the results as a table")
    bench.add_argument(
        "--peers",
        action="store_true",
        help="also run LAMMPS, ASE and SciPy on the same soft discs, where they are installed",
    )
    bench.add_argument("--quick", action="store_true", help="under half a minute, less exact")


def _add_study(command: Command) -> None:
    study = command("study", studies.study, "Measure, and write tables and figures.")
    study.add_argument(
        "name",
        metavar="NAME",
        type=argument(arguments.one_of(*studies.STUDIES)),
        help=arguments.any_of(list(studies.STUDIES)),
    )
    study.add_argument(
        "--out", metavar="DIR", required=True, help="folder for results; what is there is kept"
    )
    study.add_argument("--quick", action="store_true", help="fewer seeds, smaller packings")
    study.add_argument(
        "--only",
        nargs="+",
        metavar="NAME",
        help="these claims (paper), cases (classics) or parts (clogging) instead of all",
    )
    study.add_argument(
        "--scene", nargs="+", metavar="NAME", help="these scenes instead of all (accuracy)"
    )
    study.add_argument(
        "--estimate",
        action="store_true",
        help="nothing but the live estimate of the force's error (accuracy)",
    )
    study.add_argument(
        "--jobs",
        type=argument(arguments.whole_number(1, 64)),
        default=2,
        metavar="N",
        help="runs at the same time (default: 2)",
    )
    study.add_argument(
        "--executor",
        metavar="WHERE",
        help="local: processes here (default); dask://HOST:PORT: a Dask cluster (clogging)",
    )


def _add_prepare(command: Command) -> None:
    preparing.add_options(
        command(
            "prepare",
            preparing.prepare,
            "Compile everything now, so that no scene makes anybody wait.",
        )
    )


def _add_site(command: Command) -> None:
    site = command(
        "site",
        publish.site,
        "Write a gallery to publish: a page that plays each scene, its packings side by side, worksheets to print, and what "
        "was measured. Takes three minutes on two idle cores, and a minute more where the solver is compiled first.",
    )
    site.add_argument(
        "--out", metavar="DIR", required=True, help="folder for the pages; begin with index.html"
    )
    site.add_argument("--scene", nargs="+", metavar="NAME", help="these scenes instead of all")
    site.add_argument(
        "--steps",
        type=argument(arguments.whole_number(1, arguments.MOST_STEPS)),
        metavar="N",
        help="increments of each scene at most (default: its whole protocol)",
    )


def _add_web(command: Command) -> None:
    web = command(
        "web",
        publish.web,
        "Write pages on which scenes run in any browser, with nothing to install: the same kernels, compiled for it. "
        "Needs the extra web and Node.js; the first time it compiles and packs, for five minutes of processor.",
    )
    web.add_argument("--out", metavar="DIR", required=True, help="folder for the pages")
    what = web.add_mutually_exclusive_group()
    what.add_argument("--scene", nargs="+", metavar="NAME", help="these scenes instead of all")
    what.add_argument(
        "--single", metavar="NAME", help="one scene alone, as one file of no more than 400 kB"
    )
    web.add_argument(
        "--seeds",
        type=argument(arguments.whole_number(1, 1000)),
        default=50,
        metavar="N",
        help="packings of the seeds 1 to N on each page (default: 50), with --single of as many of them as have room",
    )


def _add_lesson(command: Command) -> None:
    lesson = command(
        "lesson",
        lessons.lesson,
        "Write a lesson for paper: worksheets, and aims, plan and answers for the teacher, beside the lesson itself. "
        "Without a name: print which lessons there are.",
    )
    lessons.add_options(lesson)
    _add_language(lesson, "all in which the lesson is written")


def _add_scene_options(parser: Parser) -> None:
    parser.add_argument(
        "--packing",
        metavar="NAME",
        help="kinds of grains: regular, auxetic or mixed (default)",
    )
    parser.add_argument(
        "--seed",
        type=argument(arguments.whole_number(0, LARGEST_SEED)),
        metavar="N",
        help="of the random packing (default: 1)",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="set a parameter of the scene; may be repeated",
    )


def _add_gif(parser: Parser) -> None:
    parser.add_argument(
        "--gif",
        type=argument(arguments.one_of("loop", "once", "hold")),
        default=DEFAULTS["gif"],
        metavar="END",
        help="an animation begins again (loop, the default), stays at its last frame (once), or holds it before (hold)",
    )


def _add_data(parser: Parser) -> None:
    parser.add_argument("--data", metavar="FILE.csv", help="table with one row per increment")
    parser.add_argument(
        "--csv",
        type=argument(arguments.one_of("plain", "excel")),
        default=DEFAULTS["csv"],
        metavar="FORM",
        help="plain (default), or excel: as Excel opens it in the country of --language",
    )
    parser.add_argument(
        "--trajectory",
        metavar="FILE",
        help="all grains and contacts: .xyz (OVITO, ASE), .npz (NumPy) or .vtp (ParaView)",
    )


def _add_compare(parser: Parser) -> None:
    parser.add_argument(
        "--compare",
        type=argument(arguments.packings),
        metavar="NAME,NAME[,NAME]",
        help="packings side by side under one hand, such as regular,mixed,auxetic",
    )


def _add_size(
    parser: Parser, default: tuple[int, int] | None = DEFAULTS["size"], said: str = "1280x720"
) -> None:
    parser.add_argument(
        "--size",
        type=argument(arguments.size),
        default=default,
        metavar="WxH",
        help=f"in pixels (default: {said})",
    )


def _add_look(parser: Parser, language_default: str = "en") -> None:
    from sandbox.words.words import VIEWS

    parser.add_argument(
        "--view",
        type=argument(arguments.one_of(*VIEWS)),
        default=DEFAULTS["view"],
        metavar="NAME",
        help=f"what the grains show: {', '.join(VIEWS)} (default: kind)",
    )
    parser.add_argument(
        "--theme",
        type=argument(arguments.one_of("dark", "light")),
        default=DEFAULTS["theme"],
        metavar="NAME",
        help="dark (default), or light for a bright room",
    )
    _add_language(parser, language_default)


def _add_language(parser: Parser, default: str) -> None:
    from sandbox.words import language

    parser.add_argument(
        "--language",
        type=argument(arguments.one_of(*language.available())),
        metavar="NAME",
        help=f"of the words in the picture: {', '.join(language.available())} (default: {default})",
    )


def _meant_command(word: str, commands: dict[str, Parser]) -> str:
    """People also write the name of a scene where a command is due."""
    from scenes import registry

    scenes = registry.names()
    meant = nearest(word, [*commands, *scenes])
    if meant in scenes:
        return f" (did you mean play {meant}?)"
    return f" (did you mean {meant}?)" if meant else f": use {', '.join(commands)}"
