"""The arch over an orifice: the lowest loaded chain from one side to the other."""

from __future__ import annotations

import numpy as np

from core import observables
from core.arches import arch
from core.packing import Packing
from core.rigid import RigidWorld, wall


def setting(x: list[float], y: list[float]) -> tuple[Packing, RigidWorld]:
    """Grains between two vertical walls at x = ±4 whose feet are the lips of an orifice."""
    world = RigidWorld(
        [
            wall("right wall", [(4.0, 0.0), (4.0, 30.0)], 0.5),
            wall("left wall", [(-4.0, 30.0), (-4.0, 0.0)], 0.5),
        ]
    )
    return Packing(x, y), world


def found(packing: Packing, world: RigidWorld) -> list[int]:
    primitives, owner = world.primitives()
    pairs = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, primitives)
    side = np.where(owner[bodies.primitive] == 0, 1, -1)
    return [int(i) for i in arch(packing, pairs, bodies, side, 0.0)]


ROW = [
    -3.02,
    -1.0067,
    1.0067,
    3.02,
]  # of grains 1.03 wide: each presses on its neighbours and the walls


def test_a_chain_from_wall_to_wall_is_found_in_order() -> None:
    packing, world = setting(ROW, [5.0, 5.1, 5.1, 5.0])
    packing.state[2] = 1.03
    assert found(packing, world) == [0, 1, 2, 3]


def test_a_chain_that_ends_short_of_a_wall_is_none() -> None:
    packing, world = setting([x - 0.1 for x in ROW], [5.0, 5.0, 5.0, 5.0])
    packing.state[2] = 1.03
    assert found(packing, world) == []


def test_the_lowest_of_several_chains() -> None:
    packing, world = setting(ROW * 3, [8.0] * 4 + [4.0] * 4 + [6.02] * 4)
    packing.state[2] = 1.03
    assert found(packing, world) == [4, 5, 6, 7]


def test_an_orifice_without_a_chain_has_no_arch() -> None:
    packing, world = setting([-3.02, -1.0067, 3.02], [5.0, 5.0, 5.0])
    packing.state[2] = 1.03
    assert found(packing, world) == []
    alone, world = setting([0.0], [5.0])
    assert found(alone, world) == []


def test_one_grain_may_be_the_plug() -> None:
    packing, world = setting([0.0, 0.0], [5.0, 20.0])
    packing.state[2] = 4.05
    packing.rest_radius[:] = 4.05
    assert found(packing, world) == [0]


def test_a_weak_link_holds_nothing() -> None:
    packing, world = setting([*ROW, 0.0], [5.0, 5.0, 5.0, 5.0, 9.0])
    packing.state[2] = 1.03
    packing.state[2, 2] = 0.984  # just touches its neighbours
    packing.rest_radius[2] = 0.984
    assert found(packing, world) == []
