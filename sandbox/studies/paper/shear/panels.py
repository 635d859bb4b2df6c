"""Figures of a quantity against the packing fraction and against the pressure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.arrays import Floats
from sandbox.studies.paper.claims import Line, Panel, over_seeds, where
from sandbox.studies.paper.conditions import colour, dashed, label, lambdas, of_lam
from sandbox.studies.paper.runs import Result
from sandbox.studies.paper.shear.cell import POSITIVE, judged, pressure
from sandbox.studies.paper.shear.confinement import Value


def against_pressure(
    results: Sequence[Result], lam: float, value: Value
) -> tuple[Floats, Floats, Floats]:
    """Pressure, value, and spread of the value over seeds, one a packing fraction, in the order of pressure."""
    mine = [r for r in of_lam(results, lam) if pressure(r) > POSITIVE]
    rows = []
    for fraction in sorted({r.request.of("packing_fraction") for r in mine}):
        here = where(mine, packing_fraction=fraction)
        values = [value(result) for result in here]
        rows.append((np.mean([pressure(r) for r in here]), np.mean(values), np.std(values)))
    table = np.array(sorted(rows), dtype=np.float64).reshape(-1, 3)
    return table[:, 0], table[:, 1], table[:, 2]


def against_confinement(results: Sequence[Result], value: Value, name: str) -> list[Panel]:
    """Against the packing fraction and against the pressure."""
    results = judged(results)
    volume, force = [], []
    for lam in lambdas(results):
        mine = of_lam(results, lam)
        fractions = sorted({float(r.request.of("packing_fraction")) for r in mine})
        values = [over_seeds(where(mine, packing_fraction=f), value) for f in fractions]
        means = np.array([np.mean(v) for v in values])
        spreads = np.array([np.std(v) for v in values])
        volume.append(
            Line(
                label(lam),
                colour(lam),
                np.array(fractions),
                means,
                spreads,
                points=True,
                dashed=dashed(lam),
            )
        )
        place, mean, spread = against_pressure(results, lam, value)
        force.append(
            Line(label(lam), colour(lam), place, mean, spread, points=True, dashed=dashed(lam))
        )
    return [
        Panel("At equal volume", "packing fraction", name, tuple(volume)),
        Panel("At equal pressure", "normal stress P [k]", name, tuple(force), log_x=True),
    ]
