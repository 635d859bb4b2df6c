"""A whole number of thousands of digits, wherever somebody's file or word may have one: a line of ours, none of Python's."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.files.archive import data_of
from sandbox.files.log_file import read_log
from sandbox.files.older_pairs import parse_pair
from sandbox.lessons.reading import parse_lesson
from sandbox.sweep.tables import read_request

DECIMAL, HEXADECIMAL = (
    "9" * 5000,
    "0x" + "f" * 5000,
)  # of the second Python reads any number, and writes none
LESSON = 'format = "auxetic-sandbox lesson"\nversion = 1\nscene = "hopper"\n'
STEP = '[[step]]\nkey = "push"\nsay = "Look."\npackings = ["regular"]\n'
PAIR = 'format = "auxetic-sandbox scene"\n'


def lesson(text: str) -> Callable[[Path], object]:
    return lambda _: parse_lesson("mine", text.encode(), "mine.toml")


def pair(text: str) -> Callable[[Path], object]:
    return lambda _: parse_pair("mine.toml", text.encode(), lambda _: b"")


def file(name: str, text: str, read: Callable[[Path], object]) -> Callable[[Path], object]:
    def written(folder: Path) -> object:
        (folder / name).write_text(text)
        return read(folder)

    return written


READERS: list[Callable[[Path], object]] = [
    *(lesson(f"x = {number}") for number in (DECIMAL, HEXADECIMAL)),
    *(lesson(f"{LESSON}seed = {number}\n{STEP}") for number in (DECIMAL, HEXADECIMAL)),
    *(lesson(f"{LESSON}{STEP}settings.grains = {n}\n") for n in (DECIMAL, HEXADECIMAL)),
    lesson(LESSON.replace("version = 1", f"version = {HEXADECIMAL}") + STEP),
    *(pair(f"{PAIR}version = {number}\n") for number in (DECIMAL, HEXADECIMAL)),
    lambda _: data_of(f'{{"seed": {DECIMAL}}}'.encode()),
    file("run.jsonl", f'{{"seed": {DECIMAL}}}\n', lambda folder: read_log(folder / "run.jsonl")),
    file("sweep.json", f'{{"version": {DECIMAL}}}', read_request),
    lambda _: arguments.whole_number(1, 10)(DECIMAL),
]


@pytest.mark.parametrize("read", READERS)
def test_a_number_of_thousands_of_digits(read: Callable[[Path], object], tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        read(tmp_path)
    said = str(refused.value).replace(str(tmp_path), "")
    assert len(said.splitlines()) == 1
    assert len(said) < 200
    assert not re.search("4300|exceed|conversion|sys\\.|Error", said)
