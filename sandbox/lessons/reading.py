"""Lessons as files: TOML that says all of it and runs nothing. What does not fit is one line of InputError.

The file names the scene, and for every step what is set up, what is asked, what a person is to do, and what explains it:
``README.md`` in this folder has the keys. It may come from anyone, so all of it is looked at before anything is shown.
"""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from core.errors import InputError
from core.files import is_special
from sandbox.files.archive import why_unread
from sandbox.lessons.lesson import (
    DEEDS,
    SECTIONS,
    WAYS,
    Condition,
    Kind,
    Lesson,
    Predict,
    Said,
    Step,
    Task,
)
from sandbox.lessons.taken import Taken, known, line_of, number_of, said_of
from sandbox.words.words import VIEWS
from scenes import registry
from scenes.parameter import LARGEST_SEED, shown
from scenes.remarks import Happening
from scenes.scene import Scene

FORMAT = "auxetic-sandbox lesson"
VERSION = 1
SUFFIX = ".toml"
LARGEST = 1 << 18  # bytes of a file
TITLE, LINE, CARD, LONG, PRINTED = 70, 110, 320, 500, 900  # letters of texts, at most
MOST_STEPS, MOST_OPTIONS, MOST_AIMS, MOST_TASKS = 40, 6, 12, 20
MOST_MINUTES, MOST_LINES, MOST_UNIT = 300, 20, 12
FARTHEST, LARGEST_NUMBER, MOST_COUNT = (
    1e4,
    1e9,
    100_000,
)  # of what conditions and answers may ask for
EVENTS = get_args(Happening)
_KEY = re.compile(r"[a-z][a-z0-9_]{0,39}")
_OLDER_SCENE = b"auxetic-sandbox scene"
_FORMAT_LINE = re.compile(
    rb"^[ \t]*format[ \t]*=[ \t]*[\"']auxetic-sandbox lesson[\"']", re.MULTILINE
)


def read_lesson(path: str | os.PathLike[str]) -> Lesson:
    """Read a lesson. Raises InputError for what is missing or malformed, one line that says what to do."""
    path = Path(path)
    return parse_lesson(path.stem, content_of(path), str(path))


def content_of(path: Path) -> bytes:
    """All of a file that is not too large for a lesson. Raises InputError."""
    try:
        if is_special(path) or not path.is_file():
            kind = "this is no file" if path.exists() else "no such file"
            raise InputError(f"{path}: {kind}")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{str(path)!r}: cannot be read ({error})") from None
    if len(content) > LARGEST:
        raise InputError(f"{path}: larger than {LARGEST // 1024} KiB; no lesson is")
    return content


def is_lesson(path: Path) -> bool:
    """Does a file say that it is a lesson?"""
    try:
        return path.suffix.lower() == SUFFIX and bool(_FORMAT_LINE.search(content_of(path)))
    except InputError:
        return False


def is_meant(path: Path) -> bool:
    """Is a file to be read as a lesson, and not as a scene of an older program, whose texts have the same suffix?"""
    if path.suffix.lower() != SUFFIX:
        return False
    try:
        return _OLDER_SCENE not in content_of(path)
    except InputError:
        return True


def parse_lesson(name: str, content: bytes, where: str) -> Lesson:
    """A lesson from the bytes of a file. Raises InputError as ``read_lesson`` does."""
    try:
        return _lesson(name, _table(content))
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _table(content: bytes) -> dict[str, Any]:
    try:
        return tomllib.loads(content.decode("utf-8-sig").replace("\r\n", "\n"))
    except UnicodeDecodeError as error:
        raise InputError(f"not UTF-8 text (byte {error.start}); save it as UTF-8") from None
    except RecursionError:
        raise InputError("tables within tables within tables; make it simpler") from None
    except ValueError as error:  # TOMLDecodeError, and numbers of too many digits
        raise InputError(f"no TOML: {why_unread(error)}") from None


