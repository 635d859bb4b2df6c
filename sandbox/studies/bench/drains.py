"""What a run of a sweep costs: a drain that clogs, one that runs empty, a push; kernels compiled and modules imported before."""

from __future__ import annotations

from typing import Any

from sandbox.studies.bench.report import Row, Section
from sandbox.sweep.asking import ask
from sandbox.sweep.outcome import carry_out
from sandbox.sweep.request import Request
from sandbox.sweep.sweep import compile_all, sorts

STILL = {"shake": 0.0}
CLOGS = ("drain that clogs", ask("gravity_hopper", [], "regular", "1", STILL))
OTHERS = (
    ("drain that runs empty", ask("gravity_hopper", [], "auxetic", "1", {**STILL, "orifice": 5.0})),
    ("push through the hopper", ask("hopper", [], "mixed", "1", {})),
)


def section(*, quick: bool) -> Section:
    """One run of each sort; with ``quick`` the shortest."""
    found = [measure(*case) for case in ((CLOGS,) if quick else (CLOGS, *OTHERS))]
    return Section(
        "drains", "Runs of a sweep, on one core", tuple(map(row_of, found)), {"runs": found}
    )


def measure(what: str, request: Request) -> dict[str, Any]:
    """The numbers of its first run."""
    job = request.job(1)
    compile_all(sorts([job]))
    run = carry_out(job).run
    names = ("outcome", "initial", "out", "increments", "seconds")
    return {"what": what, "scene": job.scene, "packing": job.packing, **{n: run[n] for n in names}}


def row_of(found: dict[str, Any]) -> Row:
    """What is shown of it."""
    each = 1e3 * found["seconds"] / max(found["increments"], 1)
    measured = (
        f"{found['seconds']:.1f} s: {found['increments']} increments of {each:.1f} ms, {found['out']} of "
        f"{found['initial']} grains out, {found['outcome']}"
    )
    return Row(f"{found['what']}, {found['initial']} grains, {found['packing']}", measured)
