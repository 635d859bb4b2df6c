"""From the words on the command line to checked values. Nothing here takes long or writes a file.

Every function raises InputError with one line: what is wrong, and what to do about it.
"""

from __future__ import annotations

import argparse
import math
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from core.errors import InputError, did_you_mean, reason_of
from core.files import clear, followed, try_writing
from sandbox.files.pipes import hold
from scenes.parameter import shown

SMALLEST_SIZE = (320, 240)
LARGEST_SIZE = (7680, 4320)
HIGHEST_FPS = {".mp4": 120.0, ".webm": 120.0, ".gif": 50.0, ".png": 120.0}
MOST_STEPS = 1_000_000
LONGEST_LINE = 400  # letters of a message

T = TypeVar("T")


def one_line(message: str) -> str:
    """A message for the terminal: one line, and not a page of what somebody gave."""
    plain = " ".join(message.split())
    return plain if len(plain) <= LONGEST_LINE else f"{plain[: LONGEST_LINE - 2]} …"


class Parser(argparse.ArgumentParser):
    """An argument parser that raises InputError where argparse prints its usage and exits."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.options: list[str] = []
        kwargs["allow_abbrev"] = False
        super().__init__(*args, **kwargs)

    def add_argument(self, *names: str, **kwargs: Any) -> argparse.Action:
        self.options += [name for name in names if name.startswith("--")]
        return super().add_argument(*names, **kwargs)

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message.removeprefix('argument ')}; see {self.prog} --help")

    def refuse_leftovers(self, words: Sequence[str]) -> None:
        """Raise InputError if the parser understood not all words."""
        for word in words:
            if word.startswith("-"):
                option = word.split("=", 1)[0]
                raise InputError(
                    f"unknown option {option}{did_you_mean(option, self.options)}"
                    f"; see {self.prog} --help"
                )
        if words:
            raise InputError(f"unexpected argument {words[0]!r}; see {self.prog} --help")


def any_of(choices: Sequence[str]) -> str:
    """``a, b or c``."""
    return " or ".join(filter(None, [", ".join(choices[:-1]), *choices[-1:]]))


def argument(parse: Callable[[str], T]) -> Callable[[str], T]:
    """Make a function of this module fit for ``type=``, so that argparse names the option."""

    def checked(text: str) -> T:
        try:
            return parse(text)
        except InputError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return checked


def one_of(*choices: str) -> Callable[[str], str]:
    """A parser for one of a few words."""

    def parse(text: str) -> str:
        if text not in choices:
            raise InputError(
                f"unknown value {text!r}{did_you_mean(text, choices)}: use {any_of(choices)}"
            )
        return text

    return parse


def size(text: str) -> tuple[int, int]:
    """``WIDTHxHEIGHT`` [px]."""
    match = re.fullmatch(r"(\d{1,6})[x×](\d{1,6})", text.strip().lower())
    if match is None:
        raise InputError(f"{text!r} is not a size: write WIDTHxHEIGHT, such as 1280x720")
    width, height = int(match[1]), int(match[2])
    fits = all(
        low <= n <= high
        for low, n, high in zip(SMALLEST_SIZE, (width, height), LARGEST_SIZE, strict=True)
    )
    if not fits:
        low, high = ("{}x{}".format(*limit) for limit in (SMALLEST_SIZE, LARGEST_SIZE))
        raise InputError(f"{text} is out of range: use a size from {low} to {high}")
    return width, height


def whole_number(low: int, high: int) -> Callable[[str], int]:
    """A parser for an integer in a range."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise InputError(f"{shown(text)} is no whole number from {low} to {high}") from None
        if not low <= value <= high:
            raise InputError(f"{value} is out of range: use {low} to {high}")
        return value

    return parse


def number(low: float, high: float) -> Callable[[str], float]:
    """A parser for a finite number in a range."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            raise InputError(f"{text!r} is not a number") from None
        if not (math.isfinite(value) and low <= value <= high):
            raise InputError(f"{text} is out of range: use {low:g} to {high:g}")
        return value

    return parse


def check_size(size: tuple[int, int], suffix: str) -> None:
    """A film needs even numbers, as it has a colour for each four pixels; pictures and animations take any."""
    width, height = size
    if suffix == ".mp4" and (width % 2 or height % 2):
        even = f"{width + width % 2}x{height + height % 2}"
        raise InputError(f"--size: a film needs even numbers, not {width}x{height}: use {even}")


def check_fps(fps: float, suffix: str) -> None:
    """A GIF stores whole hundredths of a second, and browsers slow down anything under two."""
    highest = HIGHEST_FPS[suffix]
    if fps > highest:
        raise InputError(f"--fps {fps:g} is too fast for {suffix}: use {highest:g} at most")


def output_file(option: str, text: str, suffixes: Sequence[str]) -> Path:
    """A path that can be written: right suffix, existing folder, nothing in the way."""
    path = Path(text)
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{option} {text}: the name must end in {' or '.join(suffixes)}")
    try:
        return _writable(option, text, path)
    except ValueError as error:  # a name that no system takes
        if isinstance(error, InputError):
            raise
        raise InputError(f"{option} {text!r}: this is no file name ({error})") from None
    except OSError as error:
        reason = reason_of(error)
        raise InputError(f"{option} {text}: cannot be written ({reason})") from None


def _writable(option: str, text: str, path: Path) -> Path:
    target = followed(path)
    folder = target.parent
    if not folder.is_dir():
        raise InputError(f"{option} {text}: there is no folder {folder}; make it first")
    if path.is_dir():
        raise InputError(f"{option} {text}: this is a folder; give a file name")
    if path.exists() and not os.access(path, os.W_OK):
        raise InputError(f"{option} {text}: this file is write-protected; choose another name")
    clear(folder, target.name)
    # Only an attempt tells about read-only file systems, quotas, access lists, and names that are too long.
    try_writing(path)
    try:
        hold(path)
    except InputError as error:
        raise InputError(f"{option} {error}") from None
    return path


def check_different(files: dict[str, Path | None]) -> None:
    """Raise InputError if two options name the same file, be it through a link."""
    seen: dict[Path, str] = {}
    for option, path in files.items():
        if path is None:
            continue
        earlier = seen.setdefault(path.resolve(), option)
        if earlier != option:
            raise InputError(f"{earlier} and {option} name the same file {path}: choose two")


def assignments(texts: Sequence[str]) -> dict[str, str]:
    """``NAME=VALUE`` words to names and values, still as typed: the scene knows what they mean."""
    values: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (equals and name and value):
            raise InputError(f"--set {text}: write NAME=VALUE, such as --set step=0.02")
        if name in values:
            raise InputError(f"--set {text}: {name} is set twice")
        values[name] = value
    return values


def packings(text: str) -> tuple[str, ...]:
    """``regular,mixed,auxetic``: two or three different names; the scene knows which there are."""
    names = tuple(name.strip() for name in text.split(","))
    if not 2 <= len(set(names)) == len(names) <= 3 or "" in names:
        raise InputError(
            f"{text!r}: name two or three different packings, such as regular,mixed,auxetic"
        )
    return names
