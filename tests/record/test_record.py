"""The loop that runs a session and writes down what it sees, with a session made of cardboard."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import imageio.v2
import numpy as np
import pytest

from core.errors import InputError
from sandbox.files.table import GrowingTable
from sandbox.record import record
from sandbox.record.record import Outcome, Output
from sandbox.record.video import VideoWriter
from sandbox.session.session import Session

SIZE = (64, 48)


@dataclass(frozen=True)
class Line:
    """A row of the table."""

    increment: int


class Cardboard:
    """A session whose increments take two slices each, and which counts what it is asked."""

    def __init__(self) -> None:
        self.scene = SimpleNamespace(name="cardboard")
        self.packing = "cardboard"
        self.history = self.table = self
        self.lines = [Line(0)]
        self.slices_done = 0
        self.asked_for_frames = 0
        self.idle_after: int | None = None
        self.on_increment: Callable[[int], None] = lambda increment: None

    @property
    def increments(self) -> int:
        return self.slices_done // 2

    def advance(self, max_iterations: int) -> bool:
        assert max_iterations == record.SLICE
        if self.idle:
            return False
        self.slices_done += 1
        if self.slices_done % 2:
            return False
        self.on_increment(self.increments)
        return True

    @property
    def idle(self) -> bool:
        return self.increments == self.idle_after

    slices: Any = Session.slices

    def frame(self) -> int:
        self.asked_for_frames += 1
        return self.increments

    def header(self) -> list[str]:
        return ["increment"]

    def rows(self, begin: int = 0) -> Iterator[tuple[int]]:
        return ((i,) for i in range(begin, len(self)))

    def __getitem__(self, index: int) -> Line:
        self.lines += [Line(i) for i in range(len(self.lines), index + 1)]
        return self.lines[index]

    def __len__(self) -> int:
        return self.increments + 1


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Cardboard:
    def draw(frames: list[int]) -> Any:
        return np.full((SIZE[1], SIZE[0], 3), 40 * frames[0], np.uint8)

    monkeypatch.setattr(record, "_drawer", lambda output: draw)
    return Cardboard()


def run(session: Any, steps: int, film: Path | None, table: Path | None) -> Outcome:
    output = Output(film, table, SIZE)
    return record.run([session], record.in_step([session]), steps, output)


def test_a_frame_and_a_row_per_increment(tmp_path: Path, session: Cardboard) -> None:
    film, table = tmp_path / "film.gif", tmp_path / "run.csv"
    assert run(session, 5, film, table) == Outcome(5, 5, 6, interrupted=False)
    levels = [int(frame[0, 0, 0]) for frame in imageio.v2.mimread(film)]
    assert levels == [40, 80, 120, 160, 200]
    assert table.read_text().split() == ["increment", "0", "1", "2", "3", "4", "5"]


def test_without_a_film_nothing_is_drawn(tmp_path: Path, session: Cardboard) -> None:
    table = tmp_path / "run.csv"
    assert run(session, 5, None, table) == Outcome(5, 0, 6, interrupted=False)
    assert session.asked_for_frames == 0


def test_the_run_ends_with_its_protocol(tmp_path: Path, session: Cardboard) -> None:
    session.idle_after = 2
    outcome = run(session, 9, tmp_path / "film.mp4", None)
    assert (outcome.increments, outcome.frames, outcome.interrupted) == (2, 2, False)


def test_ctrl_c_leaves_as_many_frames_as_increments(tmp_path: Path, session: Cardboard) -> None:
    """Wherever in an increment it comes: here after the state has changed, before it was drawn."""

    def press(increment: int) -> None:
        if increment == 3:
            signal.raise_signal(signal.SIGINT)

    session.on_increment = press
    film, table = tmp_path / "film.mp4", tmp_path / "run.csv"
    assert run(session, 9, film, table) == Outcome(3, 3, 4, interrupted=True)
    assert len(imageio.v2.mimread(film)) == 3
    assert len(table.read_text().split()) == 1 + 4


@pytest.mark.parametrize("moment", ["film", "table", "page"])
def test_ctrl_c_while_files_are_finished_is_told_with_what_was_written(
    tmp_path: Path, session: Cardboard, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    film, table, page = tmp_path / "film.png", tmp_path / "run.csv", tmp_path / "run.html"

    def press(*_: object) -> None:
        signal.raise_signal(signal.SIGINT)

    tape = SimpleNamespace(moments=[1, 2], add=lambda frames: None)
    monkeypatch.setattr(record, "_begun_tape", lambda sessions, output: tape)
    for name, owner, method in (
        ("film", VideoWriter, "_finish"),
        ("table", GrowingTable, "_grow"),
        ("page", record, "_write_page"),
    ):
        monkeypatch.setattr(owner, method, press if name == moment else lambda *_: None)
    output = Output(film, table, SIZE, page=page)
    outcome = record.run([cast("Session", session)], iter([True, True]), 2, output)
    assert outcome.interrupted
    assert outcome.pictures == 2


def test_ctrl_c_before_the_first_increment_writes_nothing(
    tmp_path: Path, session: Cardboard
) -> None:
    def press(_increment: int) -> None:
        raise KeyboardInterrupt

    session.on_increment = press
    outcome = run(session, 9, tmp_path / "film.mp4", tmp_path / "run.csv")
    assert (outcome.increments, outcome.frames, outcome.interrupted) == (0, 0, True)
    assert not list(tmp_path.iterdir())


def test_an_error_leaves_the_table(tmp_path: Path, session: Cardboard) -> None:
    """No film, whose frames may be wrong; but what was known before the error."""

    def fail(increment: int) -> None:
        if increment == 3:
            raise InputError("the packing collapsed")

    session.on_increment = fail
    with pytest.raises(InputError, match="collapsed"):
        run(session, 9, tmp_path / "film.mp4", tmp_path / "run.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]
    assert (tmp_path / "run.csv").read_text().split()[:4] == ["increment", "0", "1", "2"]


def test_a_film_that_fails_leaves_the_table_whole(
    tmp_path: Path, session: Cardboard, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = VideoWriter.write

    def fail(writer: VideoWriter, image: Any) -> None:
        if writer.frames == 3:
            raise InputError("no room for the film")
        write(writer, image)

    monkeypatch.setattr(VideoWriter, "write", fail)
    with pytest.raises(InputError, match="no room for the film"):
        run(session, 9, tmp_path / "film.mp4", tmp_path / "run.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]
    assert (tmp_path / "run.csv").read_text().split() == ["increment", "0", "1", "2", "3", "4"]


def test_a_table_that_fails_leaves_the_film_whole(
    tmp_path: Path, session: Cardboard, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(table: GrowingTable) -> None:
        if session.increments == 3:
            raise InputError("no room for the table")

    monkeypatch.setattr(GrowingTable, "grow", fail)
    with pytest.raises(InputError, match="no room for the table"):
        run(session, 9, tmp_path / "film.gif", tmp_path / "run.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
    assert len(imageio.v2.mimread(tmp_path / "film.gif")) == 3


def test_the_bar_of_the_build_never_goes_back(capsys: pytest.CaptureFixture[str]) -> None:
    with record.build_bar() as progress:
        progress("compiling", 0.5)
        progress("packing", 0.2)
        progress("relaxing", 2.0)
    shown = capsys.readouterr().err
    assert "100%" in shown
    assert "200%" not in shown


@pytest.mark.parametrize(("view", "theme"), [("skin", "dark"), ("pressure", "light")])
def test_a_film_shows_the_view_that_was_asked_for(tmp_path: Path, view: str, theme: str) -> None:
    from sandbox.draw.render import Renderer
    from tests.draw.frames import intruder_frame

    frame = intruder_frame(8)
    output = Output(tmp_path / "film.png", None, (640, 360), 30.0, view, theme)
    draw = record._drawer(output)
    wanted = Renderer((640, 360), 0.5, theme, view).image(frame)
    assert np.array_equal(draw([frame]), wanted)
    assert not np.array_equal(wanted, Renderer((640, 360), 0.5).image(frame))
