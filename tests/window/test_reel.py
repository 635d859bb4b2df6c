"""The run so far in the window, saved as a page: what it holds on to, and what E writes."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pygame
import pytest

from sandbox.player.coding import unpacked
from sandbox.session.frame import Ahead, Frame
from sandbox.window.reel import MOST, Reel
from tests.draw.frames import intruder_frame
from tests.window.desk import Desk

STILL = intruder_frame(6)


def at(increment: int, **changes: Any) -> Frame:
    return replace(STILL, increment=increment, **changes)


def held(reel: Reel) -> list[int]:
    return [moment[0].increment for moment in reel._thinning.moments]


@pytest.fixture
def reel() -> Reel:
    return Reel(None)  # type: ignore[arg-type]


def test_what_is_under_way_or_looked_at_again_does_not_count(reel: Reel) -> None:
    ahead = Ahead(np.zeros(1), np.zeros(1), ())
    for frame in (at(0), at(1, busy=True), at(1), at(2), at(3), at(1, ahead=ahead), at(4)):
        reel.follow([frame])
    reel.follow([at(5), None])
    reel.follow([at(5), at(4)])
    assert held(reel) == [0, 1, 2, 3, 4]


def test_it_goes_on_from_where_the_run_went_back_to(reel: Reel) -> None:
    for increment in (0, 1, 2, 3, 2, 3):
        reel.follow([at(increment, seed=1)])
    assert held(reel) == [0, 1, 2, 3]
    reel.follow([at(7, seed=2)])
    assert held(reel) == [7]


def test_other_settings_are_another_run_unless_they_act_at_once(reel: Reel) -> None:
    def made(increment: int, **changed: float) -> Frame:
        return at(increment, scene="intruder", settings={"grains": 6, "friction": 0.0, **changed})

    for increment in (0, 1, 2):
        reel.follow([made(increment)])
    reel.follow([made(3, friction=0.5)])
    assert held(reel) == [0, 1, 2, 3]
    reel.follow([made(5, friction=0.5, grains=7)])  # its first increments came between two pictures
    assert held(reel) == [5]


def test_a_long_run_is_thinned_and_keeps_its_ends(reel: Reel) -> None:
    for increment in range(3 * MOST):
        reel.follow([at(increment)])
    assert MOST / 2 < len(held(reel)) <= MOST + 1
    assert held(reel)[0] == 0
    assert held(reel)[-1] == 3 * MOST - 1
    assert max(np.diff(held(reel))) <= 4


def test_e_writes_the_run_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    desk = Desk()
    desk.start()
    desk.key(pygame.K_a)
    desk.until(lambda: desk.seen > 3)
    desk.key(pygame.K_SPACE)
    desk.until(lambda: not desk.session.busy)
    desk.app.tick()
    desk.key(pygame.K_e)
    desk.key(pygame.K_3)
    desk.app.close()
    (path,) = tmp_path.glob("*.html")
    assert path.name == "sandbox-intruder-1.html"
    found = re.search(r'id="recording">([^<]+)<', path.read_text(encoding="utf-8"))
    assert found
    increments = unpacked(base64.b64decode(found[1]))[0]["increments"]
    assert increments[0] == 0
    assert increments == sorted(set(increments))
    assert increments[-1] >= 3
