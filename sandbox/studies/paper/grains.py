"""Claims about single grains, pairs and rows: Fig. 1f and the appendices of the paper. Nothing here is a matter of chance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.arrays import Floats
from core.material import from_paper
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.paper.claims import (
    Claim,
    Figure,
    Line,
    Measured,
    Panel,
    Part,
    Reading,
    Threshold,
    cross,
    exactly,
    number,
    where,
)
from sandbox.studies.paper.conditions import LAMBDAS, MU
from sandbox.studies.paper.runs import Request, Result

RADII = (0.5, 1.0, 2.0)
SMALL_ERROR = 0.01
ASPECTS = (1.05, 1.1, 1.2, 1.4)
WITHIN = 5.0  # the factor between the second-order terms, by the paper


def _grain(lam: float, radius: float = 1.0) -> Request:
    nu, stiffness = map(float, from_paper(lam, MU))
    return Request(
        "single_grain",
        "auxetic" if nu < 0.0 else "regular",
        settings=(
            ("poisson_ratio", abs(nu)),
            ("contact_stiffness", stiffness),
            ("radius", radius),
            ("compression", 0.2),
            ("step", 0.01 * radius),
        ),
        probe="grain shape",
    )


def _poisson_ratio(result: Result) -> float:
    """Of the grain's material, by its settings."""
    sign = -1.0 if result.request.packing == "auxetic" else 1.0
    return sign * float(result.request.of("poisson_ratio"))


def _compression(result: Result) -> Floats:
    """Approach of the plates over the diameter (M,)."""
    compression: Floats = result.column("stroke") / (2.0 * result.column("radius"))
    return compression


def _force(result: Result) -> Floats:
    """The paper's normalised force: that on the plate over k times the width of the grain (M,)."""
    width = 2.0 * result.column("radius") * (1.0 + result.column("width_strain"))
    force: Floats = result.column("force") / width
    return force


def _strain_ratio(result: Result) -> Floats:
    """−(strain of the width)/(strain of the height) after the start, (M − 1,)."""
    ratio: Floats = -result.column("width_strain")[1:] / result.column("height_strain")[1:]
    return ratio


def all_sizes(quick: bool) -> list[Request]:
    """Five values of λ, and three sizes of the grain with λ = 0.1 (as in the paper)."""
    del quick
    return [_grain(lam) for lam in LAMBDAS] + [_grain(0.1, r) for r in RADII if r != 1.0]


def poisson_error(results: Sequence[Result]) -> Reading:
    """Largest difference to (λ − 1)/(λ + 1), extrapolated to no strain from the first two increments, for λ = 0.01 … 100."""
    rows = []
    for result in sorted(where(results, radius=1.0), key=_poisson_ratio):
        ratio = _strain_ratio(result)
        rows.append((_poisson_ratio(result), float(2.0 * ratio[0] - ratio[1]), float(ratio[-1])))
    worst = max(abs(measured - nu) for nu, measured, _ in rows)
    far = ", ".join(f"{number(nu, 2)} → {number(late)}" for nu, _, late in rows)
    return exactly(
        worst,
        *(Measured.of(f"for ν = {number(nu, 2)}:", "", measured) for nu, measured, _ in rows),
        remark=f"at 20 % compression the ratio of strains has moved: {far}",
    )


def stiffness_error(results: Sequence[Result]) -> Reading:
    """Largest difference to 1 of the slope of the force at small compression, for all λ and sizes [k]."""
    slopes = []
    for result in results:
        compression = _compression(result)
        stiffness = result.column("force")[1:3] / result.column("stroke")[1:3]
        # Extrapolated to no strain.
        share = compression[1] / (compression[2] - compression[1])
        slopes.append(float(stiffness[0] - share * (stiffness[1] - stiffness[0])))
    worst = float(np.max(np.abs(np.array(slopes) - 1.0)))
    tenth = {
        round(_poisson_ratio(r), 2): cross(_compression(r), _force(r), 0.1)
        for r in where(results, radius=1.0)
    }
    apart = ", ".join(f"{number(f)} for ν = {number(nu, 2)}" for nu, f in sorted(tenth.items()))
    return exactly(
        worst,
        Measured("stiffness", "k", (float(np.mean(slopes)),)),
        remark=f"force over k times width at 10 % compression: {apart}",
    )


