"""Sessions to be edited, commands carried out to their end, and what must hold whatever is edited."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.generate import inside
from sandbox.session import free_room as room
from sandbox.session.commands import (
    Command,
    Edit,
)
from sandbox.session.editing import WALL, line_of
from sandbox.session.session import Session

DENSE: dict[str, Any] = {"grains": 120, "intruder_radius": 2.0}


def built(scene: str = "workshop", packing: str = "mixed", **values: Any) -> Session:
    session = Session(scene, packing, 1, values)
    session.build()
    return session


def empty(**values: Any) -> Session:
    return built(grains=0, **values)


def do(session: Session, *commands: Command) -> None:
    """Each of them, and what it takes to relax."""
    for command in commands:
        session.submit(command)
        session.advance(100_000)
        while session.busy:
            session.advance(100_000)


def assert_refused(session: Session, command: Edit, why: str) -> None:
    """Nothing changes, nothing is logged, and one plain sentence says why."""
    before, refusals = session.state_hash(), session.frame().refusals
    logged = len(session.log().commands)
    session.submit(command)
    session.settle()
    frame = session.frame()
    assert frame.refusals == refusals + 1
    assert why in frame.refusal
    assert frame.refusal in frame.notices
    assert session.state_hash() == before
    assert len(session.log().commands) == logged


def assert_whole(session: Session) -> None:
    """Finite, counted, inside, and on one side of each wall."""
    setup, frame = session.run.setup, session.frame()
    packing = setup.packing
    packing.validate()
    assert frame.grains == len(packing) == len(frame.residual_force) == frame.motion.shape[1]
    assert np.all(packing.semi_axes[1] > 0.0)
    assert np.all(inside(setup.outline, packing.x, packing.y))
    for wall in setup.world.drawn:
        line = line_of(wall)
        path = line if len(line) > 1 else (line[0], (line[0][0] + 1e-6, line[0][1]))
        assert np.all(room.from_line(packing.x, packing.y, path)[0] > 0.5 * WALL)
    if session.run.engine.friction is not None:
        assert len(session.run.engine.friction.spin) == len(packing)
    assert all(check.holds is not False for check in session.checks()[:2])
