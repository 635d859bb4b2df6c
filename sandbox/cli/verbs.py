"""What each command does: from checked options to an exit code.

Only light modules are imported at the top, as in ``cli``; heavy ones where a command has found no mistake.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.cli import study as studies
from sandbox.cli.exit_codes import CHECK_FAILED, DIFFERENT, INTERRUPTED, OK
from sandbox.interrupts import deferred
from scenes.text import counted

if TYPE_CHECKING:
    from sandbox.files.table import Spelling
    from sandbox.lessons.lesson import Lesson
    from sandbox.record.record import Outcome, Output
    from sandbox.session.beginning import SceneFile
    from sandbox.session.session import Session
    from sandbox.sweep.tables import Made

FILM_SUFFIXES = (".mp4", ".webm", ".gif", ".png")
PAGE_SUFFIXES = (".html", ".htm")
TRAJECTORY_SUFFIXES = (".xyz", ".extxyz", ".npz", ".vtp", ".pvd")


def list_scenes(options: argparse.Namespace) -> int:
    """Print the scenes and what they know."""
    from sandbox.cli import listing
    from scenes import registry

    scenes = [registry.get(name) for name in registry.names()]
    print(listing.as_json(scenes) if options.json else listing.as_text(scenes), flush=True)
    return OK


def play(options: argparse.Namespace) -> int:
    """Open the window, with a scene or the menu."""
    from sandbox import environment
    from sandbox.lessons.answers import Answers
    from sandbox.words import language

    language.use(options.language or language.of_environment())
    log = arguments.output_file("--log", options.log, [".jsonl"]) if options.log else None
    lesson = _lesson(options.scene)
    if lesson is not None:
        for name in ("packing", "seed", "set", "compare"):
            if getattr(options, name) not in (None, []):
                raise InputError(f"--{name}: a lesson brings its own; leave this out")
    if options.scene is None or lesson is not None:
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
        _packing(options),
        _seed(options),
        settings,
        log=log,
        packings=options.compare or (),
        script=_row(options.scene) is not None,
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


def record(options: argparse.Namespace) -> int:
    """Make a film, a table or both, of one packing or of several side by side."""
    output = _output(options, options.size, options.fps, options.every)
    if output is None:
        raise InputError(
            "nothing to write: give --out FILE.mp4, --data FILE.csv or --trajectory FILE.xyz"
        )
    if output.trajectory and options.compare:
        raise InputError(
            "--trajectory takes one packing: leave --compare out, or record each alone"
        )
    sessions = _sessions(options)
    row = _row(options.scene)
    steps: int = options.steps or sessions[0].scene.steps(sessions[0].settings)
    if row is not None and not options.steps:
        steps = row.increments
    from sandbox.record import record as films

    outcome = films.record(sessions, steps, output)
    with suppress(KeyboardInterrupt), deferred():  # all is written, and is told to the end
        all_hold = _report(sessions, outcome, output)
        if outcome.interrupted:
            return INTERRUPTED
        if row is not None and row.state and steps == row.increments:
            same = sessions[0].state_hash() == row.state
            print(
                "the same state as in the table"
                if same
                else f"NOT the state of the table, {row.state}"
            )
            return OK if same else DIFFERENT
        return OK if all_hold else CHECK_FAILED
    return INTERRUPTED


def replay(options: argparse.Namespace) -> int:
    """Repeat what a log says, and compare where it leads."""
    from sandbox.files.log_file import read_log

    output = _output(options, (1280, 720), 30.0)
    log = read_log(options.log)
    from sandbox.session.replay import session_of

    session_of(log)  # finds mistakes before any work
    from sandbox.record.record import repeat

    session, outcome = repeat(log, output)
    with suppress(KeyboardInterrupt), deferred():
        _report([session], outcome, output)
        if outcome.interrupted:
            return INTERRUPTED
        same = log.hash in ("", session.state_hash())
        said = "the same state as in the log" if same else f"NOT the state of the log, {log.hash}"
        print(said if log.hash else "the log does not say in which state the run ended")
        refused, why = session.refusals
        if refused:
            noun = "command" if refused == 1 else "commands"
            print(
                f"{refused} {noun} of the log could not be carried out: {arguments.one_line(why)}"
            )
        return OK if same and not refused else DIFFERENT
    return INTERRUPTED


def bench(options: argparse.Namespace) -> int:
    """Measure the speed, and say which targets were missed."""
    data = arguments.output_file("--json", options.json, [".json"]) if options.json else None
    table = (
        arguments.output_file("--markdown", options.markdown, [".md"]) if options.markdown else None
    )
    from sandbox import environment

    environment.require_pygame_ce()
    from core.files import atomic_write
    from sandbox.studies.bench import bench as benchmark
    from sandbox.studies.bench import report as bench_report

    def show(section: bench_report.Section) -> None:
        print(f"{bench_report.as_text(section)}\n", flush=True)

    report = benchmark.run(quick=options.quick, peers=options.peers, show=show)
    with suppress(KeyboardInterrupt), deferred():
        for path, form in ((data, bench_report.as_json), (table, bench_report.as_markdown)):
            if path is not None:
                with atomic_write(path) as file:
                    file.write(form(report).encode())
        missed = len(report.missed())
        noun = "target" if missed == 1 else "targets"
        print(f"{missed} {noun} missed" if missed else "all targets met")
        return OK
    return INTERRUPTED


def study(options: argparse.Namespace) -> int:
    """Carry out one of the studies."""
    studies.refuse_foreign_options(options)
    try:
        return studies.STUDIES[options.name](options)
    except KeyboardInterrupt:
        # After the last run, that is: a study that is stopped earlier says how far it has come.
        there = Path(options.out).is_dir()
        kept = f"; what was finished is in {options.out}, the same command goes on from there"
        print(f"stopped{kept if there else ': nothing was written'}", file=sys.stderr)
        return INTERRUPTED


def web(options: argparse.Namespace) -> int:
    """Write pages on which scenes run."""
    from sandbox.files.folder import prepare_folder
    from sandbox.web import building

    asked = [options.single] if options.single else options.scene or building.SCENES
    names = [building.scene_named(name) for name in dict.fromkeys(asked)]
    folder = prepare_folder(options.out, "")
    single = options.single is not None

    def tell(text: str, share: float) -> None:
        print(f"{text}: {share:.0%}", flush=True)

    written = building.write(folder, names, tell, single=single)
    for path in written:
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")
    return OK


def site(options: argparse.Namespace) -> int:
    """Write the gallery."""
    from sandbox.files.folder import prepare_folder
    from sandbox.site import site as gallery
    from sandbox.site import studies as results
    from scenes import registry

    scenes = [registry.get(name).name for name in options.scene or registry.names()]
    results.require_markdown()
    folder = prepare_folder(options.out, "")
    try:
        written = gallery.site(folder, list(dict.fromkeys(scenes)), options.steps)
    except KeyboardInterrupt:
        print(f"stopped; the pages in {folder} that are there are whole", file=sys.stderr)
        return INTERRUPTED
    size = sum(path.stat().st_size for path in written)
    print(f"{counted(len(written), 'page')}, {size / 1e6:.1f} MB: {folder / 'index.html'}")
    if not results.found():
        print("without what was measured: this installation has no assets/studies")
    if size > gallery.MOST:
        print(
            f"larger than {gallery.MOST / 1e6:g} MB: use --scene or --steps for a smaller gallery"
        )
    return OK


def _output(
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
    if options.gif != "loop" and (film is None or film.suffix.lower() != ".gif"):
        raise InputError(f"--gif {options.gif}: there is no animation; give --out FILE.gif")
    if options.data:
        table = arguments.output_file("--data", options.data, [".csv"])
    if options.trajectory:
        trajectory = _trajectory(options.trajectory)
    files = {"--out": film or page, "--data": table, "--trajectory": trajectory}
    arguments.check_different(files)
    if not any(files.values()):
        return None
    if options.csv != "plain" and table is None:
        raise InputError(f"--csv {options.csv}: there is no table; give --data FILE.csv")
    look = size, fps, options.view, options.theme
    return Output(film, table, *look, every, _spelling(options.csv), page, trajectory, options.gif)


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


def _session(options: argparse.Namespace) -> Session:
    """The session that the options describe, checked but not built."""
    from sandbox.session.session import Session

    if _lesson(options.scene) is not None:
        raise InputError(f"{options.scene} is a lesson: write play {options.scene}")
    row = _row(options.scene)
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
    return Session(options.scene, _packing(options), _seed(options), settings)


def _sessions(options: argparse.Namespace) -> list[Session]:
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


def _row(scene: str | None) -> Made | None:
    """The run of a sweep, where the words are DIR#ROW of one."""
    folder, mark, row = (scene or "").rpartition("#")
    if not (mark and folder):
        return None
    from sandbox.sweep.tables import is_sweep, made

    return made(Path(folder), row) if is_sweep(folder) else None


