"""The folder of a sweep: its request, and two tables that grow by a row as a run ends, whatever may end the program.

A run's avalanches are written before its own row, so that a row in runs.csv says that all of it is there. What a kill has left
of a line, what somebody has made of one, avalanches without their run, runs without their avalanches, and runs that failed are
dropped when the folder is opened again, and made anew. At the end both tables are written in the order of the request.
"""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from core.errors import InputError, reason_of
from core.files import is_special
from sandbox import __version__
from sandbox.ensemble.machine import machine
from sandbox.files import cells
from sandbox.files.archive import why_unread
from sandbox.files.folder import prepare_folder, write_text
from sandbox.files.lines import append_lines
from sandbox.interrupts import deferred
from sandbox.sweep.columns import AVALANCHE, columns
from sandbox.sweep.outcome import FAILED, OUTCOMES, Found
from sandbox.sweep.request import Job, Request
from scenes.parameter import shown

FORMAT, VERSION = "auxetic-sandbox sweep", 1
ASKED, RUNS, AVALANCHES, LOCK = "sweep.json", "runs.csv", "avalanches.csv", ".lock"
Row = Mapping[str, Any]  # as a file has it: text by column
COUNTS = ("row", "avalanche", "size", "initial", "out", "left", "avalanches", "increments")
NUMBERS = ("peak_force", "mean_force", "converged", "friction_error", "seconds", "arch")
NEEDED = ("increments", "out", "avalanches")  # of a run that has not failed
LONGEST = 12  # digits of a count
_COUNT = re.compile(f"[0-9]{{0,{LONGEST}}}")


def is_sweep(text: str) -> bool:
    """Is that the folder of a sweep?"""
    return (Path(text) / ASKED).is_file()


def read_request(folder: Path) -> Request:
    """What a folder was asked. Raises InputError if it is none of a sweep, or its runs would come out otherwise now."""
    path = folder / ASKED
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data["format"] != FORMAT or data["version"] != VERSION:
            raise InputError("this is no sweep of this program")
        request, key = Request.of(data["request"]), str(data["key"])
        made = str(data.get("versions", {}).get("auxetic-sandbox", "?"))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except OSError as error:
        raise InputError(f"{path}: {reason_of(error)}") from None
    except KeyError as error:
        raise InputError(f"{path}: damaged ({error} is missing)") from None
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: damaged ({why_unread(error)})") from None
    if key != request.key():
        raise InputError(
            f"{folder} was begun by version {made}, whose scenes were others: begin a new folder with version {__version__}"
        )
    return request


@dataclass(frozen=True)
class Made:
    """A run of a sweep, and what its row says if there is one already."""

    job: Job
    increments: int  # at most, where there is none
    state: str = ""


def made(folder: Path, text: str) -> Made:
    """The run that a row of a folder's table stands for. Raises InputError if there is none."""
    request = read_request(folder)
    if not text.isdecimal() or len(text) > LONGEST:
        raise InputError(f"{folder}#{shown(text)}: after the # comes the number of a row")
    job = request.job(int(text))
    for row in read_rows(folder / RUNS, list(columns(request.scene))):
        if int(row["row"]) == job.row and row["outcome"] != FAILED:
            return Made(job, int(row["increments"]), row["state"])
    return Made(job, job.steps)


