"""A hand of limited strength: its force stays within it, whatever the packing; a testing machine goes where it is driven."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from core import generate
from core.errors import InputError
from core.friction import Friction
from core.generate import Recipe
from core.hand import SLACK, Push, force_on_body, force_on_box
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment, Quasistatic
from core.relaxation import FAILED
from core.rigid import Point, RigidBody, RigidWorld, wall
from core.settings import MACHINE, Settings
from core.system import System

BOX: list[Point] = [(0.0, 0.0), (12.0, 0.0), (12.0, 9.0), (0.0, 9.0)]
_PACKED: dict[tuple[str, str], Packing] = {}


def scene(body: str, kind: str, friction: float = 0.0, **solver: float) -> Quasistatic:
    """A dragged disc in a closed box, or a piston on a box of grains: always the same ones."""
    disc = RigidBody("disc", "intruder", position=(2.5, 4.5), discs=[(0.0, 0.0, 1.5)], held=True)
    w, h = BOX[2]
    corners = ((0.0, 0.0), (w, 0.0), (w, 1.0), (0.0, 1.0))
    piston = RigidBody(
        "piston", "piston", position=(0.0, h), polygons=[(corners, 0.0)], axis=(0.0, -1.0)
    )
    walls = wall("walls", BOX, 0.8, closed=True)
    if body == "piston":
        walls = wall("walls", [(0.0, h + 3.0), (0.0, 0.0), (w, 0.0), (w, h + 3.0)], 0.8)
    world = RigidWorld([walls, piston if body == "piston" else disc])
    if (body, kind) not in _PACKED:
        _PACKED[body, kind] = generate.pack(
            Recipe(kind=kind), seed=5, outline=BOX, world=world, packing_fraction=0.84
        )
    grains = _PACKED[body, kind].copy()
    memory = Friction(friction, len(grains)) if friction else None
    return Quasistatic(System(grains, world, Settings(**solver), memory))  # type: ignore[arg-type]


def increment(run: Quasistatic, targets: dict[str, Point], slices: int = 10**9) -> Increment:
    run.begin(targets)
    while True:
        done = run.relax(slices)
        if done is not None:
            return done


def hand_force(run: Quasistatic, done: Increment, name: str) -> float:
    fx, fy, _ = done.reactions[run.world.index(name)]
    return force_on_body((float(fx), float(fy)), done.pulled[name])


@settings(max_examples=25, deadline=None)
@example(body="piston", kind="regular", friction=0.5, strength=0.125, step=0.0625, way=0.0)
@given(
    body=st.sampled_from(["piston", "disc"]),
    kind=st.sampled_from(["regular", "mixed", "auxetic"]),
    friction=st.sampled_from([0.0, 0.5]),
    strength=st.floats(0.05, 8.0),
    step=st.floats(0.02, 0.12),
    way=st.floats(-math.pi, math.pi),
)
def test_the_force_stays_within_the_strength(
    body: str, kind: str, friction: float, strength: float, step: float, way: float
) -> None:
    """By 2 % at most, from rest on; and where the hand stops, it says why and every grain is where it can be."""
    run = scene(body, kind, friction, step=step, hand_strength=strength)
    aim = {"piston": (0.0, -99.0), "disc": (99.0 * math.cos(way), 99.0 * math.sin(way))}[body]
    increment(run, {})
    for _ in range(40):
        done = increment(run, {body: aim})
        assert done.report.reason not in FAILED
        on = sum(a * b for a, b in zip(done.moved[body], done.pulled[body], strict=True))
        # Where the grains push harder from the start, the hand goes back, a step at a time, until it can hold them.
        assert on < 0.0 or hand_force(run, done, body) <= strength * (1.0 + SLACK) + 1e-12
        assert math.hypot(*done.moved[body]) <= step * (1.0 + 1e-6)
        if on < 0.45 * step:
            assert done.stopped[body] in ("force limit", "wall", "end of travel")


def test_a_locked_hand_is_at_its_limit_and_can_be_drawn_back() -> None:
    run = scene("piston", "regular", step=0.1, hand_strength=3.0)
    for _ in range(200):
        done = increment(run, {"piston": (0.0, -99.0)})
        if done.moved["piston"] == (0.0, 0.0):
            break
    assert done.stopped == {"piston": "force limit"}
    assert 0.9 * 3.0 < hand_force(run, done, "piston") <= 3.0 * (1.0 + SLACK)
    done = increment(run, {"piston": (0.0, 99.0)})
    assert done.moved["piston"] == pytest.approx((0.0, 0.1))
    assert done.stopped == {}


def test_a_hand_that_has_become_too_weak_gives_way() -> None:
    """It goes back until it can hold what pushes it, and no further than it must."""
    run = scene("piston", "regular", step=0.05, hand_strength=6.0)
    for _ in range(200):
        done = increment(run, {"piston": (0.0, -99.0)})
        if done.moved["piston"] == (0.0, 0.0):
            break
    deep = run.world["piston"].position[1]
    run.system.solver = Settings(step=0.05, hand_strength=2.0)
    run.look_again()
    for _ in range(60):
        done = increment(run, {"piston": (0.0, -99.0)})
    assert run.world["piston"].position[1] > deep
    assert 0.9 * 2.0 < hand_force(run, done, "piston") <= 2.0 * (1.0 + SLACK)


@pytest.mark.parametrize("body", ["piston", "disc"])
def test_slices_change_nothing(body: str) -> None:
    """An increment that is tried several times, cut into calls of any length: the same bits."""
    ends = []
    for slices in (10**9, 200, 7):
        run = scene(body, "regular", 0.5, step=0.1, hand_strength=1.0)
        aim = {body: (99.0, -99.0)}
        reports = [increment(run, aim, slices).report for _ in range(30)]
        assert run.friction is not None
        ends.append((run.packing.hash(), run.friction.hash(), run.world.placement().tolist()))
        assert reports[-1].reason not in FAILED
    assert ends[0] == ends[1] == ends[2]


def test_a_testing_machine_goes_where_it_is_driven() -> None:
    """And takes the same way to the last bit as a hand that is stronger than it has to be."""
    ends = []
    for strength in (MACHINE, 1e6):
        run = scene("piston", "regular", step=0.05, hand_strength=strength)
        for _ in range(30):
            done = increment(run, {"piston": (0.0, -99.0)})
            assert done.stopped == {}
        ends.append(run.packing.hash())
    assert run.world["piston"].position[1] == pytest.approx(9.0 - 30 * 0.05)
    assert ends[0] == ends[1]


@pytest.mark.parametrize("strength", [0.0, -1.0, math.nan])
def test_senseless_strengths(strength: float) -> None:
    with pytest.raises(InputError, match="hand's strength"):
        Settings(hand_strength=strength)


def jammed_cell() -> Packing:
    """A periodic packing under pressure, relaxed tightly."""
    return generate.pack(
        Recipe(), seed=2, count=60, packing_fraction=0.9, target_pressure=0.05, tolerance=1e-8
    )


@pytest.mark.parametrize("way", [(-1.0, -1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_the_force_on_a_cell_is_the_slope_of_the_energy(way: tuple[float, float, float]) -> None:
    """Central difference over a small way of the sides, grains relaxed at each end."""
    cell = jammed_cell()
    assert cell.box is not None
    tiny = 1e-4
    length = math.hypot(*way)

    def energy(sign: float) -> float:
        assert cell.box is not None
        sides = np.array([cell.box.width, cell.box.height, cell.box.shift])
        run = Quasistatic(System(cell.copy(), RigidWorld(), Settings(tolerance=1e-9, step=0.05)))
        run.begin({}, PeriodicBox(*(sides + sign * tiny * np.array(way)).tolist()))
        while (done := run.relax(10**9)) is None:
            pass
        return done.report.energy

    slope = (energy(1.0) - energy(-1.0)) / (2.0 * tiny * length)
    pairs = Quasistatic(System(cell.copy(), RigidWorld(), Settings())).contacts()[0]
    assert force_on_box(pairs, cell.box, way) == pytest.approx(slope, rel=2e-4, abs=1e-6)


def test_a_hand_on_a_cell_stops_at_its_strength() -> None:
    cell = jammed_cell()
    assert cell.box is not None
    side = cell.box.width
    run = Quasistatic(System(cell, RigidWorld(), Settings(step=0.1, hand_strength=2.5)))
    assert force_on_box(run.contacts()[0], cell.box, (-1.0, -1.0, 0.0)) < 2.5
    forces, stopped = [], {}
    for _ in range(60):
        run.begin({}, PeriodicBox(0.5 * side, 0.5 * side))
        while (done := run.relax(10**9)) is None:
            pass
        stopped = done.stopped
        forces.append(done.hand_force)
        assert run.packing.box is not None
        slope = force_on_box(done.grain_contacts, run.packing.box, (-1.0, -1.0, 0.0))
        assert done.hand_force == pytest.approx(slope, rel=0.02)  # by the sides before and after
        if done.share == 0.0:
            break
    assert stopped == {"box": "force limit"}
    assert 0.9 * 2.5 < forces[-1] <= 2.5 * (1.0 + SLACK)


def test_a_push_that_is_too_long_becomes_shorter_until_there_is_none() -> None:
    push = Push(strength=1.0, before=0.0)
    assert not push.overpowered(1.0 + 0.9 * SLACK)
    assert push.overpowered(2.0)
    push.shorten(2.0)
    assert push.share == pytest.approx(0.5 * (1.0 + 0.5 * SLACK))
    push.shorten(math.inf)  # that one led to nothing: no secant
    assert push.share == pytest.approx(0.125 * (1.0 + 0.5 * SLACK))
    full = Push(strength=1.0, before=1.01)
    full.shorten(3.0)
    assert full.share == 0.0
    assert not full.overpowered(3.0)
