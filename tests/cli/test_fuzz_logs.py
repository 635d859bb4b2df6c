"""Logs that are damaged, hostile or of another world: one line and exit code 2, at once, whatever they claim."""

from __future__ import annotations

import json
import os
import resource
import time
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sandbox.cli import main as cli

HEAD: dict[str, Any] = {
    "format": "auxetic-sandbox log",
    "version": 1,
    "scene": "grain_row",
    "packing": "mixed",
    "seed": 1,
    "settings": {"grains": 2},
}
GRAB: dict[str, Any] = {"at": 0, "command": "grab", "handle": "plate"}
MOVE: dict[str, Any] = {"at": 0, "command": "move", "handle": "plate", "x": 0.0, "y": -9.0}
END: dict[str, Any] = {"end": 1, "hash": "0" * 64}
HUGE = 10**400
QUICK = 5.0  # seconds: nothing was built
ROOM = 1 << 20  # kilobytes of memory that reading may add


def told(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Replay ``path``; the one line that it is refused with."""
    began, memory = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert cli.main(["replay", str(path)]) == 2
    assert time.process_time() - began < QUICK
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < ROOM
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert len(said.err.splitlines()) == 1, said.err
    return said.err


def write(path: Path, *records: object) -> Path:
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    return path


HOSTILE: dict[str, tuple[object, ...]] = {
    "a number of 400 digits as a seed": ({**HEAD, "seed": HUGE}, END),
    "as a parameter": ({**HEAD, "settings": {"grains": HUGE}}, END),
    "as a place": (HEAD, GRAB, {**MOVE, "x": HUGE}, END),
    "as an end": (HEAD, {**END, "end": HUGE}),
    "as a time": (HEAD, {**GRAB, "at": HUGE}, END),
    "as a version": ({**HEAD, "version": HUGE}, END),
    "1e9 increments": (HEAD, GRAB, {**END, "end": 10**9}),
    "a list as a scene": ({**HEAD, "scene": ["hopper"]}, END),
    "a table as a parameter": ({**HEAD, "settings": {"grains": {}}}, END),
    "a list as a parameter": ({**HEAD, "settings": {"grains": [1]}}, END),
    "nothing as a parameter": ({**HEAD, "settings": {"grains": None}}, END),
    "no such parameter": ({**HEAD, "settings": {"__class__": 1}}, END),
    "a list as a command": (HEAD, {"at": 0, "command": ["grab"]}, END),
    "a command that Python knows": (HEAD, {"at": 0, "command": "__import__", "handle": "os"}, END),
    "a wall of a million points": (
        HEAD,
        {"at": 0, "command": "drawwall", "points": [[0.0, 0.0]] * 1_000_000},
        END,
    ),
    "a start that is none": ({**HEAD, "version": 2, "start": {"text": "x", "grains": "!"}}, END),
    "a start in the wrong version": ({**HEAD, "start": {"text": "", "grains": ""}}, END),
    "a start without grains": ({**HEAD, "version": 2, "start": {"text": ""}}, END),
    "a hash that is a number": (HEAD, {"end": 0, "hash": 3}),
    "an end that is true": (HEAD, {"end": True, "hash": ""}),
    "two heads": (HEAD, HEAD, END),
    "two ends": (HEAD, END, END),
    "a handle of another scene": ({**HEAD, "packing": "wooden"}, END),
}


@pytest.mark.parametrize("records", HOSTILE.values(), ids=HOSTILE.keys())
def test_hostile_claims(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], records: tuple[object, ...]
) -> None:
    told(write(tmp_path / "run.jsonl", *records), capsys)


BYTES = {
    "nothing": b"",
    "zeros": bytes(10_000),
    "no text": bytes(range(256)),
    "utf-16": json.dumps(HEAD).encode("utf-16"),
    "brackets": b"[" * 200_000,
    "braces": b'{"a":' * 200_000,
    "digits": b'{"version": ' + b"9" * 100_000 + b"}",
    "exponents": b'{"version": 1e' + b"9" * 1000 + b"}",
    "nan": json.dumps({**HEAD, "seed": float("nan")}).encode(),
    "inf": b'{"version": Infinity}',
    "half a line": json.dumps(HEAD).encode()[:-5],
    "half a surrogate": b'{"format": "\\ud800"}',
    "the same key twice": b'{"format": "auxetic-sandbox log", "format": 3}\n',
    "one endless line": b'{"format": "' + b"x" * 5_000_000,
    "ten million empty lines": b"\n" * 10_000_000,
    "a pickle": b"cos\nsystem\n(S'touch hit'\ntR.",
}


@pytest.mark.parametrize("content", BYTES.values(), ids=BYTES.keys())
def test_hostile_bytes(tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes) -> None:
    path = tmp_path / "run.jsonl"
    path.write_bytes(content)
    told(path, capsys)
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_no_file_is_not_waited_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "no such file" in told(tmp_path / "none.jsonl", capsys)
    told(tmp_path, capsys)
    if os.path.exists("/dev/zero"):  # noqa: PTH110 - a device, not a file of ours
        told(Path("/dev/zero"), capsys)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.jsonl")
        told(tmp_path / "pipe.jsonl", capsys)


def test_a_sparse_giant_is_not_opened(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.jsonl"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    assert "larger than any log" in told(path, capsys)


def test_commands_of_huge_numbers_are_refused_while_it_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What a running session refuses is passed over, as it was when the log was written; then the state is another."""
    lines = [{"at": 0, "command": "change", "name": n, "value": HUGE} for n in ("step", "seed")]
    path = write(tmp_path / "run.jsonl", HEAD, *lines, {"end": 0, "hash": "0" * 64})
    assert cli.main(["replay", str(path)]) in (1, 2)
    assert "Traceback" not in capsys.readouterr().err


junk = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.sampled_from([HUGE, -HUGE, 2**63, 1e308, -0.0]),
        st.floats(),
        st.text(max_size=8),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=5,
)
names = st.sampled_from([*HEAD, *MOVE, *END, "start", "points", "increment", "radius", "kind"])


@settings(
    max_examples=300,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.integers(0, 3), names, junk, st.booleans())
def test_one_thing_is_something_else(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    line: int,
    name: str,
    value: object,
    remove: bool,
) -> None:
    """Reading refuses it in one line, or it is a log."""
    from sandbox.files.log_file import read_log
    from sandbox.session.log import Log

    records = [dict(HEAD), dict(GRAB), dict(MOVE), dict(END)]
    if remove:
        records[line].pop(name, None)
    else:
        records[line][name] = value
    path = write(tmp_path / "run.jsonl", *records)
    from core.errors import InputError
    from sandbox.session.session import Session

    try:
        log = read_log(path)
        assert isinstance(log, Log)
        Session(log.scene, log.packing, log.seed, log.settings)
    except InputError as error:
        message = str(error)
    else:
        message = "fine"
    assert len(message.splitlines()) == 1


@settings(
    max_examples=300,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.integers(0, 10**6), st.integers(1, 255), st.booleans())
def test_one_wrong_byte_or_an_early_end(tmp_path: Path, place: int, change: int, cut: bool) -> None:
    from core.errors import InputError
    from sandbox.files.log_file import read_log

    path = write(tmp_path / "run.jsonl", HEAD, GRAB, MOVE, END)
    content = bytearray(path.read_bytes())
    place %= len(content)
    if cut:
        del content[place:]
    else:
        content[place] ^= change
    path.write_bytes(content)
    message = "fine"
    try:
        read_log(path)
    except InputError as error:
        message = str(error)
    assert len(message.splitlines()) == 1
