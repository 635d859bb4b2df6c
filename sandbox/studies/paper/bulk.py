"""Claims about compression: Fig. 2c, d of the paper and its appendix on the number of contacts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.arrays import Floats
from sandbox.studies.paper.claims import (
    SURE,
    Claim,
    Figure,
    Finding,
    Line,
    Measured,
    Panel,
    cross,
    number,
    over_seeds,
    ratio,
    surely_above,
)
from sandbox.studies.paper.runs import Request, Result

SLOWER = 2.0  # regular over auxetic pressure that counts as much
LESS_AREA = 18.0  # at which pressures in the press are compared [%]
STRAIN = 0.08  # volumetric strain −ε_v at which periodic packings are compared
PRESSURE = 0.015  # [k] at which numbers of contacts are compared
ISOSTATIC = 4.0
NEAR = 0.15  # of Z to 4 at the onset of rigidity
POINTS = 60  # of a curve that is a mean over seeds


def kinds(nu: tuple[float, ...] = (0.8, 0.0, -0.8)) -> list[tuple[str, tuple[str, float]]]:
    """Packing and setting for each Poisson's ratio."""
    return [
        ("auxetic", ("auxetic_poisson_ratio", n))
        if n < 0.0
        else ("regular", ("regular_poisson_ratio", n))
        for n in nu
    ]


def poisson_ratio(result: Result) -> float:
    """Of all grains in the packing."""
    return float(result.request.of(f"{result.request.packing}_poisson_ratio"))


def of_ratio(results: Sequence[Result], nu: float) -> list[Result]:
    """The runs with grains of that Poisson's ratio."""
    return [result for result in results if poisson_ratio(result) == nu]


def label(nu: float) -> str:
    """For tables and figures."""
    words = {0.8: "regular, ν = 0.8", 0.0: "ν = 0", -0.8: "auxetic, ν = −0.8"}
    return words.get(nu, f"ν = {number(nu)}")


def colour(nu: float) -> str:
    """Kind of line in a figure."""
    return "other" if nu == 0.0 else "regular" if nu > 0.0 else "auxetic"


def ratios(results: Sequence[Result]) -> list[float]:
    """Poisson's ratios that occur, from regular to auxetic."""
    return sorted({poisson_ratio(result) for result in results}, reverse=True)


def presses(quick: bool) -> list[Request]:
    """Fig. 2ab: 100 grains in a V-shaped press."""
    return [
        Request(
            "biaxial_press",
            packing,
            seed,
            (("grains", 100), setting, ("step", 0.1 if quick else 0.05)),
        )
        for packing, setting in kinds((0.8, -0.8))
        for seed in range(1, 4 if quick else 9)
    ]


def squeezes(quick: bool) -> list[Request]:
    """Fig. 2d: a periodic box of 500 grains that shrinks."""
    return [
        Request(
            "biaxial_periodic",
            packing,
            seed,
            (
                ("grains", 200 if quick else 500),
                setting,
                ("tolerance", 1e-2 if quick else 1e-3),
                ("max_iterations", 8000 if quick else 30_000),
                ("strain", 0.1),
            ),
            probe="contacts",
        )
        for packing, setting in kinds()
        for seed in range(1, 3 if quick else 9)
    ]


def _at(results: Sequence[Result], nu: float, what: str, x: str, place: float) -> Measured:
    """Column ``what`` where column ``x`` reaches ``place``, for one Poisson's ratio."""
    unit = "k" if what == "force" else ""
    values = over_seeds(of_ratio(results, nu), lambda r: cross(r.column(x), r.column(what), place))
    return Measured.of(label(nu), unit, values)


def _slower(results: Sequence[Result], place: float, words: str) -> Finding:
    regular, auxetic = (_at(results, nu, "force", "stroke", place) for nu in (0.8, -0.8))
    value, error = ratio(regular, auxetic)
    return Finding(
        surely_above(value, error, 1.0) and value >= SLOWER,
        f"pressure at {words}, regular / auxetic {number(value)} ± {number(error, 2)}, must be ≥ {SLOWER:g}",
        (regular, auxetic),
    )


def judge_press(results: Sequence[Result]) -> Finding:
    """Pressure in the press at the same loss of area."""
    return _slower(results, LESS_AREA, f"{LESS_AREA:g} % less area")


def judge_squeeze(results: Sequence[Result]) -> Finding:
    """Pressure of periodic packings at the same volumetric strain."""
    return _slower(results, STRAIN, f"−ε_v = {STRAIN:g}")


def judge_contacts_strain(results: Sequence[Result]) -> Finding:
    """Z at the same strain is lower for auxetic grains."""
    measured = [_at(results, nu, "z", "stroke", STRAIN) for nu in ratios(results)]
    return _difference(measured, -1.0, f"Z at −ε_v = {STRAIN:g}")


