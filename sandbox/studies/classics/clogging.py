"""Hoppers under gravity: jamming against the experiment of To, Lai and Pak, and whether the outflow is one of the grains at all.

An increment is a step of slow motion, in which a free grain sinks by ``fall``. What leaves before an arch forms must not depend
on that, nor on anything else that only says how the path is cut into steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

from sandbox.ensemble.estimates import Apart, Ratio, Share
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.studies.classics.case import (
    Asking,
    Case,
    Check,
    Job,
    Numbers,
    Row,
    seeds,
    seeds_of,
    where,
    within,
)
from sandbox.studies.common.verdicts import Demand
from scenes.parameter import Value

WIDTHS = (2.0, 3.0, 4.0, 5.0)  # of the orifice, in diameters
SEEDS = 24
GRAINS = 200
# Single-sized grains; the hopper's sides stand at 34° to the vertical, as in the experiment.
SETTINGS: tuple[tuple[str, Value], ...] = (
    ("grains", GRAINS),
    ("angle", 56.0),
    ("friction", 0.5),
    ("shake", 0.0),
    ("size_ratio", 1.0),
)
SLICE = 400  # force evaluations between two looks at whether to stop
LONGEST = 4000  # increments
PAUSE = 120  # increments in which nothing leaves, and nothing moves: it is jammed
FALLS = (0.1, 0.05, 0.02)  # [R]
DRAINS = 200  # a setting
OUTFLOW_WIDTH = 3.0  # diameters
LEFT = 0.02  # of the grains may stay on the sides of an empty hopper


def _drain(job: Job, check: Asking) -> Numbers:
    """Let a hopper run until it is empty or has come to rest."""
    asked = dict(job.settings)
    settings = {**dict(SETTINGS), "orifice": asked.pop("width"), **asked}
    session = Session("gravity_hopper", "regular", job.seed, settings)
    session.build()
    session.submit(Protocol(True))
    out, quiet, increments = 0, 0, 0
    for _ in islice(session.increments(SLICE, check), LONGEST):
        increments += 1
        now = session.frame().grains_out
        quiet = 0 if now > out or session.run.course.moving else quiet + 1
        out = now
        if quiet >= PAUSE or not len(session.run.setup.packing):
            break
    left = len(session.run.setup.packing)
    return {
        "out": float(out),
        "left": float(left),
        "jammed": float(left > LEFT * (left + out)),
        "at_rest": float(quiet >= PAUSE or left == 0),
        "increments": float(increments),
    }


def _judge(rows: Sequence[Row]) -> list[Check]:
    shares = {}
    for width in WIDTHS:
        some = where(rows, width=width)
        shares[width] = Share(sum(row["jammed"] > 0.5 for row in some), len(some))
    reason = "read off their figure, where J falls from 1 at two diameters to 0 at five; the half between is where it is steep"
    judging = seeds_of(rows)
    checks = [
        Check(
            f"J at {width:g} diameters ({_told(where(rows, width=width))})",
            shares[width],
            expected,
            demand,
            reason,
            judging,
        )
        for width, expected, demand in (
            (2.0, "near 1", Demand(0.5)),
            (5.0, "near 0", Demand(high=0.5)),
        )
    ]
    for narrow, wide in ((2.0, 3.0), (3.0, 4.0), (2.0, 4.0), (2.0, 5.0)):
        checks.append(
            Check(
                f"J at {narrow:g} less J at {wide:g} diameters "
                f"({_told(where(rows, width=narrow))}; {_told(where(rows, width=wide))})",
                Apart(shares[narrow], shares[wide]),
                "above 0: J falls with the width",
                Demand(0.0),
                "a direction",
                judging,
            )
        )
    return checks


def _told(rows: Sequence[Row]) -> str:
    """How many jammed, and how many of those before a grain had left."""
    jammed = [row for row in rows if row["jammed"] > 0.5]
    never = sum(row["out"] == 0.0 for row in jammed)
    return f"{len(jammed)} of {len(rows)}, {never or 'none'} of them at once"


def _judge_outflow(rows: Sequence[Row]) -> list[Check]:
    """Grains out by ``fall``, of the same packings: a ratio of means, paired by seeds."""
    out = {fall: [row["out"] for row in where(rows, fall=fall)] for fall in FALLS}
    means = ", ".join(f"{sum(out[fall]) / len(out[fall]):.1f} at {fall:g} R" for fall in FALLS)
    reason = "the outflow of single drains scatters by about as much as it is, so that of 200 pairs a quarter is told for sure"
    return [
        Check(
            f"outflow at fall {fall:g} R over that at {FALLS[1]:g} R ({means})",
            Ratio.of(out[fall], out[FALLS[1]]),
            "1: the same grains leave, however finely the path is cut",
            within(1.0, 0.25),
            reason,
            seeds_of(rows),
        )
        for fall in (FALLS[0], FALLS[2])
    ]


CASES = (
    Case(
        "jamming",
        "Jamming of a two-dimensional hopper",
        "To, Lai and Pak, doi:10.1103/PhysRevLett.86.71: 200 single-sized discs, hopper of half-angle 34°, J(d) falls from 1 to "
        "0 between two and five diameters",
        lambda quick: [
            Job("jamming", (("width", width),), seed)
            for width in WIDTHS
            for seed in seeds(SEEDS, quick)
        ],
        _drain,
        _judge,
        "quasistatic grains have no momentum that could break an arch, and sink as in honey: where J falls may be shifted, the "
        "more so the wider the orifice",
    ),
    Case(
        "outflow",
        "Outflow under gravity, and how finely the path is cut",
        "no closed form: what leaves until an arch forms, 200 single-sized grains, an orifice of 3 diameters",
        lambda quick: [
            Job("outflow", (("width", OUTFLOW_WIDTH), ("fall", fall)), seed)
            for fall in FALLS
            for seed in seeds(DRAINS, quick)
        ],
        _drain,
        _judge_outflow,
    ),
)
