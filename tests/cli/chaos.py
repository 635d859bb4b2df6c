"""Stops the program at random moments, in every way that there is, and looks at what is left.

    python -m tests.cli.chaos --times 100 --seed 1

Linux only, as it looks for processes in /proc. ``test_chaos.py`` does each of it once. What is tried:

| what is at work                      | kill -9 | SIGTERM | SIGINT | SIGHUP | full disk |
| ------------------------------------ | ------- | ------- | ------ | ------ | --------- |
| record, film and table               | yes     | yes     | yes    | yes    | yes       |
| record, animation, table, trajectory | yes     | yes     | yes    | yes    | yes       |
| record, side by side                 | yes     | yes     | yes    | yes    | yes       |
| replay, that also goes back          | yes     | yes     | yes    | yes    | yes       |
| study, two processes                 | yes     | yes     | yes    | yes    | no        |
| play, log and film                   | yes     | yes     | yes    | yes    | yes       |

A full disk is a small file system of its own where this may mount one, else a limit to the size of files. Moments before the
first sign of life, while Python itself starts, are left out. After each: no process is left; a table has whole rows, and of
what was drawn before a kill -9 nothing older than a moment is missing in it; a film is the earlier one or whole, and so is a
trajectory; what the program has said of them is true; no hidden file is left, after a kill -9 once the same is asked for again.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
import re
import resource
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

import imageio.v2
import numpy as np

from core import files
from core.errors import InputError
from sandbox.cli import arguments
from tests.cli import chaos_window

REPOSITORY = Path(__file__).parents[2]
PATIENCE = 300.0  # [s], of a machine that does other things too
LONGEST = 8.0  # after the first sign of life [s]
ROOM = 50_000  # bytes of the full disk
EARLIER = b"earlier"
HOPPER = ["hopper", "--steps", "100000"]
SMALL = ["--size", "320x240"]
TRAJECTORY = ["--trajectory", "run.npz"]
WORKS = {
    "film": ["record", *HOPPER, *SMALL, "--out", "film.mp4", "--data", "run.csv"],
    "animation": ["record", *HOPPER, *SMALL, "--out", "film.gif", "--data", "run.csv", *TRAJECTORY],
    "side by side": ["record", *HOPPER, "--compare", "regular,auxetic", "--data", "run.csv"],
    "replay": ["replay", "log.jsonl", "--out", "film.mp4", "--data", "run.csv", *TRAJECTORY],
    "study": ["study", "hand", "--quick", "--out", "results"],
}
FULL = "full disk"
FAULTS = ("SIGKILL", "SIGTERM", "SIGINT", "SIGHUP", FULL)
WINDOW = "window"
CASES = [
    (work, fault)
    for work in (*WORKS, *([WINDOW] if chaos_window.possible else []))
    for fault in FAULTS
    if (work, fault) != ("study", FULL)
]


@dataclass(frozen=True)
class Left:
    """What a stopped program has left."""

    folder: Path
    work: str
    fault: str
    code: int
    said: str
    seconds: float  # between the first sign of life and the end


def write_log(path: Path) -> None:
    """A log that pushes a piston, and starts again now and then."""
    head = {
        "format": "auxetic-sandbox log",
        "version": 1,
        "scene": "hopper",
        "packing": "mixed",
        "seed": 1,
        "settings": {"grains": 60, "width": 12.0},
    }
    commands: list[dict[str, object]] = []
    for at in range(0, 2_500, 25):
        commands.append({"at": at, "command": "reset"})
        commands.append({"at": at, "command": "grab", "handle": "piston"})
        commands.append({"at": at, "command": "move", "handle": "piston", "x": 0.0, "y": -100.0})
    lines = [head, *commands, {"end": 2_500, "hash": "0"}]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


@contextmanager
def small_disk(folder: Path) -> Iterator[bool]:
    """A file system with little room at ``folder``; False where nobody may mount one."""
    options = ["-t", "tmpfs", "-o", f"size={ROOM}", "tmpfs", str(folder)]
    mounted = False
    if program := shutil.which("mount"):
        done = subprocess.run([program, *options], capture_output=True, check=False)
        mounted = done.returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], check=True)


def processes(token: str) -> list[int]:
    """Those that a program has started, and those that these have, by what is in their environment."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if token.encode() in (entry / "environ").read_bytes():
                    found.append(int(entry.name))
            except OSError:
                continue  # it has just ended, or is another's
    return found