def judge_contacts_pressure(results: Sequence[Result]) -> Finding:
    """Z at the same pressure is higher for auxetic grains."""
    measured = [_at(results, nu, "z", "force", PRESSURE) for nu in ratios(results)]
    return _difference(measured, 1.0, f"Z at P = {PRESSURE:g} k")


def _difference(measured: Sequence[Measured], sign: float, what: str) -> Finding:
    """Auxetic (last) less regular (first) has that sign, surely."""
    regular, auxetic = measured[0], measured[-1]
    value = auxetic.mean - regular.mean
    error = float(np.hypot(auxetic.error, regular.error))
    side = "above" if sign > 0.0 else "below"
    return Finding(
        surely_above(sign * value, error, 0.0),
        f"{what}, auxetic less regular {number(value, 2)} ± {number(error, 2)}, must be {side} 0 by {SURE:g} standard errors",
        tuple(measured),
        "rattlers left out",
    )


def judge_onset(results: Sequence[Result]) -> Finding:
    """Z at the first state of the squeeze, where the pressure is 1e-5 C."""
    measured = [
        Measured.of(label(nu), "", over_seeds(of_ratio(results, nu), lambda r: r.column("z")[0]))
        for nu in ratios(results)
    ]
    worst = max(abs(m.mean - ISOSTATIC) for m in measured)
    pressures = [float(r.column("force")[0]) for r in results]
    return Finding(
        worst < NEAR,
        f"Z at the onset differs from {ISOSTATIC:g} by {number(worst, 2)} at most, must be < {NEAR:g}",
        tuple(measured),
        f"rattlers left out; at pressures of {number(min(pressures), 2)} to {number(max(pressures), 2)} k",
    )


def mean_curve(
    results: Sequence[Result], x: str, y: str, *, log: bool = False
) -> tuple[Floats, Floats]:
    """Places x that all runs have reached, evenly spaced or in their logarithm, and the mean of y there. Each (POINTS,)."""
    low = max(float(np.min(r.column(x))) for r in results)
    high = min(float(np.max(r.column(x))) for r in results)
    places = np.geomspace(low, high, POINTS) if log else np.linspace(low, high, POINTS)
    curves = []
    for result in results:
        order = np.argsort(result.column(x), kind="stable")
        curves.append(np.interp(places, result.column(x)[order], result.column(y)[order]))
    return places, np.mean(curves, axis=0)


def _lines(results: Sequence[Result], x: str, y: str, *, log: bool = False) -> tuple[Line, ...]:
    return tuple(
        Line(label(nu), colour(nu), *mean_curve(of_ratio(results, nu), x, y, log=log))
        for nu in ratios(results)
    )


def press_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 2c."""
    lines = _lines(results, "stroke", "force")
    return [Panel("V-shaped press, 100 grains", "less area [%]", "pressure [k]", lines)]


def squeeze_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 2d, and the appendix on the number of contacts."""
    strain = "volumetric strain −ε_v"
    z = "contacts a grain Z"
    return [
        Panel("Periodic box", strain, "pressure [k]", _lines(results, "stroke", "force")),
        Panel("Contacts at equal strain", strain, z, _lines(results, "stroke", "z")),
        Panel(
            "Contacts at equal pressure",
            "pressure [k]",
            z,
            _lines(results, "force", "z", log=True),
            log_x=True,
        ),
    ]


CLAIMS = (
    Claim(
        "press",
        "Fig. 2c",
        "this facile compression of individual metagrains induces a much slower increase of pressure in comparison to that of "
        "the rings",
        presses,
        judge_press,
        (Figure("fig-2c-press", "V-shaped press (Fig. 2c)", press_panels),),
    ),
    Claim(
        "compression",
        "Fig. 2d",
        "[in simulations, too:] a much slower increase of pressure",
        squeezes,
        judge_squeeze,
        (Figure("fig-2d-compression", "Compression (Fig. 2d, appendix)", squeeze_panels),),
    ),
    Claim(
        "contacts_strain",
        "appendix “Numerical contact number and Poisson effect”, b",
        "the coordination Z […] measured at a fixed volume of the system, is lower for auxetic particles",
        squeezes,
        judge_contacts_strain,
    ),
    Claim(
        "contacts_pressure",
        "appendix “Numerical contact number and Poisson effect”, c",
        "when we do the same measurements at fixed pressure, Z is higher for auxetic particles",
        squeezes,
        judge_contacts_pressure,
    ),
    Claim(
        "contacts_onset",
        "this program's own",
        "(not in the paper: without friction, Z → 4 at the onset of rigidity whatever the grains, which are circles there)",
        squeezes,
        judge_onset,
    ),
)
