"""Every word stands in every table, with the same placeholders, and what the program says is found there."""

from __future__ import annotations

import ast
import re
import string
from collections.abc import Iterator
from copy import copy
from pathlib import Path
from typing import Any

import pytest

from core.errors import InputError
from sandbox.draw.numbers import number, percent
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.words import language, words
from scenes import registry
from scenes.parameter import Parameter
from scenes.scene import Scene
from scenes.text import Text, filled, message

REPOSITORY = Path(__file__).parents[2]
SOURCES = [
    path for part in ("core", "scenes", "sandbox") for path in (REPOSITORY / part).rglob("*.py")
]
TREES = {path: ast.parse(path.read_text(encoding="utf-8")) for path in SOURCES}
OTHERS = [code for code in language.available() if code != language.SOURCE]
# Which form goes with which number, by the examples of CLDR.
COUNTS = (1, 2, 5, 11, 21, 22, 111)
CLDR = {"en": (0, 1, 1, 1, 1, 1, 1), "de": (0, 1, 1, 1, 1, 1, 1), "uk": (0, 1, 2, 2, 0, 1, 2)}
FORMS = re.compile(r"\{(\w+):([^{}]*\|[^{}]*)\}")


@pytest.fixture(autouse=True)
def english_again() -> Iterator[None]:
    yield
    language.use(language.SOURCE)


def leaves(table: Any, at: str = "") -> Iterator[tuple[str, str]]:
    """Every text in a table and where it stands."""
    if isinstance(table, str):
        yield at, table
        return
    items = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in items:
        yield from leaves(value, f"{at}.{key}")


def words_of(code: str) -> dict[str, str]:
    """All texts of a language by where they stand, but what is said of the language itself alone."""
    return dict(leaves({**language.table(code), "as_in_english": ""}))


def placeholders(text: str) -> set[tuple[str, str | None]]:
    text = FORMS.sub("", text)
    return {(name, spec) for _, name, spec, _ in string.Formatter().parse(text) if name is not None}


def counted(text: str) -> set[str]:
    """What is counted in a text by words that have forms."""
    return {name for name, _ in FORMS.findall(text)}


def with_form(text: str, form: int) -> str:
    """A text with one of the forms of each word."""
    return FORMS.sub(lambda found: found[2].split("|")[form], text)


def test_english_comes_first() -> None:
    assert language.available()[0] == language.SOURCE
    assert set(CLDR) <= set(language.available())


@pytest.mark.parametrize("code", OTHERS)
def test_every_table_says_the_same_things(code: str) -> None:
    source, other = words_of(language.SOURCE), words_of(code)
    missing, odd = sorted(source.keys() - other.keys()), sorted(other.keys() - source.keys())
    assert not missing, f"sandbox/words/{code}.toml has no {', '.join(missing)}"
    assert not odd, f"sandbox/words/{code}.toml has, and en.toml has not: {', '.join(odd)}"
    for key, text in source.items():
        assert other[key].strip() or not text, key
        assert placeholders(other[key]) == placeholders(text), key
        assert ("[" in other[key]) == ("[" in text), key
        assert counted(text) <= counted(other[key]), key


def test_english_counts_with_forms() -> None:
    """A number of things, without forms, would be wrong of one thing."""
    texts = words_of(language.SOURCE).values()
    counts = "|".join({"count"}.union(*map(counted, texts)))
    wrong = re.compile(rf"\{{({counts})\}} [a-z]+s\b")
    assert [text for text in texts if wrong.search(text)] == []


@pytest.mark.parametrize("code", CLDR)
def test_which_form_goes_with_which_number(code: str) -> None:
    assert tuple(map(language.plural(code), COUNTS)) == CLDR[code]


@pytest.mark.parametrize("code", language.available())
def test_every_word_with_a_number_has_the_form_that_goes_with_it(code: str) -> None:
    """Whether a text is asked for by name or said by a scene."""
    language.use(code)
    rule, source = language.plural(code), words_of(language.SOURCE)
    all_forms = 1 + max(map(rule, range(200)))
    for key, text in words_of(code).items():
        for _, forms in FORMS.findall(text):
            assert forms.count("|") + 1 == all_forms, key
        names = counted(text) | {name for name, _ in placeholders(text)}
        for count in COUNTS if counted(text) else ():
            values = dict.fromkeys(names, count)
            expected = filled(with_form(text, rule(count)), values, language.decimal_sign())
            assert language.Word(text).format(**values) == expected
            if key.startswith(".texts."):
                assert words.say(Text(source[key], **values)) == expected


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("en", "1 minute ago, 2 minutes ago, 21 minutes ago, 111 minutes ago"),
        ("de", "vor 1 Minute, vor 2 Minuten, vor 21 Minuten, vor 111 Minuten"),
        ("uk", "1 хвилину тому, 2 хвилини тому, 21 хвилину тому, 111 хвилин тому"),
    ],
)
def test_minutes(code: str, said: str) -> None:
    language.use(code)
    assert ", ".join(words.AGO_MINUTES.format(count=count) for count in (1, 2, 21, 111)) == said
    of_two = words.AGO_MINUTES.format(count=2).replace("2", "1–2")
    assert words.AGO_MINUTES.format(count="1–2") == of_two


