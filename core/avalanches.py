"""Avalanches of a sheared packing: sudden drops of the stress, and which contacts and grains take part.

Haver et al., doi:10.1073/pnas.2317915121, Fig. 5: the inverse participation ratio and the changes of the contact forces in an
avalanche, in packings under equal pressure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.arrays import Floats, Indices
from core.observables import GrainContacts

_GRAIN = 2**31


@dataclass(frozen=True)
class ForceChanges:
    """Change of the normal force of every contact that exists before, after or both, (K,) each."""

    i: Indices  # labels of the two grains
    j: Indices
    change: Floats  # Δf_c = after − before [k R]; a contact that is not there carries 0


def stress_drops(stress: Floats, least: float) -> tuple[Indices, Floats]:
    """Where a stress (M,) [k] falls by more than ``least`` [k] from one increment to the next, and by how much [k].

    The places are those of the increments in which it falls: stress[place − 1] → stress[place].
    """
    fall = -np.diff(np.asarray(stress, dtype=np.float64))
    places = np.flatnonzero(fall > least)
    return places + 1, fall[places]


def force_changes(
    before: GrainContacts, after: GrainContacts, label_before: Indices, label_after: Indices
) -> ForceChanges:
    """Δf_c [k R] between two increments. Contacts are matched by the labels (N,) of their grains, which outlive renumbering."""
    keys = np.concatenate([_keys(before, label_before), _keys(after, label_after)])
    forces = np.concatenate([-before.normal_force, after.normal_force])
    pairs, place = np.unique(keys, return_inverse=True)
    change = np.zeros(len(pairs))
    np.add.at(change, place, forces)
    return ForceChanges(pairs // _GRAIN, pairs % _GRAIN, change)


def weights(changes: ForceChanges, label: Indices) -> Floats:
    """How much each grain takes part, (N,) [k² R²]: sum of Δf_c² over its contacts, in the order of ``label`` (N,)."""
    order = np.argsort(label)
    total = np.zeros(len(label))
    if not len(label):
        return total
    for side in (changes.i, changes.j):
        place = np.minimum(np.searchsorted(label, side, sorter=order), len(label) - 1)
        grain = order[place]
        known = label[grain] == side  # a grain that has left takes part no more
        np.add.at(total, grain[known], changes.change[known] ** 2)
    return total


def participation(weight: Floats) -> float:
    """Inverse participation ratio (Σ w)² / (N Σ w²) of weights (N,): 1 = all grains alike take part, 1/N = one alone does.

    0 where none takes part.
    """
    w = np.asarray(weight, dtype=np.float64)
    largest = float(w.max(initial=0.0))
    if largest <= 0.0:
        return 0.0
    w = w / largest  # else squares of small changes could vanish
    return float(np.sum(w) ** 2 / (len(w) * np.sum(w * w)))


def _keys(contacts: GrainContacts, label: Indices) -> Indices:
    a, b = label[contacts.i], label[contacts.j]
    keys: Indices = np.minimum(a, b) * _GRAIN + np.maximum(a, b)
    return keys
