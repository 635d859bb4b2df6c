"""What is saved is what is opened: a run goes on from its file, to the last bit, as if it had never been left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sandbox.files.scene_file import content_of, parse_scene, read_scene, write_scene
from sandbox.session.commands import (
    Change,
    Command,
    DrawWall,
    Erase,
    EraseWall,
    Grab,
    Move,
    Place,
    Protocol,
    Recall,
    Redo,
    Release,
    Reset,
    Retype,
    Undo,
)
from sandbox.session.session import Session
from scenes import registry
from scenes.scene import STRONGEST

SMALL: dict[str, dict[str, Any]] = {
    "single_grain": {},
    "two_ellipses": {},
    "grain_row": {"grains": 3, "gap": 0.2},
    "biaxial_press": {"grains": 30},
    "biaxial_periodic": {"grains": 60},
    "couette": {"grains": 160},
    "avalanches": {"grains": 60, "tolerance": 1e-2},
    "intruder": {"grains": 50, "intruder_radius": 1.0},
    "hopper": {"grains": 40, "width": 9.0},
    "gravity_hopper": {"grains": 40, "width": 9.0},
    "workshop": {"grains": 12},
}
LONG = 100_000  # iterations: to the end of an increment


def begun(scene: str, packing: str = "mixed", **values: Any) -> Session:
    session = Session(scene, packing, 1, {**SMALL[scene], **values})
    session.build()
    return session


def drive(session: Session, increments: int) -> None:
    """So many increments, or fewer if nothing moves any more."""
    for _ in range(increments):
        while not session.advance(LONG):
            if session.idle:
                return


def parted(session: Session) -> list[Any]:
    """All that somebody could see of it."""
    frame = session.frame()
    return [
        session.state_hash(),
        [repr(row) for row in session.history.rows()],
        session.history.events,
        [getattr(event.text, "template", "") for event in session.history.events],
        (frame.grains_out, frame.stroke, frame.notices, frame.protocol, frame.label.tolist()),
        [(h.name, h.target, h.x, h.y) for h in frame.handles],
        session.run.course.initial,
        session.run.course.held,
        session.run.course.script,
        dict(session.settings),
        np.nan_to_num(frame.motion).tobytes(),
        None if frame.highlight is None else frame.highlight.tolist(),
        [str(check) for check in session.checks()],
    ]


def opened(session: Session) -> Session:
    """Another session, from its file."""
    file = parse_scene("it", content_of(session.made().to_file("it")))
    again = Session.from_file(file)
    again.build()
    return again


def assert_goes_on(session: Session, increments: int = 10) -> None:
    """Saved and opened now, it is the same, and stays so."""
    again = opened(session)
    if not session.busy:
        assert parted(again) == parted(session)
    for _ in range(increments):
        drive(session, 1)
        drive(again, 1)
        assert parted(again) == parted(session)


@pytest.mark.parametrize("scene", registry.names())
def test_every_scene_goes_on_in_the_middle_of_its_drive(scene: str) -> None:
    for packing in registry.get(scene).packings:
        session = begun(scene, packing)
        session.submit(Protocol(True))
        drive(session, 6)
        assert len(session.history) == 7
        assert_goes_on(session)
        assert len(session.history) > 12


@pytest.mark.parametrize("scene", [s for s in registry.names() if s != "two_ellipses"])
def test_it_goes_on_after_live_changes(scene: str) -> None:
    """The scene is built from what it was built from, and not from what is set now."""
    session = begun(scene)
    session.submit(Protocol(True))
    drive(session, 3)
    names = {p.name for p in session.scene.parameters if p.live}
    new = {"contact_stiffness": 80.0, "friction": 0.3, "step": 0.02, "hand_strength": 4.0}
    for name, value in new.items():
        if name in names:
            session.submit(Change(name, value))
            drive(session, 2)
    assert_goes_on(session)
    session.submit(Reset())
    drive(session, 1)


def test_a_hopper_with_friction_keeps_what_has_come_out() -> None:
    session = begun("hopper", "auxetic", grains=60, width=12.0, hand_strength=STRONGEST)
    session.submit(Protocol(True))
    while session.frame().grains_out < 3:
        drive(session, 1)
    again = opened(session)
    assert again.frame().grains_out == session.frame().grains_out
    assert np.array_equal(again.frame().x, session.frame().x)
    assert_goes_on(session, 30)


@pytest.mark.parametrize("slices", [1, 40])
def test_within_an_increment_it_is_that_from_its_beginning(slices: int) -> None:
    session = begun("intruder", friction=0.4)
    session.submit(Protocol(True))
    drive(session, 3)
    session.advance(slices)
    assert session.busy
    again = opened(session)
    drive(session, 1)
    drive(again, 1)
    assert parted(again) == parted(session)


def test_what_a_person_has_made_goes_on() -> None:
    session = begun("workshop", friction=0.4)
    for command in (
        Place(15.0, 3.0, "auxetic"),
        DrawWall(((12.0, 16.0), (16.0, 14.0), (20.0, 16.0))),
        DrawWall(((25.0, 5.0),)),
        Retype(15.0, 10.0, 4.0, "regular"),
        EraseWall(25.0, 5.0),
        Erase(20.0, 10.0, 2.0),
        Protocol(True),
    ):
        session.submit(command)
        session.advance(1)  # the edit has not been relaxed yet
        if session.busy:
            assert_goes_on(session, 1)
        drive(session, 2)
    assert_goes_on(session)


def test_a_hand_goes_on_to_where_it_wanted() -> None:
    session = begun("intruder")
    for command in (Grab("intruder"), Move("intruder", 5.0, 7.0)):
        session.submit(command)
    session.settle()
    assert_goes_on(session)
    for one in (session, opened(session)):
        one.submit(Release("intruder"))
        one.settle()
        assert one.idle


def test_an_edit_that_turns_out_too_tight_is_taken_back_there_as_well() -> None:
    session = begun("workshop", grains=0)
    session.submit(Place(9.0, 10.0, "regular"))
    drive(session, 1)
    session.submit(Place(15.0, 3.0, "auxetic"))
    session.settle()
    before = opened(session).run.settled.before_edit
    assert before is not None
    assert len(before.engine.packing) == 1


def test_going_back_ends_where_the_file_begins() -> None:
    session = begun("workshop", friction=0.4)
    session.submit(Protocol(True))
    drive(session, 4)
    again = opened(session)
    start, rows = again.state_hash(), len(again.history)
    drive(again, 3)
    again.submit(Erase(15.0, 10.0, 30.0))
    drive(again, 1)
    assert again.frame().grains == 0
    again.submit(Undo())
    again.submit(Recall(0))
    again.settle()
    assert (again.state_hash(), len(again.history)) == (start, rows)
    assert again.frame().first_kept == rows - 1
    again.submit(Protocol(True))
    drive(again, 3)
    again.submit(Reset())
    again.settle()
    assert (again.state_hash(), len(again.history)) == (start, rows)
    assert again.idle
    again.submit(Change("friction", 0.8))
    drive(again, 1)
    again.submit(Reset())
    again.settle()
    assert again.settings["friction"] == 0.8
    assert again.run.setup.packing.hash() == session.run.setup.packing.hash()


def test_a_file_of_a_file_of_a_file_is_the_same(tmp_path: Path) -> None:
    session = begun("hopper", friction=0.5)
    session.submit(Protocol(True))
    drive(session, 5)
    content = content_of(session.made().to_file("a"))
    for _ in range(2):
        session = Session.from_file(parse_scene("b", content))
        session.build()
        assert content_of(session.made().to_file("c")) == content
    write_scene(tmp_path / "d", session.made())
    assert content_of(read_scene(tmp_path / "d")) == content
    drive(session, 2)
    file = session.file
    assert file is not None
    assert content_of(file) == content  # what it began with, whatever it has become


# Whatever commands lead to


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


def commands(session: Session) -> st.SearchStrategy[Command]:
    """Any that make sense at all in a scene, near what is there."""
    x0, y0, x1, y1 = session.run.setup.bounds
    x, y = numbers(x0 - 2.0, x1 + 2.0), numbers(y0 - 2.0, y1 + 2.0)
    handles = st.sampled_from([handle.body for handle in session.run.setup.handles])
    live = [p for p in session.scene.parameters if p.live and p.kind == "number"]
    live = [p for p in live if p.name not in ("tolerance", "step", "strain", "compression")]
    changes = [
        st.builds(Change, st.just(p.name), numbers(float(p.low), min(float(p.high), 100.0)))
        for p in live
    ]
    kinds = st.sampled_from(["regular", "auxetic"])
    points = st.lists(st.tuples(x, y), min_size=1, max_size=4).map(tuple)
    return st.one_of(
        st.builds(Grab, handles),
        st.builds(Move, handles, x, y),
        st.builds(Move, handles, x, y),
        st.builds(Release, handles),
        st.builds(Protocol, st.booleans()),
        st.builds(Place, x, y, kinds),
        st.builds(Place, x, y, kinds),
        st.builds(Erase, x, y, numbers(0.0, 3.0)),
        st.builds(Retype, x, y, numbers(0.0, 3.0), kinds),
        st.builds(DrawWall, points),
        st.builds(EraseWall, x, y),
        st.builds(Recall, st.integers(0, 30)),
        st.sampled_from([Undo(), Redo(), Reset()]),
        *changes,
    )


def test_a_grain_behind_the_piston_is_no_reason_to_refuse() -> None:
    """Down with the piston, a grain behind it, and up again: it is pushed out of the box."""
    for scene, handle in (("grain_row", "piston"), ("single_grain", "plate")):
        session = begun(scene, hand_strength=STRONGEST)
        body = session.run.setup.world[handle]
        x, y = body.position
        thick = float(body.primitives()[:, 2].max()) - y
        session.submit(Grab(handle))
        session.submit(Move(handle, x, y - 0.9))
        drive(session, 300)
        top = session.run.setup.outline[2][1]
        session.submit(Place(x, min(body.position[1] + thick + 0.7, top - 0.01), "regular"))
        drive(session, 5)
        assert session.refusals == (0, "")
        session.submit(Move(handle, x, y + 9.0))
        drive(session, 400)
        assert_goes_on(session, 2)


@pytest.mark.parametrize("scene", registry.names())
def test_whatever_commands_lead_to_is_saved_and_opened(scene: str) -> None:
    first = begun(scene)

    @settings(
        max_examples=4,
        deadline=None,
        derandomize=True,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
    @given(st.data())
    def tried(data: st.DataObject) -> None:
        session = opened(first)
        for _ in range(3):
            for command in data.draw(st.lists(commands(session), min_size=2, max_size=5)):
                session.submit(command)
                drive(session, 1)
            drive(session, 2)
            session.advance(data.draw(st.integers(1, 30)))
            assert_goes_on(session, 2)

    tried()
