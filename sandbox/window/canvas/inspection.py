"""One grain of a frame, looked at closely: its shape, what pushes it, and whether the forces on it balance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sandbox.session.frame import Frame


@dataclass(frozen=True, slots=True)
class Touch:
    """One contact of the grain."""

    label: int | None  # of the grain on the other side; None: a rigid body
    force: float  # normal, >= 0 [k R]
    x: float  # along the line that the frame draws, away from the grain: its end [R]
    y: float  # [R]


@dataclass(frozen=True, slots=True)
class Inspection:
    """All there is to say about one grain. ``touches`` from the strongest contact to the weakest."""

    index: int  # in the frame
    label: int
    auxetic: bool
    poisson_ratio: float
    x: float  # [R]
    y: float  # [R]
    a: float  # longer semi-axis [R]
    b: float  # shorter semi-axis [R]
    angle: float  # of the longer one from the x axis, 0 to 180 [deg]
    rest_radius: float  # [R]
    area_change: float  # (area now)/(area at rest) − 1
    pressure: float  # [k]
    touches: tuple[Touch, ...]
    unbalanced: float  # magnitude of the sum of all forces [k R]; nan if nobody knows

    @property
    def total_force(self) -> float:
        """Sum of the magnitudes of the contact forces [k R]."""
        return math.fsum(touch.force for touch in self.touches)


def inspect(frame: Frame, label: int) -> Inspection | None:
    """The grain of that label; None if there is none (any more)."""
    found = np.flatnonzero(frame.label == label)
    if not found.size:
        return None
    index = int(found[0])
    p = float(frame.p[index])
    q1, q2 = float(frame.q1[index]), float(frame.q2[index])
    q = math.hypot(q1, q2)
    rest = float(frame.rest_radius[index])
    known = frame.residual_force.shape[0] == frame.grains
    return Inspection(
        index=index,
        label=label,
        auxetic=bool(frame.poisson_ratio[index] < 0.0),
        poisson_ratio=float(frame.poisson_ratio[index]),
        x=float(frame.x[index]),
        y=float(frame.y[index]),
        a=p + q,
        b=p - q,
        angle=math.degrees(0.5 * math.atan2(q2, q1)) % 180.0 if q > 0.0 else 0.0,
        rest_radius=rest,
        area_change=(p * p - q * q) / (rest * rest) - 1.0,
        pressure=float(frame.pressure[index]),
        touches=_touches(frame, index),
        unbalanced=float(frame.residual_force[index]) if known else math.nan,
    )


def _touches(frame: Frame, index: int) -> tuple[Touch, ...]:
    """Contacts of a grain, the strongest first; a contact counts on both its grains."""
    contacts = frame.contacts
    if contacts.i.shape[0] != len(contacts):
        return ()
    touches = []
    for k in np.flatnonzero((contacts.i == index) | (contacts.j == index)):
        first = contacts.i[k] == index
        other = int(contacts.j[k] if first else contacts.i[k])
        end = (contacts.x1[k], contacts.y1[k]) if first else (contacts.x0[k], contacts.y0[k])
        touches.append(
            Touch(
                None if other < 0 else int(frame.label[other]),
                float(contacts.force[k]),
                float(end[0]),
                float(end[1]),
            )
        )
    return tuple(sorted(touches, key=lambda touch: -touch.force))


def grain_at(frame: Frame, x: float, y: float) -> int | None:
    """Label of the grain that covers a place [R], in a periodic cell any of its images; None: there is none."""
    if not frame.grains:
        return None
    dx, dy = x - frame.x, y - frame.y
    if frame.box is not None:
        width, height, shift = frame.box
        if math.isfinite(height):
            rows = np.round(dy / height)
            dx, dy = dx - rows * shift, dy - rows * height
        if math.isfinite(width):
            dx = dx - np.round(dx / width) * width
    with np.errstate(all="ignore"):
        # The ellipse with matrix p + [[q1, q2], [q2, −q1]]: undo it and see if that lies in the unit circle.
        area = frame.p**2 - frame.q1**2 - frame.q2**2
        u = ((frame.p - frame.q1) * dx - frame.q2 * dy) / area
        v = (-frame.q2 * dx + (frame.p + frame.q1) * dy) / area
        inside = u * u + v * v
    inside = np.where(np.isfinite(inside), inside, np.inf)
    nearest = int(np.argmin(inside))
    return int(frame.label[nearest]) if inside[nearest] <= 1.0 else None
