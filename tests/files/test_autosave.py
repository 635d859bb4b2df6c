"""Autosave: what a crash leaves is found and gone on with; a clean end leaves nothing."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sandbox.files import autosave
from sandbox.files.autosave import ASIDE, Autosave, Found, find
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import DrawWall, Place, Protocol
from sandbox.session.session import Session
from tests.session.edited import built, do

REPOSITORY = Path(__file__).parents[2]
NEVER = 1e6  # [s] the thread does not write by itself
CRASHES = """
import sys, time
from pathlib import Path
from sandbox.files.autosave import Autosave
from sandbox.session.commands import DrawWall, Place
from sandbox.session.session import Session

session = Session("workshop", "mixed", 1, {"grains": 12})
session.build()
saved = Autosave(Path(sys.argv[1]), every=0.05)
for command in (Place(15.0, 3.0, "auxetic"), DrawWall(((12.0, 16.0), (18.0, 15.0)))):
    session.submit(command)
    while not session.advance(1000):
        pass
    saved.keep(session.made())
while not saved.path.exists():
    time.sleep(0.01)
time.sleep(0.2)
print(session.run.setup.packing.hash(), flush=True)
time.sleep(600)
"""


@pytest.fixture
def saved(tmp_path: Path) -> Iterator[Autosave]:
    one = Autosave(tmp_path, NEVER)
    yield one
    one.close()


def made_something() -> Session:
    session = built(grains=5)
    do(session, Place(15.0, 3.0, "auxetic"), DrawWall(((12.0, 16.0), (18.0, 15.0))))
    return session


def crash(one: Autosave) -> None:
    """End as a program does that is killed: nothing is taken away, the system lets go of the lock."""
    one._lock.release()


@pytest.mark.end_to_end
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 here")
def test_after_kill_9_the_same_grains_are_there(tmp_path: Path) -> None:
    program = subprocess.Popen(
        [sys.executable, "-c", CRASHES, str(tmp_path)],
        cwd=REPOSITORY,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert program.stdout is not None
    with program, program.stdout:
        digest = program.stdout.readline().strip()
        assert len(digest) == 64
        assert find(tmp_path) == Found()  # it still runs
        program.send_signal(signal.SIGKILL)
    (leftover,) = find(tmp_path).leftovers
    assert (leftover.scene, leftover.grains) == ("workshop", 13)
    assert abs(leftover.saved - time.time()) < 600.0
    session = Session.from_file(leftover.file)
    session.build()
    assert session.run.setup.packing.hash() == digest
    assert len(session.run.setup.world.drawn) == 1
    do(session, Place(20.0, 3.0, "regular"))
    assert session.frame().grains == 14
    leftover.remove()
    assert not list(tmp_path.iterdir())


def test_a_clean_end_leaves_nothing(tmp_path: Path) -> None:
    one = Autosave(tmp_path, NEVER)
    one.keep(made_something().made())
    assert one.write()
    assert list(tmp_path.glob("*.scene")) == [one.path]
    one.close()
    assert not list(tmp_path.iterdir())


def test_any_other_end_leaves_the_newest_state(tmp_path: Path) -> None:
    session = made_something()
    one = Autosave(tmp_path, NEVER)
    one.keep(session.made())
    one.close(clean=False)
    (leftover,) = find(tmp_path).leftovers
    assert leftover.file.grains.hash() == session.run.setup.packing.hash()
    empty = Autosave(tmp_path / "empty", NEVER)
    empty.close(clean=False)
    assert not list((tmp_path / "empty").iterdir())


def test_it_is_written_only_when_there_is_something_new(saved: Autosave) -> None:
    session = built(grains=5)
    saved.keep(None)
    saved.keep(session.made())  # nobody has done anything yet
    assert not saved.write()
    do(session, Protocol(True))
    saved.keep(session.made())
    assert saved.write()
    saved.keep(session.made())
    assert not saved.write()
    do(session, Protocol(False), Place(15.0, 3.0, "regular"))
    saved.keep(session.made())
    assert saved.write()
    assert sorted(p.suffix for p in saved.path.parent.iterdir()) == [".lock", ".scene"]


def test_the_thread_writes_by_itself(tmp_path: Path) -> None:
    one = Autosave(tmp_path, 0.01)
    one.keep(made_something().made())
    patience = time.monotonic() + 30.0
    while not one.path.exists():
        assert time.monotonic() < patience
        time.sleep(0.01)
    one.close()


def test_handing_over_and_writing_are_quick(saved: Autosave) -> None:
    """The solver's thread hands over only; even the writing would be no hitch in a picture."""
    session = built(grains=150)
    times = {"hand over": [], "write": []}  # type: dict[str, list[float]]
    for k in range(8):
        do(session, Place(5.0 + k, 2.0, "regular"), Protocol(True))
        # Of this thread's processor: the machine may be busy with something else, and the quickest counts.
        begun = time.thread_time()
        saved.keep(session.made())
        handed = time.thread_time()
        saved.write()
        times["hand over"].append(handed - begun)
        times["write"].append(time.thread_time() - handed)
    assert min(times["hand over"]) < 0.001
    assert min(times["write"]) < 0.010