def _lesson(scene: str | None) -> Lesson | None:
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


def _report(sessions: Sequence[Session], outcome: Outcome, output: Output | None) -> bool:
    """What a finished run came to, a line for each packing, and the scene's own checks; False where one of them fails."""
    if outcome.interrupted:
        print(_interrupted(outcome, output), file=sys.stderr)
        if not outcome.increments:
            return True
    all_hold = True
    if output and output.page and not outcome.interrupted:
        print(_page_line(outcome, output))
    for session in sessions:
        print(f"{session.packing}: " * (len(sessions) > 1) + _summary(session, outcome))
        if session.run.locked:
            print(f"  {session.run.how_locked}")
        for check in session.checks():
            verdict = {True: "holds", False: "FAILS", None: "open"}[check.holds]
            print(f"  {verdict:<5}  {check.name}: {check.measured}")
            all_hold &= check.holds is not False
    return all_hold


def _page_line(outcome: Outcome, output: Output) -> str:
    line = f"{counted(outcome.pictures, 'picture')} in {output.page}"
    if outcome.pictures < outcome.increments // output.every:
        line += (
            f", of {counted(outcome.increments, 'increment')}: a page keeps no more (see --every)"
        )
    return line


def _interrupted(outcome: Outcome, output: Output | None) -> str:
    written = []
    if outcome.frames and output and output.film:
        one = output.film.suffix.lower() == ".png"
        written.append(
            f"{'the last frame' if one else counted(outcome.frames, 'frame')} to {output.film}"
        )
    if outcome.pictures and output and output.page:
        written.append(f"{counted(outcome.pictures, 'picture')} to {output.page}")
    if outcome.increments and output and output.table:
        written.append(f"{counted(outcome.rows, 'row')} to {output.table}")
    if outcome.increments and output and output.trajectory:
        written.append(f"the trajectory to {output.trajectory}")
    what = f"wrote {' and '.join(written)}" if written else "nothing was written"
    return f"stopped after {counted(outcome.increments, 'increment')}: {what}"


def _summary(session: Session, outcome: Outcome) -> str:
    # Row 0 is the state before the hand has moved.
    reasons = session.history.column("stop_reason")[1:]
    forces = session.history.column("resisting")[1:]
    unfinished = sum(str(reason) != "converged" for reason in reasons)
    mean = float(forces.mean()) if len(forces) else 0.0
    frames = f"{counted(outcome.frames, 'frame')}, " if outcome.frames else ""
    return (
        f"{frames}{counted(len(reasons), 'increment')} "
        f"({unfinished or 'none'} did not converge), "
        f"mean {session.frame().curve_label}: {mean:.4g}, state {session.state_hash()}"
    )
