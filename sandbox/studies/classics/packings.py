"""Frictionless packings in a periodic box: the onset of rigidity, and the curvature of the energy at a minimum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core import generate, observables
from core.arrays import Floats
from core.packing import Packing
from core.relaxation import Relaxation
from sandbox.ensemble.estimates import Exact, Student
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

# Onset of rigidity.

COUNT = 256
SEEDS = 16
KINDS = (-0.8, 0.0, 0.8)  # Poisson's ratios
PRESSURES = (2.5e-4, 5e-4, 1e-3, 2e-3)  # [k]


def _onset(job: Job, check: Asking) -> Numbers:
    """Packing fraction, linear in the pressure, and contacts a grain, linear in its root, extrapolated to none."""
    recipe = generate.Recipe(kind="regular", regular_poisson_ratio=job.of("poisson_ratio"))
    phi, z = [], []
    for pressure in PRESSURES:
        check()
        packing = generate.pack(
            recipe,
            seed=job.seed,
            count=int(job.of("grains")),
            target_pressure=pressure,
            tolerance=1e-4,
        )
        assert packing.box is not None
        contacts = observables.grain_contacts(packing)
        phi.append(observables.packing_fraction(packing, packing.box.area))
        z.append(observables.coordination(packing, contacts)[1])
    return {
        "packing_fraction": float(np.polyfit(PRESSURES, phi, 1)[1]),
        "contacts": float(np.polyfit(np.sqrt(PRESSURES), z, 1)[1]),
    }


def _judge_onset(rows: Sequence[Row]) -> list[Check]:
    checks = []
    for nu in KINDS:
        some = where(rows, poisson_ratio=nu)
        for name, what, expected, tolerance, reason in (
            (
                "packing_fraction",
                "packing fraction",
                0.84,
                0.01,
                "0.842 in large packings (O'Hern et al.), lower by 0.16 N^(−0.55) = 0.008 in packings of 256",
            ),
            (
                "contacts",
                "contacts a grain, rattlers left out",
                4.0,
                0.05,
                "isostatic packings of N discs have 4 − 2/N; the next term of the extrapolation, in P, is a few hundredths",
            ),
        ):
            checks.append(
                Check(
                    f"{what} at no pressure, ν = {nu:g}",
                    Student.mean([row[name] for row in some]),
                    f"{expected:g}",
                    within(expected, tolerance),
                    reason,
                    seeds_of(some),
                )
            )
    return checks


# Curvature of the energy.

FEW = 40  # grains
PRESSURE = 0.02  # [k]
STRETCH = 1e-6  # [R] of the differences
ZERO = 1e-6  # of the largest eigenvalue: less is none


def backbone(packing: Packing) -> Packing:
    """The packing without its rattlers, which have nothing that holds them."""
    while True:
        contacts = observables.grain_contacts(packing)
        touching = np.bincount(np.concatenate([contacts.i, contacts.j]), minlength=len(packing))
        keep = touching >= 3
        if keep.all():
            return packing
        packing = packing.select(keep)


def hessian(packing: Packing) -> Floats:
    """Second derivatives of the energy by all 5 N coordinates, from central differences of the forces."""
    count = len(packing)
    columns = []
    state = packing.state.copy()
    for row in range(5):
        for k in range(count):
            sides = []
            for sign in (1.0, -1.0):
                moved = packing.copy()
                moved.state[:] = state
                moved.state[row, k] += sign * STRETCH
                relaxation = Relaxation(moved)
                relaxation.run(1)
                sides.append(relaxation.forces().reshape(-1))
            columns.append((sides[1] - sides[0]) / (2.0 * STRETCH))
    matrix = np.array(columns)
    whole: Floats = 0.5 * (matrix + matrix.T)
    return whole


def _curvature(job: Job, check: Asking) -> Numbers:
    """Eigenvalues below nothing, and about nothing, of a relaxed packing."""
    recipe = generate.Recipe(kind="mixed")
    packing = backbone(
        generate.pack(recipe, seed=job.seed, count=FEW, target_pressure=PRESSURE, tolerance=1e-6)
    )
    check()
    relaxation = Relaxation(packing, tolerance=1e-11, force_floor=1e-9, max_iterations=200_000)
    relaxation.run(200_000)
    relaxation.write_back()
    values = np.linalg.eigvalsh(hessian(packing))
    largest = float(values[-1])
    return {
        "negative": float(np.sum(values < -ZERO * largest)),
        "zero": float(np.sum(np.abs(values) <= ZERO * largest)),
        "grains": float(len(packing)),
        "least_positive": float(values[values > ZERO * largest][0]),
    }


def _judge_curvature(rows: Sequence[Row]) -> list[Check]:
    reason = (
        f"counted: eigenvalues within {ZERO:g} of the largest are none, as far as differences tell"
    )
    return [
        Check(
            "largest number of negative modes in a packing",
            Exact(max(row["negative"] for row in rows)),
            "0",
            within(0.0, 0.5),
            reason,
            seeds_of(rows),
        ),
        *(
            Check(
                f"{which} number of modes without a force",
                Exact(pick(row["zero"] for row in rows)),
                "2: the packing as a whole goes along x, and along y",
                within(2.0, 0.5),
                reason,
                seeds_of(rows),
            )
            for which, pick in (("least", min), ("largest", max))
        ),
    ]


CASES = (
    Case(
        "onset",
        "Onset of rigidity of frictionless packings",
        "O'Hern, Silbert, Liu and Nagel, doi:10.1103/PhysRevE.68.011306; at no pressure every grain is a disc, whatever its "
        "Poisson's ratio",
        lambda quick: [
            Job("onset", (("poisson_ratio", nu), ("grains", 64.0 if quick else COUNT)), seed)
            for nu in KINDS
            for seed in seeds(SEEDS, quick)
        ],
        _onset,
        _judge_onset,
    ),
    Case(
        "minimum",
        "Curvature of the energy where a packing has come to rest",
        "a minimum has no negative mode, and a rigid packing in a periodic box can be shifted as a whole only",
        lambda quick: [Job("minimum", seed=seed) for seed in seeds(12, quick)],
        _curvature,
        _judge_curvature,
    ),
)