def wait_for_processes(token: str) -> None:
    """Raise AssertionError if one does not end."""
    end = time.monotonic() + PATIENCE
    while processes(token):
        assert time.monotonic() < end, f"processes {processes(token)} are left"
        time.sleep(0.1)


def strike(folder: Path, work: str, fault: str, moment: float, *, limited: bool) -> Left:
    """Begin ``work`` in ``folder``, and let the fault happen ``moment`` [s] after its first sign of life."""
    token = secrets.token_hex(8)
    for word in WORKS[work]:
        if word.startswith("film."):
            (folder / word).write_bytes(EARLIER)
    if work == "replay":
        write_log(folder / "log.jsonl")

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM // 2, ROOM // 2))

    process = subprocess.Popen(
        [sys.executable, "-m", "sandbox", *WORKS[work]],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY), "CHAOS": token},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        preexec_fn=limit if limited else None,
    )
    assert process.stderr
    first = process.stderr.read(1)
    began = time.monotonic()
    if fault != FULL:
        time.sleep(moment)
        process.send_signal(getattr(signal, fault))
    seconds = time.monotonic() - began
    _, rest = process.communicate(timeout=PATIENCE)
    said = (first + rest).decode(errors="replace").replace("\r", "\n")
    wait_for_processes(token)
    return Left(folder, work, fault, process.returncode, said, seconds)


def rows_of(path: Path) -> list[list[str]]:
    """The rows of a table, which must be whole."""
    text = path.read_text()
    assert text.endswith("\n"), "half a row"
    header, *rows = csv.reader(text.splitlines())
    assert all(len(row) == len(header) for row in rows), "half a row"
    number = header.index("increment")
    names = {row[0] for row in rows} if number else {""}
    for name in names:
        mine = [int(row[number]) for row in rows if not number or row[0] == name]
        assert mine == list(range(len(mine))), "a row is missing"
    return rows


def frames_of(path: Path) -> int:
    """How many frames a film has."""
    return len(imageio.v2.mimread(path, memtest=False))


def look(left: Left) -> str:
    """Raise AssertionError if something is not as it should be; else what there is, in a few words."""
    folder, killed = left.folder, left.fault == "SIGKILL"
    assert "Traceback" not in left.said, left.said
    if left.fault == FULL:
        assert left.code == 2, left.said
        assert re.search("no space|no room|file too large", left.said), left.said
        assert left.said.count("error: ") == 1, left.said
    else:
        assert left.code == (-signal.SIGKILL if killed else 130), (left.code, left.said)
    if left.work == "study":
        return _look_at_study(left)
    film = next((word for word in WORKS[left.work] if word.startswith("film.")), None)
    rows = rows_of(folder / "run.csv") if (folder / "run.csv").exists() else []
    words = [f"{len(rows)} rows"]
    whole = film is not None and (folder / film).read_bytes() != EARLIER
    frames = frames_of(folder / str(film)) if whole else 0
    if whole:
        words.append(f"{frames} frames")
    moments = _moments(folder / "run.npz")
    last = left.said.strip().rpartition("\n")[2]
    if killed:
        assert not whole, "a film with its own name that nobody has finished"
        assert not moments, "a trajectory that nobody has finished"
        words += _lost(left, rows)
    elif left.fault != FULL:
        if match := re.search(r"wrote (\d+) frames?", last):
            assert int(match[1]) == frames, last
        if match := re.search(r"(\d+) rows? to run\.csv", last):
            assert int(match[1]) == len(rows), last
        assert bool(moments) == ("run.npz" in last), last
        assert not moments or left.work == "replay" or moments == len(rows), "a frame is missing"
        if "nothing was written" in last:
            assert not rows, last
            assert not whole, last
        assert re.search("nothing was written|wrote", last), last
    if match := re.search(r"run\.csv: .*; it holds the first (\d+) rows", last):
        assert int(match[1]) == len(rows), last
    _tidy(folder, film, killed=killed)
    return ", ".join(words)


