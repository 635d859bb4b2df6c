"""Claims about the hopper, Fig. 6e–g of the paper: pushed by a testing machine, and by hands of several strengths.

"Clogs" can only mean something for a hand of limited strength: a piston that goes wherever it is driven empties any hopper, and
only the force tells packings apart. So what locks is counted for hands (`study hand` drives them); forces are the machine's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.observables import force_drops
from sandbox.ensemble.estimates import Apart, Share
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.hand import study as hand
from sandbox.studies.paper.claims import (
    LESS,
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
    Threshold,
    Unmeasurable,
    by_seed,
    mean_of,
    number,
    of_kind,
    over_seeds,
    ratio,
    with_interval,
)
from sandbox.studies.paper.conditions import seeds
from sandbox.studies.paper.runs import HAND, Request, Result
from scenes.scene import BY_MACHINE, HAND_STRENGTH

KINDS = ("regular", "auxetic", "mixed")
SEEDS, SMOOTH_SEEDS = 40, 8
STRENGTHS = hand.STRENGTHS["hopper"]  # [k R]
DEFAULT = 8.0  # [k R] the scene's own, one of them
LAST = 0.25  # share of the stroke that is its end
SMALL_DROP = 1e-2  # [k R] a fall of the force below that is the tolerance's
PAPER = (("grains", 300), ("friction", 0.5), ("orifice", 3.0), ("angle", 45.0))
MOST_OF_THEM = Threshold(Demand(0.5), "“the rings clog”: most of them do")
FEW_OF_THEM = Threshold(Demand(high=0.5), "“flow”: most of them do not lock")
OFTENER = Threshold(Demand(0.0), "a direction: it happens more often")
NO_FORCE = Threshold(Demand(high=0.05), "[k R] a hundredth of what a clogged hopper takes, so none")


def machines(quick: bool) -> list[Request]:
    """Fig. 6e: friction 0.5, an orifice of three large grains, sides at 45°; the piston goes wherever it is driven."""
    settings = (*PAPER, BY_MACHINE, ("step", 0.1 if quick else 0.05))
    return [
        Request("hopper", kind, seed, settings) for kind in KINDS for seed in seeds(SEEDS, quick)
    ]


def hands(quick: bool) -> list[Request]:
    """The same hopper, which is the scene as it is, pushed by hands."""
    return [
        Request("hopper", kind, seed, ((HAND_STRENGTH, strength),), probe=HAND)
        for strength in ((DEFAULT,) if quick else STRENGTHS)
        for kind in KINDS
        for seed in seeds(SEEDS, quick)
    ]


def both(quick: bool) -> list[Request]:
    """Machines and hands."""
    return [*machines(quick), *hands(quick)]


def smooth(quick: bool) -> list[Request]:
    """Without friction."""
    return [
        Request(
            r.scene,
            r.packing,
            r.seed,
            tuple((n, 0.0 if n == "friction" else v) for n, v in r.settings),
        )
        for r in machines(quick)
        if r.packing != "mixed" and r.seed in seeds(SMOOTH_SEEDS, quick)
    ]


def whole_stroke(result: Result) -> float:
    """Mean piston force [k R]."""
    return float(np.mean(result.column("force")[1:]))


def peak(result: Result) -> float:
    """Largest piston force [k R]."""
    return float(np.max(result.column("force")))


def mean_drop(result: Result) -> float:
    """Mean fall of the piston force [k R]."""
    sizes = force_drops(result.column("force"))
    kept = sizes[sizes > SMALL_DROP]
    return float(np.mean(kept)) if len(kept) else 0.0


def continued_rise(result: Result) -> float:
    """Mean piston force in the last quarter of the stroke less that in the quarter before the middle [k R]."""
    way = result.column("stroke") / result.column("stroke").max()
    force = result.column("force")
    late, early = force[way > 1.0 - LAST], force[(way > 0.5 - LAST) & (way <= 0.5)]
    return float(np.mean(late) - np.mean(early))


def by_machine(results: Sequence[Result]) -> list[Result]:
    """The machine's runs that came to the end of the stroke; at least half of each kind must have. Raises Unmeasurable."""
    asked = [r for r in results if r.request.probe != HAND]
    complete = [result for result in asked if result.ended is None]
    for kind in {result.request.packing for result in asked}:
        all_of, done = (len(of_kind(rows, kind)) for rows in (asked, complete))
        if 2 * done < all_of:
            raise Unmeasurable(
                f"only {done} of {all_of} {kind} runs reached the end: {_short(asked)}"
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
    return f"left out: {kinds} of {len(results)} runs, which ended early ({short[0].ended})"


def _told(results: Sequence[Result]) -> str:
    return _short([r for r in results if r.request.probe != HAND])


def force_over(
    value: Callable[[Result], float], one: str, other: str
) -> Callable[[Sequence[Result]], Reading]:
    """One kind over the other under the machine, seed by seed."""

    def measure(results: Sequence[Result]) -> Reading:
        complete = by_machine(results)
        rows = [by_seed(of_kind(complete, kind), value) for kind in (one, other)]
        above, below = (
            Measured.of(kind, "k R", [v for _, v in row])
            for kind, row in zip((one, other), rows, strict=True)
        )
        medians = [number(float(np.median(m.values))) for m in (above, below)]
        remark = f"medians over seeds {medians[0]} and {medians[1]} k R"
        return ratio(above, below, tuple(rows), "; ".join(filter(None, (remark, _told(results)))))

    return measure


def force_of(value: Callable[[Result], float], kind: str) -> Callable[[Sequence[Result]], Reading]:
    """The mean of one kind under the machine."""

    def measure(results: Sequence[Result]) -> Reading:
        some = of_kind(by_machine(results), kind)
        return mean_of(Measured.of(kind, "k R", over_seeds(some, value)), _told(results))

    return measure


def _under(results: Sequence[Result], kind: str, strength: float) -> list[Result]:
    found = [
        r
        for r in of_kind(results, kind)
        if r.request.probe == HAND and r.request.of(HAND_STRENGTH) == strength
    ]
    if not found:
        raise Unmeasurable(f"no hand of {number(strength)} k R was tried")
    return found


def _share(results: Sequence[Result], kind: str, strength: float) -> Share:
    some = _under(results, kind, strength)
    return Share(sum(r.lists["locked"][0] > 0.5 for r in some), len(some))


def locks(kind: str, strength: float) -> Callable[[Sequence[Result]], Reading]:
    """Share of packings that lock."""

    def measure(results: Sequence[Result]) -> Reading:
        share = _share(results, kind, strength)
        out = [r.lists["out"][0] for r in _under(results, kind, strength)]
        return Reading(
            share,
            (Measured.of(f"{kind}, grains out", "", out),),
            f"{share.hits} of {share.count} locked",
        )

    return measure


def locks_oftener(kind: str, strength: float) -> Callable[[Sequence[Result]], Reading]:
    """Share of regular packings that lock, less that of ``kind``."""

    def measure(results: Sequence[Result]) -> Reading:
        one, other = (_share(results, k, strength) for k in ("regular", kind))
        return Reading(
            Apart(one, other),
            remark=f"regular {one.hits} of {one.count}, {with_interval(one)}; "
            f"{kind} {other.hits} of {other.count}, {with_interval(other)}",
        )

    return measure


def fewer_out(kind: str) -> Callable[[Sequence[Result]], Reading]:
    """Grains out under the scene's own hand, regular over ``kind``."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = [
            by_seed(_under(results, k, DEFAULT), lambda r: r.lists["out"][0])
            for k in ("regular", kind)
        ]
        above, below = (
            Measured.of(k, "grains", [v for _, v in row])
            for k, row in zip(("regular", kind), rows, strict=True)
        )
        complete = [r for r in results if r.request.probe != HAND and r.ended is None]
        driven = ", ".join(
            str(
                Measured.of(
                    k, "", over_seeds(of_kind(complete, k), lambda r: r.column("grains_out")[-1])
                )
            )
            for k in ("regular", kind)
            if of_kind(complete, k)
        )
        return ratio(
            above,
            below,
            tuple(rows),
            f"out under the machine, where it is the piston's volume: {driven}",
        )

    return measure


def hopper_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 6f: one seed, the mean over seeds, and what locks."""
    one, mean, locked = [], [], []
    for kind in KINDS:
        runs = [r for r in of_kind(results, kind) if r.request.probe != HAND]
        first = min(runs, key=lambda result: result.request.seed)
        one.append(Line(kind, kind, first.column("stroke"), first.column("force")))
        runs = [r for r in runs if r.ended is None] or runs
        length = min(len(r.column("force")) for r in runs)
        forces = np.array([r.column("force")[:length] for r in runs])
        stroke_then = runs[0].column("stroke")[:length]
        mean.append(Line(kind, kind, stroke_then, forces.mean(axis=0)))
        pushed = [r for r in of_kind(results, kind) if r.request.probe == HAND]
        strengths = sorted({float(r.request.of(HAND_STRENGTH)) for r in pushed})
        shares = np.array([_share(results, kind, s).value for s in strengths])
        locked.append(Line(kind, kind, np.array(strengths), shares, points=True))
    stroke, force = "stroke of the piston [R]", "force on the piston [k R]"
    return [
        Panel("By machine, one seed", stroke, force, tuple(one)),
        Panel("By machine, mean over seeds", stroke, force, tuple(mean)),
        Panel("By hand", "strength of the hand [k R]", "share that locks", tuple(locked)),
    ]


AT = f"under a hand of {DEFAULT:g} k R"
MEAN_FORCE = "mean piston force over the whole stroke, by machine"

CLAIMS = (
    Claim(
        "hopper",
        "Fig. 6f",
        "while the rings clog, which leads to a continued rise in the force exerted by the piston, both pure packing of "
        "metagrains and mixture flow",
        both,
        (
            *(
                Part(
                    "share",
                    words,
                    f"share of {kind} packings that lock {AT}",
                    threshold,
                    locks(kind, DEFAULT),
                )
                for words, kind, threshold in (
                    ("the rings clog", "regular", MOST_OF_THEM),
                    ("metagrains flow", "auxetic", FEW_OF_THEM),
                    ("the mixture flows", "mixed", FEW_OF_THEM),
                )
            ),
            *(
                Part(
                    "direction",
                    f"rings clog more often than {kind}, hand of {strength:g} k R",
                    f"share that locks, regular less {kind}, hand of {strength:g} k R",
                    OFTENER,
                    locks_oftener(kind, strength),
                )
                for strength in STRENGTHS
                for kind in ("auxetic", "mixed")
            ),
            *(
                Part(
                    "direction",
                    f"fewer rings come out than {kind}",
                    f"grains out {AT}, regular / {kind}",
                    LESS,
                    fewer_out(kind),
                )
                for kind in ("auxetic", "mixed")
            ),
            Part(
                "trend",
                "a continued rise in the force, regular",
                "piston force of the last quarter less that of the second, by machine [k R]",
                RISES,
                force_of(continued_rise, "regular"),
            ),
            *(
                Part(
                    "direction",
                    f"more force for rings than for {kind}",
                    f"{MEAN_FORCE}, regular / {kind}",
                    MORE,
                    force_over(whole_stroke, "regular", kind),
                )
                for kind in ("auxetic", "mixed")
            ),
            *(
                Part(
                    "factor",
                    f"a large build up of force: much more than for {kind}",
                    f"largest piston force, by machine, regular / {kind}",
                    MUCH,
                    force_over(peak, "regular", kind),
                )
                for kind in ("auxetic", "mixed")
            ),
        ),
        (Figure("fig-6f-hopper", "Hopper (Fig. 6f)", hopper_panels),),
        bears_short_runs=True,
    ),
    Claim(
        "hopper_mixture",
        "Fig. 6f",
        "with again the mixture requiring larger avalanches to flow",
        machines,
        (
            Part(
                "direction",
                "larger avalanches than metagrains",
                "mean fall of the piston force, by machine, mixed / auxetic",
                MORE,
                force_over(mean_drop, "mixed", "auxetic"),
            ),
            Part(
                "direction",
                "and smaller ones than rings",
                "mean fall of the piston force, by machine, regular / mixed",
                MORE,
                force_over(mean_drop, "regular", "mixed"),
            ),
        ),
        bears_short_runs=True,
    ),
    Claim(
        "hopper_no_friction",
        "this program's own",
        "(not in the paper, whose hopper is an experiment: without friction nothing clogs, and the difference vanishes)",
        smooth,
        tuple(
            Part(
                "value",
                f"no force, {kind}",
                f"{MEAN_FORCE}, {kind}",
                NO_FORCE,
                force_of(whole_stroke, kind),
            )
            for kind in ("regular", "auxetic")
        ),
    ),
)
