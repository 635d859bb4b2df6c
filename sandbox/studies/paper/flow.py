"""Claims about flow in confinement, Fig. 6 of the paper: an intruder in a closed box, a hopper."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.arrays import Floats
from core.observables import force_drops
from sandbox.studies.paper.claims import (
    SURE,
    Claim,
    Figure,
    Finding,
    Line,
    Measured,
    Panel,
    Unmeasurable,
    number,
    of_kind,
    over_seeds,
    ratio,
    surely_above,
    where,
)
from sandbox.studies.paper.runs import Request, Result
from scenes.scene import BY_MACHINE

KINDS = ("regular", "auxetic", "mixed")
STEADY = 0.25  # share of the drag that counts as its beginning
FIRST_SEEDS = 5
LAST = 0.25  # share of the piston's stroke that is averaged
CLOGGED = 1.8  # regular over auxetic
SHARE = 0.6  # of the regular force, that a mixture may need at most
NO_FORCE = 0.05  # [k R] a piston force that is none, a hundredth of what a clogged hopper takes
SMALL_DROP = 1e-3  # [k R] a fall of the force below that is the tolerance's


# Intruder.


def drags(quick: bool) -> list[Request]:
    """Fig. 6a: a closed box, an intruder of 5.7 radii."""
    seeds = range(1, 3 if quick else 11)
    settings = (("grains", 400), ("stroke", 10.0), ("step", 0.1)) if quick else (("grains", 600),)
    return [
        Request("intruder", kind, seed, (*settings, BY_MACHINE)) for kind in KINDS for seed in seeds
    ]


def _steady(result: Result) -> Floats:
    force = result.column("force")
    steady: Floats = force[int(STEADY * len(force)) :]
    return steady


def drag(result: Result) -> float:
    """Mean force on the intruder after the beginning [k R]."""
    return float(np.mean(_steady(result)))


def drops(result: Result) -> Floats:
    """Falls of the force on the intruder [k R], in the order of their coming."""
    sizes = force_drops(_steady(result))
    kept: Floats = sizes[sizes > SMALL_DROP]
    return kept


def mean_drop(result: Result) -> float:
    """Mean fall of the force on the intruder [k R]."""
    sizes = drops(result)
    return float(np.mean(sizes)) if len(sizes) else 0.0


def _of_each_kind(
    results: Sequence[Result], value: Callable[[Result], float], unit: str
) -> dict[str, Measured]:
    return {
        kind: Measured.of(kind, unit, over_seeds(of_kind(results, kind), value)) for kind in KINDS
    }


def _easier(measured: dict[str, Measured], what: str) -> Finding:
    """Regular takes surely more than auxetic, and than the mixture."""
    over = {kind: ratio(measured["regular"], measured[kind]) for kind in ("auxetic", "mixed")}
    words = "; ".join(
        f"regular / {kind} {number(value)} ± {number(error, 2)}"
        for kind, (value, error) in over.items()
    )
    return Finding(
        all(surely_above(*pair, 1.0) for pair in over.values()),
        f"{what}: {words}, each must exceed 1 by {SURE:g} standard errors",
        tuple(measured.values()),
    )


def judge_drag(results: Sequence[Result]) -> Finding:
    """Mean drag: regular above mixed and auxetic."""
    return _easier(_of_each_kind(results, drag, "k R"), "mean drag")


def judge_drops(results: Sequence[Result]) -> Finding:
    """Mean force drop: regular above mixed and auxetic."""
    return _easier(_of_each_kind(results, mean_drop, "k R"), "mean force drop")


def judge_mixture_drag(results: Sequence[Result]) -> Finding:
    """The mixture's drag lies nearer to the auxetic one than to the regular one."""
    measured = _of_each_kind(results, drag, "k R")
    regular, auxetic, mixed = (measured[kind].mean for kind in KINDS)
    place = (mixed - auxetic) / (regular - auxetic)
    return Finding(
        place < 0.5,
        f"on the way from auxetic (0) to regular (1) the mixture is at {number(place)}, must be < 0.5",
        tuple(measured.values()),
        f"mixed / auxetic = {number(mixed / auxetic)}",
    )


