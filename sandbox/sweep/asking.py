"""From words to the request of a sweep: axes, seeds, packings, endings as they are typed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal

from core.errors import InputError, did_you_mean
from sandbox.sweep.request import ENDINGS, MOST_CELLS, Axis, Request, axis_of, check, parsed
from scenes import registry
from scenes.parameter import LARGEST_SEED, shown
from scenes.scene import Scene


def ask(
    scene: str,
    vary: Sequence[str],
    packings: str | None,
    seeds: str,
    settings: Mapping[str, object],
    until: str | None = None,
    steps: int | None = None,
) -> Request:
    """The request that such words make, checked. Raises InputError."""
    known = registry.get(scene)
    axes = tuple(axis(text, known) for text in vary)
    names = [each.name for each in axes]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"--vary: {name} is varied twice")
    request = Request(
        known.name,
        axes,
        _kinds(packings, known),
        seed_range(seeds),
        tuple((name, parsed(known, name, value)) for name, value in settings.items()),
        None if until is None else _endings(until),
        steps,
    )
    check(request)
    return request


def axis(text: str, scene: Scene) -> Axis:
    """``NAME=A:B:STEP``, both ends included, or ``NAME=v1,v2,…``. Raises InputError."""
    name, equals, given = (part.strip() for part in text.partition("="))
    if not (name and equals and given):
        raise InputError(f"--vary {text}: write NAME=A:B:STEP or NAME=v1,v2,…")
    found = axis_of(scene, name, _span(text, given) if ":" in given else given.split(","))
    if len(set(found.values)) < len(found.values):
        raise InputError(f"--vary {text}: a value comes twice")
    return found


def _span(text: str, given: str) -> list[str]:
    """From A to B, both included, by STEP: in decimals as they are written, so that 0:1:0.1 ends with 1."""
    try:
        first, last, step = (Decimal(part.strip()) for part in given.split(":"))
        length = (last - first) / step
        many = length >= MOST_CELLS
    except (ValueError, ArithmeticError):
        raise InputError(f"--vary {text}: write A:B:STEP, three numbers, STEP not 0") from None
    if length < 0:
        raise InputError(f"--vary {text}: the range is empty, as STEP leads away from B")
    if many:
        raise InputError(f"--vary {text}: too many values: use {MOST_CELLS:,} at most")
    return [str(first + k * step) for k in range(int(length) + 1)]


def seed_range(text: str) -> tuple[int, int]:
    """``N``: seeds 1 to N; ``A:B``: from A to B, both included. Raises InputError."""
    words = text.split(":")
    try:
        numbers = [int(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 2):
        raise InputError(f"--seeds {shown(text)}: write how many, or FIRST:LAST")
    first, last = numbers if len(numbers) == 2 else (1, numbers[0])
    if not 0 <= first <= last <= LARGEST_SEED:
        raise InputError(f"--seeds {text}: the range is empty, or not within 0 and 2^63 - 1")
    return first, last


def _kinds(text: str | None, scene: Scene) -> tuple[str, ...]:
    if text is None:
        return ("mixed" if "mixed" in scene.packings else scene.packings[0],)
    kinds = tuple(scene.check_packing(word.strip()) for word in text.split(","))
    if len(set(kinds)) < len(kinds):
        raise InputError(f"--packing {text}: a packing comes twice")
    return kinds


def _endings(text: str) -> tuple[str, ...]:
    words = tuple(dict.fromkeys(word.strip() for word in text.split(",")))
    for word in words:
        if word not in ENDINGS:
            raise InputError(
                f"--until {shown(word)}: use {', '.join(ENDINGS)}{did_you_mean(word, ENDINGS)}"
            )
    return words
