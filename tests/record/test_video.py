"""Films, animations and pictures: whole or not at all."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path
from typing import Any

import imageio.v2
import numpy as np
import pytest
from numpy.typing import NDArray

from core import files
from core.errors import InputError
from sandbox.record import video
from sandbox.record.video import VideoWriter

WIDTH, HEIGHT = 128, 96
PINK = (238, 51, 119)
GROUND = (16, 20, 24)
REPOSITORY = Path(__file__).parents[2]


def image(column: int = 0) -> NDArray[np.uint8]:
    """A pink square on the ground, at some column."""
    picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    picture[:] = GROUND
    picture[32:64, column : column + 32] = PINK
    return picture


def facts_of(path: Path) -> dict[str, Any]:
    reader: Any = imageio.v2.get_reader(path)
    with reader:
        return dict(reader.get_meta_data())


def frames_of(path: Path) -> list[NDArray[np.uint8]]:
    return [np.asarray(frame)[..., :3] for frame in imageio.v2.mimread(path, memtest=False)]


@pytest.mark.parametrize(("suffix", "tolerance"), [(".mp4", 12), (".webm", 12), (".gif", 0)])
def test_every_frame_arrives_with_its_colours(tmp_path: Path, suffix: str, tolerance: int) -> None:
    path = tmp_path / f"film{suffix}"
    # Frames 20 to 23 are alike: encoders like to merge these.
    columns = [2 * min(i, 20) for i in range(24)]
    with VideoWriter(path, (WIDTH, HEIGHT), 30) as writer:
        for column in columns:
            writer.write(image(column))
    frames = frames_of(path)
    assert len(frames) == writer.frames == len(columns)
    for frame, column in zip(frames, columns, strict=True):
        assert frame.shape == (HEIGHT, WIDTH, 3)
        np.testing.assert_allclose(frame[48, column + 16], PINK, atol=tolerance)
        np.testing.assert_allclose(frame[8, 120], GROUND, atol=tolerance)
    assert list(tmp_path.iterdir()) == [path]


def test_film_is_made_for_the_web_and_for_projectors(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    with VideoWriter(path, (WIDTH, HEIGHT), 25) as writer:
        for i in range(5):
            writer.write(image(i))
    content = path.read_bytes()
    assert content.index(b"moov") < content.index(b"mdat")  # plays while it still loads
    facts = facts_of(path)
    assert facts["codec"] == "h264"
    assert facts["pix_fmt"].startswith("yuv420p")
    assert facts["fps"] == 25.0
    assert facts["size"] == (WIDTH, HEIGHT)


def test_gif_repeats_for_ever_with_one_palette(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    with VideoWriter(path, (WIDTH, HEIGHT), 20) as writer:
        for i in range(5):
            writer.write(image(i))
    facts = facts_of(path)
    assert facts["loop"] == 0
    assert facts["duration"] == 50  # [ms]
    content = path.read_bytes()
    assert content[10] & 0x80  # a palette for the whole file


def test_picture_is_the_last_frame(tmp_path: Path) -> None:
    path = tmp_path / "last.png"
    with VideoWriter(path, (WIDTH, HEIGHT), 30) as writer:
        canvas = image(0)
        writer.write(canvas)
        canvas[:] = image(40)
        writer.write(canvas)
        canvas[:] = 0  # a renderer may reuse its canvas
    np.testing.assert_array_equal(imageio.v2.imread(path), image(40))


@pytest.mark.parametrize("suffix", video.SUFFIXES)
def test_error_keeps_the_earlier_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"earlier")
    with (
        pytest.raises(RuntimeError, match="solver"),
        VideoWriter(path, (WIDTH, HEIGHT), 30) as writer,
    ):
        writer.write(image())
        raise RuntimeError("solver")
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", video.SUFFIXES)
def test_ctrl_c_leaves_a_whole_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"earlier")
    with (
        pytest.raises(KeyboardInterrupt),
        VideoWriter(path, (WIDTH, HEIGHT), 30) as writer,
    ):
        for i in range(7):
            writer.write(image(i))
        raise KeyboardInterrupt
    assert len(frames_of(path)) == (1 if suffix == ".png" else 7)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", video.SUFFIXES)
def test_without_a_frame_nothing_is_published(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"earlier")
    with VideoWriter(path, (WIDTH, HEIGHT), 30):
        pass
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


def test_names_that_ffmpeg_would_read_otherwise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("-i.mp4", "http:%d é.mp4", "-f.gif"):
        with VideoWriter(name, (WIDTH, HEIGHT), 30) as writer:
            writer.write(image())
        assert len(frames_of(tmp_path / name)) == 1


def test_a_link_is_followed(tmp_path: Path) -> None:
    target = tmp_path / "kept" / "film.mp4"
    target.parent.mkdir()
    link = tmp_path / "link.mp4"
    link.symlink_to(target)
    with VideoWriter(link, (WIDTH, HEIGHT), 30) as writer:
        writer.write(image())
    assert link.is_symlink()
    assert len(frames_of(target)) == 1


@pytest.mark.parametrize("suffix", video.SUFFIXES)
def test_the_longest_names_that_there_are(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / ("ν" * ((255 - len(suffix)) // 2) + suffix)
    with VideoWriter(path, (WIDTH, HEIGHT), 30) as writer:
        writer.write(image())
    assert list(tmp_path.iterdir()) == [path]
    assert path.stat().st_size > 100


@pytest.mark.parametrize("suffix", [".gif", ".png"])
def test_animations_and_pictures_have_any_size(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"odd{suffix}"
    picture = image()[:-1, :-1]
    with VideoWriter(path, (WIDTH - 1, HEIGHT - 1), 30) as writer:
        writer.write(np.ascontiguousarray(picture))
    (frame,) = frames_of(path)
    np.testing.assert_array_equal(frame, picture)


@pytest.mark.parametrize(
    ("end", "loops", "last"), [("loop", 0, 4), ("once", None, 4), ("hold", 0, 200)]
)
def test_an_animation_ends_as_it_is_told(
    tmp_path: Path, end: str, loops: int | None, last: int
) -> None:
    path = tmp_path / "film.gif"
    with VideoWriter(path, (WIDTH, HEIGHT), 25, end) as writer:
        for column in range(3):
            writer.write(image(column))
    content = path.read_bytes()
    # The block that browsers ask how often, and those before each frame: the time that it is shown, in hundredths of a second.
    again = re.search(rb"NETSCAPE2\.0\x03\x01(..)\x00", content, re.DOTALL)
    assert (again and int.from_bytes(again[1], "little")) == loops
    shown = re.findall(rb"\x21\xf9\x04.(..).\x00", content, re.DOTALL)
    assert [int.from_bytes(time, "little") for time in shown] == [4, 4, last]


def test_an_ffmpeg_without_webm_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(video, "_ffmpeg", lambda *_: " V....D libx264  H.264")
    with pytest.raises(InputError, match=r"cannot write \.webm.*: write \.mp4"):
        VideoWriter(tmp_path / "film.webm", (WIDTH, HEIGHT), 30)


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices of POSIX")
@pytest.mark.parametrize("suffix", video.SUFFIXES)
def test_pipes_and_devices_are_written_to(tmp_path: Path, suffix: str) -> None:
    """A pipe, and a link to a device, are still that afterwards, and have got all of it."""
    with VideoWriter(tmp_path / f"plain{suffix}", (WIDTH, HEIGHT), 30) as writer:
        writer.write(image())
    pipe, link = tmp_path / f"pipe{suffix}", tmp_path / f"link{suffix}"
    os.mkfifo(pipe)
    link.symlink_to(os.devnull)
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()), daemon=True)
    reader.start()
    for path in (link, pipe):
        with VideoWriter(path, (WIDTH, HEIGHT), 30) as writer:
            writer.write(image())
    reader.join(60)
    assert got == [(tmp_path / f"plain{suffix}").read_bytes()]
    assert pipe.is_fifo()
    assert link.is_symlink()
    assert Path(os.devnull).is_char_device()
    assert len(list(tmp_path.iterdir())) == 3


def test_mistakes_are_found_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"film\.avi.*\.mp4"):
        VideoWriter(tmp_path / "film.avi", (WIDTH, HEIGHT), 30)
    with pytest.raises(InputError, match="even"):
        VideoWriter(tmp_path / "film.mp4", (WIDTH + 1, HEIGHT), 30)
    with (
        VideoWriter(tmp_path / "film.mp4", (WIDTH, HEIGHT), 30) as writer,
        pytest.raises(ValueError, match="uint8"),
    ):
        writer.write(image()[:, ::2])


def run_writer(folder: Path, body: str) -> subprocess.CompletedProcess[str]:
    """Run ``body`` with a writer of noise to film.mp4 or film.gif in a process of its own."""
    start = """
        import os, resource, signal, sys, threading, time
        import numpy as np
        from core.errors import InputError
        from sandbox.record.video import VideoWriter
        noise = np.random.default_rng(1).integers(0, 256, (240, 320, 3)).astype(np.uint8)
    """
    script = textwrap.dedent(start) + textwrap.dedent(body)
    return subprocess.run(
        [sys.executable, "-c", script],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.mark.end_to_end
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no file size limit to set")
@pytest.mark.parametrize("suffix", video.SUFFIXES)
def test_no_room_is_told_in_one_line_and_keeps_the_earlier_file(
    tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"earlier")
    done = run_writer(
        tmp_path,
        f"""
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
        try:
            with VideoWriter("film{suffix}", (320, 240), 30) as writer:
                for i in range(200):
                    writer.write(np.roll(noise, i, 0))
        except InputError as error:
            sys.exit(str(error))
        """,
    )
    assert done.returncode == 1, done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert f"film{suffix}: file too large" in done.stderr
    assert "earlier file was kept" in done.stderr
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
def test_last_bytes_that_found_no_room_are_noticed(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The encoder ends without a word when its trailer cannot be written."""
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"earlier")
    counted = video._count_frames
    monkeypatch.setattr(video, "_count_frames", lambda part: counted(part) - 1)
    with (
        pytest.raises(InputError, match="earlier file was kept"),
        VideoWriter(path, (WIDTH, HEIGHT), 30) as writer,
    ):
        writer.write(image())
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.end_to_end
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_at_any_moment_leaves_a_whole_film(tmp_path: Path) -> None:
    """Interrupts arrive while a frame is being piped to the encoder; none may cut it in half."""
    done = run_writer(
        tmp_path,
        """
        def press():
            time.sleep(0.3)
            os.kill(os.getpid(), signal.SIGINT)

        try:
            with VideoWriter("film.mp4", (320, 240), 30) as writer:
                threading.Thread(target=press).start()
                while True:
                    writer.write(noise)
        except KeyboardInterrupt:
            print(writer.frames)
        """,
    )
    assert done.returncode == 0, done.stderr
    assert len(frames_of(tmp_path / "film.mp4")) == int(done.stdout) > 0
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


