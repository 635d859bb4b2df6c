"""What a sweep is asked, before any work: axes, seeds, numbers of rows, and what is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.sweep.asking import ask, axis
from sandbox.sweep.columns import AFTER, BEFORE
from sandbox.sweep.request import Request
from scenes import registry

HOPPER = "gravity_hopper"


def test_an_axis_ends_where_it_says() -> None:
    scene = registry.get(HOPPER)
    assert axis("friction=0:0.3:0.1", scene).values == (0.0, 0.1, 0.2, 0.3)
    assert axis("orifice=3:2:-0.5", scene).values == (3.0, 2.5, 2.0)
    assert axis("grains=40,60", scene).values == (40, 60)
    assert axis("hand_strength=2,machine", scene).values == (2.0, 1000.0)


def test_more_seeds_leave_every_row_as_it_was() -> None:
    asked = ask(HOPPER, ["orifice=2,3", "fall=0.1,0.2"], "regular,auxetic", "4:5", {"grains": "80"})
    jobs = list(asked.jobs())
    assert [job.row for job in jobs] == list(range(1, 17))
    assert jobs == [asked.job(row) for row in range(1, 17)]
    assert [(job.seed, job.packing) for job in jobs[::4]] == [
        (seed, kind) for seed in (4, 5) for kind in ("regular", "auxetic")
    ]
    assert [job.settings["orifice"] for job in jobs[:4]] == [2.0, 2.0, 3.0, 3.0]
    assert {job.steps for job in jobs} == {4000, 2000}
    more = asked.with_more_seeds(1)
    assert list(more.jobs())[:16] == jobs
    assert more.key() == asked.key()
    assert Request.of(asked.data()) == asked
    assert ask(HOPPER, ["orifice=2,4"], None, "4", {}).key() != asked.key()


@pytest.mark.parametrize("name", registry.names())
def test_no_parameter_is_called_as_a_column(name: str) -> None:
    assert not {p.name for p in registry.get(name).parameters} & {*BEFORE, *AFTER}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--vary", "orifise=2,3"], "did you mean orifice?"),
        (["--vary", "orifice=3:2:0.5"], "the range is empty"),
        (["--vary", "orifice=2:3:0"], "STEP not 0"),
        (["--vary", "orifice=2:99:1"], "must lie between"),
        (["--vary", "fall=0.01:0.3:0.000000001"], "too many"),
        (["--vary", "orifice=0:1e99999:1"], "too many"),
        (["--vary", "orifice=2,2"], "a value comes twice"),
        (["--vary", "orifice=2", "--set", "orifice=3"], "both varied and set"),
        (["--vary", "orifice=2,8", "--set", "width=12"], "at orifice=8: the orifice is wider"),
        (["--seeds", "1000000000"], "runs are too many"),
        (["--seeds", "9:5"], "the range is empty"),
        (["--packing", "regular,auxetc"], "unknown packing"),
        (["--until", "clogs"], "did you mean clog?"),
        (["--set", "friktion=1"], "did you mean friction?"),
        (["--executor", "slurm"], "use local or dask://"),
        (["--executor", "dask://nowhere"], "dask://HOST:PORT"),
        (["--executor", "dask://127.0.0.1:1"], "no scheduler answers there"),
        (["--jobs", "0"], "--jobs"),
        (["--seeds", ""], "write how many"),
        (["--out", ""], "where shall the tables go?"),
        (["--out", 300 * "x"], "too long"),
    ],
)
def test_mistakes_are_one_line_before_any_work(
    words: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: object())  # as if all were installed
    assert cli.main(["sweep", HOPPER, "--out", str(tmp_path / "out"), *words]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_row_that_is_not_there() -> None:
    with pytest.raises(InputError, match="use 1 to 10"):
        ask(HOPPER, [], None, "10", {}).job(11)


@pytest.mark.parametrize(
    "changed",
    [
        {"steps": "x"},
        {"steps": -1},
        {"seeds": [5, 1]},
        {"packings": []},
        {"packings": ["mixed", "mixed"]},
        {"until": ["nonsense"]},
        {"scene": 3},
        {"settings": {"grains": "many"}},
        *({"axes": [{"name": "orifice", "values": v}]} for v in ([], ["x"], [[1]], [10**400])),
        {"axes": 2 * [{"name": "orifice", "values": [2.0]}]},
    ],
)
def test_a_request_that_somebody_has_changed_is_refused(changed: dict[str, object]) -> None:
    with pytest.raises(InputError):
        Request.of({**ask(HOPPER, ["orifice=2,3"], None, "4", {}).data(), **changed})
