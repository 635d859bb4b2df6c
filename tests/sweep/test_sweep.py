"""Sweeps carried out: the same tables however, killed at any byte, and any row again to the last bit."""

from __future__ import annotations

import csv
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest

pytest.importorskip("scipy")

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.ensemble.batch import LOST
from sandbox.ensemble.estimates import Share
from sandbox.files.folder import write_text
from sandbox.session.session import Session
from sandbox.sweep import outcome, summary, sweep
from sandbox.sweep.asking import ask
from sandbox.sweep.outcome import AT_REST, CENSORED, CLOGGED, EMPTIED, NEVER, Found, carry_out
from sandbox.sweep.pictures import heat_map
from sandbox.sweep.request import Job, Request
from sandbox.sweep.sweep import Ways
from sandbox.sweep.tables import ASKED, AVALANCHES, LOCK, RUNS, Tables, made, read_request
from sandbox.window.explore.explorer import shown
from tests.sweep.conftest import fake, invented

REPOSITORY = Path(__file__).parents[2]
SMALL = {"grains": 24, "width": 10.0, "shake": 0.0, "fall": 0.3}
WORDS = ["gravity_hopper", "--vary", "orifice=1.5,3.5", "--packing", "regular", "--seeds", "3"]
WORDS += [word for name, value in SMALL.items() for word in ("--set", f"{name}={value}")]


def small(seeds: str = "3", **more: object) -> Request:
    """Runs of a tenth of a second."""
    return ask("gravity_hopper", ["orifice=1.5,3.5"], "regular", seeds, {**SMALL, **more})


def go(folder: Path, request: Request, jobs: int = 2) -> Tables:
    tables = Tables(folder, request)
    try:
        assert sweep.sweep(tables, Ways(jobs=jobs))
    finally:
        tables.close()
    return tables


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def compared(folder: Path) -> list[dict[str, str]]:
    """All that another run of the same request may not change."""
    runs = rows(folder / RUNS)
    for row in runs:
        row.pop("seconds")
    return runs + rows(folder / AVALANCHES)


# Outcomes.


def test_outcomes_and_avalanches_of_drains() -> None:
    narrow, wide = (carry_out(job) for job in small("1").jobs())
    assert narrow.run["outcome"] in (CLOGGED, NEVER)
    assert int(narrow.run["arch"]) >= 1
    assert wide.run["outcome"] == EMPTIED
    assert int(wide.run["out"]) + int(wide.run["left"]) == wide.run["initial"]
    assert [fall["size"] for fall in wide.avalanches] == [wide.run["out"]]
    assert wide.avalanches[0]["ended"] == EMPTIED
    assert wide.run["why"] == wide.run["arch"] == ""
    (short,) = (
        carry_out(job) for job in ask("gravity_hopper", [], "regular", "1", SMALL, steps=3).jobs()
    )
    assert (short.run["outcome"], short.run["why"]) == (CENSORED, "after 3 increments")


def test_a_run_ends_as_soon_as_it_is_known() -> None:
    job = small("1").job(1)
    session = Session(job.scene, job.packing, job.seed, job.settings)
    watch = outcome.drive(session, job)
    assert watch.resting == AT_REST
    assert not session.run.course.moving
    assert len(session.run.checkpoints) < 12


def test_shaken_grains_leave_avalanche_by_avalanche() -> None:
    request = ask(
        "gravity_hopper", [], "regular", "1", {**SMALL, "orifice": 2.0, "shake": 0.8}, "empty", 420
    )
    found = carry_out(request.job(1))
    assert len(found.avalanches) > 1
    assert sum(int(fall["size"]) for fall in found.avalanches) == found.run["out"]
    assert {fall["ended"] for fall in found.avalanches[:-1]} == {CLOGGED}


def test_a_hand_locks_or_runs_through() -> None:
    settings = {"grains": 24, "width": 8.0, "angle": 20.0, "stroke": 2.0, "orifice": 1.0}
    request = ask("hopper", ["hand_strength=0.5,machine"], "regular", "1", settings)
    assert [carry_out(job).run["outcome"] for job in request.jobs()] == ["locked", "ran through"]
    flowing = ask(
        "hopper",
        ["step=0.1"],
        "regular",
        "1",
        {**settings, "friction": 0.0, "stroke": 2.5, "orifice": 3.0},
    )
    run = carry_out(flowing.job(1)).run
    assert int(run["out"]) > 0
    assert (run["outcome"], run["left"]) == ("ran through", 24 - int(run["out"]))