@pytest.mark.parametrize("code", OTHERS)
def test_nothing_was_forgotten(code: str) -> None:
    """A text that is the same in both languages is a name, a sign, or a word that both have."""
    source, other = words_of(language.SOURCE), words_of(code)
    alike = {re.sub(r"\{.*?\}", "", text) for key, text in source.items() if other[key] == text}
    both_have = set(language.table(code)["as_in_english"])
    assert {text for text in alike if re.search("[A-Za-z]{4}", text)} == both_have


def test_every_word_that_is_asked_for_is_there_and_none_is_left_over() -> None:
    asked = set()
    for tree in TREES.values():
        for node in ast.walk(tree):
            match node:
                case ast.Attribute(ast.Name("words"), attr) if attr.isupper():
                    asked.add(attr)
    there = {name.upper() for name in language.table(language.SOURCE)["words"]}
    assert asked - set(vars(words)) == there


def constants(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_texts_in_the_tables_are_what_the_program_says() -> None:
    said = {text for tree in TREES.values() for text in constants(tree)}
    texts = set(language.table(language.SOURCE)["texts"].values())
    assert texts <= said


def test_texts_of_scenes_are_in_the_tables() -> None:
    """Templates, labels of handles and of axes."""
    texts = set(language.table(language.SOURCE)["texts"].values())
    wanted = {"Text": 1, "Handle": 2, "Curve": 2}
    for path, tree in TREES.items():
        for node in ast.walk(tree):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
                continue
            if node.func.id not in wanted or (node.func.id == "Curve" and "draw" in path.parts):
                continue
            for argument in node.args[: wanted[node.func.id]]:
                if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                    name = node.func.id == "Handle" and argument is node.args[0]
                    assert name or argument.value in texts, f"{path}: {argument.value!r}"


def test_no_word_is_taken_at_import() -> None:
    """The language can change at any moment."""
    for path, tree in TREES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module == "sandbox.words.words":
                names = [alias.name for alias in node.names]
                assert all(name in vars(words) for name in names), f"{path}: {names}"
            if isinstance(node, ast.FunctionDef):
                for default in [*node.args.defaults, *node.args.kw_defaults]:
                    for part in ast.walk(default) if default is not None else ():
                        taken = isinstance(part, ast.Attribute) and part.attr.isupper()
                        base = getattr(part, "value", None)
                        assert not (taken and isinstance(base, ast.Name) and base.id == "words"), (
                            f"{path}: default of {node.name}"
                        )


def not_as_in_english(scene: Scene) -> list[str]:
    """What the English table lacks of a scene, or says otherwise: the key, its table, and what is to be there."""
    name, english = scene.name, language.table(language.SOURCE)
    said = english["scenes"].get(name, {})
    wrong = [
        f"{key} in [scenes.{name}]: {getattr(scene, key)!r}"
        for key in ("title", "question", "about")
        if said.get(key) != getattr(scene, key)
    ]
    for parameter in scene.parameters:
        if parameter.name not in english["parameters"]:
            wrong.append(f"{parameter.name} in [parameters]: its name in plain words")
        if words.parameter_help(name, parameter.name) != parameter.help:
            wrong.append(f"{parameter.name} in [parameter_help]: {parameter.help!r}")
        if re.fullmatch("[a-z]{3,}", parameter.unit) and parameter.unit not in english["units"]:
            wrong.append(f"{parameter.unit} in [units]: {parameter.unit!r}")
    return wrong


@pytest.mark.parametrize("name", registry.names())
def test_scenes_and_their_parameters_are_in_the_tables(name: str) -> None:
    wrong = not_as_in_english(registry.get(name))
    assert not wrong, "sandbox/words/en.toml has not, or otherwise: " + "; ".join(wrong)


def test_words_that_a_new_scene_lacks_are_named_with_their_tables() -> None:
    my_row = copy(registry.get("grain_row"))
    push = Parameter("my_push", 1.0, "furlong", 0.0, 2.0, "how far it is pushed")
    for key, value in {"name": "my_row", "title": "My row", "parameters": (push,)}.items():
        setattr(my_row, key, value)
    wrong = not_as_in_english(my_row)
    assert [line.partition(":")[0] for line in wrong] == [
        "title in [scenes.my_row]",
        "question in [scenes.my_row]",
        "about in [scenes.my_row]",
        "my_push in [parameters]",
        "my_push in [parameter_help]",
        "furlong in [units]",
    ]


def test_no_scene_or_parameter_in_the_tables_is_gone() -> None:
    english = language.table(language.SOURCE)
    parameters = {p.name for name in registry.names() for p in registry.get(name).parameters}
    gone = set(english["scenes"]) - set(registry.names())
    assert not gone, f"[scenes.*] of scenes that are gone: {gone}"
    gone = set(english["parameters"]) | set(english["parameter_help"])
    assert not gone - parameters, f"[parameters], [parameter_help]: {gone - parameters} are gone"


def test_words_are_looked_up_in_the_present_language() -> None:
    assert words.PAUSED == "paused"
    language.use("de")
    assert words.PAUSED == "angehalten"
    assert words.PACKINGS["mixed"] == "gemischt"
    assert words.PACKINGS.get("unknown", "unknown") == "unknown"
    assert next(iter(words.VIEWS)) == "kind"
    assert words.title("hopper", "Hopper") == "Trichter"
    assert words.title("hopper", "My own hopper") == "My own hopper"
    assert words.title("unknown") == ""
    assert words.parameter_name("not_in_any_table") == "not in any table"
    with pytest.raises(AttributeError, match="NO_SUCH_WORD"):
        words.NO_SUCH_WORD  # noqa: B018


def test_texts_are_said_in_the_present_language() -> None:
    inner = Text("clogged: {diameters:.1f} diameters of stroke, no grain came out", diameters=1.44)
    outer = Text(
        "{clogged}, held by an arch of {grains} {grains:grain|grains}", clogged=inner, grains=7
    )
    plain = "clogged: 1.4 diameters of stroke, no grain came out, held by an arch of 7 grains"
    assert outer == plain
    assert words.say(outer) == plain
    language.use("de")
    assert words.say(outer) == (
        "verstopft: 1,4 Durchmesser Weg, kein Korn kam heraus, gehalten von einem Bogen aus 7 Körnern"
    )
    assert words.say("stroke [R]") == "Weg [R]"
    assert words.say("nobody translated this") == "nobody translated this"
    assert words.say(Text("{count} of them", count=-2.5)) == "−2,5 of them"
    language.use("uk")
    assert words.say(Text("{n} {n:knot|knots} nobody translated", n=21)).startswith("21 knots")
    language.use("de")
    label = Text("force on the {label} [k R]", label="piston")
    assert words.say(label) == "Kraft: Kolben [k R]"


def test_numbers_are_written_as_the_language_does() -> None:
    assert (number(-1.25, 2), percent(0.004)) == ("−1.25", "0.5 %")
    language.use("de")
    assert (number(-1.25, 2), percent(0.004)) == ("−1,25", "0,5 %")


def test_an_error_keeps_its_text() -> None:
    text = Text("{label}: end of travel", label="piston")
    assert message(InputError(text)) is text
    assert message(ValueError()) == ""
    assert message(OSError(2, "no such file")) == "[Errno 2] no such file"


@pytest.mark.parametrize(
    ("variables", "code"),
    [
        ({"LANG": "de_DE.UTF-8"}, "de"),
        ({"LANG": "de_AT"}, "de"),
        ({"LANG": "de_DE", "LC_ALL": "en_GB.UTF-8"}, "en"),
        ({"LANG": "fr_FR.UTF-8"}, "en"),
        ({"LANG": "German_Germany.1252"}, "de"),
        ({"LANG": "uk_UA.UTF-8"}, "uk"),
        ({"LANG": "Ukrainian_Ukraine.1251"}, "uk"),
        ({"LANG": "English_United States.1252"}, "en"),
        ({"LANG": "C"}, "en"),
    ],
    ids=str,
)
def test_language_of_the_environment(
    variables: dict[str, str], code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert language.of_environment() == code


def test_unknown_language_is_a_plain_mistake() -> None:
    with pytest.raises(InputError, match=f"choose {', '.join(language.available())}"):
        language.use("tlh")
    assert language.after(language.available()[-1]) == language.SOURCE


@pytest.mark.parametrize("name", registry.names())
def test_what_a_running_scene_says_is_translated(name: str) -> None:
    """Labels, notices and events of the first increments."""
    settings: dict[str, object] = {"friction": 0.0} if name == "hopper" else {}
    session = Session(name, "mixed", 1, settings)
    session.build()
    session.submit(Protocol(True))
    for _ in range(12):
        while not session.advance(2000) and not session.idle:
            pass
    frame = session.frame()
    said = [frame.curve_label, frame.stroke_label, *frame.notices]
    said += session.table.header()
    said += [handle.label for handle in frame.handles] + [event.text for event in frame.events]
    for code in OTHERS:
        language.use(code)
        untranslated = [text for text in said if words.say(text) == text]
        assert untranslated == []
        assert words.title(frame.scene, frame.title) != frame.title
