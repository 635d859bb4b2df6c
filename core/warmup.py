"""Compile, or load from the cache, every kernel that a scene will need, and say how far that is.

Left alone, the kernels would compile inside the first relaxation: the same wait, without a word about it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core import contacts, fire, neighbors, observables, rigid_contacts
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation


def compile_kernels(
    box: PeriodicBox | None, rigid: bool, progress: Callable[[float], None] | None = None
) -> None:
    """Compile for a scene with these terms. ``progress`` is told the share done, from small kernels to the one that holds all."""
    packing = Packing(
        [0.0, 1.9, 3.8],
        [0.0, 0.1, 0.0],
        box=box and PeriodicBox(40.0, 40.0 if np.isfinite(box.height) else box.height),
    )
    primitives = (
        np.array([[rigid_contacts.EDGE, -5.0, -0.95, 1.0, 0.0, 9.0, -0.95, 0.0]]) if rigid else None
    )
    relaxation = Relaxation(packing, primitives, tolerance=0.5, max_iterations=10)
    m, form, term = relaxation._minimizer, relaxation._box, relaxation._rigid

    def forces() -> None:
        rows = m.force
        contacts.prepare(*m.state[2:], *m.support, *rows)
        lists = m.lists
        contacts.add_contact_forces(
            m.state,
            m.support,
            rows,
            lists.width,
            lists.offset,
            lists.neighbor,
            lists.stiffness,
            form,
        )

    steps: list[tuple[float, Callable[[], object]]] = [
        (0.13, lambda: neighbors.find_pairs(m.state, 0.1, m.lists, form)),
        (0.10, lambda: fire.relist(m, form, term, 0.1)),
        (0.15, forces),
        (0.15, lambda: fire.evaluate(m, form, term)),
        (0.10, lambda: fire.mean_contact_force(m, form, term)),
        (0.22, lambda: relaxation.run(10)),
        (0.08, lambda: observables.grain_contacts(packing)),
        (
            0.07,
            lambda: None if primitives is None else observables.body_contacts(packing, primitives),
        ),
    ]
    done = 0.0
    for share, step in steps:
        step()
        done += share
        if progress is not None:
            progress(min(done, 1.0))