def drag_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 6b and c."""
    curves, distributions = [], []
    for kind in KINDS:
        runs = of_kind(results, kind)
        first = min(runs, key=lambda result: result.request.seed)
        curves.append(Line(kind, kind, first.column("stroke"), first.column("force")))
        sizes = np.sort(np.concatenate([drops(result) for result in runs]))
        share = np.arange(1, len(sizes) + 1) / max(len(sizes), 1)
        distributions.append(Line(kind, kind, sizes, share, dashed=kind == "mixed"))
    return [
        Panel("Drag, one seed", "way of the intruder [R]", "force [k R]", tuple(curves)),
        Panel(
            "Force drops, all seeds",
            "force drop [k R]",
            "cumulative distribution",
            tuple(distributions),
            log_x=True,
        ),
    ]


# Hopper.


def pushes(quick: bool) -> list[Request]:
    """Fig. 6e: friction 0.5, an orifice of three large grains, sides at 45°."""
    seeds = range(1, 4 if quick else 11)
    settings = (
        ("grains", 300),
        ("friction", 0.5),
        ("orifice", 3.0),
        ("angle", 45.0),
        BY_MACHINE,
        ("step", 0.1 if quick else 0.05),
    )
    return [Request("hopper", kind, seed, settings) for kind in KINDS for seed in seeds]


def pushes_without_friction(quick: bool) -> list[Request]:
    """The same without friction, and without the mixture."""
    kinds = ("regular", "auxetic")
    return [
        Request(
            r.scene,
            r.packing,
            r.seed,
            tuple((n, 0.0 if n == "friction" else v) for n, v in r.settings),
        )
        for r in pushes(quick)
        if r.packing in kinds and r.seed <= 5
    ]


def last_quarter(result: Result) -> float:
    """Mean piston force in the last quarter of the stroke [k R]."""
    stroke, force = result.column("stroke"), result.column("force")
    return float(np.mean(force[stroke > (1.0 - LAST) * stroke.max()]))


def whole(results: Sequence[Result]) -> list[Result]:
    """The runs that came to the end of the stroke; at least half of each kind must have. Raises Unmeasurable."""
    complete = [result for result in results if result.ended is None]
    for kind in {result.request.packing for result in results}:
        asked, done = (len(of_kind(rows, kind)) for rows in (results, complete))
        if 2 * done < asked:
            raise Unmeasurable(
                f"only {done} of {asked} {kind} runs reached the end: {_short(results)}"
            )
    return complete


def _short(results: Sequence[Result]) -> str:
    """How many runs did not come to the end of the stroke, and why; nothing if all did."""
    short = [result for result in results if result.ended is not None]
    if not short:
        return ""
    kinds = ", ".join(
        f"{len(of_kind(short, kind))} {kind}" for kind in KINDS if of_kind(short, kind)
    )
    return (
        f"left out: {kinds} of {len(results)} runs, which ended early ({short[0].ended}): in this model a grain resists a "
        "squeeze from all sides with a force that has a maximum, and gives way beyond it"
    )


def _remark(*words: str) -> str:
    return "; ".join(filter(None, words))


def _forces(results: Sequence[Result], kind: str) -> Measured:
    return Measured.of(kind, "k R", over_seeds(of_kind(results, kind), last_quarter))


def judge_hopper(results: Sequence[Result]) -> Finding:
    """Regular needs at least 1.8 times the force of auxetic."""
    complete = whole([r for r in results if r.request.packing != "mixed"])
    regular, auxetic = _forces(complete, "regular"), _forces(complete, "auxetic")
    value, error = ratio(regular, auxetic)
    early = [result for result in complete if result.request.seed <= FIRST_SEEDS]
    five, _ = ratio(_forces(early, "regular"), _forces(early, "auxetic"))
    above = float(np.median(regular.values)), float(np.median(auxetic.values))
    return Finding(
        value >= CLOGGED,
        f"mean piston force in the last quarter of the stroke, regular / auxetic {number(value)} ± {number(error, 2)}, "
        f"must be ≥ {CLOGGED:g}",
        (regular, auxetic),
        _remark(
            f"{number(five)} over the first {FIRST_SEEDS} seeds",
            f"medians over seeds {number(above[0])} and {number(above[1])} k R",
            _short([r for r in results if r.request.packing != "mixed"]),
        ),
    )


def judge_hopper_mixture(results: Sequence[Result]) -> Finding:
    """The mixture flows at a fraction of the regular force, and takes at least as much as auxetic."""
    complete = whole(results)
    measured = {kind: _forces(complete, kind) for kind in KINDS}
    share, error = ratio(measured["mixed"], measured["regular"])
    more, _ = ratio(measured["mixed"], measured["auxetic"])
    return Finding(
        share + SURE * error < 1.0 and share < SHARE,
        f"mixed / regular {number(share)} ± {number(error, 2)}, must be < {SHARE:g} and below 1 by {SURE:g} standard errors",
        tuple(measured.values()),
        _remark(f"mixed / auxetic = {number(more)}", _short(results)),
    )


def judge_no_friction(results: Sequence[Result]) -> Finding:
    """Without friction nothing clogs, whatever the grains: the model's own test, not the paper's."""
    regular, auxetic = _forces(results, "regular"), _forces(results, "auxetic")
    highest = max(regular.mean, auxetic.mean)
    return Finding(
        highest < NO_FORCE,
        f"mean piston force {number(highest, 2)} k R at most, must be < {NO_FORCE:g} k R for both",
        (regular, auxetic),
        "nothing clogs, so there is no difference that the kind of grain could make; the paper's grains have friction",
    )


def hopper_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 6f: one seed, and the mean over seeds."""
    one, mean = [], []
    for kind in KINDS:
        runs = of_kind(where(results, "friction", 0.5), kind)
        first = min(runs, key=lambda result: result.request.seed)
        one.append(Line(kind, kind, first.column("stroke"), first.column("force")))
        runs = [r for r in runs if r.ended is None] or runs
        length = min(len(r.column("force")) for r in runs)
        forces = np.array([r.column("force")[:length] for r in runs])
        mean.append(Line(kind, kind, first.column("stroke")[:length], forces.mean(axis=0)))
    stroke, force = "stroke of the piston [R]", "force on the piston [k R]"
    return [
        Panel("One seed", stroke, force, tuple(one)),
        Panel("Mean over seeds", stroke, force, tuple(mean)),
    ]


