"""Workshop: an almost empty box, with as many grains as wanted, none among them."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from sandbox.session.commands import DrawWall, Place, Protocol
from sandbox.session.session import Session
from scenes import registry


def workshop(packing: str = "mixed", **values: object) -> Session:
    session = Session("workshop", packing, 1, values)
    session.build()
    return session


@pytest.mark.parametrize("grains", [0, 1, 40, 185])
def test_there_are_as_many_grains_as_asked_for(grains: int) -> None:
    session = workshop(grains=grains)
    packing = session.run.setup.packing
    assert len(packing) == grains
    assert session.frame().converged
    disc = session.run.setup.world["intruder"]
    apart = np.hypot(packing.x - disc.position[0], packing.y - disc.position[1])
    assert np.all(apart > 2.0 + 0.9 * packing.rest_radius)


@pytest.mark.parametrize("kind", ["regular", "auxetic", "mixed"])
def test_without_grains_the_disc_goes_there_and_back(kind: str) -> None:
    session = workshop(kind, grains=0)
    disc = session.run.setup.world["intruder"]
    home = disc.position
    session.submit(Protocol(True))
    farthest, increments = 0.0, 0
    while not session.idle:
        increments += session.advance()
        farthest = max(farthest, disc.position[0])
    assert increments == session.scene.steps(session.settings) == 1000
    assert farthest == pytest.approx(31.0 - 3.0)
    assert disc.position == pytest.approx(home)
    assert np.all(session.history.column("resisting") == 0.0)
    assert all(check.holds for check in session.checks())


def test_pushed_grains_resist() -> None:
    session = workshop(grains=0)
    session.submit(DrawWall(((10.0, 7.0), (10.0, 13.0))))
    session.submit(Place(6.2, 10.0, "regular"))
    session.submit(Place(8.4, 10.0, "regular"))
    session.submit(Protocol(True))
    done = 0
    while done < 40:
        done += session.advance()
    assert session.history[-1].resisting > 0.01


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"intruder_radius": 9.0}, "does not fit"),
        ({"grains": 250}, "leave no room"),
        ({"grains": -1}, "grains must lie"),
    ],
)
def test_what_does_not_fit_is_refused_at_once(values: dict[str, object], why: str) -> None:
    with pytest.raises(InputError, match=why):
        Session("workshop", "mixed", 1, values)


def test_it_is_in_the_menu() -> None:
    assert "workshop" in registry.names()
