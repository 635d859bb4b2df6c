"""The V-shaped press: pressure rises much slower in auxetic packings (Fig. 2 of the paper)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.session.commands import Grab, Move, Protocol
from sandbox.session.session import Session

KINDS = ("regular", "mixed", "auxetic")


def press(kind: str, seed: int, **settings: object) -> Session:
    """A press at the end of its scripted drive; every claim of it holds."""
    session = Session("biaxial_press", kind, seed, settings)
    session.build()
    session.submit(Protocol(True))
    while not session.idle:
        session.advance(20_000)
    assert all(check.holds for check in session.checks())
    return session


@pytest.mark.parametrize("seed", [1, 2])
def test_auxetic_packings_are_more_compressible(seed: int) -> None:
    """Same seed, same places, same strain. Measured over seeds 1 to 3: regular over auxetic 4.8 … 5.6 at 10 % less area and
    6.1 … 6.5 at 15 %; the mixed packing between the two. Nothing pushes before the lid moves."""
    pressure = {}
    for kind in KINDS:
        less_area, curve = press(kind, seed).history.curve
        assert abs(curve[0]) < 1e-3
        pressure[kind] = np.interp([10.0, 15.0], less_area, curve)
    ratio = pressure["regular"] / pressure["auxetic"]
    assert ratio[0] > 3.5
    assert ratio[1] > 4.5
    assert np.all(pressure["regular"] > pressure["mixed"])
    assert np.all(pressure["mixed"] > pressure["auxetic"])


def test_pressure_and_strain_are_what_they_say() -> None:
    """From the bare forces on lid and grains, by the geometry of a square on its corner."""
    session = press("regular", 3, grains=40, tolerance=1e-4)
    frame, last = session.frame(), session.history[-1]
    side = math.sqrt(40 * math.pi * 0.5 * (1.0 + 1.0 / 1.4**2) / 0.78)
    down = -frame.handles[0].fy
    lid = next(body for body in frame.bodies if body.name == "lid")
    apex = max(lid.segments[:, 1].max(), lid.segments[:, 3].max()) - math.sqrt(2.0) * 0.4
    moved = math.sqrt(2.0) * side - apex
    now = side - moved / math.sqrt(2.0)
    assert last.stroke == pytest.approx(100.0 * (1.0 - (now / side) ** 2), rel=1e-9)
    assert last.resisting == pytest.approx(down / (math.sqrt(2.0) * now), rel=1e-9)
    # The mean over grains, by the virial: both faces feel the pressure that the grains have inside, the rims apart.
    contacts = frame.contacts
    length = np.hypot(contacts.x1 - contacts.x0, contacts.y1 - contacts.y0)
    inside = 0.5 * float(np.sum(contacts.force * length)) / now**2
    assert last.resisting == pytest.approx(inside, rel=0.1)


def test_the_lid_only_goes_down_and_stays_above_the_floor() -> None:
    session = Session("biaxial_press", "auxetic", 1, {"grains": 20, "step": 0.15})
    session.build()
    lid = session.frame().handles[0]
    session.submit(Grab("lid"))
    for target in (lid.y + 5.0, lid.y - 100.0):
        session.submit(Move("lid", 0.0, target))
        session.advance(1)
        while not session.idle:
            session.advance(20_000)
        assert any("end of travel" in notice for notice in session.frame().notices) or target < 0.0
    assert session.frame().handles[0].y > 0.3 * lid.y
    assert not [c for c in session.checks() if c.holds is False and "sinks" not in c.name]
