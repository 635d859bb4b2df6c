"""Runs in several processes: kept, resumed, failed, interrupted; and the study as a command."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.ensemble.pool import Stopped
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.paper import study as paper
from sandbox.studies.paper.claims import (
    Claim,
    Figure,
    Line,
    Measured,
    Panel,
    Part,
    Reading,
    Threshold,
    Unmeasurable,
    exactly,
)
from sandbox.studies.paper.runs import (
    HAND,
    Request,
    Result,
    Store,
    execute,
    implied,
    run_all,
)
from scenes.scene import HAND_STRENGTH

REPOSITORY = Path(__file__).parents[2]
TINY = (("grains", 2), ("step", 0.05), ("tolerance", 1e-2))


def tiny(packing: str, seed: int = 1) -> Request:
    """A run of a tenth of a second."""
    return Request("grain_row", packing, seed, TINY, probe="sideways")


def test_execute_runs_the_whole_drive_or_part_of_it() -> None:
    whole = execute(tiny("regular"))
    assert whole.column("stroke")[-1] == pytest.approx(15.0)
    assert len(whole.column("down")) == 7
    assert whole.converged == 1.0
    part = execute(Request("grain_row", "regular", 1, TINY, steps=2))
    assert len(part.column("force")) == 3
    assert part.column("force").tolist() == whole.column("force")[:3].tolist()


def test_execute_stops_when_told() -> None:
    with pytest.raises(Stopped):
        execute(tiny("regular"), stopping=lambda: True)


def test_execute_tells_of_a_run_that_ended_early(monkeypatch: pytest.MonkeyPatch) -> None:
    from sandbox.session.session import Session

    def collapse(session: Session, _: int) -> bool:
        from dataclasses import replace

        session.settle()
        if not session.run.history[-1].increment:
            row = replace(session.run.history[-1], increment=1, stop_reason="collapsed")
            session.run.history.append(row)
            return True
        session.run.hands.follow_script(False)
        return False

    monkeypatch.setattr(Session, "advance", collapse)
    result = execute(tiny("regular"))
    assert result.ended == result.trouble == "a grain was squeezed flat at increment 1 of 6"
    assert result.failure is None
    assert len(result.column("force")) == 2


def test_key_depends_on_everything_that_the_run_does() -> None:
    keys = {
        request.key()
        for request in (
            tiny("regular"),
            tiny("auxetic"),
            tiny("regular", 2),
            Request("grain_row", "regular", 1, TINY, probe="curve"),
            Request("grain_row", "regular", 1, TINY, steps=3, probe="sideways"),
            Request("grain_row", "regular", 1, TINY[:2], probe="sideways"),
        )
    }
    assert len(keys) == 6
    default = Request("grain_row", "regular", 1, (("grains", 7),))
    assert default.key() == Request("grain_row", "regular", 1).key()  # 7 is the scene's own
    assert all(re.fullmatch(r"grain_row-[0-9a-f]{16}", key) for key in keys)


def test_store_keeps_runs_and_tries_bad_ones_again(tmp_path: Path) -> None:
    store, request = Store(tmp_path), tiny("regular")
    assert store.read(request) is None
    kept = Result(request, {"stroke": [0.0, 1.0]}, {"drop": [0.5]}, 1.0, 2.0)
    store.write(kept)
    assert store.read(request) == kept
    assert store.read(tiny("auxetic")) is None
    store.path(request).write_text("{")
    assert store.read(request) is None
    store.write(Result(request, failure="no"))
    assert json.loads(store.path(request).read_text())["failure"] == "no"
    assert store.read(request) is None


def test_a_figure_that_cannot_be_drawn_is_left_out(tmp_path: Path) -> None:
    def nothing(_: Sequence[Result]) -> Sequence[Panel]:
        raise Unmeasurable("the pressure does not rise")

    part = Part("value", "says", "increments", Threshold(Demand(5.5, 6.5), "reason"), count)
    figures = (Figure("none", "figure", nothing),)
    claim = Claim("tiny", "", "words", lambda quick: [tiny("regular")], (part,), figures)
    (tmp_path / "runs").mkdir()
    outcome = paper.study(tmp_path, jobs=1, claims=(claim,))
    assert [row.findings[0].verdict for row in outcome.judged] == ["holds"]
    assert (tmp_path / "claims.md").exists()
    assert not (tmp_path / "none.png").exists()


def test_only_what_is_missing_is_run_again(tmp_path: Path) -> None:
    """Two runs and one that fails; one file is deleted; that one and the failed one are run again."""
    bad = Request("grain_row", "regular", 1, (("grains", 0),))
    requests = (tiny("regular"), tiny("auxetic"), bad)
    part = Part(
        "value", "says", "increments in all", Threshold(Demand(11.5, 12.5), "reason"), count
    )
    claim = Claim("tiny", "", "words", lambda quick: requests[:2], (part,))
    broken = Claim("broken", "", "words", lambda quick: requests, (part,))
    (tmp_path / "runs").mkdir()
    outcome = paper.study(tmp_path, jobs=2, claims=(claim, broken))
    assert (outcome.runs, outcome.failed, outcome.interrupted) == (3, 1, False)
    verdicts = {row.claim.name: row.findings[0] for row in outcome.judged}
    assert verdicts["tiny"].verdict == "holds"
    assert verdicts["broken"].verdict == "not measured"
    assert "grains" in verdicts["broken"].decided_by

    store = Store(tmp_path / "runs")
    times = {request: store.path(request).stat().st_mtime_ns for request in requests}
    store.path(requests[1]).unlink()
    paper.study(tmp_path, jobs=1, claims=(claim, broken))
    again = {request: store.path(request).stat().st_mtime_ns for request in requests}
    assert again[requests[0]] == times[requests[0]]
    assert again[requests[1]] > times[requests[1]]
    assert again[requests[2]] > times[requests[2]]

    data = json.loads((tmp_path / "results.json").read_text())
    assert data["runs_from_before"] == 1
    verdicts_told = [claim["parts"][0]["verdict"] for claim in data["claims"]]
    assert verdicts_told == ["holds", "not measured"]
    text = (tmp_path / "claims.md").read_text()
    assert (
        "| value: says | increments in all: 12 | between 11.5 and 12.5 | no chance | **holds** |"
        in text
    )
    assert "| value: says | 1 of 3 runs failed" in text
    with (tmp_path / "runs.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["claims"] for row in rows] == ["tiny broken", "tiny broken", "broken"]
    assert [row["increments"] for row in rows] == ["6", "6", "0"]
    assert sum(bool(row["failure"]) for row in rows) == 1


def count(results: Sequence[Result]) -> Reading:
    """How many increments there were in all."""
    total = sum(len(run.columns["stroke"]) - 1 for run in results)
    return exactly(total, Measured.of("increments", "", total))


def test_a_hand_is_that_of_the_study_of_the_hand() -> None:
    """The same push comes to the same, and what a run writes down of it can be kept."""
    from sandbox.studies.hand.jobs import Job, push

    request = Request("grain_row", "regular", 1, ((HAND_STRENGTH, 0.5),), probe=HAND)
    done = execute(request)
    row = push(Job("push", "grain_row", "regular", 1, 0.5), lambda: None)
    assert done.lists["locked"] == [1.0]
    assert done.lists["peak_force"] == [row["peak_force"]]
    assert done.increments == row["increments"]
    assert done.ended is None


def test_a_process_that_dies_fails_its_run_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sandbox.ensemble.batch import LOST
    from sandbox.ensemble.pool import Pool
    from sandbox.studies.paper import runs

    store = Store(tmp_path)
    told: list[Result] = []
    first = [True]
    true = runs._execute

    def submit(pool: Pool, function: object, *arguments: object) -> object:
        if function is true and first.pop():
            first.append(False)
            return real(pool, os._exit, 3)
        return real(pool, function, *arguments)  # type: ignore[arg-type]

    real = Pool.submit
    monkeypatch.setattr(Pool, "submit", submit)
    run_all([tiny("regular"), tiny("auxetic")], store, 1, told.append)
    assert [result.failure for result in told] == [LOST, None]


# Figures.


def test_figures_are_pictures(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    import imageio.v2
    import numpy as np

    from sandbox.studies.paper.figures import draw

    x = np.array([1.0, 2.0])
    lines = (
        Line("line", "regular", x, x),
        Line("marks", "auxetic", x, x, 0.1 * x, points=True),
        Line("", "mixed", x, x, dashed=True),
    )
    panel = Panel("title", "x [R]", "y [k R]", lines, log_x=True, log_y=True)
    draw(Figure("f", "figure", lambda _: [panel] * 3), [], tmp_path / "f.png")
    image = imageio.v2.imread(tmp_path / "f.png")
    assert image.shape[0] > 900
    assert image.shape[1] > 1200
    colours = {tuple(map(int, pixel)) for pixel in image[..., :3].reshape(-1, 3)}
    assert {(0x00, 0x77, 0xBB), (0xEE, 0x33, 0x77), (0x00, 0x99, 0x88)} <= colours
    with pytest.raises(InputError, match="cannot write"):
        draw(Figure("f", "figure", lambda _: [panel]), [], tmp_path / "none" / "f.png")


# The command.


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["study"], "NAME"),
        (["study", "paper"], "--out"),
        (["study", "papers", "--out", "x"], "did you mean paper?"),
        (
            ["study", "paper", "--out", "x", "--only", "grain_rows"],
            "did you mean grain_row?",
        ),
        (["study", "paper", "--out", "x", "--only", "zzz"], "there are poisson_ratio"),
        (["study", "paper", "--out", "x", "--jobs", "0"], "--jobs"),
        (["study", "paper", "--out", "x", "--fast"], "unknown option --fast"),
        (["study", "paper", "--out", "file.txt"], "cannot write there"),
    ],
)
def test_mistakes_are_one_line(
    words: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file.txt").write_text("mine")
    assert cli.main(words) == 2
    said = capsys.readouterr()
    assert message in said.err
    assert said.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["file.txt"]
    assert Path("file.txt").read_text() == "mine"


def test_without_matplotlib_nothing_is_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert cli.main(["study", "paper", "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "auxetic-sandbox[study]" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def command(folder: Path, *words: str) -> list[str]:
    return [sys.executable, "-m", "sandbox", "study", "paper", "--out", str(folder), *words]


def test_a_weaker_hand_that_was_never_needed_is_not_tried_again(tmp_path: Path) -> None:
    hands = [
        Request("grain_row", "auxetic", 1, ((HAND_STRENGTH, strength),), probe=HAND)
        for strength in (50.0, 20.0, 0.1)
    ]
    strong, weak, too_weak = (execute(hand) for hand in hands)
    assert implied(hands[1], [strong]) == replace(weak, seconds=0.0)
    assert implied(hands[2], [strong, weak]) is None
    assert implied(hands[0], [weak]) is None
    assert implied(tiny("auxetic"), [strong]) is None
    told: dict[Request, Result] = {strong.request: strong}

    def done(result: Result) -> None:
        told[result.request] = result

    store = Store(tmp_path)
    run_all(hands[1:], store, 1, done, known=told.values())
    assert told[hands[1]].seconds == 0.0
    assert store.read(hands[1]) == told[hands[1]]
    assert told[hands[2]].lists == too_weak.lists


@pytest.mark.end_to_end
def test_quick_study_of_one_claim(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    words = command(tmp_path / "out", "--quick", "--only", "grain_row", "--jobs", "1")
    done = subprocess.run(words, cwd=REPOSITORY, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert re.match(r"grain_row  holds +direction: ", done.stdout)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "claims.md",
        "fig-poisson-effect.png",
        "results.json",
        "runs",
        "runs.csv",
    ]
    data = json.loads((tmp_path / "out" / "results.json").read_text())
    assert data["quick"] is True
    assert [part["verdict"] for part in data["claims"][0]["parts"]] == ["holds", "holds"]
    assert data["machine"]["cores"] >= 1
    assert data["versions"]["numba"]
    assert len((tmp_path / "out" / "runs.csv").read_text().splitlines()) == 1 + data["runs"] == 3


@pytest.mark.end_to_end
@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT as a terminal does")
def test_ctrl_c_keeps_what_is_finished(tmp_path: Path) -> None:
    """As in a terminal, all processes hear it; what was finished stays, and nobody is left behind."""
    pytest.importorskip("matplotlib")
    words = command(tmp_path / "out", "--only", "grain_row", "intruder_drag", "--jobs", "1")
    process = subprocess.Popen(
        words, cwd=REPOSITORY, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    kept = tmp_path / "out" / "runs"
    end = time.monotonic() + 300.0
    while not list(kept.glob("*.json")) and process.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
    assert process.poll() is None, "the study ended before anybody pressed a key"
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "the same command goes on from there" in said
    assert "Traceback" not in said
    for path in kept.glob("*"):
        assert json.loads(path.read_text())["failure"] is None
    assert not (tmp_path / "out" / "results.json").exists()
    end = time.monotonic() + 30.0
    while alive(process.pid) and time.monotonic() < end:
        time.sleep(0.05)  # the process that watches over shared resources ends last
    assert not alive(process.pid)


def alive(group: int) -> bool:
    """Whether a process of the group is left."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