def _moments(path: Path) -> int:
    """How many frames a trajectory has, if there is one; it must be whole."""
    if not path.exists():
        return 0
    with np.load(path) as arrays:
        assert all(arrays[name].size >= 0 for name in arrays)
        return len(arrays["increment"])


def _lost(left: Left, rows: list[list[str]]) -> list[str]:
    """A film shows every increment, and its encoder finishes what it was given: how far is the table behind?

    Told, and not asserted: what share of the time was spent on building the scene is not known here. That rows are written every
    half second is tested with a clock of its own (``test_table.py``).
    """
    parts = list(left.folder.glob(".film.*.part.mp4"))
    if left.work != "film" or not parts or not parts[0].stat().st_size:
        return []
    drawn = frames_of(parts[0])
    lost = max(drawn - max(len(rows) - 1, 0), 0)
    return [f"{lost} of {drawn} increments lost, {lost * left.seconds / drawn:.2f} s or less"]


def _look_at_study(left: Left) -> str:
    """Every line of finished runs can be read; what is said to be finished is."""
    kept = [path for path in (left.folder / "results").rglob("*") if path.is_file()]
    lines = 0
    for path in kept:
        if path.suffix == ".jsonl":
            text = path.read_text()
            assert not text or text.endswith("\n"), f"half a line in {path.name}"
            lines += len([json.loads(line) for line in text.splitlines()])
    if match := re.search(r"stopped after (\d+) runs?", left.said):
        assert int(match[1]) == lines, left.said
    files.clear(left.folder / "results")
    assert not list((left.folder / "results").rglob(".*"))
    return f"{lines} runs"


def _tidy(folder: Path, film: str | None, *, killed: bool) -> None:
    """No hidden file; after a kill -9, once the same is asked for again."""
    if killed:
        time.sleep(files.SETTLED)
        for option, name in (("--out", film), ("--data", "run.csv")):
            if name:
                arguments.output_file(option, str(folder / name), [Path(name).suffix])
    hidden = [path.name for path in folder.iterdir() if path.name.startswith(".")]
    assert not hidden, hidden


def once(folder: Path, work: str, fault: str, moment: float) -> str:
    """One fault; what was left, in words. Raises AssertionError if that is not as it should be."""
    if work == WINDOW:
        return _once_in_a_window(folder, fault, moment)
    if fault != FULL:
        return look(strike(folder, work, fault, moment, limited=False))
    with small_disk(folder) as mounted:
        return look(strike(folder, work, fault, moment, limited=not mounted))


def _once_in_a_window(folder: Path, fault: str, moment: float) -> str:
    token = secrets.token_hex(8)
    with small_disk(folder) if fault == FULL else nullcontext(enter_result=True) as mounted:
        if not mounted:
            return "not tried: nobody may mount a small disk"
        words = chaos_window.once(folder, fault, moment, token)
        wait_for_processes(token)
        return words


def main() -> int:
    """Many faults; 1 if anything was not as it should be."""
    parser = argparse.ArgumentParser(description="Stop the program at random moments.")
    parser.add_argument("--times", type=int, default=25)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", choices=[*WORKS, WINDOW], help="this one only")
    options = parser.parse_args()
    chance = random.Random(options.seed)
    bad = 0
    cases = [case for case in CASES if options.work in (None, case[0])]
    for number in range(options.times):
        work, fault = cases[number % len(cases)]
        moment = chance.uniform(0.0, LONGEST)
        with tempfile.TemporaryDirectory() as folder:
            try:
                words = once(Path(folder), work, fault, moment)
            except (AssertionError, InputError, OSError, subprocess.TimeoutExpired) as error:
                bad += 1
                words = f"BAD: {error}"
        print(f"{number:4}  {work:<13} {fault:<9} {moment:5.2f} s  {words}", flush=True)
    print(f"{options.times} faults, {bad or 'none'} bad")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
