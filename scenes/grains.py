"""Which grains a scene packs: sizes, material, and the material in the words of Haver et al., doi:10.1073/pnas.2317915121.

A grain is made of ν and C (core/MODEL.md, section 3) or, which is the same, of the paper's λ and μ: ``stiffness_ratio`` takes
the place of both Poisson's ratios, ``softness`` that of ``contact_stiffness``. Each is left out where it is 0; who gives both,
what is replaced and what replaces it, is told so.
"""

from __future__ import annotations

from collections.abc import Mapping

from core.errors import InputError
from core.friction import Friction
from core.generate import SIZE_RATIO, Recipe
from core.material import (
    DEFAULT_CONTACT_STIFFNESS,
    DEFAULT_POISSON_RATIO,
    contact_stiffness_of,
    from_paper,
)
from scenes.parameter import Parameter, Value, round_up
from scenes.text import Text

KINDS_OF_GRAINS = ("regular", "auxetic")
MOST_STIFFNESS = 2000.0  # [k]
LEAST_RATIO = 0.01
# Large grains have the radius R. Unlike material, sizes are set when the grains are packed.
SIZES = (
    Parameter(
        "size_ratio",
        SIZE_RATIO,
        "",
        1.0,
        10.0,
        "radius of large over that of small grains; 1: all alike",
    ),
    Parameter(
        "small_fraction",
        0.5,
        "",
        0.0,
        1.0,
        "share of small grains, by number; without effect if all are alike",
    ),
    Parameter(
        "size_width",
        0.0,
        "",
        0.0,
        0.5,
        "share by which radii of a size are spread, evenly, below the largest; 0: all of a size alike",
    ),
)
MATERIAL = (
    Parameter("auxetic_fraction", 0.5, "", 0.0, 1.0, "share of auxetic grains in a mixed packing"),
    Parameter(
        "regular_poisson_ratio", 0.8, "", 0.0, 0.99, "Poisson's ratio of regular grains", live=True
    ),
    Parameter(
        "auxetic_poisson_ratio",
        -0.8,
        "",
        -0.99,
        -0.01,
        "Poisson's ratio of auxetic grains",
        live=True,
    ),
    Parameter(
        "contact_stiffness",
        50.0,
        "k",
        5.0,
        MOST_STIFFNESS,
        "stiffness of a contact over that of a grain: higher is harder and slower",
        live=True,
    ),
)
# The same, as the paper has it: λ = k_A/k_s of area and shape, μ = (k_A + k_s)/k of grain and contact.
PAPER = (
    Parameter(
        "stiffness_ratio",
        0.0,
        "",
        0.0,
        100.0,
        "λ of the paper, in place of both Poisson's ratios: stiffness of area over shape, 1/λ for the other kind; 0: not used",
        live=True,
    ),
    Parameter(
        "softness",
        0.0,
        "",
        0.0,
        1.0,
        "the paper's μ, in place of the contact stiffness: grain over contact stiffness (paper: 0.1); 0: not used",
        live=True,
    ),
)
POISSON_RATIOS = ("regular_poisson_ratio", "auxetic_poisson_ratio")
FRICTION = "Coulomb friction coefficient, between grains and with walls; 0 leaves the term out"
STIFFNESSES = ("contact_stiffness", "softness")


def material(settings: Mapping[str, Value], kind: str) -> tuple[float, float]:
    """Poisson's ratio and contact stiffness [k] of regular or auxetic grains. Of λ and 1/λ auxetic grains have the smaller."""
    sign = -1.0 if kind == "auxetic" else 1.0
    nu = float(settings.get(f"{kind}_poisson_ratio", sign * DEFAULT_POISSON_RATIO))
    stiffness = float(settings.get("contact_stiffness", DEFAULT_CONTACT_STIFFNESS))
    ratio, softness = _paper(settings)
    if ratio > 0.0:
        nu = sign * abs(float(from_paper(ratio, 1.0)[0]))
    if softness > 0.0:
        stiffness = float(contact_stiffness_of(nu, softness))
    return nu, stiffness


def check_material(settings: Mapping[str, Value]) -> None:
    """Raises InputError where the paper's numbers are given beside those that they replace, or lead too far."""
    ratio, softness = _paper(settings)
    if ratio > 0.0:
        if any(settings[p.name] != p.default for p in MATERIAL if p.name in POISSON_RATIOS):
            raise InputError(
                "give stiffness_ratio or Poisson's ratios, not both: leave one of them at its default"
            )
        if ratio < LEAST_RATIO:
            raise InputError(
                Text(
                    "stiffness_ratio must be 0, which leaves it out, or lie between {least:g} and {most:g}",
                    least=LEAST_RATIO,
                    most=1.0 / LEAST_RATIO,
                )
            )
    if softness > 0.0:
        if settings["contact_stiffness"] != DEFAULT_CONTACT_STIFFNESS:
            raise InputError(
                "give softness or contact_stiffness, not both: leave one of them at its default"
            )

        def stiffest_of(softness: float) -> float:
            asked = {**settings, "softness": softness}
            return max(material(asked, kind)[1] for kind in KINDS_OF_GRAINS)

        if stiffest_of(softness) > MOST_STIFFNESS:
            raise InputError(
                Text(
                    "contacts would be stiffer than {most:g} k: raise softness to {least:g}, "
                    "or bring stiffness_ratio nearer to 1",
                    most=MOST_STIFFNESS,
                    # C − 2 falls as one over the softness; from that of 1, as C may be more than a number can hold.
                    least=round_up((stiffest_of(1.0) - 2.0) / (MOST_STIFFNESS - 2.0)),
                )
            )


def _paper(settings: Mapping[str, Value]) -> tuple[float, float]:
    return float(settings.get("stiffness_ratio", 0.0)), float(settings.get("softness", 0.0))


def recipe(settings: Mapping[str, Value], packing: str) -> Recipe:
    """The grains that ``settings`` and the kind of packing ask for."""
    (regular, stiffness), (auxetic, auxetic_stiffness) = (
        material(settings, kind) for kind in KINDS_OF_GRAINS
    )
    return Recipe(
        kind=packing,
        auxetic_fraction=float(settings["auxetic_fraction"]),
        regular_poisson_ratio=regular,
        auxetic_poisson_ratio=auxetic,
        contact_stiffness=stiffness,
        auxetic_contact_stiffness=auxetic_stiffness,
        size_ratio=float(settings["size_ratio"]),
        small_fraction=float(settings["small_fraction"]),
        size_width=float(settings["size_width"]),
    )


def friction(settings: Mapping[str, Value], grains: int) -> Friction | None:
    """That of so many grains as ``settings`` call for; None without any."""
    return Friction.of(float(settings["friction"]), grains)
