"""Built-in lessons are whole in English and German, last as long as they say, and go onto paper, where nothing in them runs."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.lessons import classroom, sheets
from sandbox.lessons.reading import parse_lesson, read_lesson
from sandbox.words import language
from tests.lessons.test_reading import HEAD, STEP

NAMES = classroom.names()
TAUGHT = ("en", "de")


class Seen(HTMLParser):
    """Tags and text of a page; complains about what is not closed."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.text = ""
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        assert not any(name.startswith("on") or name in ("src", "href") for name, _ in attrs)
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag != "path":
            assert self.open.pop() == tag

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.text += data


def test_there_are_six_lessons() -> None:
    assert NAMES == ("poisson", "mixture", "arches", "yield", "friction", "residual")


@pytest.mark.parametrize("name", NAMES)
def test_a_lesson_is_whole_in_both_languages(name: str) -> None:
    lesson = classroom.lesson(name)
    for where, said in lesson.texts():
        if said:
            assert set(TAUGHT) <= set(said.by_language), where
            if (
                re.search("[A-Za-z]{5}", said.by_language["en"])
                and len(said.by_language["en"]) > 12
            ):
                assert said.by_language["en"] != said.by_language["de"], where
    assert (lesson.minutes, lesson.seed) == (45, 1)
    assert len(lesson.aims) >= 2
    assert lesson.prior
    assert len(lesson.tasks) >= 2
    assert all(step.minutes for step in lesson.steps)
    left = lesson.minutes - sum(step.minutes for step in lesson.steps)
    assert 3 <= left <= 8  # for the worksheet
    asked = [step.predict for step in lesson.steps if step.predict is not None]
    assert len(asked) >= 3
    assert all(predict.right is not None for predict in asked if predict.kind != "sketch")


@pytest.mark.parametrize("name", NAMES)
def test_pages_for_pupils_do_not_tell_and_those_for_teachers_do(name: str) -> None:
    lesson = classroom.lesson(name)
    for code in TAUGHT:
        with language.speaking(code):
            pupils, teachers = Seen(sheets.worksheet(lesson)), Seen(sheets.teacher(lesson))
            for step in lesson.steps:
                assert str(step.say) in pupils.text
                if step.why:
                    assert str(step.why) not in pupils.text
                    assert str(step.why) in teachers.text
                if step.predict is not None:
                    assert str(step.predict.ask) in pupils.text
            for task in lesson.tasks:
                assert str(task.text) in pupils.text
                assert str(task.answer) not in pupils.text
                assert str(task.answer) in teachers.text
            assert all(str(aim) in teachers.text for aim in lesson.aims)
            assert not {"script", "img", "link", "iframe"} & {*pupils.tags, *teachers.tags}


def test_the_command_writes_pages_and_the_lesson_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["lesson"]) == 0
    assert [line.split(":")[0] for line in capsys.readouterr().out.splitlines()] == list(NAMES)
    assert main(["lesson", "poisson", "--out", str(tmp_path / "paper")]) == 0
    there = {path.name for path in (tmp_path / "paper").iterdir()}
    pages = {f"poisson-{kind}-{code}.html" for kind in ("worksheet", "teacher") for code in TAUGHT}
    assert there == {"poisson.toml", *pages}
    assert read_lesson(tmp_path / "paper" / "poisson.toml") == classroom.lesson("poisson")
    # Once more, from the copy, where it lies.
    own = tmp_path / "paper" / "poisson.toml"
    assert main(["lesson", str(own), "--out", str(tmp_path / "paper"), "--language", "uk"]) == 0
    assert (tmp_path / "paper" / "poisson-teacher-uk.html").exists()
    assert read_lesson(own) == classroom.lesson("poisson")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["poison", "--out", "x"], "did you mean poisson"),
        (["poisson"], "give --out DIR"),
        (["--out", "x"], "--out needs a lesson"),
        (["gone.toml", "--out", "x"], "no such file"),
    ],
    ids=str,
)
def test_mistakes(given: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lesson", *given]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1


def test_no_text_becomes_markup() -> None:
    bad = "<script>alert(1)</script>"
    text = HEAD.replace("version", f'title = "{bad}"\nversion') + STEP.replace(
        "Look.", f'{bad} & \\"quoted\\"'
    )
    lesson = parse_lesson("mine", text.encode(), "")
    for page in (sheets.worksheet(lesson), sheets.teacher(lesson)):
        seen = Seen(page)
        assert bad in seen.text
        assert "script" not in seen.tags


def test_a_lesson_in_english_alone_has_english_pages_alone() -> None:
    lesson = parse_lesson("mine", (HEAD + STEP).encode(), "")
    assert sheets.languages_of(lesson) == ("en",)
    assert sheets.languages_of(classroom.lesson("arches")) == TAUGHT


def test_a_lesson_that_somebody_has_changed_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["lesson", "poisson", "--out", str(tmp_path)]) == 0
    assert main(["lesson", "poisson", "--out", str(tmp_path), "--language", "de"]) == 0
    mine = tmp_path / "poisson.toml"
    mine.write_text(mine.read_text(encoding="utf-8") + "# mine\n", encoding="utf-8")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    capsys.readouterr()
    assert main(["lesson", "poisson", "--out", str(tmp_path)]) == 2
    assert re.fullmatch(r"error: .*poisson\.toml is another lesson.*\n", capsys.readouterr().err)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert main(["lesson", str(mine), "--out", str(tmp_path)]) == 0
    assert mine.read_text(encoding="utf-8").endswith("# mine\n")
