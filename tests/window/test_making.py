"""The runs of the window: what was made is saved, opened, put side by side, and found again after a crash."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from sandbox.files import log_file
from sandbox.files.autosave import Autosave, Found, find
from sandbox.files.growing_log import GrowingLog
from sandbox.files.log_file import read_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import Change, DrawWall, Place, Protocol, Undo
from sandbox.session.frame import Frame
from sandbox.session.replay import replay
from sandbox.window.solvers.panes import Panes
from tests.session.edited import built, do

PATIENCE = 60.0  # [s]
WALL = DrawWall(((20.0, 3.0), (24.0, 4.0)))


def wait(
    run: Panes, condition: Callable[[Frame], bool], pane: int = 0, said: list[str] | None = None
) -> Frame:
    """Tick as the window does until the picture is like that; what is said meanwhile is added to ``said``."""
    said, end = [] if said is None else said, time.monotonic() + PATIENCE
    while time.monotonic() < end:
        said += filter(None, [run.tick()])
        snapshot = run.snapshots[pane] if pane < len(run.snapshots) else None
        if snapshot is not None:
            assert snapshot.phase != "failed", snapshot.error
            frame = snapshot.frame if snapshot.phase == "running" else None
            if frame is not None and condition(frame):
                return frame
        time.sleep(0.005)
    raise AssertionError("it did not come to that")


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Panes]:
    one = Panes("mixed", 1, autosave=Autosave(tmp_path / "autosave", 0.02))
    yield one
    one.close()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    session = built(grains=0)
    do(session, WALL, Place(10.0, 4.0, "regular"), Place(13.0, 4.0, "auxetic"))
    write_scene(tmp_path / "made.scene", session.made())
    return tmp_path / "made.scene"


def test_what_was_made_is_saved_and_opened(run: Panes, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to save"):
        run.save(tmp_path / "it.scene")
    run.start("workshop", {"grains": 0})
    wait(run, lambda frame: True)
    run.send(Place(10.0, 4.0, "regular"))
    run.send(WALL)
    wait(run, lambda frame: frame.grains == 1 and len(frame.bodies) == 3)
    run.save(tmp_path / "it.scene")
    with pytest.raises(InputError, match="nowhere"):
        run.save(tmp_path / "nowhere" / "it.scene")
    run.start("workshop", {"grains": 5})
    wait(run, lambda frame: frame.grains == 5)
    run.open(tmp_path / "it.scene")
    wait(run, lambda frame: frame.grains == 1 and len(frame.bodies) == 3)
    with pytest.raises(InputError, match="no such file"):
        run.open(tmp_path / "none.scene")
    wait(run, lambda frame: frame.grains == 1)


def test_while_the_run_is_held_things_are_made_and_the_drive_stays(run: Panes) -> None:
    run.start("workshop", {"grains": 0})
    wait(run, lambda frame: True)
    run.send(Protocol(True))
    wait(run, lambda frame: frame.increment > 3)
    run.pause_or_go_on()
    time.sleep(0.1)
    before = run.snapshot.frame
    assert before is not None
    run.send(Place(20.0, 4.0, "regular"))
    frame = wait(run, lambda frame: frame.grains == 1)
    frame = wait(run, lambda frame: not frame.busy)
    assert frame.stroke == before.stroke
    assert frame.increment == before.increment + 1
    run.send(Undo())
    wait(run, lambda frame: frame.grains == 0)


def test_refusals_are_counted_for_the_window(run: Panes) -> None:
    run.start("workshop", {"grains": 0})
    wait(run, lambda frame: True)
    run.send(Place(-9.0, 4.0, "regular"))
    assert "inside" in wait(run, lambda frame: frame.refusals == 1).refusal


def test_what_a_file_has_is_put_side_by_side(run: Panes, file: Path) -> None:
    run.open(file)
    wait(run, lambda frame: frame.grains == 2)
    run.compare()
    assert len(run.snapshots) == 3
    regular, mixed, auxetic = (wait(run, lambda frame: frame.grains == 2, k) for k in range(3))
    assert not regular.auxetic.any()
    assert mixed.auxetic.tolist() == [False, True]
    assert auxetic.auxetic.all()
    for frame in (regular, mixed, auxetic):
        assert len(frame.bodies) == 3
    run.send(Place(16.0, 4.0, "regular"))
    for k in range(3):
        wait(run, lambda frame: frame.grains == 3, k)


def test_a_new_start_leaves_the_file_behind(run: Panes, file: Path) -> None:
    run.open(file)
    wait(run, lambda frame: frame.grains == 2)
    run.send(Change("grains", 7))
    wait(run, lambda frame: frame.grains == 7 and len(frame.bodies) == 2)
    made = run.snapshot.made
    assert made is not None
    assert made.file is None


def test_after_a_crash_the_next_run_goes_on(tmp_path: Path) -> None:
    first = Panes("mixed", 1, autosave=Autosave(tmp_path, 0.02))
    first.start("workshop", {"grains": 0})
    wait(first, lambda frame: True)
    first.send(WALL)
    first.send(Place(10.0, 4.0, "auxetic"))
    wait(first, lambda frame: frame.grains == 1)
    first.close(clean=False)
    (leftover,) = find(tmp_path).leftovers
    autosave = Autosave(tmp_path, 0.02)
    second = Panes("regular", 5, autosave=autosave)
    second.take_up(leftover)
    frame = wait(second, lambda frame: frame.grains == 1)
    assert (frame.packing, frame.seed) == ("mixed", 1)
    assert len(frame.bodies) == 3
    wait(second, lambda _: not leftover.path.exists())
    kept = read_scene(autosave.path)
    assert kept.grains.hash() == leftover.file.grains.hash()
    second.close()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("trouble", ["a full disk", "a folder that is gone"])
def test_a_log_that_cannot_be_written_leaves_the_autosave(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, trouble: str
) -> None:
    log = tmp_path / "there" / "it.jsonl"
    run = Panes("mixed", 1, autosave=Autosave(tmp_path / "autosave", 0.02), log=log)
    if trouble == "a full disk":
        log.parent.mkdir()

        def full(_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(log_file, "atomic_write", full)
    run.start("workshop", {"grains": 0})
    wait(run, lambda frame: True)
    run.send(Place(10.0, 4.0, "auxetic"))
    wait(run, lambda frame: frame.grains == 1)
    end = time.monotonic() + PATIENCE
    while "it is tried again" not in run.tick():  # the person at the window is told, once
        assert time.monotonic() < end
        time.sleep(0.005)
    assert run.tick() == ""
    with pytest.raises(InputError, match=r"it.jsonl: no .*kept"):
        run.close()
    (leftover,) = find(tmp_path / "autosave").leftovers
    assert leftover.grains == 1


def test_a_clean_end_writes_the_log_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[str] = []
    log = tmp_path / "it.jsonl"
    run = Panes("mixed", 1, autosave=Autosave(tmp_path / "autosave", 0.02), log=log)
    run.start("workshop", {"grains": 0})
    wait(run, lambda frame: True)
    close_log, close = GrowingLog.close, Autosave.close

    def noted(one: GrowingLog) -> None:
        order.append("log")
        close_log(one)

    def noted_too(one: Autosave, clean: bool = True) -> None:
        order.append("autosave")
        close(one, clean)

    monkeypatch.setattr(GrowingLog, "close", noted)
    monkeypatch.setattr(Autosave, "close", noted_too)
    run.close()
    assert order == ["log", "autosave"]
    assert read_log(log).end == 0
    assert find(tmp_path / "autosave") == Found()


def test_the_log_is_that_of_the_scene_that_runs(tmp_path: Path) -> None:
    log = tmp_path / "it.jsonl"
    run = Panes("mixed", 1, autosave=None, log=log)
    run.start("workshop", {"grains": 0})
    wait(run, lambda _: log.exists())
    run.start("single_grain", packings=("regular", "auxetic"))
    run.send(Protocol(True))
    wait(run, lambda frame: frame.increment > 3)
    end = time.monotonic() + PATIENCE
    while read_log(log).end < 3:  # while it runs
        assert time.monotonic() < end
        run.tick()
        time.sleep(0.02)
    run.close()
    last = read_log(log)
    assert (last.scene, last.packing) == ("single_grain", "regular")
    assert list(replay(last))[-1].state_hash() == last.hash


def test_every_run_has_a_log(tmp_path: Path) -> None:
    """Whatever begins next: a scene, the same again, packings side by side, a file. What stood there is no place for one."""
    log = tmp_path / "it.jsonl"
    (tmp_path / "it-3.jsonl").write_text("somebody's")
    session = built(grains=6)
    write_scene(tmp_path / "it.scene", session.made())
    run = Panes("mixed", 1, autosave=None, log=log)
    begin: list[Callable[[], None]] = [
        lambda: run.start("single_grain"),
        lambda: run.start("single_grain"),
        lambda: run.start("grain_row", packings=("regular", "auxetic")),
        lambda: run.open(tmp_path / "it.scene"),
    ]
    ends: list[int] = []
    said: list[str] = []
    for each in begin:
        each()
        run.send(Protocol(True))
        ends.append(wait(run, lambda frame: frame.increment > 2, 0, said).increment)
        run.pause_or_go_on()
    run.start("hopper")  # is left before it is there
    run.close()
    names = ["it.jsonl", "it-2.jsonl", "it-4.jsonl", "it-5.jsonl"]
    assert [path.name for path in run.logs] == names
    assert [name in text for name, text in zip(names[1:], said, strict=True)] == [True] * 3
    found = [read_log(path) for path in run.logs]
    assert [one.scene for one in found] == ["single_grain", "single_grain", "grain_row", "workshop"]
    for one, end in zip(found, ends, strict=True):
        assert one.end >= end
        assert [*replay(one)][-1].state_hash() == one.hash
    assert (tmp_path / "it-3.jsonl").read_text() == "somebody's"


def test_a_log_before_that_could_not_be_written_is_told(tmp_path: Path) -> None:
    run = Panes("mixed", 1, autosave=None, log=tmp_path / "there" / "it.jsonl")
    run.start("single_grain")
    run.send(Protocol(True))
    wait(run, lambda frame: frame.increment > 2)
    run.start("single_grain")
    said: list[str] = []
    wait(run, lambda frame: True, 0, said)
    assert any(
        re.match(r"the log of the run before .*it.jsonl: no such", s, re.IGNORECASE) for s in said
    )
    with pytest.raises(InputError, match=r"it-2\.jsonl"):
        run.close()


def test_side_by_side_all_begin_together_from_the_file(run: Panes, tmp_path: Path) -> None:
    session = built(grains=6)
    do(session, *[Protocol(True)] * 4)
    write_scene(tmp_path / "it.scene", session.made())
    run.open(tmp_path / "it.scene")
    first = wait(run, lambda frame: True)
    assert first.increment >= 4
    run.compare()
    frames = [wait(run, lambda frame: True, k) for k in range(3)]
    assert [frame.increment for frame in frames] == [0, 0, 0]
    assert all(not frame.protocol for frame in frames)
    assert all(np.abs(frame.x - session.frame().x).max() < 0.2 for frame in frames)
