"""All scenes by name. A scene registers itself with ``@register``; to add one, write its file and name it in ``_MODULES``."""

from __future__ import annotations

import importlib
from typing import TypeVar

from core.errors import InputError, nearest
from scenes.scene import Scene

_MODULES = (
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
    _load()
    return list(_SCENES)


def get(name: str) -> Scene:
    """The scene of that name. Raises InputError with the closest match."""
    _load()
    if name not in _SCENES:
        close = nearest(name, _SCENES)
        hint = f"did you mean {close}?" if close else f"there are: {', '.join(_SCENES)}"
        raise InputError(f"no scene is called {name!r}; {hint}")
    return _SCENES[name]


def _load() -> None:
    for module in _MODULES:
        importlib.import_module(f"scenes.{module}")
