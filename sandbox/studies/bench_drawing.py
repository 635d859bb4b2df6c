"""How long one picture takes."""

from __future__ import annotations

from sandbox.commands import Protocol
from sandbox.environment import prepare_headless
from sandbox.frame import Frame
from sandbox.session import Session
from sandbox.studies.bench_clock import in_turn
from sandbox.studies.bench_report import Row, Section, at_most

GRAINS, SIZE = 1000, (1280, 720)
TARGET = 9.0  # [ms]


def example(grains: int, increments: int = 5) -> Frame:
    """A frame with force chains in the middle of a drag."""
    session = Session("intruder", "mixed", 1, {"grains": grains})
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < increments and not (done and session.idle):
        done += session.advance(400)
    return session.frame()


def section(*, seconds: float, grains: int = GRAINS) -> Section:
    """The whole picture: grains, bodies, force chains, curve, letters."""
    prepare_headless()
    from sandbox.draw.render import Renderer

    frame = example(grains)
    renderer = Renderer(SIZE)

    def draw(times: int) -> None:
        for _ in range(times):
            renderer.draw(frame)

    times = in_turn({"draw": draw}, seconds=seconds)["draw"]
    milliseconds = times.data(1e-3)
    contacts = int((frame.contacts.force > 0.0).sum())
    row = Row(
        f"{len(frame.x)} grains with {contacts} forces at {SIZE[0]}×{SIZE[1]}",
        f"{milliseconds['min']:.1f} ms (median {milliseconds['median']:.1f})",
        *at_most(milliseconds["min"], TARGET, f"{TARGET:g} ms"),
    )
    data = {"grains": len(frame.x), "contacts": contacts, "ms": milliseconds}
    return Section("drawing", "Drawing, one core", (row,), data)
