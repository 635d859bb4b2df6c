"""The share of contacts that pull harder than friction allows: in increments, rows, tables, frames and the status line."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from core import frictional_contacts
from sandbox.draw.render import Renderer
from sandbox.draw.text import Type
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from tests.draw.frames import intruder_frame


def pressed(friction: float, increments: int = 6) -> Session:
    """A row of grains under the piston."""
    session = Session("grain_row", "mixed", 1, {"tolerance": 1e-3, "friction": friction})
    session.build()
    session.submit(Protocol(True))
    while len(session.history) <= increments:
        session.advance()
    return session


def test_no_contact_is_beyond_the_cone_by_the_law_itself() -> None:
    session = pressed(0.3)
    assert session.run.last.friction is not None
    assert len(session.run.last.friction.i)
    assert np.all(session.history.column("beyond_cone") == 0.0)


def test_rows_tables_and_frames_carry_what_the_increment_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(frictional_contacts, "BEYOND", 0.5)  # half a cone: what slides is beyond it
    session = pressed(0.3)
    increment = session.run.last
    forces = increment.friction
    assert forces is not None
    contacts = increment.grain_contacts, increment.body_contacts
    counted = forces.beyond_cone(0.3, len(session.frame().x), *contacts)
    assert increment.beyond_cone == counted
    assert 0.0 < counted <= 1.0
    assert session.history[-1].beyond_cone == counted
    place = session.table.header().index("share of contacts beyond the friction cone")
    assert list(session.table.rows())[-1][place] == counted
    assert session.frame().beyond_cone == counted
    session.run.recall(3)
    assert session.frame().beyond_cone == session.history[3].beyond_cone


def test_without_friction_nobody_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frictional_contacts.FrictionForces, "beyond_cone", None)
    session = pressed(0.0)
    assert session.run.last.friction is None
    assert session.run.last.beyond_cone == session.history[-1].beyond_cone == 0.0


def test_the_status_line_says_it_only_where_there_is_any(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    render = Type.render

    def spy(self: Type, text: str, *rest: Any, **more: Any) -> Any:
        said.append(text)
        return render(self, text, *rest, **more)

    monkeypatch.setattr(Type, "render", spy)
    frame = intruder_frame(8)
    Renderer((1280, 720)).image(frame)
    assert not [text for text in said if "beyond friction" in text]
    Renderer((1280, 720)).image(replace(frame, beyond_cone=0.018))
    assert "2 % beyond friction" in said
    Renderer((1280, 720)).image([frame, replace(frame, beyond_cone=0.04), frame])
    assert "5 % beyond friction" in said