CLAIMS = (
    Claim(
        "intruder_drag",
        "Fig. 6b",
        "it is easier to traverse through a packing of metagrains or a mixture of metagrains and rings compared to a packing "
        "of rings only",
        drags,
        judge_drag,
        (Figure("fig-6bc-intruder", "Intruder (Fig. 6b, c)", drag_panels),),
    ),
    Claim(
        "intruder_mixture",
        "Fig. 6b",
        "the mixture shows almost the same drag force than the pure packing of metagrains",
        drags,
        judge_mixture_drag,
    ),
    Claim(
        "intruder_drops",
        "Fig. 6c",
        "the size of the avalanches is also much reduced",
        drags,
        judge_drops,
    ),
    Claim(
        "hopper",
        "Fig. 6f",
        "while the rings clog, which leads to a continued rise in the force exerted by the piston, both pure packing of "
        "metagrains and mixture flow",
        pushes,
        judge_hopper,
        (Figure("fig-6f-hopper", "Hopper (Fig. 6f)", hopper_panels),),
        bears_short_runs=True,
    ),
    Claim(
        "hopper_mixture",
        "Fig. 6f",
        "both pure packing of metagrains and mixture flow, with again the mixture requiring larger avalanches to flow",
        pushes,
        judge_hopper_mixture,
        bears_short_runs=True,
    ),
    Claim(
        "hopper_no_friction",
        "this program's own",
        "(not in the paper, whose hopper is an experiment: without friction nothing clogs, and the difference vanishes)",
        pushes_without_friction,
        judge_no_friction,
    ),
)
