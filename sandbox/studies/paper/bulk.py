"""Claims about compression: Fig. 2c, d of the paper and its appendix on the number of contacts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.arrays import Floats
from sandbox.ensemble.estimates import Student
from sandbox.studies.paper.claims import (
    FALLS,
    MORE,
    MUCH,
    RISES,
    Claim,
    Figure,
    Line,
    Measured,
    Panel,
    Part,
    Reading,
    Unmeasurable,
    by_seed,
    cross,
    mean_of,
    ratio,
)
from sandbox.studies.paper.conditions import (
    AUXETIC,
    LAMBDAS,
    REGULAR,
    SYSTEMS,
    colour,
    dashed,
    label,
    lambdas,
    material,
    of_lam,
    packing,
    seeds,
)
from sandbox.studies.paper.runs import Request, Result

LESS_AREA = 18.0  # at which pressures in the press are compared [%]
STRAIN = 0.08  # volumetric strain −ε_v at which periodic packings are compared
PRESSURE = 0.015  # [k] at which numbers of contacts are compared
POINTS = 60  # of a curve that is a mean over seeds


def presses(quick: bool) -> list[Request]:
    """Fig. 2ab: 100 grains in a V-shaped press."""
    return [
        Request(
            "biaxial_press",
            packing(lam),
            seed,
            (("grains", 100), *material(lam), ("step", 0.1 if quick else 0.05)),
        )
        for lam in (REGULAR, AUXETIC)
        for seed in seeds(SYSTEMS, quick)
    ]


def squeezes(quick: bool) -> list[Request]:
    """Fig. 2d: a periodic box of 500 grains that shrinks, 16 systems of each λ."""
    return [
        Request(
            "biaxial_periodic",
            packing(lam),
            seed,
            (
                ("grains", 200 if quick else 500),
                *material(lam),
                ("tolerance", 1e-2 if quick else 1e-3),
                ("max_iterations", 8000 if quick else 60_000),
                ("strain", 0.1),
            ),
            probe="contacts",
        )
        for lam in ((REGULAR, AUXETIC) if quick else LAMBDAS)
        for seed in seeds(SYSTEMS, quick)
    ]


def strain(result: Result) -> Floats:
    """Strain of a run (M,) from where the pressure would be 0: the scene counts from 5e-4 k, whatever the contacts' stiffness.
    For the press its loss of area as it is.
    """
    stroke: Floats = result.column("stroke")
    if result.request.scene != "biaxial_periodic":
        return stroke
    force = result.column("force")
    rises = np.flatnonzero(force > force[0])
    if not rises.size:
        raise Unmeasurable(f"the pressure does not rise (seed {result.request.seed})")
    first = rises[0]  # the next increment, unless grains rearrange in it
    return stroke + float(force[0] * (stroke[first] - stroke[0]) / (force[first] - force[0]))


def _reach(what: str, x: str, place: float) -> Callable[[Result], float]:
    """Column ``what`` where column ``x`` reaches ``place``."""

    def value(result: Result) -> float:
        along = strain(result) if x == "stroke" else result.column(x)
        return cross(along, result.column(what), place)

    return value


def _slower(place: float) -> Callable[[Sequence[Result]], Reading]:
    def measure(results: Sequence[Result]) -> Reading:
        rows = [
            by_seed(of_lam(results, lam), _reach("force", "stroke", place))
            for lam in (REGULAR, AUXETIC)
        ]
        above, below = (
            Measured.of(label(lam), "k", [v for _, v in row])
            for lam, row in zip((REGULAR, AUXETIC), rows, strict=True)
        )
        return ratio(above, below, tuple(rows))

    return measure


def _contacts(x: str, place: float) -> Callable[[Sequence[Result]], Reading]:
    """Z where ``x`` is at ``place``: auxetic less regular, seed by seed."""

    def measure(results: Sequence[Result]) -> Reading:
        value = _reach("z", x, place)
        regular, auxetic = (
            dict(by_seed(of_lam(results, lam), value)) for lam in (REGULAR, AUXETIC)
        )
        both = sorted(regular.keys() & auxetic.keys())
        less = [auxetic[seed] - regular[seed] for seed in both]
        return Reading(
            Student.mean(less),
            (
                Measured.of(label(REGULAR), "", list(regular.values())),
                Measured.of(label(AUXETIC), "", list(auxetic.values())),
            ),
            "rattlers left out",
        )

    return measure


def _over_lambdas(
    what: str, x: str, place: float, *, exponent: bool
) -> Callable[[Sequence[Result]], Reading]:
    """Slope against ln λ over all λ, of the quantity or (``exponent``) of its logarithm, one a seed."""

    def measure(results: Sequence[Result]) -> Reading:
        there = lambdas(results)
        value = _reach(what, x, place)
        rows = {lam: dict(by_seed(of_lam(results, lam), value)) for lam in there}
        common = sorted(set.intersection(*(set(row) for row in rows.values())))
        slopes = []
        for seed in common:
            values = np.array([rows[lam][seed] for lam in there])
            y = np.log(values) if exponent else values
            # Differences, so that the slope of what is all alike is zero, and not how a library rounds.
            slopes.append(float(np.polyfit(np.log(there), y - y[0], 1)[0]))
        return mean_of(
            Measured.of("slope", "", slopes),
            "; ".join(str(Measured.of(label(lam), "", list(rows[lam].values()))) for lam in there),
        )

    return measure


def mean_curve(
    results: Sequence[Result], x: str, y: str, *, log: bool = False
) -> tuple[Floats, Floats]:
    """Places x that all runs have reached, evenly spaced or in their logarithm, and the mean of y there. Each (POINTS,)."""
    rows = [strain(r) if x == "stroke" else r.column(x) for r in results]
    low = max(float(np.min(row)) for row in rows)
    high = min(float(np.max(row)) for row in rows)
    places = np.geomspace(low, high, POINTS) if log else np.linspace(low, high, POINTS)
    curves = []
    for row, result in zip(rows, results, strict=True):
        order = np.argsort(row, kind="stable")
        curves.append(np.interp(places, row[order], result.column(y)[order]))
    return places, np.mean(curves, axis=0)


def _lines(results: Sequence[Result], x: str, y: str, *, log: bool = False) -> tuple[Line, ...]:
    return tuple(
        Line(
            label(lam),
            colour(lam),
            *mean_curve(of_lam(results, lam), x, y, log=log),
            dashed=dashed(lam),
        )
        for lam in lambdas(results)
    )


def press_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 2c."""
    lines = _lines(results, "stroke", "force")
    return [Panel("V-shaped press, 100 grains", "less area [%]", "pressure [k]", lines)]


