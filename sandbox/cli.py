"""The command line: list, play, record, replay, bench, study.

Only light modules are imported at the top: ``--help`` answers at once, and a mistake is found
before anything is compiled.
"""

from __future__ import annotations

import argparse
import errno
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from core.errors import InputError
from sandbox import __version__, arguments
from sandbox.arguments import Parser, argument
from sandbox.exit_codes import DIFFERENT, INTERRUPTED, OK, USER_MISTAKE
from sandbox.studies import commands as studies

if TYPE_CHECKING:
    from sandbox.scene_file import SceneFile
    from sandbox.session import Session
    from sandbox.views.record import Outcome, Output

PROGRAM = "python -m sandbox"
FILM_SUFFIXES = (".mp4", ".gif", ".png")

NO_ROOM = {errno.ENOSPC, errno.EDQUOT}  # a full disk, a full share of it


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return the exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        options = parse(words)
        command: Callable[[argparse.Namespace], int] = options.run
        return command(options)
    except InputError as error:
        print(f"error: {arguments.one_line(str(error))}", file=sys.stderr)
        return USER_MISTAKE
    except KeyboardInterrupt:
        print("stopped: nothing was written", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output (head, a pager) has seen enough. Python flushes once more at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OK
    except OSError as error:
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

    listing = command("list", _list, "Print the scenes, their packings and their parameters.")
    listing.add_argument("--json", action="store_true", help="print the same as JSON")

    play = command("play", _play, "Open a window; grab a handle with the mouse and move it.")
    play.add_argument(
        "scene",
        nargs="?",
        metavar="SCENE",
        help="name of a scene, or a scene file FILE.toml; without it: a menu",
    )
    _add_scene_options(play)
    _add_compare(play)
    play.add_argument("--log", metavar="FILE.jsonl", help="write down what is done, for replay")
    _add_size(play)
    play.add_argument(
        "--scale",
        type=argument(arguments.number(0.5, 4.0)),
        metavar="FACTOR",
        help="size of letters and controls, 0.5 to 4 (default: by the screen's size)",
    )
    _add_look(play, "that of this computer, if there is a choice")

    record = command("record", _record, "Run a scene by itself, and write a film, a table or both.")
    record.add_argument(
        "scene",
        metavar="SCENE",
        help="one of the names that `list` prints, or a scene file FILE.toml",
    )
    record.add_argument(
        "--out", metavar="FILE", help="film (.mp4), animation (.gif) or last frame (.png)"
    )
    record.add_argument("--data", metavar="FILE.csv", help="table with one row per increment")
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
        default=30.0,
        metavar="N",
        help="frames a second (default: 30)",
    )

    record.add_argument(
        "--every",
        type=argument(arguments.whole_number(1, 1000)),
        default=1,
        metavar="N",
        help="a frame for every N increments (default: 1)",
    )

    replay = command("replay", _replay, "Repeat a logged run; say whether it came out the same.")
    replay.add_argument("log", metavar="LOG.jsonl", help="a file that `play --log` has written")
    replay.add_argument("--out", metavar="FILE", help="film, animation or last frame")
    replay.add_argument("--data", metavar="FILE.csv", help="table with one row per increment")
    _add_look(replay)

    bench = command("bench", _bench, "Measure how fast the program is on this machine.")
    bench.add_argument("--json", metavar="FILE.json", help="write all numbers down")
    bench.add_argument("--markdown", metavar="FILE.md", help="write the results as a table")
    bench.add_argument(
        "--peers",
        action="store_true",
        help="also run LAMMPS, ASE and SciPy on the same soft discs, where they are installed",
    )
    bench.add_argument("--quick", action="store_true", help="under half a minute, less exact")

    study = command("study", _study, "Measure, and write tables and figures.")
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
        "--only", nargs="+", metavar="CLAIM", help="these claims instead of all (paper)"
    )
    study.add_argument(
        "--scene", nargs="+", metavar="NAME", help="these scenes instead of all (accuracy)"
    )
    study.add_argument(
        "--jobs",
        type=argument(arguments.whole_number(1, 64)),
        default=2,
        metavar="N",
        help="runs at the same time (default: 2)",
    )
    return parser, commands


