"""The gallery: whole pages that ask for nothing, a worksheet for every scene, and what was measured."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sandbox.cli import main as cli
from sandbox.site import studies
from sandbox.site.site import MOST
from sandbox.words import language
from scenes import registry
from tests.player.markup import Markup, asks_for

SCENES = ("single_grain", "grain_row")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site") / "gallery"
    words = ["site", "--out", str(folder), "--scene", *SCENES, "--steps", "4"]
    assert cli.main(words) == 0
    return folder


def test_every_page_is_there_and_links_lead_to_pages(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    there = {f"{name}.html" for name in (*SCENES, "index", "worksheets")}
    assert names == there | {studies.file_of(name) for name in studies.found()}
    assert len(studies.found()) == 5
    assert sum(path.stat().st_size for path in folder.iterdir()) < MOST
    for path in folder.iterdir():
        markup = Markup(path.read_text(encoding="utf-8"))
        links = [str(a["href"]) for a in markup.all("a")]
        own = [link for link in links if "://" not in link]
        assert links, path
        for link in own:
            name, _, place = link.partition("#")
            assert not name or name in names, (path, link)
            if name.startswith("worksheets") and place:
                assert f'id="{place}"' in (folder / name).read_text(encoding="utf-8")


def test_no_page_asks_for_anything(folder: Path) -> None:
    for path in folder.iterdir():
        assert asks_for(path.read_text(encoding="utf-8")) == [], path


def test_a_worksheet_says_everything_in_every_language(folder: Path) -> None:
    text = (folder / "worksheets.html").read_text(encoding="utf-8")
    for code in language.available():
        table = language.table(code)
        assert set(table["worksheets"]) == set(registry.names())
        for scene in registry.names():
            assert set(table["worksheets"][scene]) == {"predict", "measure", "explain"}
        for scene in SCENES:
            for said in (table["scenes"][scene]["question"], *table["worksheets"][scene].values()):
                assert said.split("“")[0].replace("'", "&#x27;") in text
    sheets = re.findall(r'<section class="sheet" id="(\w+)">', text)
    assert sheets == list(SCENES)


def test_what_was_measured_has_its_tables_and_figures(folder: Path) -> None:
    text = (folder / studies.file_of("claims")).read_text(encoding="utf-8")
    source = studies.found()["claims"].read_text(encoding="utf-8")
    assert text.count("<tr>") == len(re.findall(r"^\|(?!\s*---)", source, re.MULTILINE))
    assert text.count("data:image/png;base64,") == source.count("![")


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--scene", "hoper"], "did you mean hopper"),
        (["--steps", "0"], "out of range"),
    ],
)
def test_mistakes_are_one_plain_line(
    words: list[str], part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["site", "--out", str(tmp_path / "x"), *words]) == 2
    said = capsys.readouterr().err
    assert part in said
    assert said.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_file_in_the_way_is_a_plain_mistake(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x").write_text("kept")
    assert cli.main(["site", "--out", str(tmp_path / "x")]) == 2
    assert "cannot write there" in capsys.readouterr().err
    assert (tmp_path / "x").read_text() == "kept"
