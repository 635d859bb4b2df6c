"""The Poisson effect: a row of regular grains pushes its walls apart, a row of auxetic grains draws back."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes.grain_row import expected_slope


def squeeze(kind: str, **settings: object) -> Session:
    """A row at the end of its scripted drive; no claim of it fails."""
    session = Session("grain_row", kind, 1, settings)
    session.build()
    session.submit(Protocol(True))
    while not session.idle:
        session.advance(20_000)
    assert not [check for check in session.checks() if check.holds is False]
    return session


@pytest.mark.parametrize("count", [1, 2, 7])
@pytest.mark.parametrize(("nu", "stiffness"), [(0.8, 50.0), (0.3, 50.0), (0.8, 500.0)])
def test_regular_grains_push_from_the_start(nu: float, stiffness: float, count: int) -> None:
    """Sideways force over approach as by hand; the next term is of the order of strain/(1 − ν²)."""
    strain = 2e-4
    session = squeeze(
        "regular",
        grains=count,
        regular_poisson_ratio=nu,
        contact_stiffness=stiffness,
        compression=1e-3,
        step=2.0 * strain,
        tolerance=1e-8,
    )
    force = session.history.column("resisting")
    slope = force[1] / (2.0 * strain)
    expected = expected_slope(nu, stiffness, count)
    assert slope == pytest.approx(expected, rel=3.0 * strain / (1.0 - nu**2))
    assert np.all(np.diff(force) > 0.0)


def test_hard_contacts_and_a_long_row() -> None:
    """C → ∞: a sheet that cannot widen, F_x = ν F_y and F_y = k δ/(1 − ν²)."""
    assert expected_slope(0.8, 1e9, 1000) == pytest.approx(0.8 / (1.0 - 0.64), rel=1e-8)


def test_auxetic_grains_make_room() -> None:
    """No sideways force at all, and gaps as wide as Poisson's ratio says: N × 2R × ν × strain, near enough at small strain."""
    session = squeeze("auxetic", compression=0.01, step=0.002)
    assert np.all(session.history.column("resisting") == 0.0)
    frame = session.frame()
    assert bool(frame.contacts.rigid.all())
    room = 14.0 - 2.0 * float(np.sum(frame.p + frame.q1))
    # The grains take the share 1 − 2/C of the approach.
    assert room == pytest.approx(14.0 * 0.8 * 0.01 * 0.96, rel=0.02)
    assert any("room" in notice for notice in frame.notices)


def test_mixed_rows_push_less() -> None:
    """Regular ≫ mixed > auxetic = 0 at equal compression."""
    force = {
        kind: squeeze(kind, auxetic_fraction=0.3).history[-1].resisting
        for kind in ("regular", "mixed", "auxetic")
    }
    assert force["regular"] > 1.5 * force["mixed"] > 0.0
    assert force["auxetic"] == 0.0


def test_a_gap_must_close_first() -> None:
    """With room between them regular grains begin to push when they have filled it."""
    session = squeeze("regular", gap=0.05)
    force = session.history.column("resisting")
    began = np.flatnonzero(force > 0.0)
    assert 0 < began[0] < len(force) - 1
    assert np.all(force[: began[0]] == 0.0)


def test_friction_shares_the_load() -> None:
    """With friction floor and piston hold part of the sideways force."""
    smooth, rough = (
        squeeze("regular", friction=f, tolerance=1e-3).history[-1].resisting for f in (0.0, 0.5)
    )
    assert 0.0 < rough < smooth