class Tables:
    """Both tables of a folder, open for rows. Only one program at a time may do that."""

    def __init__(self, folder: Path, request: Request) -> None:
        """Begin a folder, or go on with one. Raises InputError where it is somebody else's, or cannot be written."""
        self.folder, self.request = folder, request
        prepare_folder(str(folder), "")
        self._lock = FileLock(folder / LOCK)
        try:
            self._lock.acquire(timeout=0)
        except Timeout:
            raise InputError(f"{folder}: another program is at work on this sweep") from None
        except OSError as error:
            reason = reason_of(error)
            raise InputError(f"{folder / LOCK}: {reason}") from None
        self._run_columns = list(columns(request.scene))
        self._avalanche_columns = [*AVALANCHE, *(axis.name for axis in request.axes)]
        self.runs = {
            int(row["row"]): row
            for row in read_rows(folder / RUNS, self._run_columns)
            if row["outcome"] != FAILED
        }
        self.avalanches: dict[int, list[Row]] = {}
        for row in read_rows(folder / AVALANCHES, self._avalanche_columns):
            mine = self.avalanches.setdefault(int(row["row"]), [])
            if int(row["row"]) in self.runs and row["avalanche"] == str(len(mine) + 1):
                mine.append(row)
        for number, row in [*self.runs.items()]:
            if len(self.avalanches.get(number, ())) != int(row["avalanches"]):
                del self.runs[number]
        self._write_request()
        self.write_all()

    def close(self) -> None:
        """Let others at it."""
        self._lock.release()

    def add(self, found: Found) -> None:
        """A finished run: its avalanches, then its row."""
        row = int(found.run["row"])
        axes = {axis.name: found.run[axis.name] for axis in self.request.axes}
        some = [as_read({**avalanche, **axes}) for avalanche in found.avalanches]
        self.avalanches[row], self.runs[row] = some, as_read(found.run)
        with deferred():
            append_lines(self.folder / AVALANCHES, _lines(some, self._avalanche_columns))
            append_lines(self.folder / RUNS, _lines([self.runs[row]], self._run_columns))

    def write_all(self) -> None:
        """Both tables anew, in the order of the request."""
        ordered = sorted(self.runs)
        falls = [fall for row in ordered for fall in self.avalanches.get(row, ())]
        for name, rows, names in (
            (AVALANCHES, falls, self._avalanche_columns),
            (RUNS, [self.runs[row] for row in ordered], self._run_columns),
        ):
            header = {name: name for name in names}
            write_text(self.folder / name, _lines([header, *rows], names))

    def _write_request(self) -> None:
        data = {
            "format": FORMAT,
            "version": VERSION,
            "key": self.request.key(),
            "request": self.request.data(),
            **machine(),
            "columns": {RUNS: columns(self.request.scene), AVALANCHES: AVALANCHE},
        }
        write_text(self.folder / ASKED, json.dumps(data, indent=1, ensure_ascii=False) + "\n")


def read_rows(path: Path, names: Sequence[str]) -> list[Row]:
    """The whole lines of a table that has these columns, without those that no sweep has written: they are made again.

    Raises InputError for a table with other columns, and for what is no file; none there is an empty one.
    """
    if is_special(path):
        raise InputError(f"{path}: this is no file")
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"{path}: {reason_of(error)}") from None
    whole = text[: text.rfind("\n") + 1]
    try:
        rows = cells.read(whole)
    except csv.Error as error:
        raise InputError(f"{path}: damaged ({error})") from None
    if not rows:
        return []
    if rows[0] != list(names):
        raise InputError(f"{path}: these are not the columns of this sweep; begin a new folder")
    found = [dict(zip(names, row, strict=True)) for row in rows[1:] if len(row) == len(names)]
    return [row for row in found if _is_sound(row)]


def _is_sound(row: Row) -> bool:
    """Are the numbers of a row such, and is its outcome one?"""
    if not row["row"].strip("0") or row.get("outcome", FAILED) not in OUTCOMES:
        return False
    if row.get("outcome", FAILED) != FAILED and not all(row[name] for name in NEEDED):
        return False
    counts = (row.get(name, "") for name in COUNTS)
    numbers = (row.get(name, "") for name in NUMBERS)
    return all(_COUNT.fullmatch(text) for text in counts) and all(map(_is_number, numbers))


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text or 0.0))
    except ValueError:
        return False


def as_read(row: Mapping[str, object]) -> Row:
    """A row as it will be read again: floats to the same bits."""
    return {name: str(value) for name, value in row.items()}


def _lines(rows: Iterable[Row], names: Sequence[str]) -> str:
    return cells.lines([row[name] for name in names] for row in rows)
