"""Frames to a film (.mp4, .webm), an animation (.gif) or a picture of the last frame (.png).

Whatever happens, the file that stood at the path before stays until the new one is whole: frames
go to a hidden name in the same folder, which is renamed at the end. Ctrl-C also ends in a whole
file. What goes to a pipe or a device is made in the folder for temporary files, and copied.
"""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Self

import numpy as np
from numpy.typing import NDArray

from core import files
from core.errors import InputError, reason_of
from core.files import atomic_write
from sandbox.files.pipes import with_reader
from sandbox.interrupts import deferred

SUFFIXES = (".mp4", ".webm", ".gif", ".png")

Image = NDArray[np.uint8]

# Players take untagged HD film for BT.709 while ffmpeg converts by BT.601: say and do the same.
_BT709 = "setparams=colorspace=bt709:color_primaries=bt709:color_trc=bt709:range=tv"
_TO_BT709 = ["-vf", f"scale=out_color_matrix=bt709:out_range=tv,{_BT709}"]
_MP4 = {
    "codec": "libx264",
    "pixelformat": "yuv420p",  # what every browser, phone and projector laptop can show
    "macro_block_size": 2,  # yuv420p halves the colour planes, which is why sizes are even
    "quality": None,
    "ffmpeg_params": ["-preset", "veryfast", "-crf", "20", "-movflags", "+faststart", *_TO_BT709],
}
_VP9, _VP8 = "libvpx-vp9", "libvpx"
_WEBM = {
    "pixelformat": "yuv420p",
    "macro_block_size": 1,
    "quality": None,
    "ffmpeg_params": [
        *("-crf", "36", "-b:v", "0", "-deadline", "realtime", "-cpu-used", "5"),
        *("-auto-alt-ref", "0", "-f", "webm", "-fflags", "+bitexact", *_TO_BT709),
    ],
}
# How an animation ends: it begins again, stays at its last frame, or begins again after that has stood for a while.
GIF_ENDS = {"loop": ("-loop", "0"), "once": ("-loop", "-1"), "hold": ("-loop", "0")}
HOLD = 2.0  # [s]
# A GIF needs the palette of the whole film before its first frame can be written, so frames wait in
# a lossless file: memory stays flat however long the film is.
_LOSSLESS = {
    "codec": "libx264rgb",
    "pixelformat": "rgb24",
    "macro_block_size": 1,
    "quality": None,
    "ffmpeg_params": ["-preset", "ultrafast", "-qp", "0"],
}
_PROBE_BYTES = 1 << 22


