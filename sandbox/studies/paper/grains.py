"""Claims about single grains, pairs and rows: Fig. 1f and the appendices of the paper. Nothing here is a matter of chance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.arrays import Floats
from core.material import from_paper
from sandbox.studies.paper.claims import (
    Claim,
    Figure,
    Finding,
    Line,
    Measured,
    Panel,
    cross,
    number,
    where,
)
from sandbox.studies.paper.runs import Request, Result

# λ and μ of the paper.
LAMBDAS = (0.01, 0.1, 1.0, 10.0, 100.0)
MU = 0.1
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


def judge_poisson_ratio(results: Sequence[Result]) -> Finding:
    """Extrapolated to no strain from the first two increments, for λ = 0.01 … 100."""
    rows = []
    for result in sorted(where(results, "radius", 1.0), key=_poisson_ratio):
        ratio = _strain_ratio(result)
        rows.append((_poisson_ratio(result), float(2.0 * ratio[0] - ratio[1]), float(ratio[-1])))
    worst = max(abs(measured - nu) for nu, measured, _ in rows)
    far = ", ".join(f"{number(nu, 2)} → {number(late)}" for nu, _, late in rows)
    return Finding(
        worst < SMALL_ERROR,
        f"largest difference to (λ − 1)/(λ + 1): {number(worst, 2)}, must be < {SMALL_ERROR}",
        tuple(Measured.of(f"for ν = {number(nu, 2)}:", "", measured) for nu, measured, _ in rows),
        f"at 20 % compression the ratio of strains has moved: {far}",
    )


def judge_stiffness(results: Sequence[Result]) -> Finding:
    """Slope of the force at small compression, for all λ and sizes, in units of k."""
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
        for r in where(results, "radius", 1.0)
    }
    apart = ", ".join(f"{number(f)} for ν = {number(nu, 2)}" for nu, f in sorted(tenth.items()))
    return Finding(
        worst < SMALL_ERROR,
        f"stiffness differs from k by {number(worst, 2)} k at most, must be < {SMALL_ERROR} k",
        (Measured("stiffness", "k", (float(np.mean(slopes)),)),),
        f"force over k times width at 10 % compression: {apart}",
    )


def single_grain_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 1f, and the appendix' figure of a single grain."""
    strains, ratios, forces, sizes = [], [], [], []
    for result in sorted(where(results, "radius", 1.0), key=_poisson_ratio):
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


def judge_overlap_factor(results: Sequence[Result]) -> Finding:
    """Terms in ε² of the contact distance over b, as multiples of (1 − cos 4θ)/16, extrapolated to ε → 0 at θ = 45°."""
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
    factor = float(exact / model)
    return Finding(
        abs(factor - WITHIN) < 0.5,
        f"exact over approximate term: {number(factor)}, must be {WITHIN:g}",
        (
            Measured.of("exact term", "", exact),
            Measured.of("approximate term", "", model),
        ),
        "in units of ε²(1 − cos 4θ)/16; the paper has 5 and 1 because it takes a support function for a polar radius, and its "
        "first-order term is half of the true one",
    )


def judge_overlap_start(results: Sequence[Result]) -> Finding:
    """Never late, and early by little at the aspect ratios of compressed grains."""
    latest = min(float(np.min(_early(result))) for result in results)
    most = {float(r.request.of("aspect")): 100.0 * float(np.max(_early(r))) for r in results}
    words = ", ".join(f"{number(early, 2)} % at {aspect:g}" for aspect, early in most.items())
    return Finding(
        latest > -1e-9 and most[1.2] < 2.0,
        f"never late, and early by {number(most[1.2])} % of a diameter at aspect ratio 1.2, must be < 2 %",
        (Measured.of("early by", "% of a diameter", most[1.2]),),
        f"worst tilt of two parallel ellipses: {words}; mirror images touch exactly where the model says",
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


def judge_row(results: Sequence[Result]) -> Finding:
    """Regular: a force from the first increment. Auxetic: none at all."""
    regular, auxetic = (
        next(r for r in results if r.request.packing == kind) for kind in ("regular", "auxetic")
    )
    first = float(regular.column("force")[1] / regular.column("down")[1])
    last = float(regular.column("force")[-1] / regular.column("down")[-1])
    none = float(np.max(np.abs(auxetic.column("force") / np.max(auxetic.column("down")))))
    return Finding(
        first > 0.1 and none < 1e-6,
        f"sideways over downward force: regular {number(first)} at the first increment, must be > 0.1; "
        f"auxetic {number(none)} at most, must be < 1e-6",
        (
            Measured.of("regular, at the end", "", last),
            Measured.of("auxetic, at most", "", none),
        ),
    )


def row_panels(results: Sequence[Result]) -> list[Panel]:
    """Force sideways against compression."""
    lines = tuple(
        Line(r.request.packing, r.request.packing, r.column("stroke"), r.column("force"))
        for r in results
    )
    return [Panel("A row of grains", "compression [%]", "force sideways [k R]", lines)]


CLAIMS = (
    Claim(
        "poisson_ratio",
        "Fig. 1f, appendix “Single Particle Compression”",
        "by changing the area and shape stiffnesses […] we can tune the particle's Poisson's ratio from +1 to −1; "
        "at small strain ν = (λ − 1)/(λ + 1)",
        all_sizes,
        judge_poisson_ratio,
        (Figure("fig-1f-single-grain", "Single grain (Fig. 1f)", single_grain_panels),),
    ),
    Claim(
        "grain_stiffness",
        "appendix “Single Particle Compression”",
        "with the normalization all the particles have the same linear response, regardless of its Poisson's ratio or the "
        "particles initial size",
        all_sizes,
        judge_stiffness,
    ),
    Claim(
        "overlap_factor",
        "appendix “Ellipse Overlap Approximation”",
        "equal […] up until the second order in ε, where there is a difference by a factor of 5",
        ellipses,
        judge_overlap_factor,
    ),
    Claim(
        "overlap_start",
        "appendix “Ellipse Overlap Approximation”",
        "at least in this test case the used approximation is well behaved",
        ellipses,
        judge_overlap_start,
        (Figure("fig-overlap", "Overlap approximation (appendix)", overlap_panels),),
    ),
    Claim(
        "grain_row",
        "appendix “Poisson's effect”",
        "[regular:] a force in the transverse direction is building up starting from the first moment of compression; "
        "[auxetic:] no force chain can emerge in the transverse direction",
        rows,
        judge_row,
        (Figure("fig-poisson-effect", "Poisson effect (appendix)", row_panels),),
    ),
)
