"""What the study of clogging asks of its sweeps: each claim with a threshold whose reason was written before the runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from sandbox.ensemble.estimates import Apart, Share
from sandbox.studies.classics.case import Check
from sandbox.studies.clogging.fits import (
    ON_THE_GATE,
    Falls,
    begun,
    divergence,
    exponential,
    falling,
    pooled_memory,
    preference,
)
from sandbox.studies.clogging.parts import (
    FIRST,
    SHARES,
    SOFT,
    STRENGTHS,
    USUAL_HAND,
    WIDE,
    WIDTHS,
)
from sandbox.studies.common.verdicts import Demand
from sandbox.sweep.sizes import hazard
from sandbox.sweep.summary import Cell

Found = Mapping[str, Sequence[Cell]]  # the cells of each part
FACTOR = 1.5  # of hazards that still counts as none
A_DIRECTION = "a direction"


@dataclass(frozen=True)
class Claim:
    """``find`` makes the checks of all cells; fewer, or none, where the runs were too few."""

    name: str
    title: str
    source: str
    find: Callable[[Found], list[Check]]
    limits: str


def stopped(cells: Sequence[Cell], *at: float, packing: str | None = None) -> Share | None:
    """The share that stopped, of all cells ``at`` those values of the first axes."""
    shares = [
        cell.stopped
        for cell in cells
        if packing in (None, cell.packing) and cell.values[: len(at)] == at
    ]
    known = [share for share in shares if share is not None]
    if not known:
        return None
    return Share(sum(s.hits for s in known), sum(s.count for s in known))


def _check(
    quantity: str, estimate: Share | Apart, expected: str, demand: Demand, reason: str, seeds: int
) -> Check:
    judging = tuple(range(FIRST, FIRST + seeds))
    return Check(quantity, estimate, expected, demand, reason, judging)


def _jamming(found: Found) -> list[Check]:
    """J(d/D) of To, Lai and Pak."""
    cells = [*found[WIDTHS.name], *found[WIDE.name]]
    checks = []
    for width, expected, demand in (
        (2.0, "near 1", Demand(0.5)),
        (5.0, "near 0", Demand(high=0.5)),
    ):
        share = stopped(cells, width)
        if share is not None:
            reason = "read off their figure: 1 at two diameters, 0 at five; the half is where it is steep"
            checks.append(
                _check(f"J at {width:g} diameters", share, expected, demand, reason, share.count)
            )
    for narrow, wide in ((2.0, 3.0), (3.0, 4.0), (2.0, 4.0)):
        one, other = stopped(cells, narrow), stopped(cells, wide)
        if one is not None and other is not None:
            quantity = (
                f"J at {narrow:g} less J at {wide:g} diameters ({one.value:.2f}; {other.value:.2f})"
            )
            demand = Demand(0.0)
            checks.append(
                _check(quantity, Apart(one, other), "above 0", demand, A_DIRECTION, one.count)
            )
    return checks


def _sizes(found: Found) -> list[Check]:
    """Whether an avalanche forgets how large it is already: width by width, and all together."""
    cells = found[WIDTHS.name]
    bound = math.log(FACTOR)
    reason = (
        f"exponential sizes have the same hazard late as early, logarithm 0; a factor of {FACTOR:g} either way is what some "
        "hundred clogs can tell"
    )
    some = [(f"{c.values[0]:g} diameters", [c]) for c in cells] + [
        ("all widths together", [*cells])
    ]
    checks = []
    for name, those in some:
        estimate = pooled_memory(those)
        if estimate is not None:
            clogs = sum(int(begun(cell)[1].sum()) for cell in those)
            quantity = f"logarithm of the hazard beyond the mean size over that up to it, {name}, {clogs} clogs"
            seeds = tuple(range(FIRST, FIRST + len(those[0].runs)))
            demand = Demand(-bound, bound)
            checks.append(Check(quantity, estimate, "0", demand, reason, seeds))
    return checks


def _decay(found: Found) -> list[Check]:
    """How the hazard falls with the width, and which of the two forms the avalanches prefer."""
    cells = [cell for cell in found[WIDTHS.name] if len(begun(cell)[0])]
    seeds = tuple(range(FIRST, FIRST + max((len(c.runs) for c in cells), default=0)))
    checks = []
    slope = falling(cells)
    if slope is not None:
        quantity = "slope of ln q against the squared width [per square diameter]"
        reason = (
            f"{A_DIRECTION}: wider orifices clog less, exponentially in the area of their width"
        )
        checks.append(Check(quantity, slope, "below 0", Demand(high=0.0), reason, seeds))
        falls = Falls.of(cells)
        one, other = exponential(falls), divergence(falls)
        quantity = (
            f"log likelihood an avalanche, {one.name} ({one.words}; criterion {one.criterion:.1f}) over {other.name} "
            f"({other.words}; {other.criterion:.1f})"
        )
        reason = f"{A_DIRECTION}: no critical width is needed; below 0 there is one"
        estimate = preference(one, other)
        checks.append(Check(quantity, estimate, "above 0", Demand(0.0), reason, seeds))
    return checks


def _softness(found: Found) -> list[Check]:
    """Clogs over grains that left, of the lightest and the heaviest grains."""
    cells = sorted(found[SOFT.name], key=lambda cell: cell.values)
    if len(cells) < 2:
        return []
    light, heavy = cells[0], cells[-1]
    one, other = hazard(*light.sizes), hazard(*heavy.sizes)
    checks = []
    names = f"at {light.values[0]:g} and {heavy.values[0]:g} k/R"
    if one is not None and other is not None:
        told = f"{one.value:.3f}; {other.value:.3f}"
        quantity = (
            f"clogs a grain that leaves, weights {names} ({told}), the lighter less the heavier"
        )
        demand = Demand(0.0)
        checks.append(
            _check(quantity, Apart(one, other), "above 0", demand, A_DIRECTION, len(light.runs))
        )
    first, last = light.stopped, heavy.stopped
    if first is not None and last is not None:
        quantity = f"J, weights {names} ({first.value:.2f}; {last.value:.2f}), the lighter less the heavier"
        apart = Apart(first, last)
        checks.append(_check(quantity, apart, "above 0", Demand(0.0), A_DIRECTION, first.count))
    return checks


def _maps(found: Found) -> list[Check]:
    """Regular less auxetic, at each orifice under gravity, and under each hand."""
    checks = []
    shares = found[SHARES.name]
    for orifice in sorted({float(cell.values[0]) for cell in shares}):
        one, other = (stopped(shares, orifice, share) for share in (0.0, 1.0))
        if one is not None and other is not None:
            quantity = (
                f"under gravity, {orifice:g} diameters: share that stops, no auxetic grain less all auxetic "
                f"({one.value:.2f}; {other.value:.2f})"
            )
            apart = Apart(one, other)
            checks.append(_check(quantity, apart, "above 0", Demand(0.0), A_DIRECTION, one.count))
    pushed = found[STRENGTHS.name]
    for orifice in sorted({float(cell.values[0]) for cell in pushed}):
        for kind in ("mixed", "auxetic"):
            one, other = (
                stopped(pushed, orifice, USUAL_HAND, packing=each) for each in ("regular", kind)
            )
            if one is not None and other is not None:
                quantity = (
                    f"hand of {USUAL_HAND:g} k R, {orifice:g} diameters: share that locks, regular less {kind} "
                    f"({one.value:.2f}; {other.value:.2f})"
                )
                apart = Apart(one, other)
                checks.append(
                    _check(quantity, apart, "above 0", Demand(0.0), A_DIRECTION, one.count)
                )
    return checks


SLOW = (
    "quasistatic grains have no momentum that could break an arch, and sink as in honey: where the probability falls may be "
    "shifted, the more so the wider the orifice"
)
CLAIMS = (
    Claim(
        "jamming",
        "(a) Probability of jamming",
        "To, Lai and Pak, doi:10.1103/PhysRevLett.86.71",
        _jamming,
        SLOW,
    ),
    Claim(
        "sizes",
        "(b) Avalanche sizes are exponential at every opening",
        "Pérez, arXiv:0705.1744; Janda et al., doi:10.1209/0295-5075/84/44002",
        _sizes,
        "a drain of 200 grains that runs empty says only that its avalanche was no smaller. A first avalanche starts from a "
        f"packing that was made, not from one that had clogged: only those of more than {ON_THE_GATE} grains, which may have "
        "lain on the gate, are counted, and from there on",
    ),
    Claim(
        "decay",
        "(c) Decay of clogging with the width",
        "Thomas and Durian, arXiv:1410.0933, against Zuriguel et al., arXiv:cond-mat/0407761",
        _decay,
        "widths up to four diameters, a decade and a half of hazards: more than that no 200 grains can tell",
    ),
    Claim(
        "softness",
        "(d) Softer grains clog less",
        "Hong, Kohne, Morrell, Wang and Weeks, PRE 96, 062605; Tao et al., PRE 104, 044909",
        _softness,
        "softness is the weight of a grain over its stiffness; momentum, which their drops have, is none here. Clogs right "
        "after the gate is gone are counted, too",
    ),
    Claim(
        "maps",
        "(e) Auxetic grains: under gravity, and under a hand",
        "new: nobody has published these for auxetic grains",
        _maps,
        "auxetic grains that are squeezed beyond what their hole allows are too soft here (core/MODEL.md, section 11)",
    ),
)
