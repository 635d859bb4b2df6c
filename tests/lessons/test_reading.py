"""A lesson is read whole, or refused in one line that names what is wrong and where."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.cli.main import main
from sandbox.lessons import classroom, tours
from sandbox.lessons.lesson import Condition, Said
from sandbox.lessons.reading import LARGEST, is_lesson, is_meant, parse_lesson, read_lesson
from sandbox.words import language
from scenes import registry

HEAD = 'format = "auxetic-sandbox lesson"\nversion = 1\nscene = "hopper"\n'
STEP = '[[step]]\nkey = "push"\npackings = ["regular"]\nsay = "Look."\n'
PULL = 'do = "Push."\nuntil = { moved = "piston", by = 1.0 }\n'
CHOICE = '[step.predict]\nkind = "choice"\nask = "Which?"\noptions = ["this", "that"]\n'
WHOLE = HEAD + STEP + PULL + CHOICE


def parsed(text: str) -> object:
    return parse_lesson("mine", text.encode(), "mine.toml")


def test_a_small_lesson() -> None:
    lesson = parse_lesson(
        "mine", (WHOLE + 'right = 2\nanswer.en = "That."\nanswer.de = "Jenes."\n').encode(), ""
    )
    (step,) = lesson.steps
    assert (lesson.name, lesson.scene, step.packings) == ("mine", "hopper", ("regular",))
    assert step.until == Condition(moved="piston", by=1.0)
    assert step.predict is not None
    assert [str(option) for option in step.predict.options] == ["this", "that"]
    assert step.predict.is_right(1.0) is True
    assert step.predict.is_right(0.0) is False
    assert str(step.predict.answer) == "That."
    with language.speaking("de"):
        assert str(step.predict.answer) == "Jenes."
        assert str(step.say) == "Look."  # nobody has translated it


def test_a_number_is_right_within_its_tolerance() -> None:
    ask = '[step.predict]\nkind = "number"\nask = "How much?"\nright = 3\nwithin = 0.5\nunit = "k R"\n'
    predict = parse_lesson("mine", (HEAD + STEP + ask).encode(), "").steps[0].predict
    assert predict is not None
    assert [predict.is_right(value) for value in (2.4, 2.5, 3.5, 3.6)] == [False, True, True, False]


def test_a_sketch_has_axes() -> None:
    ask = '[step.predict]\nkind = "sketch"\nask = "Draw."\nalong = [0, 2]\nup = [-1, 4.5]\n'
    predict = parse_lesson("mine", (HEAD + STEP + PULL + ask).encode(), "").steps[0].predict
    assert predict is not None
    assert (predict.axes, predict.is_right(1.0)) == ((0.0, 2.0, -1.0, 4.5), None)


def test_a_step_may_begin_another_scene() -> None:
    more = STEP.replace("push", "rest").replace("packings", 'scene = "single_grain"\npackings')
    last = '[[step]]\nkey = "on"\nsay = "Go on."\ndo = "Pull."\nuntil = { moved = "plate", by = 0.1 }\n'
    lesson = parse_lesson("mine", (HEAD + STEP + more + last).encode(), "")
    assert [lesson.scene_of(index) for index in range(3)] == [
        "hopper",
        "single_grain",
        "single_grain",
    ]


# What is wrong, and what the line says about it.
MISTAKES = [
    ("", "not a lesson of this program; its first line is"),
    ("x = [[[", "no TOML"),
    ("x = 1\nx = 2", "no TOML"),
    ("x = " + "[" * 5000, "no TOML|tables within"),
    ("x = 1" + "0" * 5000, "no TOML"),
    (HEAD.replace("version = 1\n", ""), "version is missing; add it"),
    (HEAD.replace("version = 1", "version = 2"), "version 2 of the format, this program reads 1"),
    (HEAD.replace("hopper", "hoper"), r"scene 'hoper' is none of .* \(did you mean hopper\?\)"),
    (HEAD.replace('"hopper"', "7"), "scene 7 is none of"),
    (HEAD, "step is missing"),
    (HEAD + "step = 1", "step must be 1 to 40 tables"),
    (HEAD + "[[step]]", "step 1 key is missing"),
    (WHOLE.replace('"push"', '"Push!"'), "step 1 key must be small letters"),
    (WHOLE + STEP, "two steps have the key 'push'"),
    (WHOLE.replace('packings = ["regular"]\n', ""), "the first step begins the scene"),
    (WHOLE.replace("regular", "reglar"), r"step push: packings 'reglar' is none of .*mean regular"),
    (WHOLE.replace('["regular"]', '["regular", "regular"]'), "packings names one twice"),
    (WHOLE.replace('["regular"]', '"regular"'), "step push: packings must be a list"),
    (WHOLE.replace('say = "Look."', "say = 3"), "step push: say must be a text"),
    (WHOLE.replace('say = "Look."', 'say.de = "Sieh."'), "step push: say.en is missing"),
    (WHOLE.replace('say = "Look."', 'say = { en = "a", deutsch = "b" }'), "a language has a code"),
    (WHOLE.replace("Look.", "Look." * 100), "step push: say has 500 letters: use 320 at most"),
    (WHOLE.replace("Look.", r"Look\u0007"), "step push: say has a line break or another sign"),
    (WHOLE.replace("Look.", "  "), "step push: say is empty"),
    (WHOLE.replace("say = ", "sey = "), "step push: say is missing"),
    (WHOLE.replace("[[step]]", "sead = 3\n[[step]]"), r"'sead': nobody knows this key \(did you mean seed\?\)"),
    (WHOLE.replace("[[step]]", "seed = -1\n[[step]]"), "seed must be a whole number from 0"),
    (WHOLE.replace("[[step]]", "minutes = 4.5\n[[step]]"), "minutes must be a whole number from 1 to 300"),
    (WHOLE.replace('say = "Look."', 'say = "Look."\nwant = 1'), "step push: 'want': nobody knows this key"),
    (WHOLE.replace('do = "Push."\n', ""), "step push: do is missing"),
    (HEAD + STEP + 'do = "Push."\n', "step push: until is missing"),
    (WHOLE.replace("piston", "pistn"), r"until moved 'pistn' is none of piston \(did you mean piston\?\)"),
    (WHOLE.replace(", by = 1.0", ""), "step push: until by is missing"),
    (WHOLE.replace("by = 1.0", "by = nan"), "until by must be a number from"),
    (WHOLE.replace("by = 1.0", "by = true"), "until by must be a number from"),
    (WHOLE.replace("by = 1.0", "by = 1" + "0" * 400), "until by must be a number from"),
    (WHOLE.replace('moved = "piston", by = 1.0', ""), "until must say one thing"),
    (WHOLE.replace("by = 1.0", "by = 1.0, out = 3"), "until must say one thing"),
    (WHOLE.replace('moved = "piston", by = 1.0', 'event = "clogg"'), r"mean clog\?"),
    (WHOLE.replace('moved = "piston", by = 1.0', 'setting = "frction"'), r"mean friction\?"),
    (WHOLE.replace('moved = "piston", by = 1.0', "out = 2, by = 1.0"), "until by goes with moved alone"),
    (WHOLE.replace("by = 1.0", 'by = 1.0, way = "dwn"'), r"push: until way 'dwn' is none of .*mean down\?"),
    (WHOLE.replace("by = 1.0", "by = 1.0, way = 3"), "until way 3 is none of left, right"),
    (WHOLE.replace('moved = "piston", by = 1.0', 'out = 2, way = "down"'), "until way goes with moved alone"),
    (WHOLE.replace('say = "Look."', 'say = "Look."\nview = "presure"'), r"mean pressure\?"),
    (WHOLE.replace('say = "Look."', 'say = "Look."\nsettings = { orfice = 3 }'), "has no parameter 'orfice'"),
    (WHOLE.replace('say = "Look."', 'say = "Look."\nsettings = { orifice = 300 }'), "orifice must lie between"),
    (WHOLE.replace('say = "Look."', 'say = "Look."\nsettings = 3'), "settings must be a table"),
    (WHOLE + '[[step]]\nkey = "b"\nsay = "x"\nsettings = { friction = 0.1 }', "settings needs packings"),
    (WHOLE + '[[step]]\nkey = "b"\nsay = "x"\nscene = "intruder"', "scene needs packings"),
    (WHOLE.replace('"choice"', '"chioce"'), r"predict kind 'chioce' is none of .*mean choice"),
    (WHOLE.replace('["this", "that"]', '["this"]'), "predict options has 1 entries: give 2 to 6"),
    (WHOLE.replace('["this", "that"]', '["this", 2]'), "predict options 2 must be a text"),
    (WHOLE + "right = 3\n", "predict right must be a whole number from 1 to 2"),
    (WHOLE + "within = 3\n", "predict 'within': nobody knows this key"),
    (WHOLE.replace("choice", "sketch").replace('options = ["this", "that"]', "along = [2, 1]\nup = [0, 1]"), "lower one first"),
    (WHOLE.replace("choice", "sketch").replace('options = ["this", "that"]', "along = [2]\nup = [0, 1]"), "has 1 entries"),
    (HEAD + STEP + '[step.predict]\nkind = "sketch"\nask = "Draw."\nalong = [0, 2]\nup = [0, 1]', "until is missing: it says"),
    (WHOLE + 'why = "So."', r"predict 'why': nobody knows this key.*stands above \[step.predict\]"),
    (WHOLE.replace("[[step]]", 'hide = ["frction"]\n[[step]]'), r"hide 1 'frction' is none of .*mean friction"),
    (WHOLE.replace("[[step]]", 'task = 4\n[[step]]'), "task must be a list"),
    (WHOLE + '[[task]]\ntext = "Why?"\n', "task 1 answer is missing"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "said"), MISTAKES, ids=[said[:40] for _, said in MISTAKES])
def test_every_mistake_is_one_line_that_names_the_file(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        parsed(text)
    assert str(caught.value).startswith("mine.toml: ")
    assert "\n" not in str(caught.value)


def test_what_is_no_text_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not UTF-8"):
        parse_lesson("mine", WHOLE.encode("utf-16"), "mine.toml")
    marked = parse_lesson("mine", b"\xef\xbb\xbf" + WHOLE.replace("\n", "\r\n").encode(), "")
    assert marked.steps[0].key == "push"
    (tmp_path / "large.toml").write_bytes(b"#" * (LARGEST + 1))
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "folder.toml").mkdir()
    for name in ("large", "pipe", "folder", "gone"):
        with pytest.raises(InputError, match=f"{name}.toml: (larger|this is no file|no such file)"):
            read_lesson(tmp_path / f"{name}.toml")


def test_play_refuses_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(WHOLE.replace("piston", "pistn"), encoding="utf-8")
    assert main(["play", str(path)]) == 2
    err = capsys.readouterr().err
    assert re.fullmatch(r"error: .*mine\.toml: step push: until moved 'pistn'.*\n", err)
    path.write_text(WHOLE, encoding="utf-8")
    for words in (["--seed", "3"], ["--packing", "mixed"], ["--set", "friction=0.1"]):
        assert main(["play", str(path), *words]) == 2
        assert "a lesson brings its own" in capsys.readouterr().err
    assert main(["record", str(path), "--data", str(tmp_path / "x.csv")]) == 2
    assert "is a lesson: write play" in capsys.readouterr().err
    assert not (tmp_path / "x.csv").exists()


def test_a_folder_shows_its_lessons_and_what_is_meant_as_one(tmp_path: Path) -> None:
    (tmp_path / "good.toml").write_text(WHOLE, encoding="utf-8")
    (tmp_path / "broken.toml").write_text(HEAD, encoding="utf-8")
    (tmp_path / "other.toml").write_text('[project]\nname = "x"\n', encoding="utf-8")
    (tmp_path / "older.toml").write_text('format = "auxetic-sandbox scene"\n', encoding="utf-8")
    found = {here.path.stem: here.lesson is not None for here in classroom.lessons_here(tmp_path)}
    assert found == {"good": True, "broken": False}
    meant = [path.stem for path in sorted(tmp_path.iterdir()) if is_meant(path)]
    assert meant == ["broken", "good", "other"]


@pytest.mark.parametrize("name", registry.names())
def test_scenes_name_their_handles(name: str) -> None:
    scene = registry.get(name)
    settings = scene.settings()
    setup = scene.build(settings, scene.packings[0], 1)
    assert tuple(handle.body for handle in setup.handles) == scene.handle_names


def test_built_in_files_say_that_they_are_lessons() -> None:
    paths = [*tours.FOLDER.iterdir(), *classroom.FOLDER.glob("*.toml")]
    assert len(paths) >= 11
    assert all(is_lesson(path) for path in paths)


def test_a_text_falls_back_to_english() -> None:
    said = Said({"en": "grain", "de": "Korn"})
    with language.speaking("uk"):
        assert str(said) == "grain"
    assert str(Said()) == ""
