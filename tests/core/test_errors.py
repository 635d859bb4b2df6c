"""What a person probably meant: a guess that helps, or none."""

from __future__ import annotations

import pytest

from core.errors import did_you_mean, nearest
from scenes import registry

SCENES = tuple(registry.names())
PARAMETERS = {name: tuple(p.name for p in registry.get(name).parameters) for name in SCENES}
VIEWS = ("kind", "skin", "pressure", "shape", "area", "motion", "chains", "fringes")


@pytest.mark.parametrize(
    ("word", "choices", "meant"),
    [
        # Letters that are missing, doubled, swapped, or in capitals.
        ("hoper", SCENES, "hopper"),
        ("Hoppper", SCENES, "hopper"),
        ("single_grian", SCENES, "single_grain"),
        ("orfice", PARAMETERS["hopper"], "orifice"),
        ("presure", VIEWS, "pressure"),
        ("drak", ("dark", "light"), "dark"),
        ("auxtic", ("regular", "auxetic", "mixed"), "auxetic"),
        ("--output", ("--out", "--data", "--view"), "--out"),
        # A name in part, where only one has it.
        ("ellipses", SCENES, "two_ellipses"),
        ("strength", PARAMETERS["hopper"], "hand_strength"),
        ("radius", PARAMETERS["intruder"], "intruder_radius"),
        ("iterations", PARAMETERS["hopper"], "max_iterations"),
        # Other words, whatever letters they share with a name.
        ("gravity", PARAMETERS["grain_row"], None),
        ("gravity", PARAMETERS["hopper"], None),
        ("weight", PARAMETERS["hopper"], None),
        ("colour", PARAMETERS["hopper"], None),
        ("temperature", PARAMETERS["hopper"], None),
        ("bridge", SCENES, None),
        ("trampoline", SCENES, None),
        ("steel", ("regular", "auxetic", "mixed"), None),
        ("size", PARAMETERS["hopper"], None),  # two names have it
        ("", SCENES, None),
    ],
)
def test_a_guess_is_near_or_none(word: str, choices: tuple[str, ...], meant: str | None) -> None:
    assert nearest(word, choices) == meant
    assert did_you_mean(word, choices) == (f" (did you mean {meant}?)" if meant else "")


@pytest.mark.parametrize("choices", [SCENES, VIEWS, *PARAMETERS.values()])
def test_every_name_is_guessed_with_a_letter_missing_or_doubled(choices: tuple[str, ...]) -> None:
    for name in choices:
        for k in range(1, len(name)):
            for slip in (name[:k] + name[k + 1 :], name[:k] + name[k - 1 :]):
                if len(slip) > 3 and slip not in choices:
                    assert nearest(slip, choices) == name