def _lesson(name: str, table: Mapping[str, Any]) -> Lesson:
    top = Taken(table, "")
    if top.take("format", None) != FORMAT:
        raise InputError(f'not a lesson of this program; its first line is format = "{FORMAT}"')
    version = top.take("version")
    if isinstance(version, bool) or version != VERSION:
        raise InputError(
            f"version {shown(version)} of the format, this program reads {VERSION}; update the program"
        )
    scene = registry.get(top.one_of("scene", registry.names()))
    steps: list[Step] = []
    for number, data in enumerate(_list(top.take("step"), "step", MOST_STEPS), 1):
        running = next((s.scene or scene.name for s in reversed(steps) if s.packings), scene.name)
        steps.append(_step(Taken(data, f"step {number}"), scene.name, running))
    keys = [step.key for step in steps]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise InputError(f"two steps have the key {twice!r}; give each its own")
    if not steps[0].packings:
        raise InputError("step 1 packings is missing: the first step begins the scene")
    used = [
        registry.get(one)
        for one in dict.fromkeys([scene.name, *(s.scene for s in steps if s.scene)])
    ]
    lesson = Lesson(
        name=name,
        scene=scene.name,
        steps=tuple(steps),
        title=top.said("title", TITLE, optional=True),
        about=top.said("about", LINE, optional=True),
        minutes=top.whole("minutes", 1, MOST_MINUTES, 0),
        seed=top.whole("seed", 0, LARGEST_SEED, None),
        aims=top.each("aims", MOST_AIMS, lambda value, at: said_of(value, PRINTED, at)),
        prior=top.each("prior", MOST_AIMS, lambda value, at: said_of(value, PRINTED, at)),
        tasks=top.each("task", MOST_TASKS, _task),
        hide=_hidden(top, used),
    )
    top.end()
    return lesson


def _list(value: object, where: str, most: int) -> list[object]:
    if not isinstance(value, list) or not 1 <= len(value) <= most:
        raise InputError(f"{where} must be 1 to {most} tables, each headed [[{where}]]")
    return value


def _step(table: Taken, first: str, running: str) -> Step:
    """A step; ``running`` is the scene that goes on where it begins none, ``first`` the lesson's."""
    key = table.take("key")
    if not isinstance(key, str) or not _KEY.fullmatch(key):
        raise InputError(
            f"{table.at('key')} must be small letters, digits and _, such as push, not {shown(key)}"
        )
    table.where = f"step {key}:"
    packings = table.each("packings", 3, lambda value, at: line_of(value, LINE, at))
    named = table.one_of("scene", registry.names(), "")
    settings = table.take("settings", {})
    if (named or settings) and not packings:
        what = "scene" if named else "settings"
        raise InputError(f"{table.at(what)} needs packings: they begin the scene anew")
    scene = registry.get(named or (first if packings else running))
    for packing in packings:
        known(packing, scene.packings, table.at("packings"))
    if len(set(packings)) != len(packings):
        raise InputError(f"{table.at('packings')} names one twice; take it out")
    if not isinstance(settings, dict):
        raise InputError(f"{table.at('settings')} must be a table, not {shown(settings)}")
    try:
        scene.settings(settings)
    except InputError as error:
        raise InputError(f"{table.at('settings')}: {error}") from None
    until, predict = table.take("until", None), table.take("predict", None)
    step = Step(
        key=key,
        say=table.said("say", CARD),
        do=table.said("do", CARD, optional=until is None),
        why=table.said("why", LONG, optional=True),
        scene=named,
        packings=packings,
        settings=settings,
        view=table.one_of("view", list(VIEWS), ""),
        until=None if until is None else _condition(Taken(until, table.at("until")), scene),
        predict=None if predict is None else _predict(Taken(predict, table.at("predict"))),
        hide=_hidden(table, [scene]),
        minutes=table.whole("minutes", 1, MOST_MINUTES, 0),
    )
    if step.predict is not None and step.predict.kind == "sketch" and until is None:
        raise InputError(
            f"{table.at('until')} is missing: it says when what was sketched has been measured"
        )
    if step.do and until is None:
        raise InputError(
            f"{table.at('until')} is missing: it says when what is to be done has been done"
        )
    table.end()
    return step