def squeeze_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 2d, and the appendix on the number of contacts."""
    along = "volumetric strain −ε_v"
    z = "contacts a grain Z"
    return [
        Panel("Periodic box", along, "pressure [k]", _lines(results, "stroke", "force")),
        Panel("Contacts at equal strain", along, z, _lines(results, "stroke", "z")),
        Panel(
            "Contacts at equal pressure",
            "pressure [k]",
            z,
            _lines(results, "force", "z", log=True),
            log_x=True,
        ),
    ]


def _slower_parts(place: float, where_: str) -> tuple[Part, ...]:
    quantity = f"pressure at {where_}, regular / auxetic"
    return (
        Part("direction", "a slower increase", quantity, MORE, _slower(place)),
        Part("factor", "a much slower one", quantity, MUCH, _slower(place)),
    )


CLAIMS = (
    Claim(
        "press",
        "Fig. 2c",
        "this facile compression of individual metagrains induces a much slower increase of pressure in comparison to that of "
        "the rings",
        presses,
        _slower_parts(LESS_AREA, f"{LESS_AREA:g} % less area"),
        (Figure("fig-2c-press", "V-shaped press (Fig. 2c)", press_panels),),
    ),
    Claim(
        "compression",
        "Fig. 2d",
        "[in simulations, too:] a much slower increase of pressure",
        squeezes,
        (
            *_slower_parts(STRAIN, f"−ε_v = {STRAIN:g}"),
            Part(
                "trend",
                "the slower, the more auxetic (λ from 0.01 to 100)",
                f"n in pressure ∝ λⁿ at −ε_v = {STRAIN:g}",
                RISES,
                _over_lambdas("force", "stroke", STRAIN, exponent=True),
            ),
        ),
        (Figure("fig-2d-compression", "Compression (Fig. 2d, appendix)", squeeze_panels),),
    ),
    Claim(
        "contacts_strain",
        "appendix “Numerical contact number and Poisson effect”, b",
        "the coordination Z […] measured at a fixed volume of the system, is lower for auxetic particles",
        squeezes,
        (
            Part(
                "direction",
                "lower for auxetic grains",
                f"Z at −ε_v = {STRAIN:g}, auxetic less regular",
                FALLS,
                _contacts("stroke", STRAIN),
            ),
            Part(
                "trend",
                "the lower, the more auxetic (λ from 0.01 to 100)",
                f"slope of Z against ln λ at −ε_v = {STRAIN:g}",
                RISES,
                _over_lambdas("z", "stroke", STRAIN, exponent=False),
            ),
        ),
    ),
    Claim(
        "contacts_pressure",
        "appendix “Numerical contact number and Poisson effect”, c",
        "when we do the same measurements at fixed pressure, Z is higher for auxetic particles",
        squeezes,
        (
            Part(
                "direction",
                "higher for auxetic grains",
                f"Z at P = {PRESSURE:g} k, auxetic less regular",
                RISES,
                _contacts("force", PRESSURE),
            ),
            Part(
                "trend",
                "the higher, the more auxetic (λ from 0.01 to 100)",
                f"slope of Z against ln λ at P = {PRESSURE:g} k",
                FALLS,
                _over_lambdas("z", "force", PRESSURE, exponent=False),
            ),
        ),
    ),
)
