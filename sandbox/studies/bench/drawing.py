"""How long one picture takes: one large packing, and three side by side."""

from __future__ import annotations

from itertools import islice

from sandbox.environment import prepare_headless
from sandbox.session.commands import Protocol
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.studies.bench.report import Row, Section, at_most
from sandbox.studies.bench.times import in_turn

GRAINS, SIZE = 1000, (1280, 720)
TARGET = 9.0  # [ms]
SIDE_BY_SIDE, GRAINS_EACH = ("regular", "mixed", "auxetic"), 300
TARGET_SIDE_BY_SIDE = 12.0  # [ms]: 60 pictures a second, and a quarter of the time for the rest


def example(grains: int, packing: str = "mixed", increments: int = 5) -> Frame:
    """A frame with force chains in the middle of a drag."""
    session = Session("intruder", packing, 1, {"grains": grains})
    session.build()
    session.submit(Protocol(True))
    for _ in islice(session.increments(400), increments):
        pass
    return session.frame()


def section(*, seconds: float, grains: int = GRAINS) -> Section:
    """The whole picture: grains, bodies, force chains, curves, letters."""
    prepare_headless()
    from sandbox.draw.render import Renderer

    few = min(grains, GRAINS_EACH)
    pictures = {
        "draw": [example(grains)],
        "side by side": [example(few, packing) for packing in SIDE_BY_SIDE],
    }
    renderers = {name: Renderer(SIZE) for name in pictures}

    def draw(name: str, times: int) -> None:
        for _ in range(times):
            renderers[name].draw(pictures[name])

    times = in_turn(
        {name: lambda times, name=name: draw(name, times) for name in pictures},  # type: ignore[misc]
        seconds=seconds,
    )
    rows, data = [], {}
    for name, target in (("draw", TARGET), ("side by side", TARGET_SIDE_BY_SIDE)):
        frames = pictures[name]
        milliseconds = times[name].data(1e-3)
        contacts = sum(int((frame.contacts.force > 0.0).sum()) for frame in frames)
        count = " + ".join(str(frame.grains) for frame in frames)
        rows.append(
            Row(
                f"{count} grains with {contacts} forces at {SIZE[0]}×{SIZE[1]}",
                f"{milliseconds['min']:.1f} ms (median {milliseconds['median']:.1f})",
                *at_most(milliseconds["min"], target, f"{target:g} ms"),
            )
        )
        data[name] = {"grains": count, "contacts": contacts, "ms": milliseconds}
    return Section("drawing", "Drawing, one core", tuple(rows), data)
