"""The present language. One table a language in sandbox/words holds every word that is drawn; the English one decides what
there is to be said."""

from __future__ import annotations

import gettext
import locale
import os
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from core.errors import InputError
from scenes.text import Plural, Text, filled

FOLDER = Path(__file__).parent
SOURCE = "en"


class _Present:
    """Which language is spoken now. Only the thread that draws changes it or asks for it."""

    code = SOURCE


def available() -> tuple[str, ...]:
    """Codes of all languages, English first."""
    codes = sorted(path.stem for path in FOLDER.glob("*.toml"))
    return (SOURCE, *(code for code in codes if code != SOURCE))


def present() -> str:
    """Code of the language that is spoken now."""
    return _Present.code


def use(code: str) -> None:
    """Speak that language from now on. Raises InputError for an unknown one."""
    if code not in available():
        raise InputError(f"unknown language {code!r}: choose {', '.join(available())}")
    _Present.code = code


@contextmanager
def speaking(code: str) -> Iterator[None]:
    """Speak that language for a while. Raises InputError for an unknown one."""
    before = present()
    use(code)
    try:
        yield
    finally:
        use(before)


def in_each(saying: Callable[[], str]) -> tuple[str, ...]:
    """What ``saying`` says in every language, in the order of ``available``."""
    said = []
    for code in available():
        with speaking(code):
            said.append(saying())
    return tuple(said)


def after(code: str) -> str:
    """The next language; after the last the first."""
    codes = available()
    return codes[(codes.index(code) + 1) % len(codes)]


def of_environment() -> str:
    """The language of the person at this computer, as far as there is a table of it; English otherwise."""
    variables = ("LC_ALL", "LC_MESSAGES", "LANG")
    said = next((os.environ[name] for name in variables if os.environ.get(name)), "")
    spoken = re.split(r"[_.@-]", (said or locale.getlocale()[0] or "").lower())[0]
    # Windows writes German_Germany where others write de_DE.
    known = (code for code in available() if spoken in (code, table(code)["in_english"].lower()))
    return next(known, SOURCE)


@cache
def table(code: str) -> dict[str, Any]:
    """All words of a language, as its file has them."""
    with (FOLDER / f"{code}.toml").open("rb") as file:
        return tomllib.load(file)


def find(*keys: str) -> Any:
    """What the present language has under these keys, or else English; None if neither has anything."""
    for code in dict.fromkeys((present(), SOURCE)):
        found: Any = table(code)
        for key in keys:
            found = found.get(key) if isinstance(found, dict) else None
        if found is not None:
            return found
    return None


def decimal_sign() -> str:
    """What stands before the decimals of a number."""
    return str(find("decimal"))


@cache
def plural(code: str) -> Plural:
    """Which form a word has after a number, by the rule in the table of a language, which is written as gettext has it."""
    return gettext.c2py(table(code)["plural"])


class Word(str):
    """A text of the tables. ``format`` writes numbers, and the words that go with them, as the present language does."""

    def format(self, *_: object, **values: object) -> str:
        """The text with its values."""
        return filled(self, values, decimal_sign(), plural(present()))


def say(text: str) -> str:
    """What a scene or the solver says, in the present language; as it is, if nobody has translated it."""
    template = text.template if isinstance(text, Text) else text
    key = _texts().get(template)
    if key is not None:
        template = find("texts", key)
    if not isinstance(text, Text):
        return template
    values = {
        name: say(value) if isinstance(value, str) else value for name, value in text.values.items()
    }
    forms = plural(present() if key is not None else SOURCE)
    return filled(template, values, decimal_sign(), forms)


@cache
def _texts() -> dict[str, str]:
    """English texts of scenes and solver, and the keys they have in the tables."""
    return {text: key for key, text in table(SOURCE)["texts"].items()}


class Section(Mapping[str, str]):
    """Words that belong together, always in the present language."""

    def __init__(self, *keys: str) -> None:
        self._keys = keys

    def _source(self) -> dict[str, str]:
        found: Any = table(SOURCE)
        for key in self._keys:
            found = found[key]
        return dict(found)

    def __getitem__(self, key: str) -> str:
        found = find(*self._keys, key)
        if found is None:
            raise KeyError(key)
        return Word(found)

    def __iter__(self) -> Iterator[str]:
        return iter(self._source())

    def __len__(self) -> int:
        return len(self._source())