class VideoWriter:
    """Writes frames (h, w, 3) of ``size`` (w, h) [px] to ``path`` at ``fps`` frames a second.

    A context manager: leaving it normally, or by Ctrl-C, publishes the file; leaving it by any
    other exception removes what was written so far. With no frame written nothing is published.
    ``gif`` is one of ``GIF_ENDS``. Raises InputError, in one line, for what a person can mend: the
    suffix, the size, a full disk, an ffmpeg that cannot write such films.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        size: tuple[int, int],
        fps: float,
        gif: str = "loop",
    ) -> None:
        # Absolute, since ffmpeg would take "a:b.mp4" for a protocol and "-a.mp4" for an option.
        self.path = files.followed(path)
        self.suffix = Path(path).suffix.lower()
        if self.suffix not in SUFFIXES:
            raise InputError(f"{path}: cannot write this kind of file; use {', '.join(SUFFIXES)}")
        if self.suffix == ".mp4" and (size[0] % 2 or size[1] % 2):
            raise InputError(f"a film needs even width and height, not {size[0]}x{size[1]}")
        self.size = size
        self.fps = fps
        self.gif = gif
        self.frames = 0
        special = files.is_special(self.path)
        near = Path(tempfile.gettempdir(), self.path.name) if special else self.path
        # A name that ``core.files`` knows again; WebM is a kind of Matroska.
        own = ".mkv" if self.suffix == ".webm" else self.suffix
        self._temporary = files.hidden(near, f"part{own}")
        self._lossless = files.hidden(near, "part.mkv")
        self._palette = files.hidden(near, "part.png")
        self._claimed: list[BinaryIO] = []  # open as long as this is at work: see core.files
        self._encoder: Any = None
        self._last: Image | None = None
        if self.suffix != ".png":
            _ffmpeg_program()
        self._webm = {"codec": webm_codec(), **_WEBM} if self.suffix == ".webm" else {}

    def write(self, image: Image) -> None:
        """Append one frame, uint8 (h, w, 3)."""
        width, height = self.size
        if image.shape != (height, width, 3) or image.dtype != np.uint8:
            raise ValueError(
                f"a frame must be uint8 ({height}, {width}, 3), not {image.dtype} {image.shape}"
            )
        with deferred():
            if self.suffix == ".png":
                self._last = image.copy()
            else:
                try:
                    if self._encoder is None:
                        self._encoder = self._open_encoder()
                    self._encoder.append_data(image)
                except OSError as error:
                    raise self._failed(error) from error
            self.frames += 1

    def close(self) -> None:
        """Finish the file and give it its name."""
        with deferred():
            try:
                if self.frames:
                    with with_reader(self.path):
                        self._finish()
            except OSError as error:
                raise self._failed(error) from error
            finally:
                self._remove_temporaries()

    def discard(self) -> None:
        """Forget everything that was written; the earlier file stays."""
        with deferred():
            self._close_encoder()
            self._remove_temporaries()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None or issubclass(kind, KeyboardInterrupt):
            self.close()
        else:
            self.discard()

    def _open_encoder(self) -> Any:
        import imageio.v2

        options = {".mp4": _MP4, ".webm": self._webm, ".gif": _LOSSLESS}[self.suffix]
        target = self._lossless if self.suffix == ".gif" else self._temporary
        self._claim(target)
        # ffmpeg's own messages are many lines long; _failed finds out what went wrong instead. Those of its wrapper tell of
        # broken pipes, if ffmpeg has not quite ended yet.
        logging.getLogger("imageio_ffmpeg").setLevel(logging.ERROR)
        return imageio.v2.get_writer(
            target, format="FFMPEG", mode="I", fps=self.fps, ffmpeg_log_level="quiet", **options
        )

    def _claim(self, *paths: Path) -> None:
        """Make files that ffmpeg will write, and say that somebody is at work on them."""
        for path in paths:
            self._claimed.append(path.open("xb"))
            files.lock(self._claimed[-1].fileno())

    def _release(self) -> None:
        while self._claimed:
            self._claimed.pop().close()

    def _close_encoder(self) -> None:
        encoder, self._encoder = self._encoder, None
        if encoder is not None:
            encoder.close()

    def _finish(self) -> None:
        self._close_encoder()
        if self.suffix == ".png":
            assert self._last is not None
            write_picture(self.path, self._last)
            return
        if self.suffix == ".gif":
            self._make_gif()
        # The encoder does not say that its last bytes found no room, so the frames are counted.
        found = _count_frames(self._temporary)
        if found != self.frames:
            raise OSError(f"{found} of {self.frames} frames arrived in the file")
        self._release()  # Windows renames no open file
        files.publish(self._temporary, self.path)

    def _make_gif(self) -> None:
        """One palette made from all frames: no flicker, and small differences between frames."""
        self._claim(self._palette, self._temporary)
        wait = ("-final_delay", str(round(100 * HOLD))) if self.gif == "hold" else ()
        _ffmpeg("-i", self._lossless, "-vf", "palettegen", "-update", "1", self._palette)
        _ffmpeg(
            *("-i", self._lossless, "-i", self._palette),
            *("-lavfi", "paletteuse=dither=none:diff_mode=rectangle"),
            *(*GIF_ENDS[self.gif], *wait, self._temporary),
        )

    def _failed(self, error: OSError) -> InputError:
        """Explain in one line why the file could not be written, then tidy up.

        The folder is tried while the part file still takes its room: a full disk then shows itself.
        """
        reason = _why_not_writable(self.path.parent) or f"the encoder stopped ({_one_line(error)})"
        self.discard()
        _let_go_of_pipes(error)
        kept = "; the earlier file was kept" if self.path.is_file() else ""
        return InputError(f"cannot write {self.path}: {reason}{kept}")

    def _remove_temporaries(self) -> None:
        self._release()
        for path in (self._temporary, self._lossless, self._palette):
            path.unlink(missing_ok=True)


def _let_go_of_pipes(error: BaseException | None) -> None:
    """Let those be closed whose encoder has died, and be quiet about it: from Python 3.14 on they complain, whenever that is."""
    hook, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        while error is not None:
            traceback.clear_frames(error.__traceback__)
            error = error.__context__
    finally:
        sys.unraisablehook = hook


def write_picture(path: Path, image: Image) -> None:
    """Write one image, uint8 (h, w, 3), as PNG."""
    import imageio.v2

    content = imageio.v2.imwrite("<bytes>", image, format="png")
    with atomic_write(path) as file:
        file.write(content)


def _why_not_writable(folder: Path) -> str | None:
    """What the system says when some bytes are written to the folder, or None if all goes well."""
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(bytes(_PROBE_BYTES))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return f"{reason_of(error)} in {folder}"
    return None


def _ffmpeg_program() -> str:
    import imageio_ffmpeg

    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError as error:
        raise InputError(
            "no ffmpeg was found: reinstall it with pip install --force-reinstall imageio-ffmpeg"
        ) from error


def webm_codec() -> str:
    """The better one of what this ffmpeg has for WebM. Raises InputError if it has none."""
    known = {line.split()[1] for line in _ffmpeg("-encoders").splitlines() if len(line.split()) > 1}
    for codec in (_VP9, _VP8):
        if codec in known:
            return codec
    raise InputError(
        "this ffmpeg cannot write .webm, as it is built without libvpx: write .mp4, or name another "
        "ffmpeg in the environment variable IMAGEIO_FFMPEG_EXE"
    )


def _ffmpeg(*arguments: str | Path) -> str:
    """Run ffmpeg, out of reach of the terminal's Ctrl-C, and return its standard output.

    Raises OSError with its messages if it fails.
    """
    done = subprocess.run(
        [_ffmpeg_program(), "-nostdin", "-y", "-v", "error", *map(str, arguments)],
        check=False,
        capture_output=True,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    if done.returncode:
        raise OSError(done.stderr.strip() or f"ffmpeg ended with code {done.returncode}")
    return done.stdout


def _count_frames(path: Path) -> int:
    """How many frames a file holds; reads them without decoding, a line of checksums each."""
    lines = _ffmpeg("-i", path, "-map", "0:v:0", "-c", "copy", "-f", "framecrc", "-").splitlines()
    return sum(not line.startswith("#") for line in lines)


def _one_line(error: OSError) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