@pytest.mark.usefixtures("in_threads")
def test_what_never_started_is_no_clog(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In no share, and told beside it: in the lines of the terminal, on the page, on the map, in the study."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    endings = {1: CLOGGED, 3: NEVER, 5: EMPTIED, 7: CENSORED}  # all others: never started

    def drain(job: Job) -> Found:
        ended = endings.get(job.row, NEVER)
        return invented(job, ended, 0 if ended == NEVER else 9)

    monkeypatch.setattr(sweep, "carry_out", drain)
    assert cli.main(["sweep", *WORDS, "--seeds", "4", "--pictures", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    some, none = summary.cells(go(tmp_path, read_request(tmp_path)))
    assert some.stopped == Share(1, 2)
    assert some.told == "0.50 (0.09 to 0.91), 2 runs"
    assert none.stopped is None
    assert none.told == "never started"
    assert "5 never started" in said
    page = (tmp_path / "index.html").read_text()
    assert "0.50<small>0.09 to 0.91, 2 runs" in page
    assert "<td>never started" in page
    assert shown(none).share is None
    assert shown(some).share == 0.5
    request = ask("gravity_hopper", ["orifice=1.5,3.5", "fall=0.3"], "regular", "1", {})
    axes = Figure().add_subplot()
    heat_map(axes, request, [replace(cell, values=(*cell.values, 0.3)) for cell in (some, none)])
    assert [text.get_text() for text in axes.texts] == ["0.50", "never\nstarted"]


# Tables.


@pytest.mark.usefixtures("in_threads")
def test_the_order_is_that_of_the_request(tmp_path: Path) -> None:
    go(tmp_path / "one", small(), jobs=1)
    tables = go(tmp_path / "three", small(), jobs=3)
    assert compared(tmp_path / "one") == compared(tmp_path / "three")
    assert [row["row"] for row in rows(tmp_path / "one" / RUNS)] == list("123456")
    cells = summary.cells(tables)
    assert [(cell.values, cell.outcomes) for cell in cells] == [
        ((1.5,), {CLOGGED: 3}),
        ((3.5,), {EMPTIED: 3}),
    ]
    assert cells[0].sizes[0].tolist() == [1.0, 2.0, 3.0]
    assert cells[0].sizes[1].all()
    assert not cells[1].sizes[1].any()
    assert "6 of 6 runs" in summary.as_text(tables.request, cells)


@pytest.mark.usefixtures("in_threads")
def test_a_table_that_was_cut_anywhere_is_whole_again(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    go(folder, small())
    whole = compared(folder)
    runs, falls = ((folder / name).read_bytes() for name in (RUNS, AVALANCHES))
    for cut in range(0, len(runs), 97):
        (folder / RUNS).write_bytes(runs[:cut])
        (folder / AVALANCHES).write_bytes(falls[: len(falls) * (cut + 200) // len(runs)])
        go(folder, small())
        assert compared(folder) == whole


@pytest.mark.usefixtures("in_threads")
def test_rows_that_no_sweep_has_written_are_made_again(tmp_path: Path) -> None:
    go(tmp_path, small())
    whole = {name: (tmp_path / name).read_text() for name in (RUNS, AVALANCHES)}
    for name, column, text in (
        *((RUNS, "row", text) for text in ("²", "0", 5000 * "9")),
        *((RUNS, "increments", text) for text in ("x", "", "-1", "1.5")),
        *((RUNS, "out", "x"), (RUNS, "seconds", "nan"), (RUNS, "outcome", "<b>")),
        *((AVALANCHES, "row", "²"), (AVALANCHES, "avalanche", "x"), (AVALANCHES, "size", "inf")),
    ):
        header, first, *rest = whole[name].splitlines()
        changed = dict(zip(header.split(","), first.split(","), strict=True)) | {column: text}
        (tmp_path / name).write_text("\n".join([header, ",".join(changed.values()), *rest, ""]))
        if name == RUNS:
            made(tmp_path, "1")
        tables = go(tmp_path, small())
        assert summary.as_text(tables.request, summary.cells(tables))
        assert {name: (tmp_path / name).read_text() for name in whole} == whole


def test_what_is_no_folder_of_a_sweep_is_said_in_one_line(tmp_path: Path) -> None:
    Tables(tmp_path, small()).close()
    asked = (tmp_path / ASKED).read_text()
    for text in (100_000 * "[", asked.replace('"versions": {', '"versions": 3, "x": {')):
        (tmp_path / ASKED).write_text(text)
        with pytest.raises(InputError, match="damaged"):
            read_request(tmp_path)
    (tmp_path / ASKED).write_text(asked)
    for words in ("²", "", 5000 * "9"):
        with pytest.raises(InputError, match="number of a row"):
            made(tmp_path, words)
    (tmp_path / RUNS).write_text(f'"{200_000 * "x"}"\n')
    with pytest.raises(InputError, match="damaged"):
        Tables(tmp_path, small())
    (tmp_path / RUNS).unlink()
    os.mkfifo(tmp_path / RUNS)
    with pytest.raises(InputError, match="no file"):
        Tables(tmp_path, small())


def test_what_is_no_text_in_a_path_stops_no_page(tmp_path: Path) -> None:
    write_text(tmp_path / "page", os.fsdecode(b"play b\xff#1"))
    assert (tmp_path / "page").read_text() == "play b?#1"


def test_a_lock_that_cannot_be_taken(tmp_path: Path) -> None:
    (tmp_path / LOCK).mkdir()
    with pytest.raises(InputError, match=LOCK):
        Tables(tmp_path, small())


@pytest.mark.usefixtures("in_threads")
def test_a_folder_goes_on_and_grows(tmp_path: Path) -> None:
    go(tmp_path, small())
    before = compared(tmp_path)
    more = read_request(tmp_path).with_more_seeds(1)
    go(tmp_path, more)
    assert [row for row in compared(tmp_path) if int(row["row"]) <= 6] == before
    assert len(rows(tmp_path / RUNS)) == 8
    assert read_request(tmp_path) == more
    about = json.loads((tmp_path / "sweep.json").read_text())
    assert list(about["columns"][RUNS]) == list(rows(tmp_path / RUNS)[0])


@pytest.mark.usefixtures("in_threads")
def test_a_page_shows_the_cells_and_how_to_open_a_run_of_each(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    words = ["--vary", "fall=0.1,0.3", "--pictures", "--out", str(tmp_path)]
    assert cli.main(["sweep", *WORDS[:-2], *words]) == 0
    assert "index.html" in capsys.readouterr().out
    page = (tmp_path / "index.html").read_text()
    assert page.count("<td") == 4
    for row in range(1, 5):
        assert f"play {tmp_path}#{row}<" in page
    for name in re.findall(r'<img src="(.+?)"', page):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    assert page.count("<img") == 2  # three avalanches a cell are too few for the third


@pytest.mark.usefixtures("in_threads")
def test_commands_that_are_printed_can_be_typed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    folder = tmp_path / "a folder & more"
    assert cli.main(["sweep", *WORDS, "--pictures", "--out", str(folder)]) == 0
    said = capsys.readouterr().out
    typed = shlex.split(said.partition("a run: ")[2])
    assert typed == ["python", "-m", "sandbox", "play", f"{folder}#ROW"]
    codes = re.findall(r"<code>(.+?)</code>", (folder / "index.html").read_text())
    assert shlex.split(unescape(codes[0])) == ["play", f"{folder}#1"]
    assert cli.main(["sweep", "gravity_hopper", "--out", str(folder)]) == 2
    again = capsys.readouterr().err.partition("go on with: ")[2]
    assert shlex.split(again) == ["sweep", str(folder)]


@pytest.mark.usefixtures("in_threads")
def test_parquet_has_the_types_of_its_columns(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    assert cli.main(["sweep", *WORDS, "--parquet", "--out", str(tmp_path)]) == 0
    table = parquet.read_table(tmp_path / "runs.parquet")
    assert table.column("orifice").to_pylist() == [1.5, 3.5] * 3
    assert table.column("packing").to_pylist() == ["regular"] * 6


@pytest.mark.usefixtures("in_threads")
def test_a_text_that_begins_as_a_formula_is_text_in_both_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")

    def fails(job: Job) -> Found:
        raise InputError(f"={job.row}+1")

    monkeypatch.setattr(sweep, "carry_out", fails)
    assert cli.main(["sweep", *WORDS, "--parquet", "--out", str(tmp_path)]) == 1
    assert "'=1+1" in (tmp_path / RUNS).read_text()
    found = parquet.read_table(tmp_path / "runs.parquet").column("why").to_pylist()
    assert found == [f"={row}+1" for row in range(1, 7)]


@pytest.mark.usefixtures("in_threads")
def test_what_fails_is_a_row_that_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def one_fails(job: Job) -> Found:
        if job.row == 2:
            raise InputError("no room")
        return fake(job)

    monkeypatch.setattr(sweep, "carry_out", one_fails)
    go(tmp_path, small())
    assert [row["why"] for row in rows(tmp_path / RUNS)] == ["", "no room", "", "", "", ""]
    monkeypatch.setattr(sweep, "carry_out", fake)
    go(tmp_path, small())
    assert [row["why"] for row in rows(tmp_path / RUNS)] == [""] * 6


@pytest.mark.usefixtures("in_threads")
def test_one_program_at_a_time_and_no_other_sweep(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tables = Tables(tmp_path, small())
    with pytest.raises(InputError, match="another program"):
        Tables(tmp_path, small())
    tables.close()
    assert cli.main(["sweep", "gravity_hopper", "--out", str(tmp_path)]) == 2
    assert cli.main(["sweep", str(tmp_path), "--seeds", "4"]) == 2
    (tmp_path / "sweep.json").write_text("{")
    assert cli.main(["sweep", str(tmp_path)]) == 2
    said = capsys.readouterr().err.splitlines()
    assert ["another sweep" in said[0], "--seeds" in said[1], "damaged" in said[2]] == [True] * 3


@pytest.mark.usefixtures("in_threads")
def test_a_process_that_dies_takes_no_run_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was under way is carried out again; a run whose process dies each time fails, and the others do not."""
    deaths = {1: 1, 3: sweep.TRIES}

    def deadly(job: Job) -> Found:
        if deaths.get(job.row, 0):
            deaths[job.row] -= 1
            raise BrokenProcessPool
        return fake(job)

    monkeypatch.setattr(sweep, "carry_out", deadly)
    go(tmp_path, small())
    assert [row["why"] for row in rows(tmp_path / RUNS)] == ["", "", LOST, "", "", ""]


# The command.


def command(folder: Path, *words: str) -> list[str]:
    return [sys.executable, "-m", "sandbox", "sweep", *WORDS, "--out", str(folder), *words]


@pytest.mark.end_to_end
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="a signal of POSIX")
def test_killed_and_resumed_by_others_the_rows_are_the_same_and_so_are_the_bits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    killed = subprocess.Popen(command(tmp_path / "a", "--jobs", "1"), cwd=REPOSITORY, stderr=-3)
    runs = tmp_path / "a" / RUNS
    while killed.poll() is None and (not runs.exists() or runs.read_bytes().count(b"\n") < 3):
        time.sleep(0.01)
    killed.kill()
    killed.wait()
    assert cli.main(["sweep", str(tmp_path / "a"), "--jobs", "1"]) == 0
    assert "6 of 6 runs" in capsys.readouterr().out
    alone = Tables(tmp_path / "b", read_request(tmp_path / "a"))
    for job in alone.request.jobs():
        alone.add(carry_out(job))
    alone.write_all()
    assert compared(tmp_path / "a") == compared(tmp_path / "b")
    table = tmp_path / "run.csv"
    assert cli.main(["record", f"{tmp_path / 'a'}#3", "--data", str(table)]) == 0
    assert "the same state as in the table" in capsys.readouterr().out
    assert len(rows(table)) == int(rows(tmp_path / "a" / RUNS)[2]["increments"]) + 1
    for row, said in (("99", "use 1 to 6"), ("x", "number of a row")):
        with pytest.raises(InputError, match=said):
            made(tmp_path / "a", row)