def single_grain_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 1f, and the appendix' figure of a single grain."""
    strains, ratios, forces, sizes = [], [], [], []
    for result in sorted(where(results, radius=1.0), key=_poisson_ratio):
        nu = _poisson_ratio(result)
        label, kind = f"ν = {number(nu, 2)}", _colour(nu)
        dashed = abs(nu) > 0.9
        percent = 100.0 * _compression(result)
        strains.append(
            Line(
                label,
                kind,
                -100.0 * result.column("height_strain"),
                100.0 * result.column("width_strain"),
                dashed=dashed,
            )
        )
        ratios.append(Line(label, kind, percent[1:], _strain_ratio(result), dashed=dashed))
        forces.append(Line(label, kind, percent, _force(result), dashed=dashed))
    for radius in RADII:
        for result in results:
            if result.request.of("radius") == radius and abs(_poisson_ratio(result) + 0.82) < 0.01:
                line = Line(
                    f"radius {number(radius)} R",
                    "other" if radius < 1.0 else "auxetic",
                    100.0 * _compression(result),
                    _force(result),
                    points=radius != 1.0,
                )
                sizes.append(line)
    squeeze, force = "compression [%]", "force / (k × width)"
    return [
        Panel("Strains of a grain", "height lost [%]", "width gained [%]", tuple(strains)),
        Panel("Poisson's ratio", squeeze, "−width strain / height strain", tuple(ratios)),
        Panel("Force", squeeze, force, tuple(forces)),
        Panel("Force, λ = 0.1, three sizes", squeeze, force, tuple(sizes)),
    ]


def _colour(nu: float) -> str:
    return "other" if abs(nu) < 1e-9 else "auxetic" if nu < 0.0 else "regular"


def ellipses(quick: bool) -> list[Request]:
    """Two equal, equally tilted ellipses, tilted by half a turn, for several aspect ratios."""
    del quick
    return [
        Request("two_ellipses", "regular", settings=(("aspect", aspect),), probe="outlines")
        for aspect in ASPECTS
    ]


def _early(result: Result) -> Floats:
    """By how much contact starts early, as a share of the mean diameter of the ellipse (M,)."""
    size = 2.0 * np.sqrt(result.column("a") * result.column("b"))
    early: Floats = (result.column("model_distance") - result.column("exact_distance")) / size
    return early


def overlap_factor(results: Sequence[Result]) -> Reading:
    """Exact over approximate term in ε² of the contact distance over b, at θ = 45°.

    As multiples of (1 − cos 4θ)/16, extrapolated to ε → 0.
    """
    two = sorted(results, key=lambda r: float(r.request.of("aspect")))[:2]
    terms, stretches = [], []
    for result in two:
        tilt = np.deg2rad(result.column("stroke"))
        k = int(np.argmin(np.abs(tilt - 0.25 * np.pi)))
        b = float(result.column("b")[k])
        stretch = float(result.column("a")[k]) / b - 1.0
        first = 2.0 + 2.0 * stretch * np.cos(tilt[k]) ** 2
        scale = stretch**2 * (1.0 - np.cos(4.0 * tilt[k])) / 16.0
        terms.append(
            [
                (float(result.column(name)[k]) / b - first) / scale
                for name in ("exact_distance", "model_distance")
            ]
        )
        stretches.append(stretch)
    low, high = (np.array(row) for row in terms)
    exact, model = low - (high - low) * stretches[0] / (stretches[1] - stretches[0])
    return exactly(
        float(exact / model),
        Measured.of("exact term", "", exact),
        Measured.of("approximate term", "", model),
        remark="in units of ε²(1 − cos 4θ)/16; the paper has 5 and 1 because it takes a support function for a polar radius, "
        "and its first-order term is half of the true one",
    )


def overlap_late(results: Sequence[Result]) -> Reading:
    """By how much contact starts late, at most [diameters]; negative where it is always early."""
    late = max(-float(np.min(_early(result))) for result in results) + 0.0  # no −0
    return exactly(late, Measured.of("late by, at most", "diameters", late))


def overlap_early(results: Sequence[Result]) -> Reading:
    """By how much contact starts early at aspect ratio 1.2, at most [% of a diameter]."""
    most = {float(r.request.of("aspect")): 100.0 * float(np.max(_early(r))) for r in results}
    words = ", ".join(f"{number(early, 2)} % at {aspect:g}" for aspect, early in most.items())
    return exactly(
        most[1.2],
        Measured.of("early by", "% of a diameter", most[1.2]),
        remark=f"worst tilt of two parallel ellipses: {words}; mirror images touch exactly where the model says",
    )


def overlap_panels(results: Sequence[Result]) -> list[Panel]:
    """By how much contact starts early, against the tilt."""
    lines = [
        Line(
            f"aspect ratio {r.request.of('aspect'):g}",
            "other",
            r.column("stroke")[:-1],
            100.0 * _early(r)[:-1],
            dashed=r.request.of("aspect") in (1.05, 1.2),
        )
        for r in results
    ]
    return [
        Panel(
            "Two parallel ellipses",
            "tilt to the line of centres [deg]",
            "contact starts early by [% of a diameter]",
            tuple(lines),
        )
    ]


