"""One grain between two plates and between four: the linear response, for the paper's five materials."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core import material
from core.packing import Packing
from core.quasistatic import Quasistatic
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from sandbox.ensemble.estimates import Exact
from sandbox.studies.classics.apparatus import increment
from sandbox.studies.classics.case import Asking, Case, Check, Job, Numbers, Row, within

LAMBDAS, MU = (0.01, 0.1, 1.0, 10.0, 100.0), 0.1  # of the paper
STRAIN = 1e-4  # the response is linear to within about as much
SOURCE = (
    "closed form: the energy of one grain minimised by hand; Haver et al., doi:10.1073/pnas.2317915121, appendix “Single "
    "Particle Compression”"
)


def _squeeze(job: Job, check: Asking) -> Numbers:
    """Force on one plate over the approach of two [k], and the ratio of the axes' strains."""
    nu, stiffness = map(float, material.from_paper(job.of("lambda"), MU))
    gap = 1.0 - STRAIN
    sides = [(0.0, -gap), (0.0, gap), (-gap, 0.0), (gap, 0.0)][: int(job.of("plates"))]
    plates = [
        RigidBody(f"plate {k}", position=at, segments=[(-3.0, 0.0, 3.0, 0.0, 0.0)])
        for k, at in enumerate(sides)
    ]
    for body in plates[2:]:
        body.angle = 0.5 * math.pi
    packing = Packing([0.0], [0.0], 1.0, nu, stiffness)
    careful = Settings(0.05, 1e-8, force_floor=1e-12, max_iterations=100_000)
    done = increment(Quasistatic(System(packing, RigidWorld(plates), careful)), check=check)
    height, width = float(packing.p[0] - packing.q1[0]), float(packing.p[0] + packing.q1[0])
    return {
        "stiffness": float(done.reactions[1, 1]) / (2.0 * STRAIN),
        "strains": -(width - 1.0) / (height - 1.0),
    }


def from_all_sides(lam: float) -> float:
    """C K/(2(2C + K)) with K = κ(1+ν) [k]: minimise 4·C/2 (δ − e)² + K e² over the strain e; the force is C (δ − e)."""
    nu, stiffness = map(float, material.from_paper(lam, MU))
    modulus = float(material.area_modulus(nu, stiffness))
    return stiffness * modulus / (2.0 * (2.0 * stiffness + modulus))


def _judge(rows: Sequence[Row]) -> list[Check]:
    checks = []
    reason = f"the next term is of the order of the strain, {STRAIN:g}"
    for row in rows:
        lam = row.job.of("lambda")
        if row.job.of("plates") == 2.0:
            nu = (lam - 1.0) / (lam + 1.0)
            checks += [
                Check(
                    f"force over approach of two plates [k], λ = {lam:g}",
                    Exact(row["stiffness"]),
                    "1",
                    within(1.0, 3.0 * STRAIN),
                    reason,
                ),
                Check(
                    f"ratio of strains between two plates, λ = {lam:g}",
                    Exact(row["strains"]),
                    f"(λ − 1)/(λ + 1) = {nu:.4f}",
                    within(nu, 3.0 * STRAIN),
                    reason,
                ),
            ]
        else:
            closed = from_all_sides(lam)
            checks.append(
                Check(
                    f"force over approach of four plates, over C K/(2(2C + K)), λ = {lam:g}",
                    Exact(row["stiffness"] / closed),
                    f"1 (of {closed:.4g} k)",
                    within(1.0, 3.0 * STRAIN),
                    reason,
                )
            )
    return checks


CASES = (
    Case(
        "plates",
        "A grain between two plates, and between four",
        SOURCE,
        lambda _: [
            Job("plates", (("lambda", lam), ("plates", plates)))
            for plates in (2.0, 4.0)
            for lam in LAMBDAS
        ],
        _squeeze,
        _judge,
    ),
)
