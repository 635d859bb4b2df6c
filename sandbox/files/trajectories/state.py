"""What a trajectory has of each moment: a frame, the forces of its contacts, and the row of the table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.arrays import Floats
from sandbox.session.forces import ContactForces
from sandbox.session.frame import Frame
from sandbox.session.history import Row
from sandbox.session.session import Session


@dataclass(frozen=True)
class State:
    """A moment between two increments."""

    frame: Frame
    forces: ContactForces
    row: Row

    @classmethod
    def of(cls, session: Session) -> State:
        """Where a session stands."""
        return cls(session.frame(), session.contact_forces(), session.history[-1])

    @property
    def axes(self) -> Floats:
        """Semi-axes of every grain, the long one first, (2, N) [R]."""
        frame = self.frame
        size = np.hypot(frame.q1, frame.q2)
        return np.array([frame.p + size, frame.p - size])

    @property
    def angle(self) -> Floats:
        """Of the long axis from x, (N,) [rad]."""
        return 0.5 * np.arctan2(self.frame.q2, self.frame.q1)

    @property
    def spin(self) -> Floats:
        """The angle that every grain has turned by, (N,) [rad]; 0 without friction."""
        return np.zeros(self.frame.grains) if self.frame.spin is None else self.frame.spin