def _add_scene_options(parser: Parser) -> None:
    parser.add_argument(
        "--packing",
        metavar="NAME",
        help="kinds of grains: regular, auxetic or mixed (default)",
    )
    parser.add_argument(
        "--seed",
        type=argument(arguments.whole_number(0, arguments.LARGEST_SEED)),
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


def _add_compare(parser: Parser) -> None:
    parser.add_argument(
        "--compare",
        type=argument(arguments.packings),
        metavar="NAME,NAME[,NAME]",
        help="packings side by side under one hand, such as regular,mixed,auxetic",
    )


def _add_size(parser: Parser) -> None:
    parser.add_argument(
        "--size",
        type=argument(arguments.size),
        default=(1280, 720),
        metavar="WxH",
        help="in pixels (default: 1280x720)",
    )


def _add_look(parser: Parser, language_default: str = "en") -> None:
    from sandbox import language
    from sandbox.draw.words import VIEWS

    parser.add_argument(
        "--view",
        type=argument(arguments.one_of(*VIEWS)),
        default="kind",
        metavar="NAME",
        help=f"what the grains show: {', '.join(VIEWS)} (default: kind)",
    )
    parser.add_argument(
        "--theme",
        type=argument(arguments.one_of("dark", "light")),
        default="dark",
        metavar="NAME",
        help="dark (default), or light for a bright room",
    )
    parser.add_argument(
        "--language",
        type=argument(arguments.one_of(*language.available())),
        metavar="NAME",
        help=f"of the words in the picture: {', '.join(language.available())} "
        f"(default: {language_default})",
    )


def _meant_command(word: str, commands: dict[str, Parser]) -> str:
    """People also write the name of a scene where a command is due."""
    from scenes import registry

    scenes = registry.names()
    meant = arguments.nearest(word, [*commands, *scenes])
    if meant in scenes:
        return f" (did you mean play {meant}?)"
    return f" (did you mean {meant}?)" if meant else f": use {', '.join(commands)}"


def _list(options: argparse.Namespace) -> int:
    from sandbox import listing
    from scenes import registry

    scenes = [registry.get(name) for name in registry.names()]
    print(listing.as_json(scenes) if options.json else listing.as_text(scenes), flush=True)
    return OK


def _play(options: argparse.Namespace) -> int:
    from sandbox import environment, language

    language.use(options.language or language.of_environment())
    log = arguments.output_file("--log", options.log, [".jsonl"]) if options.log else None
    if options.scene is None:
        if options.set:
            raise InputError("--set needs a scene: write play SCENE --set NAME=VALUE")
        if options.compare:
            raise InputError("--compare needs a scene: write play SCENE --compare NAME,NAME")
        _check_packing_of_some_scene(_packing(options))
        settings: dict[str, object] = {}
        scene: str | SceneFile | None = None
    else:
        session = _sessions(options)[0]
        settings = dict(session.settings)
        scene = session.file or session.scene.name
        if session.file and options.compare:
            raise InputError("--compare: open the scene file without it, then press C")
    environment.require_pygame_ce()
    environment.require_display()
    from sandbox.window import app

    return app.run(
        scene,
        _packing(options),
        _seed(options),
        settings,
        log=log,
        size=options.size,
        scale=options.scale,
        theme=options.theme,
        view=options.view,
        packings=options.compare or (),
    )


def _record(options: argparse.Namespace) -> int:
    output = _output(options, options.size, options.fps, options.every)
    if output is None:
        raise InputError("nothing to write: give --out FILE.mp4, --data FILE.csv or both")
    sessions = _sessions(options)
    steps: int = options.steps or sessions[0].scene.steps(sessions[0].settings)
    from sandbox.interrupts import stop_like_ctrl_c
    from sandbox.views.record import record
    from sandbox.views.record_side_by_side import record_side_by_side

    with stop_like_ctrl_c():
        if len(sessions) == 1:
            outcome = record(sessions[0], steps, output)
        else:
            outcome = record_side_by_side(sessions, steps, output)
    _report(sessions, outcome, output)
    return INTERRUPTED if outcome.interrupted else OK


def _replay(options: argparse.Namespace) -> int:
    from sandbox.log import read_log

    output = _output(options, (1280, 720), 30.0)
    log = read_log(options.log)
    from sandbox.replay import session_of

    session_of(log)  # finds mistakes before any work
    from sandbox.interrupts import stop_like_ctrl_c
    from sandbox.views.record import repeat

    with stop_like_ctrl_c():
        session, outcome = repeat(log, output)
    _report([session], outcome, output)
    if outcome.interrupted:
        return INTERRUPTED
    same = session.state_hash() == log.hash
    print("the same state as in the log" if same else f"NOT the state of the log, {log.hash}")
    return OK if same else DIFFERENT


def _bench(options: argparse.Namespace) -> int:
    data = arguments.output_file("--json", options.json, [".json"]) if options.json else None
    table = (
        arguments.output_file("--markdown", options.markdown, [".md"]) if options.markdown else None
    )
    from sandbox import environment

    environment.require_pygame_ce()
    from core.files import atomic_write
    from sandbox.studies import bench, bench_report

    def show(section: bench_report.Section) -> None:
        print(f"{bench_report.as_text(section)}\n", flush=True)

    report = bench.run(quick=options.quick, peers=options.peers, show=show)
    for path, form in ((data, bench_report.as_json), (table, bench_report.as_markdown)):
        if path is not None:
            with atomic_write(path) as file:
                file.write(form(report).encode())
    missed = len(report.missed())
    noun = "target" if missed == 1 else "targets"
    print(f"{missed} {noun} missed" if missed else "all targets met")
    return OK


def _study(options: argparse.Namespace) -> int:
    studies.refuse_foreign_options(options)
    return studies.STUDIES[options.name](options)


def _output(
    options: argparse.Namespace, size: tuple[int, int], fps: float, every: int = 1
) -> Output | None:
    """Where to write, checked; None if nothing is asked for."""
    from sandbox import language
    from sandbox.views.record import Output

    language.use(options.language or language.SOURCE)
    film: Path | None = None
    table: Path | None = None
    if options.out:
        from sandbox import environment

        film = arguments.output_file("--out", options.out, FILM_SUFFIXES)
        arguments.check_fps(fps, film.suffix.lower())
        environment.require_pygame_ce()
    if options.data:
        table = arguments.output_file("--data", options.data, [".csv"])
    arguments.check_different({"--out": film, "--data": table})
    if not (film or table):
        return None
    return Output(film, table, size, fps, options.view, options.theme, every)


def _session(options: argparse.Namespace) -> Session:
    """The session that the options describe, checked but not built."""
    from sandbox.session import Session

    if options.scene.lower().endswith(".toml"):
        for name, value in (("packing", options.packing), ("seed", options.seed)):
            if value is not None:
                raise InputError(f"--{name}: a scene file brings its own; leave this out")
        if options.set:
            raise InputError("--set: a scene file brings its own settings; write them there")
        return Session.from_file(options.scene)
    settings = arguments.assignments(options.set)
    return Session(options.scene, _packing(options), _seed(options), settings)


def _sessions(options: argparse.Namespace) -> list[Session]:
    """One session, or one for each packing to be compared."""
    if options.compare is None:
        return [_session(options)]
    if options.packing is not None:
        raise InputError("--packing and --compare: give one of them")
    from sandbox.session import Session

    options.packing = None if options.scene.lower().endswith(".toml") else options.compare[0]
    first = _session(options)
    kinds = [first.scene.check_packing(kind) for kind in options.compare]
    if first.file is not None:
        return [Session.from_file(first.file.of_kind(kind)) for kind in kinds]
    name, seed, settings = first.scene.name, first.seed, first.settings
    return [Session(name, kind, seed, settings) for kind in kinds]


def _packing(options: argparse.Namespace) -> str:
    return "mixed" if options.packing is None else str(options.packing)


def _seed(options: argparse.Namespace) -> int:
    return 1 if options.seed is None else int(options.seed)


def _check_packing_of_some_scene(name: str) -> None:
    from scenes import registry

    known = {
        packing: None for scene in registry.names() for packing in registry.get(scene).packings
    }
    if name not in known:
        raise InputError(f"unknown packing {name!r}: choose {', '.join(known)}")


def _report(sessions: Sequence[Session], outcome: Outcome, output: Output | None) -> None:
    """What a finished run came to, a line for each packing, and the scene's own checks."""
    if outcome.interrupted:
        print(_interrupted(outcome, output), file=sys.stderr)
        if not outcome.increments:
            return
    for session in sessions:
        print(f"{session.packing}: " * (len(sessions) > 1) + _summary(session, outcome))
        for check in session.checks():
            verdict = {True: "holds", False: "FAILS", None: "open"}[check.holds]
            print(f"  {verdict:<5}  {check.name}: {check.measured}")


def _interrupted(outcome: Outcome, output: Output | None) -> str:
    written = []
    if outcome.increments and output and output.film:
        written.append(f"{outcome.frames} frames to {output.film}")
    if outcome.increments and output and output.table:
        written.append(f"{outcome.rows} rows to {output.table}")
    what = f"wrote {' and '.join(written)}" if written else "nothing was written"
    return f"stopped after {outcome.increments} increments: {what}"


def _summary(session: Session, outcome: Outcome) -> str:
    # Row 0 is the state before the hand has moved.
    reasons = session.history.column("stop_reason")[1:]
    forces = session.history.column("resisting")[1:]
    unfinished = sum(str(reason) != "converged" for reason in reasons)
    mean = float(forces.mean()) if len(forces) else 0.0
    return (
        f"{outcome.frames} frames, {len(reasons)} increments "
        f"({unfinished or 'none'} did not converge), "
        f"mean {session.frame().curve_label}: {mean:.4g}, state {session.state_hash()}"
    )
