"""Making things: grains placed, erased and retyped, and all of it undone; whatever a hand does, what is there stays whole."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from sandbox.files.log_file import read_log, write_log
from sandbox.session import editing
from sandbox.session.commands import (
    Command,
    DrawWall,
    Erase,
    EraseWall,
    Place,
    Protocol,
    Redo,
    Reset,
    Retype,
    Undo,
    from_data,
    to_data,
)
from sandbox.session.editing import WALL
from sandbox.session.replay import replay
from sandbox.session.run import TOO_TIGHT
from tests.session.edited import DENSE, assert_refused, assert_whole, built, do, empty

FAR = 100.0  # [R] radius of a brush that reaches everything


# Grains


def test_a_grain_is_placed_where_there_is_room() -> None:
    session = empty()
    do(session, Place(15.0, 10.0, "regular"), Place(20.0, 12.0, "auxetic"))
    packing = session.run.setup.packing
    assert packing.x.tolist() == [15.0, 20.0]
    assert packing.y.tolist() == [10.0, 12.0]
    assert packing.poisson_ratio.tolist() == [0.8, -0.8]
    assert packing.rest_radius.tolist() == [1.0, 1.0 / 1.4]  # in turn
    assert packing.p.tolist() == packing.rest_radius.tolist()
    assert packing.label.tolist() == [0, 1]
    assert len(session.history) == 3  # an increment each


def test_a_placed_grain_has_the_settings_of_the_scene() -> None:
    session = empty(regular_poisson_ratio=0.3, contact_stiffness=80.0)
    do(session, Place(15.0, 10.0, "regular"))
    packing = session.run.setup.packing
    assert packing.poisson_ratio[0] == 0.3
    assert packing.contact_stiffness[0] == 80.0


def test_where_the_room_is_narrow_a_grain_begins_small_and_swells() -> None:
    session = empty()
    # Four pegs, and between them room for a circle of radius 0.6.
    reach = (0.6 + WALL) / math.sqrt(2.0)
    for dx, dy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        do(session, DrawWall(((15.0 + dx * reach, 10.0 + dy * reach),)))
    session.submit(Place(15.0, 10.0, "regular"))
    session.settle()
    packing = session.run.setup.packing
    assert packing.p[0] == pytest.approx(0.6)
    assert packing.rest_radius[0] == 1.0
    session.advance(100_000)
    assert 0.6 < session.run.setup.packing.p[0] < 0.8
    assert session.frame().stop_reason == "converged"
    assert len(session.frame().contacts) == 4


def test_a_full_box_takes_grains_in_until_there_is_no_room() -> None:
    session = built("intruder", **DENSE)
    first = len(session.run.setup.packing)
    random = np.random.default_rng(3)
    x0, y0, x1, y1 = session.run.setup.bounds
    for x, y in random.uniform((x0 + 1, y0 + 1), (x1 - 1, y1 - 1), (60, 2)):
        do(session, Place(float(x), float(y), "regular"))
        assert_whole(session)
    frame = session.frame()
    assert frame.grains > first
    assert frame.grains - first == len(session.log().commands)
    assert frame.refusals == 60 - len(session.log().commands) > 0
    assert frame.converged


@pytest.mark.parametrize(
    ("at", "why"),
    [
        ((-5.0, 10.0), "inside the scene"),
        ((15.0, 1e5), "inside the scene"),
        ((1e300, 0.0), "far outside"),
        ((3.0, 10.0), "another body"),
        ((20.0, 10.0), "no room"),
    ],
)
def test_no_grain_where_none_can_be(at: tuple[float, float], why: str) -> None:
    session = empty()
    do(session, Place(20.0, 10.0, "regular"))
    assert_refused(session, Place(*at, "auxetic"), why)


def test_labels_are_never_used_again() -> None:
    session = empty()
    do(session, Place(15.0, 10.0, "regular"), Place(20.0, 10.0, "regular"))
    do(session, Erase(20.0, 10.0, 0.5), Place(20.0, 10.0, "regular"))
    assert session.run.setup.packing.label.tolist() == [0, 2]


def test_when_labels_are_used_up_a_free_one_is_taken() -> None:
    session = empty()
    do(session, Place(15.0, 10.0, "regular"))
    made = editing.edited(session.run.setup, session.settings, Place(20.0, 10.0, "regular"), 2**30)
    assert made.packing.label.tolist() == [0, 1]


def test_there_are_never_more_grains_than_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    session = empty()
    monkeypatch.setattr(editing, "MOST_GRAINS", 1)
    do(session, Place(15.0, 10.0, "regular"))
    assert_refused(session, Place(20.0, 10.0, "regular"), "no more fit")


def test_erase_takes_what_the_brush_covers_and_what_lies_under_it() -> None:
    session = empty()
    do(session, *(Place(12.0 + 3.0 * k, 10.0, "regular") for k in range(5)))
    do(session, Erase(15.4, 10.0, 0.0))  # inside the second, not at its centre
    assert session.run.setup.packing.label.tolist() == [0, 2, 3, 4]
    do(session, Erase(19.5, 10.0, 2.0))
    assert session.run.setup.packing.label.tolist() == [0, 4]
    assert_refused(session, Erase(25.0, 3.0, 1.0), "no grain here")


def test_everything_can_be_erased() -> None:
    for scene, values in (
        ("intruder", DENSE),
        ("hopper", {"grains": 60, "width": 12.0}),
        ("gravity_hopper", {"grains": 40}),
        ("couette", {"grains": 160}),
        ("biaxial_periodic", {"grains": 60}),
        ("grain_row", {"grains": 3}),
    ):
        session = built(scene, **values)
        x0, y0, x1, y1 = session.run.setup.bounds
        do(session, Erase(0.5 * (x0 + x1), 0.5 * (y0 + y1), FAR))
        assert session.frame().grains == 0
        do(session, Protocol(True), Protocol(True), Protocol(True))
        assert np.all(np.isfinite(session.history.curve))


def test_retype_changes_the_kind_and_nothing_else() -> None:
    session = built("intruder", "regular", friction=0.5, **DENSE)
    do(session, Protocol(True), Protocol(True))
    before = session.run.setup.packing.copy()
    memory = session.run.engine.friction.hash()  # type: ignore[union-attr]
    middle = 0.5 * session.run.setup.bounds[2], 0.5 * session.run.setup.bounds[3]
    session.submit(Retype(*middle, 3.0, "auxetic"))
    session.settle()
    packing = session.run.setup.packing
    near = np.hypot(packing.x - middle[0], packing.y - middle[1]) <= 3.0
    assert 1 < near.sum() < len(near)
    assert np.all(packing.poisson_ratio[near] == -0.8)
    assert packing.state.tobytes() == before.state.tobytes()
    assert session.run.engine.friction.hash() == memory  # type: ignore[union-attr]
    do(session)
    session.advance(100_000)
    assert_whole(session)


def test_a_cell_that_repeats_itself_is_edited_by_its_images() -> None:
    session = built("biaxial_periodic", grains=60)
    box = session.run.setup.packing.box
    assert box is not None
    do(session, Erase(-0.5, -0.5, 2.0))  # beyond the corner: all four corners are one place
    gone = 60 - len(session.run.setup.packing)
    x, y = session.run.setup.packing.folded()
    corner = np.hypot(
        np.minimum(x + 0.5, box.width - 0.5 - x), np.minimum(y + 0.5, box.height - 0.5 - y)
    )
    assert gone > 1
    assert corner.min() > 2.0 - 0.3  # what has moved into the hole since
    do(session, Place(-0.5, -0.5, "auxetic"))
    assert len(session.run.setup.packing) == 61 - gone
    assert_refused(session, DrawWall(((1.0, 1.0), (4.0, 4.0))), "repeats itself")


def test_scenes_whose_plates_and_grains_move_together_cannot_be_edited() -> None:
    session = built("two_ellipses")
    assert_refused(session, Erase(0.0, 0.0, 1.0), "move together")


# Time


def test_edits_are_undone_and_redone_to_the_last_bit() -> None:
    session = built("intruder", friction=0.3, **DENSE)
    _, _, x1, y1 = session.run.setup.bounds
    at = 0.7 * x1, 0.5 * y1
    states = [session.state_hash()]
    for command in (
        Erase(*at, 2.0),
        Place(*at, "auxetic"),
        Retype(*at, 4.0, "regular"),
        DrawWall(((at[0] + 2.0, 2.0), (at[0] + 2.0, 6.0))),
        EraseWall(at[0] + 2.0, 4.0),
    ):
        do(session, command)
        assert not session.frame().refusal
        states.append(session.state_hash())
    assert len(set(states)) == len(states)
    for state in reversed(states[:-1]):
        do(session, Undo())
        assert session.state_hash() == state
        assert_whole(session)
    for state in states[1:]:
        do(session, Redo())
        assert session.state_hash() == state


def test_one_stroke_of_the_brush_is_undone_at_once() -> None:
    session = empty()
    do(session, Place(10.0, 10.0, "regular"), Place(14.0, 10.0, "regular"))
    do(session, *(Place(18.0 + 3.0 * k, 10.0, "regular", goes_on=k > 0) for k in range(3)))
    assert session.frame().grains == 5
    do(session, Undo())
    assert session.frame().grains == 2
    do(session, Undo())
    assert session.frame().grains == 1


def test_reset_takes_away_what_was_made() -> None:
    session = built(grains=10)
    start = session.state_hash()
    do(session, Place(15.0, 3.0, "regular"), DrawWall(((20.0, 3.0), (25.0, 3.0))), Reset())
    assert session.state_hash() == start
    assert len(session.run.setup.world.drawn) == 0
    do(session, Undo())
    assert session.frame().grains == 11
    assert len(session.run.setup.world.drawn) == 1


def test_what_was_made_replays_to_the_same_bits(tmp_path: Path) -> None:
    session = built("hopper", grains=60, width=12.0)
    do(session, *[Protocol(True)] * 3)
    do(session, DrawWall(((-3.0, 9.0), (2.0, 8.0), (2.0, 7.0))), Place(0.0, 5.0, "auxetic"))
    do(session, Erase(0.0, 6.0, 1.5), Retype(0.0, 8.0, 3.0, "auxetic"), *[Protocol(True)] * 5)
    do(session, Undo(), Place(1.0, 4.0, "regular"), EraseWall(2.0, 7.5), Redo(), Undo(), Undo())
    write_log(tmp_path / "made.jsonl", session.log())
    log = read_log(tmp_path / "made.jsonl")
    assert len(log.commands) > 8
    again = list(replay(log, slice_iterations=61))[-1]
    assert again.state_hash() == session.state_hash() == log.hash
    assert list(again.history.rows()) == list(session.history.rows())


def test_what_was_too_tight_is_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    session = built("intruder", friction=0.3, **DENSE)
    do(session, Protocol(True), Protocol(False))
    before, rows = session.state_hash(), len(session.history)
    relax = Quasistatic.relax

    def collapses(self: Quasistatic, most: int) -> object:
        increment = relax(self, most)
        if increment is None:
            return None
        return replace(increment, report=replace(increment.report, reason=StopReason.COLLAPSED))

    monkeypatch.setattr(Quasistatic, "relax", collapses)
    do(session, DrawWall(((14.0, 3.0), (14.0, 6.0))))
    monkeypatch.undo()
    assert session.frame().notices == (TOO_TIGHT,)
    assert session.state_hash() == before
    assert len(session.history) == rows
    assert session.idle
    do(session, Erase(14.0, 5.0, 2.0))
    assert_whole(session)


def test_claims_about_the_scene_end_where_it_was_edited() -> None:
    session = built("grain_row", "auxetic")
    do(session, *[Protocol(True)] * 3)
    assert len(session.checks()) == 5
    do(session, Retype(0.0, 1.0, 1.0, "regular"))
    assert len(session.checks()) == 3
    assert all(check.holds is not False for check in session.checks())


def test_placed_grains_have_not_left() -> None:
    session = built("gravity_hopper", grains=40)
    x0, _, x1, y1 = session.run.setup.bounds
    for k in range(3):
        do(session, Place(0.5 * (x0 + x1) - 4.0 + 3.0 * k, y1 - 2.0, "regular"))
    frame = session.frame()
    assert frame.grains > 40
    assert frame.curve_force[-1] == frame.grains_out
    assert all(check.holds is not False for check in session.checks())


def test_an_edit_is_no_avalanche() -> None:
    session = built("avalanches", grains=60)
    do(session, *[Protocol(True)] * 10)
    side = session.run.setup.outline[1][0]
    do(session, Protocol(False), Erase(0.5 * side, 0.5 * side, 3.0))
    assert not any(event.increment == len(session.history) - 1 for event in session.frame().events)


# Whatever comes


places = st.floats(-2.0, 33.0)
kinds = st.sampled_from(["regular", "auxetic"])
radii = st.floats(0.0, 5.0)
edits = st.one_of(
    st.builds(Place, places, places, kinds),
    st.builds(Erase, places, places, radii),
    st.builds(Retype, places, places, radii, kinds),
    st.builds(DrawWall, st.lists(st.tuples(places, places), min_size=1, max_size=6).map(tuple)),
    st.builds(EraseWall, places, places),
    st.sampled_from([Undo(), Redo(), Reset(), Protocol(True), Protocol(False)]),
)


@pytest.mark.slow
@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.sampled_from([("workshop", 60), ("workshop", 0), ("workshop", 190), ("intruder", 80)]),
    st.sampled_from([0.0, 0.4]),
    st.lists(edits, min_size=1, max_size=12),
)
def test_any_edits_leave_everything_whole(
    scene: tuple[str, int], friction: float, commands: list[Command]
) -> None:
    values: dict[str, Any] = {"intruder_radius": 2.0} if scene[0] == "intruder" else {}
    session = built(scene[0], grains=scene[1], friction=friction, **values)
    for command in commands:
        do(session, command)
        assert_whole(session)
    log = session.log()
    assert list(replay(log))[-1].state_hash() == log.hash


# As data


@pytest.mark.parametrize(
    "command",
    [
        Place(1.0, 2.5, "auxetic"),
        Place(1.0, 2.5, "regular", True),
        Erase(1.0, 2.0, 3.0),
        Retype(1.0, 2.0, 0.0, "regular"),
        DrawWall(((0.0, 1.0), (2.0, 3.0))),
        EraseWall(4.0, 5.0),
    ],
)
def test_edits_are_data(command: Command) -> None:
    assert from_data(to_data(command)) == command


@pytest.mark.parametrize(
    "data",
    [
        {"command": "place", "x": 1, "y": 2, "kind": "wooden", "goes_on": False},
        {"command": "place", "x": 1, "y": 2, "kind": ["regular"], "goes_on": False},
        {"command": "place", "x": 1, "y": 10**400, "kind": "regular", "goes_on": False},
        {"command": "place", "x": 1, "y": 2, "kind": "regular", "goes_on": 1},
        {"command": "erase", "x": 1, "y": 2, "radius": -1.0, "goes_on": False},
        {"command": "erase", "x": 1, "y": 2, "radius": 1e3, "goes_on": False},
        {"command": "erase", "x": 1, "y": 2, "radius": True, "goes_on": False},
        {"command": "drawwall", "points": []},
        {"command": "drawwall", "points": [[1.0, 2.0]] * 4001},
        {"command": "drawwall", "points": [[1.0]]},
        {"command": "drawwall", "points": [[1.0, float("nan")]]},
        {"command": "drawwall", "points": "12"},
        {"command": "drawwall"},
    ],
)
def test_edits_that_are_none(data: dict[str, object]) -> None:
    with pytest.raises(InputError):
        from_data(data)
