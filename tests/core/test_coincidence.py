"""Grains that stand at one place are parted, always the same way; a grain in the middle of a disc is pushed out."""

from __future__ import annotations

import numpy as np
import pytest

from core import observables
from core.coincidence import NUDGE, part_coincident
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System

BOX = PeriodicBox(12.0, 12.0)


def relaxed(packing: Packing, friction: float = 0.0, times: int = 2) -> Quasistatic:
    rubbing = Friction(friction, len(packing)) if friction else None
    engine = Quasistatic(System(packing, RigidWorld(), Settings(tolerance=1e-4), rubbing))
    for _ in range(times):
        engine.begin({})
        done = engine.relax(10_000)
        assert done is not None
        assert done.report.reason is StopReason.CONVERGED
    return engine


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize(
    "places",
    [[(3.0, 3.0)] * 2, [(3.0, 3.0)] * 7, [(0.0, 3.0), (12.0, 3.0)], [(3.0, 12.0), (3.0, 0.0)]],
    ids=["two", "seven", "image beside", "image above"],
)
def test_they_part_until_they_hardly_touch(
    places: list[tuple[float, float]], friction: float
) -> None:
    engine = relaxed(Packing(*np.transpose(places), box=BOX), friction)
    overlap = engine.contacts()[0].overlap
    assert np.all(np.isfinite(engine.packing.state))
    assert overlap.max(initial=0.0) < 0.01
    again = relaxed(Packing(*np.transpose(places), box=BOX), friction)
    assert again.packing.hash() == engine.packing.hash()


def test_only_those_at_one_place_are_touched_and_hardly() -> None:
    packing = Packing([1.0, 1.0, 2.0, 1.0], [1.0, 1.0, 1.0, 2.5], [1.0, 0.5, 1.0, 1.0])
    before = packing.state.copy()
    assert part_coincident(packing, observables.grain_contacts(packing))
    moved = np.hypot(*(packing.state - before)[:2])
    assert moved[:2] == pytest.approx([NUDGE, 0.5 * NUDGE])
    assert not moved[2:].any()
    assert not part_coincident(packing, observables.grain_contacts(packing))


def test_a_grain_in_the_middle_of_a_disc_is_pushed_out() -> None:
    disc = RigidBody("disc", "intruder", position=(4.0, 4.0), discs=[(0.0, 0.0, 2.0)])
    engine = Quasistatic(System(Packing([4.0], [4.0]), RigidWorld([disc])))
    for _ in range(2):
        engine.begin({})
        done = engine.relax(10_000)
        assert done is not None
        assert np.all(np.isfinite(done.reactions))
    assert float(np.hypot(engine.packing.x[0] - 4.0, engine.packing.y[0] - 4.0)) > 2.9
