"""The check "no grain is lost and none has passed a wall": it holds in bursts of grains, and sees a grain behind any wall."""

from __future__ import annotations

import numpy as np
import pytest

from core.generate import inside
from core.packing import Packing
from core.rigid import Point
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes.checks import Check
from scenes.scene import HAND_STRENGTH, STRONGEST

KEPT = "no grain is lost and none has passed a wall"
MACHINE: dict[str, object] = {HAND_STRENGTH: STRONGEST}  # a weaker hand is locked before
SHORT: dict[str, object] = {"grains": 160, "step": 0.1, **MACHINE}
FEW: dict[str, dict[str, object]] = {"couette": {"grains": 160}}


def kept(session: Session) -> Check:
    return next(check for check in session.checks() if check.name == KEPT)


def built(name: str, settings: dict[str, object] | None = None) -> Session:
    session = Session(name, "mixed", 1, settings or {})
    session.build()
    return session


@pytest.mark.parametrize("kind", ["regular", "mixed", "auxetic"])
def test_it_holds_after_every_increment_of_whole_runs(kind: str) -> None:
    """Without taking away who lies beside the lips, all of these runs end with grains under the funnel."""
    for seed in (2, 5):
        session = Session("hopper", kind, seed, SHORT)
        session.build()
        session.submit(Protocol(True))
        while not session.idle:
            if session.advance(20_000):
                assert kept(session).holds, f"seed {seed}: {kept(session).measured}"
        assert session.history.column("grains_out")[-1] > 50


# The runs in which it failed, up to the burst that made it fail.
@pytest.mark.parametrize(
    ("grains", "kind", "seed", "burst"),
    [(160, "regular", 5, 100), (300, "regular", 1, 211), (300, "mixed", 3, 127)],
)
def test_who_was_pushed_under_the_funnel_has_left(
    grains: int, kind: str, seed: int, burst: int
) -> None:
    session = Session("hopper", kind, seed, {"grains": grains, **MACHINE})
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < burst:
        done += session.advance(20_000)
    frame = session.frame()
    assert kept(session).holds
    outside = ~inside(session.run.setup.outline, frame.x, frame.y)
    assert np.all(np.abs(frame.x[outside]) < 4.0)  # between the lips alone


HOPPER_SIDE = (12.0 + 1.5, 14.0)
PLACES: list[tuple[str, Point]] = [
    ("hopper", HOPPER_SIDE),
    ("hopper", (-HOPPER_SIDE[0], 14.0)),
    ("hopper", (8.0, 4.7)),  # in the funnel's side: its face is 0.2 R away, and 0.6 R the other one
    ("hopper", (0.0, 40.0)),  # behind the piston, and still between the channel's walls
    ("hopper", (0.0, 45.0)),
    ("gravity_hopper", (10.0 + 1.5, 12.0)),
    ("gravity_hopper", (6.0, 2.7)),
    ("intruder", (-1.5, 5.0)),
    ("workshop", (5.0, -1.5)),
    ("biaxial_press", (0.0, -2.0)),
    ("couette", (5.0, -3.0)),
    ("grain_row", (0.0, -1.0)),
    ("single_grain", (1.0, -1.0)),
]


@pytest.mark.parametrize(("name", "place"), PLACES)
def test_it_fails_where_a_grain_lies_behind_a_wall(name: str, place: Point) -> None:
    session = built(name, FEW.get(name))
    assert kept(session).holds
    put(session.run.setup.packing, place)
    assert kept(session).holds is False
    assert "1 astray" in kept(session).measured


@pytest.mark.parametrize(
    ("name", "body", "beyond"),
    [
        ("hopper", "piston", 0.5),
        ("grain_row", "piston", 0.5),
        ("single_grain", "plate", 0.5),
        ("biaxial_press", "lid", 0.5),
    ],
)
def test_it_fails_where_a_grain_lies_behind_what_presses(
    name: str, body: str, beyond: float
) -> None:
    """Inside the outline of the walls, and yet past the face that has come down."""
    session = built(name)
    presses = session.run.setup.world[body]
    presses.position = (presses.position[0], presses.position[1] - 0.8)
    x, y = presses.position
    put(session.run.setup.packing, (x, y + beyond))
    assert inside(session.run.setup.outline, np.array([x]), np.array([y + beyond]))[0]
    assert kept(session).holds is False


def test_a_grain_between_the_lips_is_on_its_way() -> None:
    session = built("hopper")
    put(session.run.setup.packing, (1.0, -0.5))
    assert kept(session).holds
    session = built("gravity_hopper")
    for place in ((1.0, -4.0), (-7.0, 1.0)):
        put(session.run.setup.packing, place)
        assert kept(session).holds, place


def put(packing: Packing, place: Point) -> None:
    """The first grain somewhere else."""
    packing.state[0, 0], packing.state[1, 0] = place
