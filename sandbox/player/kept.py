"""What is kept of a frame: all that a page draws and tells, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.lamp import lamp
from sandbox.draw.theme import DARK
from sandbox.draw.views import motion
from sandbox.session.frame import BodyShape, Frame, HandleState
from sandbox.words import words
from sandbox.words.language import in_each

Floats = NDArray[np.float32]
Said = tuple[str, ...]  # the same in every language, in the order of ``language.available``

THERE, POINTED_AT, SQUEEZED = 1, 2, 4  # bits of a grain's marks
LEVELS = (DARK.good, DARK.working, DARK.bad)  # of the lamp

# Rows of ``Kept.grains``.
QUANTITIES = (
    "x",  # centre [R]
    "y",
    "p",  # mean semi-axis [R]
    "q1",  # elongations [R]
    "q2",
    "rest",  # radius with no force on the grain [R]
    "nu",  # Poisson's ratio
    "spin",  # angle turned by [rad]
    "pressure",  # [k]
    "stress",  # difference of the principal stresses [k]
    "motion",  # in the latest increment against the mean of all [R]
    "unbalanced",  # sum of all forces [k R]; not finite where nobody knows
)


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """One packing at one increment: N grains, C contacts, B of them with bodies, which come last."""

    increment: int
    label: NDArray[np.int32]  # (N,)
    grains: Floats  # (len(QUANTITIES), N)
    marks: NDArray[np.uint8]  # (N,)
    pairs: NDArray[np.int32]  # (2, C) labels; −1: a body
    force: Floats  # (C,) normal [k R]
    ends: Floats  # (2, B) where those with bodies touch, from the grain's centre [R]
    bodies: tuple[BodyShape, ...]
    handles: tuple[HandleState, ...]
    box: tuple[float, float, float] | None
    bounds: tuple[float, float, float, float]
    out: int
    level: int  # of the lamp: 0 settled, 1 on the way, 2 not to be believed
    state: Said  # what the lamp says
    notices: tuple[Said, ...]

    @property
    def size(self) -> int:
        """What it weighs against others: grains."""
        return int(self.label.shape[0])


def keep(frame: Frame) -> Kept:
    """What a page needs of a frame. Belongs to the thread that draws, as it speaks every language."""
    none = np.zeros(frame.grains)
    known = frame.residual_force.shape[0] == frame.grains
    rows = (
        *(frame.x, frame.y, frame.p, frame.q1, frame.q2, frame.rest_radius, frame.poisson_ratio),
        none if frame.spin is None else frame.spin,
        *(frame.pressure, frame.stress_difference, motion(frame)),
        frame.residual_force if known else none * np.nan,
    )
    grains = np.array(rows, dtype=np.float32)
    finite = np.isfinite(grains[:5]).all(axis=0)  # what is no place is not drawn
    marks = THERE * finite.astype(np.uint8) + SQUEEZED * frame.squeezed.astype(np.uint8)
    if frame.highlight is not None:
        marks += POINTED_AT * frame.highlight.astype(np.uint8)
    pairs, force, ends = _contacts(frame)
    state = lamp(frame, DARK)
    return Kept(
        increment=frame.increment,
        label=frame.label.astype(np.int32),
        grains=grains,
        marks=marks,
        pairs=pairs,
        force=force,
        ends=ends,
        bodies=frame.bodies,
        handles=frame.handles,
        box=frame.box,
        bounds=frame.bounds,
        out=frame.grains_out,
        level=LEVELS.index(state.colour),
        state=in_each(lambda: lamp(frame, DARK).words),
        notices=tuple(_said(notice) for notice in frame.notices),
    )


def _said(notice: str) -> Said:
    return in_each(lambda: words.say(notice))


def _contacts(frame: Frame) -> tuple[NDArray[np.int32], Floats, Floats]:
    """Pairs of labels (2, C), forces (C,), and ends (2, B) of those with bodies; nothing where nobody knows the grains."""
    contacts = frame.contacts
    if contacts.i.shape[0] != len(contacts):
        return np.empty((2, 0), np.int32), np.empty(0, np.float32), np.empty((2, 0), np.float32)
    order = np.flatnonzero(np.isfinite(contacts.force) & (contacts.force > 0.0))
    order = order[np.argsort(contacts.rigid[order], kind="stable")]
    i, rigid = contacts.i[order], contacts.rigid[order]
    other = np.where(rigid, -1, frame.label[np.maximum(contacts.j[order], 0)])
    pairs = np.array([frame.label[i], other], dtype=np.int32)
    ends = np.array([contacts.x1 - contacts.x0, contacts.y1 - contacts.y0])[:, order[rigid]]
    return pairs, contacts.force[order].astype(np.float32), ends.astype(np.float32)