def rows(quick: bool) -> list[Request]:
    """One row of each kind."""
    return [
        Request(
            "grain_row",
            packing,
            settings=(
                ("grains", 5 if quick else 7),
                ("step", 0.02 if quick else 0.005),
                ("tolerance", 1e-3 if quick else 1e-5),
            ),
            probe="sideways",
        )
        for packing in ("regular", "auxetic")
    ]


def _row(results: Sequence[Result], kind: str) -> Result:
    return next(r for r in results if r.request.packing == kind)


def row_pushes(results: Sequence[Result]) -> Reading:
    """Regular grains: sideways over downward force at the first increment."""
    regular = _row(results, "regular")
    share = regular.column("force")[1:] / regular.column("down")[1:]
    return exactly(float(share[0]), Measured.of("regular, at the end", "", share[-1]))


def row_stays(results: Sequence[Result]) -> Reading:
    """Auxetic grains: largest sideways force over the largest downward force."""
    auxetic = _row(results, "auxetic")
    none = float(np.max(np.abs(auxetic.column("force") / np.max(auxetic.column("down")))))
    return exactly(none, Measured.of("auxetic, at most", "", none))


def row_panels(results: Sequence[Result]) -> list[Panel]:
    """Force sideways against compression."""
    lines = tuple(
        Line(r.request.packing, r.request.packing, r.column("stroke"), r.column("force"))
        for r in results
    )
    return [Panel("A row of grains", "compression [%]", "force sideways [k R]", lines)]


EXACTLY = Threshold(
    Demand(high=SMALL_ERROR),
    "nothing here is a matter of chance; what is left is the extrapolation to no strain, some 1e-4",
)
CLAIMS = (
    Claim(
        "poisson_ratio",
        "Fig. 1f, appendix “Single Particle Compression”",
        "by changing the area and shape stiffnesses […] we can tune the particle's Poisson's ratio from +1 to −1; "
        "at small strain ν = (λ − 1)/(λ + 1)",
        all_sizes,
        (
            Part(
                "value",
                "ν = (λ − 1)/(λ + 1) at small strain",
                "largest difference over λ = 0.01 … 100",
                EXACTLY,
                poisson_error,
            ),
        ),
        (Figure("fig-1f-single-grain", "Single grain (Fig. 1f)", single_grain_panels),),
    ),
    Claim(
        "grain_stiffness",
        "appendix “Single Particle Compression”",
        "with the normalization all the particles have the same linear response, regardless of its Poisson's ratio or the "
        "particles initial size",
        all_sizes,
        (
            Part(
                "value",
                "the same stiffness for every ν and size",
                "largest difference to k, over k",
                EXACTLY,
                stiffness_error,
            ),
        ),
    ),
    Claim(
        "overlap_factor",
        "appendix “Ellipse Overlap Approximation”",
        "equal […] up until the second order in ε, where there is a difference by a factor of 5",
        ellipses,
        (
            Part(
                "factor",
                "a difference by a factor of 5",
                "exact over approximate term in ε²",
                Threshold(Demand(WITHIN - 0.5, WITHIN + 0.5), "5, to a digit"),
                overlap_factor,
            ),
        ),
    ),
    Claim(
        "overlap_start",
        "appendix “Ellipse Overlap Approximation”",
        "at least in this test case the used approximation is well behaved",
        ellipses,
        (
            Part(
                "direction",
                "contact is never late",
                "late by at most [diameters]",
                Threshold(Demand(high=1e-9), "rounding"),
                overlap_late,
            ),
            Part(
                "value",
                "and early by little at the aspect ratios of compressed grains",
                "early at aspect ratio 1.2 by [% of a diameter]",
                Threshold(
                    Demand(high=2.0),
                    "the share 2/C of a compression that overlap takes is as large",
                ),
                overlap_early,
            ),
        ),
        (Figure("fig-overlap", "Overlap approximation (appendix)", overlap_panels),),
    ),
    Claim(
        "grain_row",
        "appendix “Poisson's effect”",
        "[regular:] a force in the transverse direction is building up starting from the first moment of compression; "
        "[auxetic:] no force chain can emerge in the transverse direction",
        rows,
        (
            Part(
                "direction",
                "regular grains push sideways from the first moment",
                "sideways over downward force at the first increment, regular",
                Threshold(Demand(0.1), "far above the tolerance of the relaxation, 1e-3 at most"),
                row_pushes,
            ),
            Part(
                "direction",
                "auxetic grains never do",
                "sideways over downward force at most, auxetic",
                Threshold(Demand(high=1e-6), "none, but for rounding"),
                row_stays,
            ),
        ),
        (Figure("fig-poisson-effect", "Poisson effect (appendix)", row_panels),),
    ),
)
