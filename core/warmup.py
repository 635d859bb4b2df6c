"""Compile, or load from the cache, every kernel that a scene will need, and say how far that is.

Left alone, the kernels would compile inside the first relaxation: the same wait, without a word about it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core import contacts, fire, kernel_cache, neighbors, observables, rigid_contacts
from core.arrays import Floats
from core.friction import Friction
from core.frictional_contacts import Origin
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation


def compile_kernels(
    *,
    periodic: bool,
    rigid: bool,
    friction: bool,
    gravity: bool,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Compile for a scene with these terms. ``progress`` is told the share done, from small kernels to the one that holds all."""
    box = PeriodicBox(40.0, 40.0) if periodic else None
    packing = Packing([0.0, 1.9, 3.8], [0.0, 0.1, 0.0], box=box)
    rows = np.array([[rigid_contacts.EDGE, -5.0, -0.95, 1.0, 0.0, 9.0, -0.95, 0.0]])
    primitives = rows if rigid else np.zeros((0, rigid_contacts.COLUMNS))
    origin = _origin(packing, primitives) if friction else None
    relaxation = Relaxation(
        packing,
        primitives,
        origin,
        (0.0, -1e-3) if gravity else None,
        tolerance=0.5,
        max_iterations=10,
    )
    m, form, body = relaxation._minimizer, relaxation._box, relaxation._rigid
    weight = relaxation._weight
    steps: list[tuple[float, Callable[[], object]]] = [
        (0.13, lambda: neighbors.find_pairs(m.state, 0.1, m.lists, form)),
        (0.10, relaxation._relist),
        (0.15, lambda: _contact_forces(m, form)),
        (0.15, lambda: fire.evaluate(m, form, body, relaxation.friction_terms, weight, None)),
        (0.10, lambda: fire.mean_contact_force(m, form, body)),
        (0.20, lambda: relaxation.run(10)),
        (0.01, relaxation.gone_through),
        (0.01, lambda: relaxation.slips() if friction else None),
        (0.08, lambda: observables.grain_contacts(packing)),
        (0.07, lambda: observables.body_contacts(packing, primitives)),
    ]
    done = 0.0
    for share, step in steps:
        step()
        done += share
        if progress is not None:
            progress(min(done, 1.0))
    kernel_cache.prune()


def _origin(packing: Packing, primitives: Floats) -> Origin:
    """Of an increment in which nothing moves."""
    owner, still = np.zeros(len(primitives), dtype=np.int64), np.zeros((1, 3))
    return Friction(0.5, len(packing)).begin(packing, primitives, owner, still, still)


def _contact_forces(m: fire.Minimizer, box: tuple[float, ...] | None) -> None:
    """Those between grains alone."""
    rows, lists = m.force, m.lists
    contacts.prepare(*m.state[2:5], *m.support, *rows[:5])
    slots = lists.width, lists.offset, lists.neighbor, lists.stiffness
    contacts.add_contact_forces(0, rows.shape[1], m.state, m.support, rows, *slots, box, None)
