"""``bench`` from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sandbox.cli import main as cli
from sandbox.studies.bench import bench
from sandbox.studies.bench.report import Row, Section


def cardboard(met: bool) -> Section:
    return Section("part", "A part", (Row("speed", "1 µs", "≤ 2 µs", met),), {"us": 1.0})


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, bool]]:
    """The bench with one part of cardboard; a list of how it was asked."""
    asked = []

    def parts(**options: bool) -> object:
        asked.append(options)
        yield lambda: cardboard(met=not options["peers"])

    monkeypatch.setattr(bench, "parts", parts)
    return asked


def test_writes_json_and_table(
    tmp_path: Path, quick: list[dict[str, bool]], capsys: pytest.CaptureFixture[str]
) -> None:
    data, table = tmp_path / "b.json", tmp_path / "b.md"
    words = ["bench", "--quick", "--json", str(data), "--markdown", str(table)]
    assert cli.main(words) == 0
    assert quick == [{"quick": True, "peers": False}]
    written = json.loads(data.read_text(encoding="utf-8"))
    assert written["sections"]["part"]["us"] == 1.0
    assert written["machine"]["cores"] >= 1
    assert set(written["machine"]) == {"processor", "cores", "system", "python", "numpy", "numba"}
    assert "| speed | 1 µs | ≤ 2 µs |" in table.read_text(encoding="utf-8")
    out = capsys.readouterr().out
    assert "A part" in out
    assert "all targets met" in out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["b.json", "b.md"]


def test_counts_what_was_missed(
    quick: list[dict[str, bool]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["bench", "--peers"]) == 0
    assert quick == [{"quick": False, "peers": True}]
    assert "1 target missed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["--json", "b.txt"], "must end in .json"),
        (["--markdown", "b.html"], "must end in .md"),
        (["--json", "nowhere/b.json"], "there is no folder"),
        (["--fast"], "unknown option --fast"),
        (["again"], "unexpected argument"),
    ],
)
def test_mistakes_are_one_line_and_come_first(
    words: list[str],
    complaint: str,
    quick: list[dict[str, bool]],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["bench", *words]) == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1
    assert not quick
    assert not list(tmp_path.iterdir())


def test_all_parts_are_there() -> None:
    assert len(list(bench.parts(quick=True, peers=False))) == 8
    assert len(list(bench.parts(quick=False, peers=False))) == 11
    assert bench.QUICK.frames < bench.FULL.frames
