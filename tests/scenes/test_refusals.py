"""What does not go together is refused with the number that would do."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from functools import cache

import pytest

from core.errors import InputError
from scenes import registry
from scenes.text import Text, message

MOST = 30  # of a kind
# Which end of which parameters a value in a refusal speaks of.
SPOKEN_OF: dict[str, dict[str, tuple[str, ...]]] = {
    "too few grains to fill": {"least": ("grains",)},
    "too few grains of these sizes": {"least": ("grains",)},
    "the intruder does not fit": {"least": ("grains",)},
    "the orifice is wider": {"most": ("orifice",), "least": ("width",)},
    "the disc does not fit": {"most": ("intruder_radius",), "least": ("width", "height")},
    "so many grains": {"most": ("grains",)},
    "contacts would be stiffer": {"least": ("softness",)},
}
OTHERS = ("give stiffness_ratio or", "give softness or", "step must be at most")
# Further ones, that no two extremes come to.
MORE: tuple[tuple[str, Mapping[str, float]], ...] = (
    ("hopper", {"grains": 40, "width": 23.7, "angle": 51.3, "packing_fraction": 0.83}),
    ("gravity_hopper", {"orifice": 4.3, "width": 8.9, "angle": 12.0, "grains": 900}),
    ("couette", {"grains": 437, "size_ratio": 3.7, "small_fraction": 0.93}),
    ("intruder", {"intruder_radius": 7.7, "packing_fraction": 0.81, "size_width": 0.37}),
    ("hopper", {"softness": 0.02, "stiffness_ratio": 0.02}),
)


def refusal(scene: str, settings: Mapping[str, object]) -> Text | None:
    try:
        registry.get(scene).settings(settings)
    except InputError as error:
        said = message(error)
        return said if isinstance(said, Text) else Text(said)
    return None


def extremes(scene: str) -> list[dict[str, float]]:
    """All settings with one or two parameters at an end of their ranges."""
    ends = [
        (p.name, value)
        for p in registry.get(scene).parameters
        if p.kind != "switch"
        for value in (p.low, p.high)
    ]
    pairs = itertools.combinations(ends, 2)
    return [{name: value} for name, value in ends] + [
        dict(pair) for pair in pairs if pair[0][0] != pair[1][0]
    ]


@cache
def refused() -> list[tuple[str, Mapping[str, float], Text]]:
    """Scenes, settings, and what is said."""
    cases = [(name, each) for name in registry.names() for each in extremes(name)]
    said = [(name, settings, refusal(name, settings)) for name, settings in (*MORE, *cases)]
    return [(name, settings, text) for name, settings, text in said if text is not None]


def kind_of(text: str) -> str:
    (kind,) = [kind for kind in (*SPOKEN_OF, *OTHERS) if text.startswith(kind)]
    return kind


def test_every_refusal_is_known() -> None:
    assert {kind_of(said) for _, _, said in refused()} >= set(SPOKEN_OF)


@pytest.mark.parametrize("kind", SPOKEN_OF)
def test_the_number_that_is_named_is_the_right_one(kind: str) -> None:
    """With it the same refusal is gone, and a hair beyond it is not."""
    some = [(name, settings, said) for name, settings, said in refused() if kind_of(said) == kind]
    for scene, settings, said in some[:MOST]:
        allowed = {p.name: p for p in registry.get(scene).parameters}
        for end, names in SPOKEN_OF[kind].items():
            value = said.values[end]
            assert isinstance(value, (int, float))
            hair = 1 if isinstance(value, int) else 0.02 * value
            beyond = value - hair if end == "least" else value + hair
            for trial, wrong in ((value, False), (beyond, True)):
                if all(allowed[name].low <= trial <= allowed[name].high for name in names):
                    again = refusal(scene, {**settings, **dict.fromkeys(names, trial)})
                    assert (again is not None and again.startswith(kind)) == wrong, (again, trial)
