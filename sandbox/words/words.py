"""Every word that is drawn, in the present language.

``words.HINT`` is what the tables in sandbox/words have under ``[words] hint``, looked up when it is asked for: never
import a word by its name, the language can change at any moment. New words go into every table. Where the form of a word
hangs on a number the tables have all its forms, in the order of their ``plural``: ``{count} {count:minute|minutes} ago``.
"""

from __future__ import annotations

from sandbox.words import language
from sandbox.words.language import Section, decimal_sign, say

__all__ = [
    "BROKEN",
    "BUTTONS",
    "BUTTONS_HELP",
    "EVENTS",
    "FORCE_UNIT",
    "KINDS",
    "KINDS_SHORT",
    "LENGTH_UNIT",
    "MEASURES",
    "MEASURES_HELP",
    "OUTCOMES",
    "PACKINGS",
    "PERCENT",
    "SECTIONS",
    "STOPPED",
    "STRESS_UNIT",
    "THEMES",
    "TOOLS",
    "TOOLS_HELP",
    "TOPS",
    "VIEWS",
    "Section",
    "about",
    "decimal_sign",
    "first_sentence",
    "help_groups",
    "parameter_help",
    "parameter_name",
    "question",
    "say",
    "title",
    "unit",
]

# Signs, not words: the same in every language.
FORCE_UNIT = "k R"
STRESS_UNIT = "k"
LENGTH_UNIT = "R"
PERCENT = "%"

BROKEN = frozenset(
    {"not finite", "collapsed", "sunk"}
)  # ends of a relaxation that leave no picture to believe

BUTTONS = Section("buttons")
BUTTONS_HELP = Section("buttons_help")
EVENTS = Section("events")
KINDS = Section("kinds")
MEASURES = Section("measures")
MEASURES_HELP = Section("measures_help")
KINDS_SHORT = Section("kinds_short")
OUTCOMES = Section("outcomes")
PACKINGS = Section("packings")
SECTIONS = Section("sections")
STOPPED = Section("stopped")
THEMES = Section("themes")
TOOLS = Section("tools")
TOOLS_HELP = Section("tools_help")
TOPS = Section("tops")
VIEWS = Section("views")


def __getattr__(name: str) -> str:
    found = language.find("words", name.lower()) if name.isupper() else None
    if found is None:
        raise AttributeError(f"no language has a word {name}")
    return language.Word(found)


def title(scene: str, own: str = "") -> str:
    """The title of a scene, unless it has been given a title of its ``own`` that no table knows."""
    return own if own and own != _source(scene) else _of_scene(scene, "title", own)


def question(scene: str, own: str = "") -> str:
    """The question that a scene answers."""
    return _of_scene(scene, "question", own)


def about(scene: str, own: str = "") -> str:
    """A sentence or two about a scene."""
    return _of_scene(scene, "about", own)


def _source(scene: str) -> str:
    """The title of a scene in English, as the program has it too."""
    known = language.table(language.SOURCE)["scenes"].get(scene, {})
    return str(known.get("title", ""))


def _of_scene(scene: str, key: str, own: str) -> str:
    found = language.find("scenes", scene, key)
    return own if found is None else str(found)


def parameter_name(parameter: str) -> str:
    """A parameter's name in plain words."""
    found = language.find("parameters", parameter)
    return parameter.replace("_", " ") if found is None else str(found)


def parameter_help(scene: str, parameter: str, own: str = "") -> str:
    """One line about a parameter of a scene; ``own`` is for one that no table knows."""
    found = language.find("scenes", scene, "help", parameter)
    if found is None:
        found = language.find("parameter_help", parameter)
    return own if found is None else str(found)


def unit(unit: str) -> str:
    """A unit as it is written: signs stay, "deg" and "diameters" are words."""
    found = language.find("units", unit)
    return unit if found is None else str(found)


def first_sentence(text: str) -> str:
    """The beginning of a text, to its first full stop."""
    head, stop, _ = text.partition(". ")
    return f"{head}." if stop else text


def help_groups() -> list[tuple[str, list[tuple[str, str]]]]:
    """The help page: titles, each with its keys and what they do."""
    groups = language.find("help")
    return [(group["title"], [(key, does) for key, does in group["keys"]]) for group in groups]