def _condition(table: Taken, scene: Scene) -> Condition:
    c = Condition(
        moved=table.one_of("moved", scene.handle_names, ""),
        by=table.number("by", 1e-6, FARTHEST, 0.0),
        way=table.one_of("way", WAYS, ""),
        event=table.one_of("event", EVENTS, ""),
        or_event=table.one_of("or_event", EVENTS, ""),
        view=table.one_of("view", list(VIEWS), ""),
        setting=table.one_of("setting", [p.name for p in scene.parameters], ""),
        below=table.number("below", -LARGEST_NUMBER, LARGEST_NUMBER, math.inf),
        out=table.whole("out", 1, MOST_COUNT, 0),
        force=table.number("force", 1e-9, LARGEST_NUMBER, 0.0),
        grains=table.whole("grains", 1, MOST_COUNT, 0),
        walls=table.whole("walls", 1, MOST_COUNT, 0),
        increments=table.whole("increments", 1, MOST_COUNT, 0),
    )
    table.end()
    wants = (c.moved, c.event, c.view, c.setting, c.out, c.force, c.grains, c.walls, c.increments)
    if sum(bool(want) for want in wants) != 1:
        raise InputError(
            f"{table.where} must say one thing: moved, event, view, setting, out, force, grains, walls or increments"
        )
    for extra, of, there in (
        ("by", "moved", c.by > 0.0),
        ("way", "moved", bool(c.way)),
        ("or_event", "event", bool(c.or_event)),
        ("below", "setting", math.isfinite(c.below)),
    ):
        if there and not getattr(c, of):
            raise InputError(f"{table.at(extra)} goes with {of} alone; take it out")
    if c.moved and not c.by:
        raise InputError(f"{table.at('by')} is missing: how far {c.moved} is to move [R]")
    return c


def _predict(table: Taken) -> Predict:
    kind: Kind = table.one_of("kind", get_args(Kind))  # type: ignore[assignment]
    ask = table.said("ask", CARD)
    answer = table.said("answer", LONG, optional=True)
    options: tuple[Said, ...] = ()
    right: float | None = None
    within, unit, axes, names = 0.0, "", (0.0, 1.0, 0.0, 1.0), (Said(), Said())
    if kind == "choice":
        options = table.each(
            "options", MOST_OPTIONS, lambda value, at: said_of(value, LINE, at), least=2
        )
        number = table.whole("right", 1, len(options), None)
        right = None if number is None else number - 1.0
    elif kind == "number":
        right = table.number("right", -LARGEST_NUMBER, LARGEST_NUMBER, None)
        within = table.number("within", 0.0, LARGEST_NUMBER, 0.0)
        unit = table.text("unit", MOST_UNIT, "")
    else:
        axes = (*_range(table, "along"), *_range(table, "up"))
        names = (
            table.said("along_name", TITLE, optional=True),
            table.said("up_name", TITLE, optional=True),
        )
    table.end("; what belongs to the step stands above [step.predict]")
    return Predict(kind, ask, options, right, within, unit, axes, answer=answer, names=names)


def _range(table: Taken, key: str) -> tuple[float, float]:
    """Two numbers, the lower one first."""
    at = table.at(key)
    low, *rest = table.each(
        key,
        2,
        lambda value, where: number_of(value, -LARGEST_NUMBER, LARGEST_NUMBER, where),
        least=2,
    )
    if not low < rest[0]:
        raise InputError(f"{at} must be two numbers, the lower one first, such as [0, 2]")
    return low, rest[0]


def _task(value: object, where: str) -> Task:
    table = Taken(value, where)
    task = Task(
        text=table.said("text", PRINTED),
        answer=table.said("answer", PRINTED),
        lines=table.whole("lines", 0, MOST_LINES, 4),
    )
    table.end()
    return task


def _hidden(table: Taken, scenes: list[Scene]) -> frozenset[str]:
    names = [
        *DEEDS,
        *SECTIONS,
        *dict.fromkeys(p.name for scene in scenes for p in scene.parameters),
    ]
    return frozenset(table.each("hide", len(names), lambda value, at: known(value, names, at)))
