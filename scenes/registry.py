"""All scenes by name. To add one, write its file, which has its name and puts ``@register`` on it, and name it in ``_NAMES``.

A scene's file is read when the scene is asked for, and no other scene's.
"""

from __future__ import annotations

import importlib
from typing import TypeVar

from core.errors import InputError, nearest
from scenes.scene import Scene

_NAMES = (
    "single_grain",
    "two_ellipses",
    "grain_row",
    "biaxial_press",
    "biaxial_periodic",
    "couette",
    "avalanches",
    "intruder",
    "hopper",
    "gravity_hopper",
    "workshop",
)
_SCENES: dict[str, Scene] = {}
_S = TypeVar("_S", bound=type[Scene])


def register(scene: _S) -> _S:
    """Class decorator. Raises ValueError if the name is taken."""
    if scene.name in _SCENES:
        raise ValueError(f"two scenes are called {scene.name!r}")
    _SCENES[scene.name] = scene()
    return scene


def names() -> list[str]:
    """Names of all scenes, in the order of the menu."""
    return list(_NAMES)


def get(name: str) -> Scene:
    """The scene of that name. Raises InputError with the closest match."""
    if name not in _NAMES:
        close = nearest(name, _NAMES)
        hint = f"did you mean {close}?" if close else f"there are: {', '.join(_NAMES)}"
        raise InputError(f"no scene is called {name!r}; {hint}")
    importlib.import_module(f"scenes.{name}")
    return _SCENES[name]
