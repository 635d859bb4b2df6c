"""Runs one packing or several without a window, increment by increment, and writes down what it sees."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from core.errors import InputError
from core.files import atomic_write
from sandbox.bars import bar_options
from sandbox.beside import beside
from sandbox.environment import cores
from sandbox.files.pipes import with_reader
from sandbox.files.table import PLAIN, GrowingTable, Spelling
from sandbox.interrupts import deferred
from sandbox.record.video import VideoWriter

if TYPE_CHECKING:
    from sandbox.files.trajectories.trajectory import Trajectory
    from sandbox.player.tape import Tape
    from sandbox.session.frame import Frame
    from sandbox.session.log import Log
    from sandbox.session.session import Session
    from sandbox.session.table import RunTable

# Relaxation steps between two looks at the clock and at Ctrl-C: a fraction of a second.
SLICE = 400


@dataclass(frozen=True)
class Output:
    """Where a run is written to; at least one of them."""

    film: Path | None
    table: Path | None
    size: tuple[int, int] = (1280, 720)
    fps: float = 30.0
    view: str = "kind"
    theme: str = "dark"
    every: int = 1  # increments to a frame of film or trajectory, or to a picture of the page
    spelling: Spelling = PLAIN  # of the table
    page: Path | None = None
    trajectory: Path | None = None  # .xyz, .npz or .pvd
    gif: str = "loop"  # how an animation ends: see ``GIF_ENDS``


@dataclass(frozen=True)
class Outcome:
    """What a run came to. The table has a row more than there are increments: that of the start."""

    increments: int
    frames: int
    rows: int  # of all packings
    interrupted: bool
    pictures: int = 0  # of the page


NOTHING = Outcome(0, 0, 0, interrupted=True)  # Ctrl-C while grains were packed


def record(sessions: Sequence[Session], steps: int, output: Output) -> Outcome:
    """Build all sessions, run their scripted protocols for ``steps`` increments, write the output.

    One frame an increment. Ctrl-C, or the end of the protocol, ends the run early; everything done
    until then is written.
    """
    from sandbox.draw.warmup import missing
    from sandbox.session.commands import Protocol

    try:
        with beside(missing() if output.film else []):
            for session in sessions:
                with build_bar() as progress:
                    session.build(progress)
        for session in sessions:
            if not session.frame().protocol:  # a file may have been left in the middle of it
                session.submit(Protocol(True))
    except KeyboardInterrupt:
        return NOTHING
    outcome = run(sessions, in_step(sessions), steps, output)
    if not outcome.increments and not outcome.interrupted:
        raise InputError(
            "there is nothing to drive, so no increment was made and nothing is written"
        )
    return outcome


def repeat(log: Log, output: Output | None) -> tuple[Session, Outcome]:
    """Run a log again, one frame an increment; the session at its end, and what it came to.

    Raises InputError if the log does not fit the scene.
    """
    from sandbox.session.replay import repeated, session_of

    session = session_of(log)
    try:
        with build_bar() as progress:
            session.build(progress)
    except KeyboardInterrupt:
        return session, NOTHING
    work = repeated(log, session, SLICE)
    outcome = run([session], work, log.end, output)
    try:
        for _ in () if outcome.interrupted else work:
            pass  # commands that came after the last increment
    except KeyboardInterrupt:
        outcome = replace(outcome, interrupted=True)
    return session, outcome


def in_step(sessions: Sequence[Session]) -> Iterator[bool]:
    """Work slice by slice, in all at the same time, until none has anything to do; True where an increment was finished.

    Each packing relaxes every increment to the end before any begins the next; one that is done waits. So the result does
    not depend on how fast the machine is.
    """
    with ThreadPoolExecutor(min(len(sessions), cores())) as pool:
        works = [session.slices(SLICE) for session in sessions]
        finished = True
        while finished:
            at_work, finished = works, False
            while at_work:
                done = list(pool.map(lambda work: next(work, None), at_work))
                finished |= True in done
                at_work = [w for w, d in zip(at_work, done, strict=True) if d is False]
                if at_work or finished:
                    yield not at_work


def run(
    sessions: Sequence[Session], work: Iterator[bool], steps: int, output: Output | None
) -> Outcome:
    """Draw on ``work``, which says when an increment was finished, until its end or ``steps`` times.

    The sessions, several of them side by side, are built already. A frame is written after each increment, or each n-th and
    the last; the table grows on the disk. Ctrl-C is heard between two pieces of work, so that frames and rows always go
    together. Where one of the two cannot be written any more, or the work fails, the run ends, and a table holds what there
    was; a film that can still be written is finished. Raises what had happened.
    """
    from tqdm import tqdm

    film, path = (output.film, output.table) if output else (None, None)
    table = (
        GrowingTable(path, lambda: _tables(sessions), output.spelling) if path and output else None
    )
    tape = _begun_tape(sessions, output) if output and output.page else None
    draw = _drawer(output) if output and film else None
    trajectory = _trajectory(output.trajectory) if output and output.trajectory else None
    writer = VideoWriter(film, output.size, output.fps, output.gif) if output and film else None

    def show() -> None:
        if writer and draw:
            writer.write(draw([session.frame() for session in sessions]))
        if trajectory:
            trajectory.write(sessions[0])

    increments = 0
    interrupted = False
    failed: InputError | None = None  # of the table
    try:
        with (
            writer or nullcontext(),
            trajectory or nullcontext(),
            tqdm(
                total=steps, desc=sessions[0].scene.name, unit="increment", **bar_options()
            ) as bar,
        ):
            if trajectory:
                trajectory.begin(sessions[0])
            while increments < steps:
                with deferred():
                    finished = next(work, None)
                    if finished is None:
                        break
                    if finished:
                        increments += 1
                        if output and increments % output.every == 0:
                            show()
                        if tape:
                            tape.add([session.frame() for session in sessions])
                        bar.update()
                if table and increments:
                    try:
                        table.grow()
                    except InputError as error:
                        failed = error
                        break
            if output and increments % output.every:
                with deferred():
                    show()
    except KeyboardInterrupt:
        interrupted = True
    finally:
        if table and increments and not failed:
            interrupted |= _interrupted(table.finish)
    if tape and increments and output:
        interrupted |= _interrupted(lambda: _write_page(tape, output))
    if failed:
        raise failed
    rows = sum(len(session.history) for session in sessions)
    pictures = len(tape.moments) if tape else 0
    return Outcome(increments, writer.frames if writer else 0, rows, interrupted, pictures)


def _interrupted(finish: Callable[[], None]) -> bool:
    """Finish something, to its end; whether Ctrl-C came meanwhile."""
    try:
        with deferred():
            finish()
    except KeyboardInterrupt:
        return True
    return False


def _begun_tape(sessions: Sequence[Session], output: Output) -> Tape:
    from sandbox.player.tape import Tape

    tape = Tape(every=output.every)
    tape.add([session.frame() for session in sessions])
    return tape


def _write_page(tape: Tape, output: Output) -> None:
    from sandbox.player.page import Look, page

    assert output.page is not None
    with with_reader(output.page), atomic_write(output.page) as file:
        file.write(page(tape, Look(output.theme, output.view)).encode())


def _trajectory(path: Path) -> Trajectory:
    from sandbox.files.trajectories.trajectory import Trajectory

    return Trajectory(path)


def _tables(sessions: Sequence[Session]) -> list[tuple[str, RunTable]]:
    return [(session.packing, session.table) for session in sessions]


@contextmanager
def build_bar() -> Iterator[Callable[[str, float], None]]:
    """A progress bar to pass to ``Session.build``."""
    from tqdm import tqdm

    with tqdm(
        total=1.0, bar_format="{desc:<42.42} {percentage:3.0f}%|{bar}| {elapsed}", **bar_options()
    ) as bar:

        def progress(text: str, fraction: float) -> None:
            bar.set_description_str(text, refresh=False)
            bar.update(max(0.0, min(fraction, 1.0) - bar.n))

        yield progress
        bar.update(max(0.0, 1.0 - bar.n))


def _drawer(output: Output) -> Callable[[Sequence[Frame]], Any]:
    """What makes a picture of one frame or several: the next of the film."""
    from sandbox.environment import prepare_headless

    prepare_headless()
    from sandbox.draw.flashes import Flashes
    from sandbox.draw.render import Renderer

    # Letters and lines keep their share of the picture whatever its size.
    scale = max(0.5, min(output.size[0] / 1280, output.size[1] / 720))
    renderer = Renderer(output.size, scale, output.theme, output.view)
    flashes, numbers = Flashes(), count()

    def draw(frames: Sequence[Frame]) -> Any:
        lit = flashes.follow(frames, next(numbers) / output.fps)  # the film's time, not the clock's
        return renderer.image(frames, flashes=lit)

    return draw
