"""Several packings in one film and one table: in step, and the same bits again."""

from __future__ import annotations

import csv
from pathlib import Path

import imageio.v2
import pytest

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.record.record import Output, record
from sandbox.session.session import Session

KINDS = ("regular", "mixed", "auxetic")
SETTINGS = {"grains": 50, "intruder_radius": 2.0}


def sessions() -> list[Session]:
    return [Session("intruder", kind, 3, SETTINGS) for kind in KINDS]


def test_in_step_and_the_same_bits_again(tmp_path: Path) -> None:
    hashes, films = [], []
    for name in ("a", "b"):
        made = sessions()
        output = Output(tmp_path / f"{name}.gif", tmp_path / f"{name}.csv", (640, 360))
        outcome = record(made, 4, output)
        assert (outcome.increments, outcome.frames, outcome.rows) == (4, 4, 3 * 5)
        assert [session.finished for session in made] == [4, 4, 4]
        hashes.append([session.state_hash() for session in made])
        films.append(imageio.v2.mimread(tmp_path / f"{name}.gif"))
    assert hashes[0] == hashes[1]
    assert len(set(hashes[0])) == 3
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert all((one == other).all() for one, other in zip(*films, strict=True))
    rows = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))
    assert [row["packing"] for row in rows] == [kind for kind in KINDS for _ in range(5)]
    assert "stroke [R]" in rows[0]


def test_alone_a_packing_does_the_same(tmp_path: Path) -> None:
    made = sessions()
    record(made, 3, Output(None, tmp_path / "all.csv"))
    alone = sessions()[1]
    record([alone], 3, Output(None, tmp_path / "one.csv"))
    assert alone.state_hash() == made[1].state_hash()


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--compare", "regular"], "two or three"),
        (["--compare", "regular,regular"], "two or three"),
        (["--compare", "regular,wood"], "unknown packing"),
        (["--compare", "regular,auxetic", "--packing", "mixed"], "one of them"),
    ],
)
def test_mistakes_are_one_plain_line(
    words: list[str], part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = cli.main(["record", "intruder", "--data", str(tmp_path / "x.csv"), *words])
    assert code == 2
    said = capsys.readouterr().err
    assert part in said
    assert said.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_comparing_needs_a_scene() -> None:
    options = cli.parse(["play", "--compare", "regular,auxetic"])
    with pytest.raises(InputError, match="needs a scene"):
        options.run(options)


def test_a_run_in_which_nothing_is_driven_is_a_mistake_and_no_empty_film(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = Session("single_grain", "regular")
    monkeypatch.setattr(type(session.scene), "drive", lambda *_: None)
    with pytest.raises(InputError, match="nothing to drive"):
        record([session], 3, Output(None, tmp_path / "one.csv"))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("every", "frames"), [(1, 5), (2, 3), (5, 1), (1000, 1)])
def test_the_last_increment_is_shown_whatever_is_left_out(
    every: int, frames: int, tmp_path: Path
) -> None:
    def made(name: str, every: int) -> Path:
        session = Session("single_grain", "regular")
        xyz = tmp_path / f"{name}.xyz"
        output = Output(tmp_path / name, None, (640, 360), every=every, trajectory=xyz)
        outcome = record([session], 5, output)
        assert outcome.increments == 5
        if name.endswith(".gif"):
            assert outcome.frames == frames
        return tmp_path / name

    made("film.gif", every)
    assert len(imageio.v2.mimread(tmp_path / "film.gif")) == frames
    assert (tmp_path / "film.gif.xyz").exists()
    assert made("few.png", every).read_bytes() == made("all.png", 1).read_bytes()
    few, all_of_them = (
        (tmp_path / f"{name}.png.xyz").read_text().splitlines()[-3:] for name in ("few", "all")
    )
    assert few == all_of_them