def test_running_programs_are_left_alone(tmp_path: Path, saved: Autosave) -> None:
    other = Autosave(tmp_path, NEVER)
    for one in (saved, other):
        one.keep(made_something().made())
        one.write()
    assert find(tmp_path) == Found()
    crash(other)
    assert [one.path for one in find(tmp_path).leftovers] == [other.path]
    assert other.path != saved.path
    other.close()
    assert find(tmp_path) == Found()
    assert saved.path.exists()


def test_what_is_gone_on_with_is_taken_away_when_it_is_saved_again(tmp_path: Path) -> None:
    gone = Autosave(tmp_path, NEVER)
    gone.keep(made_something().made())
    gone.write()
    crash(gone)
    (leftover,) = find(tmp_path).leftovers
    session = Session.from_file(leftover.file)
    session.build()
    one = Autosave(tmp_path, NEVER)
    one.adopt(leftover)
    assert gone.path.exists()
    one.keep(session.made())  # nothing was done yet, but there is something to lose
    assert one.write()
    assert not gone.path.exists()
    crash(one)
    (again,) = find(tmp_path).leftovers
    assert again.file.grains.hash() == leftover.file.grains.hash()
    assert isinstance(again.file, SceneFile)


def test_what_is_gone_on_with_stays_if_it_never_ran(tmp_path: Path) -> None:
    gone = Autosave(tmp_path, NEVER)
    gone.keep(made_something().made())
    gone.write()
    crash(gone)
    (leftover,) = find(tmp_path).leftovers
    one = Autosave(tmp_path, NEVER)
    one.adopt(leftover)
    one.keep(made_something().made())  # something else was begun instead
    one.write()
    one.close()
    assert gone.path.exists()
    assert len(find(tmp_path).leftovers) == 1


def newer(path: Path) -> None:
    rewrite_head(path, lambda head: head.update(version=9))


def one_key_more(path: Path) -> None:
    rewrite_head(path, lambda head: head.update(speed=1))


def scene_not_there(path: Path) -> None:
    rewrite_head(path, lambda head: head.update(scene="trampoline"))


def half(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:1000])


def forbidden(path: Path) -> None:
    path.chmod(0)
    if os.access(path, os.R_OK):
        pytest.skip("nothing is forbidden to this person")


def a_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def rewrite_head(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    with zipfile.ZipFile(path) as archive:
        content = {info.filename: archive.read(info) for info in archive.infolist()}
    head = json.loads(content["scene.json"])
    change(head)
    content["scene.json"] = json.dumps(head).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, part in content.items():
            archive.writestr(name, part)


@pytest.mark.parametrize("spoil", [newer, one_key_more, scene_not_there, half, forbidden, a_folder])
def test_what_cannot_be_read_is_set_aside_and_named(
    tmp_path: Path, spoil: Callable[[Path], None]
) -> None:
    gone = Autosave(tmp_path, NEVER)
    gone.keep(made_something().made())
    gone.write()
    crash(gone)
    spoil(gone.path)
    content = gone.path.read_bytes() if gone.path.is_file() and spoil is not forbidden else b""
    others = [tmp_path / name for name in ("autosave-mine.scene", "notes.scene")]
    for other in others:
        other.write_text("mine")
    found = find(tmp_path)
    assert found.leftovers == ()
    (aside,) = found.set_aside
    assert aside.path == tmp_path / ASIDE / gone.path.name
    assert aside.path.exists()
    assert aside.why
    assert "\n" not in aside.why
    if content:
        assert aside.path.read_bytes() == content  # never changed, never deleted
    assert all(other.exists() for other in others)
    assert find(tmp_path) == Found()  # it is said once
    assert not list(tmp_path.glob("*.lock"))


def test_what_an_older_program_left_is_found_and_set_aside_too(tmp_path: Path) -> None:
    pairs = Path(__file__).parent / "pairs"
    path = tmp_path / "autosave-12-0123abcd.toml"
    text = (pairs / "workshop.toml").read_text(encoding="utf-8")
    path.write_text(text.replace("workshop.npz", f"{path.stem}.1.npz"), encoding="utf-8")
    grains = path.with_name(f"{path.stem}.1.npz")
    grains.write_bytes((pairs / "workshop.npz").read_bytes())
    (leftover,) = find(tmp_path).leftovers
    assert leftover.scene == "workshop"
    grains.write_bytes(b"")
    (aside,) = find(tmp_path).set_aside
    assert sorted(p.name for p in aside.path.parent.iterdir()) == [grains.name, path.name]
    assert [p.name for p in tmp_path.iterdir()] == [ASIDE]


def test_without_a_folder_there_is_none(tmp_path: Path) -> None:
    assert find(tmp_path / "nowhere") == Found()
    (tmp_path / "file").write_text("")
    assert autosave.begin(tmp_path / "file") is None


def test_the_folder_is_the_persons_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("other systems say it otherwise")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert autosave.folder() == tmp_path / "auxetic-sandbox" / "autosave"
    one = autosave.begin()
    assert one is not None
    assert one.path.parent == autosave.folder()
    one.close()
