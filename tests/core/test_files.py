"""Files are whole or not there, keep what stood there, and killed writers leave nothing for long."""

from __future__ import annotations

import os
import stat
import sys
import threading
from pathlib import Path

import pytest

from core import files
from core.files import atomic_write

posix = pytest.mark.skipif(sys.platform == "win32", reason="permissions, pipes, locks of POSIX")


def write(path: Path, content: bytes = b"new") -> None:
    with atomic_write(path) as file:
        file.write(content)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@posix
@pytest.mark.parametrize("before", [0o600, 0o640, 0o664, 0o755])
def test_permissions_are_kept(tmp_path: Path, before: int) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"old")
    path.chmod(before)
    write(path)
    assert (path.read_bytes(), mode(path)) == (b"new", before)


@posix
def test_a_new_file_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "other").touch()
    write(tmp_path / "file")
    assert mode(tmp_path / "file") == mode(tmp_path / "other")


@posix
@pytest.mark.skipif(
    sys.platform == "win32" or os.geteuid() != 0, reason="only root can give files away"
)
def test_the_owner_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.touch(0o600)
    os.chown(path, 1234, 2345)
    write(path)
    assert (path.stat().st_uid, path.stat().st_gid, mode(path)) == (1234, 2345, 0o600)


@posix
def test_links_are_followed(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / "file", tmp_path / "link"
    link.symlink_to(target)
    for content in (b"new", b"newer"):  # where it leads there is nothing at first
        write(link, content)
        assert link.is_symlink()
        assert target.read_bytes() == content
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    with pytest.raises(OSError, match="symbolic links"):
        write(tmp_path / "circle")


@posix
def test_pipes_and_devices_are_written_to(tmp_path: Path) -> None:
    pipe, link = tmp_path / "pipe", tmp_path / "link"
    os.mkfifo(pipe)
    link.symlink_to(os.devnull)
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()), daemon=True)
    reader.start()
    for path in (link, Path(os.devnull), pipe):
        write(path)
    reader.join(60)
    assert got == [b"new"]
    assert pipe.is_fifo()
    assert Path(os.devnull).is_char_device()
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("letter", ["x", "ν"])
def test_names_as_long_as_the_system_takes(tmp_path: Path, letter: str) -> None:
    path = tmp_path / (letter * (255 // len(letter.encode())))
    files.try_writing(path)
    assert not list(tmp_path.iterdir())
    write(path)
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(OSError, match="too long"):
        files.try_writing(tmp_path / (path.name + letter))


@posix
def test_what_the_dead_have_left_goes_and_all_else_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    mine, other = tmp_path / "film.mp4", tmp_path / "film.gif"
    dead = [files.hidden(mine, kind) for kind in ("tmp", "part.mp4", "part.mkv")]
    of_other = files.hidden(other, "tmp")
    foreign = [
        tmp_path / name
        for name in (".film.mp4", ".film.mp4.swp", ".film.mp4.notes.tmp", "film.mp4")
    ]
    for path in (*dead, of_other, *foreign):
        path.touch()
    files.clear(tmp_path, mine.name)
    assert all(path.exists() for path in dead)  # perhaps they get their names just now
    monkeypatch.setattr(files, "SETTLED", 0.0)
    with dead[0].open("rb") as file:
        files.lock(file.fileno())
        files.clear(tmp_path, mine.name)
        assert [path.exists() for path in dead] == [True, False, False]
    assert of_other.exists()
    files.clear(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(foreign)
    assert [record.message.split(",")[0] for record in caplog.records] == [
        "removed half a film"
    ] * 2
    files.clear(tmp_path / "nowhere")
