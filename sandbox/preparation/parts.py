"""Compile kernels before somebody waits for them. They come in parts, each compiled once and kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict

from core import kernel_cache, warmup
from core.errors import InputError
from sandbox.draw import warmup as drawing
from sandbox.draw.warmup import DRAWING
from scenes import registry
from scenes.scene import Ingredients, Scene


def _silent(part: str, seconds: float) -> None:
    """Nobody asks."""


def of_scene(scene: Scene) -> list[str]:
    """What a scene may need, with and without friction, drawing apart."""
    found: dict[str, None] = {}
    for terms in ingredients_of(scene):
        found[warmup.packing_part(periodic=terms.periodic, rigid=terms.rigid)] = None
        found[warmup.increments_part(**asdict(terms))] = None
    return list(found)


def ingredients_of(scene: Scene) -> list[Ingredients]:
    """What a scene may have to be made of: as it is by default, and with the friction that it may have."""
    found: dict[Ingredients, None] = {}
    for values in ({}, {"friction": 0.0}, {"friction": 0.5}):
        with suppress(InputError):  # it has no such parameter
            found[scene.ingredients(scene.settings(values))] = None
    return list(found)


def of_scenes(scenes: Sequence[str]) -> list[str]:
    """What these scenes may need, drawing first: every picture waits for it."""
    found = dict.fromkeys([DRAWING])
    for name in scenes:
        found.update(dict.fromkeys(of_scene(registry.get(name))))
    return list(found)


def missing(wanted: Sequence[str]) -> list[str]:
    """Those that are not kept yet."""
    return [part for part in wanted if not _kept(part)]


def require_room(wanted: Sequence[str]) -> None:
    """Raise InputError if what is compiled of them could not be kept; where there is nothing to compile it need not be."""
    for folder in (kernel_cache.CORE, drawing.FOLDER) if wanted else ():
        where = kernel_cache.place(folder)
        if why := kernel_cache.trouble(where):
            raise InputError(
                f"compiled code cannot be kept in {where.parent} ({why}), so that nothing would be gained: make that folder "
                "writable, or name another in the variable NUMBA_CACHE_DIR, then and when the window is opened"
            )


def carry_out(wanted: Sequence[str], tell: Callable[[str, float], None] = _silent) -> None:
    """Compile them, or load them from where they are kept; ``tell(part, seconds)`` is called after each."""
    for part in wanted:
        began = time.perf_counter()
        if part == DRAWING:
            drawing.compile_kernels()
        else:
            warmup.compile_part(part)
        tell(part, time.perf_counter() - began)


def _kept(part: str) -> bool:
    return not drawing.missing() if part == DRAWING else warmup.compiled(kernel_cache.CORE, part)