@pytest.mark.end_to_end
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="signals of POSIX")
def test_a_killed_program_leaves_the_earlier_file_and_offers_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "film.mp4"
    path.write_bytes(b"earlier")
    done = run_writer(
        tmp_path,
        """
        writer = VideoWriter("film.mp4", (320, 240), 30)
        for i in range(20):
            writer.write(noise)
        os.kill(os.getpid(), signal.SIGKILL)
        """,
    )
    assert done.returncode == -signal.SIGKILL
    assert path.read_bytes() == b"earlier"
    unfinished = tmp_path / "film.unfinished.mp4"
    (part,) = tmp_path.glob(".film.*.part.mp4")
    end = time.monotonic() + 60.0
    while b"moov" not in part.read_bytes():  # its encoder ends by itself
        assert time.monotonic() < end
        time.sleep(0.01)
    monkeypatch.setattr(files, "SETTLED", 0.0)
    assert files.clear(tmp_path, path.name) == [unfinished]
    assert sorted(tmp_path.iterdir()) == [path, unfinished]
    assert len(frames_of(unfinished)) == 20
    assert "film.unfinished.mp4" in caplog.text
    # Another one, and a third: none takes the place of one that is there.
    film = unfinished.read_bytes()
    for number in (2, 3):
        (tmp_path / part.name).write_bytes(film)
        assert files.clear(tmp_path, path.name) == [tmp_path / f"film.unfinished-{number}.mp4"]
    assert [p.read_bytes() for p in tmp_path.glob("film.unfinished*")] == [film] * 3
