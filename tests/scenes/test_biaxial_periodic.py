"""A shrinking periodic box: pressure and coordination against volumetric strain (Fig. 2d and appendix of the paper)."""

from __future__ import annotations

import numpy as np
import pytest

from core import observables
from sandbox.session.commands import Grab, Move, Protocol
from sandbox.session.session import Session


def squeeze(kind: str, grains: int = 200) -> np.ndarray:
    """Rows of (−ε_v, pressure [k], Z without rattlers)."""
    session = Session("biaxial_periodic", kind, 2, {"grains": grains, "strain": 0.06})
    session.build()
    session.submit(Protocol(True))
    rows = []
    while True:
        row = session.history[-1]
        packing = session.run.setup.packing
        contacts = observables.grain_contacts(packing)
        rows.append((row.stroke, row.resisting, observables.coordination(packing, contacts)[1]))
        while not session.advance(20_000):
            if session.idle:
                assert all(check.holds for check in session.checks())
                return np.array(rows)


def finish(session: Session) -> None:
    """Until there is nothing left to do."""
    while not session.idle:
        session.advance(20_000)


def test_auxetic_packings_are_softer_and_better_connected() -> None:
    """Measured with 500 grains, seed 1: P at −ε_v = 0.06 is 0.082 / 0.015 k, Z there 5.06 / 4.58, Z at P = 0.01 4.41 / 4.47."""
    regular, auxetic = squeeze("regular"), squeeze("auxetic")
    for rows in (regular, auxetic):
        assert rows[0, 1] == pytest.approx(5e-4, rel=0.02)  # it starts at the onset
        assert rows[0, 2] == pytest.approx(4.0, abs=0.2)  # where grains are discs, whatever ν
        assert rows[-1, 0] == pytest.approx(0.06, abs=1e-6)
    at = 0.05
    stiff, soft = (np.interp(at, r[:, 0], r[:, 1]) for r in (regular, auxetic))
    assert stiff > 3.0 * soft
    assert np.interp(at, regular[:, 0], regular[:, 2]) > np.interp(at, auxetic[:, 0], auxetic[:, 2])
    assert np.interp(0.012, regular[:, 1], regular[:, 2]) < np.interp(
        0.012, auxetic[:, 1], auxetic[:, 2]
    )


def test_a_hand_shrinks_the_box_and_cannot_make_it_larger_than_at_the_start() -> None:
    session = Session("biaxial_periodic", "mixed", 1, {"grains": 80})
    session.build()
    box = session.run.setup.packing.box
    assert box is not None
    side = box.width
    session.submit(Grab("box"))
    session.submit(Move("box", side - 0.3, side - 0.1))
    finish(session)
    box = session.run.setup.packing.box
    assert box is not None
    assert box.width == box.height == pytest.approx(side - 0.2)
    handle = session.frame().handles[0]
    assert (handle.x, handle.y) == (box.width, box.height)
    session.submit(Move("box", side + 9.0, side + 9.0))
    finish(session)
    box = session.run.setup.packing.box
    assert box is not None
    assert box.width == pytest.approx(side)
