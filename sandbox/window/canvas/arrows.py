"""The hand by keyboard: with the canvas in focus the arrow keys pull a handle, with Shift by small steps.

Tab goes from handle to handle.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

from sandbox.draw.overlays import KNOB
from sandbox.draw.painter import Painter
from sandbox.draw.widgets.look import draw_ring, ring_colour
from sandbox.session.commands import Grab, Move, Release
from sandbox.session.frame import HandleState
from sandbox.window.focus import CANVAS
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage

STEP = 0.25  # of the hand, a press [R]
FINE_STEP = (
    0.01  # and with Shift: whatever a lesson asks for, such as 0.15 R, is so many of them [R]
)
FINE = FINE_STEP / STEP
LEAD = 2.0  # the hand is never farther ahead of the body [R]
PAUSE = 1.0  # a press after such a pause begins a gesture of its own, to be undone by itself [s]
WAYS = {  # in steps
    Action.LEFT: (-1.0, 0.0),
    Action.RIGHT: (1.0, 0.0),
    Action.UP: (0.0, 1.0),
    Action.DOWN: (0.0, -1.0),
    Action.FINE_LEFT: (-FINE, 0.0),
    Action.FINE_RIGHT: (FINE, 0.0),
    Action.FINE_UP: (0.0, FINE),
    Action.FINE_DOWN: (0.0, -FINE),
}


class Arrows(Silent):
    """Grab at the first press, a step of the hand each, release when the keyboard goes elsewhere."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._held = ""  # name of the handle
        self._target = (0.0, 0.0)
        self._pressed = -math.inf  # when [s]

    def stops(self) -> Sequence[str]:
        """The handles; the canvas itself where there are none."""
        frame = self.stage.panes.snapshot.frame
        handles = () if frame is None else frame.handles
        return [f"{CANVAS}/{handle.name}" for handle in handles] or [CANVAS]

    def handle_state(self) -> HandleState | None:
        """The handle that the arrow keys pull."""
        frame, focus = self.stage.panes.snapshot.frame, self.stage.focus
        if frame is None or not frame.handles or not focus.on_canvas:
            return None
        name, names = focus.name.partition("/")[2], [handle.name for handle in frame.handles]
        return self.state_of(name if name in names else names[0])

    def state_of(self, name: str) -> HandleState | None:
        """A handle where it has come nearest to the hand, or else farthest: one that is locked holds back no other."""
        panes = self.stage.panes
        frames = [frame for seen in (panes.snapshot, *panes.snapshots) if (frame := seen.frame)]
        found = [(h, frame.stroke) for frame in frames for h in frame.handles if h.name == name]

        def behind(state: tuple[HandleState, float]) -> tuple[float, float]:
            handle, stroke = state
            there = (handle.x, handle.y)
            return math.dist(handle.target or there, there), -stroke

        return min(found, key=behind)[0] if found else None

    def act(self, action: Action) -> bool:
        """An arrow key, with the keyboard on the canvas."""
        handle = self.handle_state()
        if action not in WAYS or handle is None or self.stage.mouse.holding:
            return False
        step = self._step(handle, *WAYS[action])
        if step != (0.0, 0.0):
            self.lead(handle, *step)
        return True

    def lead(self, handle: HandleState, x: float, y: float) -> None:
        """On from where the hand wants it, by so much [R]; never far ahead of the body."""
        self._take(handle)
        x, y = self._target[0] + x - handle.x, self._target[1] + y - handle.y
        far = max(math.hypot(x, y) / LEAD, 1.0)
        self._move(handle.x + x / far, handle.y + y / far)

    def lead_to(self, handle: HandleState, x: float, y: float) -> None:
        """To a place [R], however far that is."""
        self._take(handle)
        self._move(x, y)

    def _take(self, handle: HandleState) -> None:
        """Another gesture, to be undone by itself, after a pause or with another handle."""
        now = time.perf_counter()
        if handle.name != self._held or now - self._pressed > PAUSE:
            if self._held != handle.name:
                self._let_go()
            self._held = handle.name
            self._target = handle.target if handle.target is not None else (handle.x, handle.y)
            self.stage.send(Grab(handle.name))
        self._pressed = now

    def _move(self, x: float, y: float) -> None:
        self._target = (x, y)
        self.stage.send(Move(self._held, x, y))
        self.stage.has_begun()

    def _step(self, handle: HandleState, x: float, y: float) -> tuple[float, float]:
        """A step of the hand; along the line that the handle can slide on."""
        if handle.axis is None:
            return STEP * x, STEP * y
        along = STEP * (x * handle.axis[0] + y * handle.axis[1])
        return along * handle.axis[0], along * handle.axis[1]

    def tick(self, now: float) -> bool:
        """Let go when the keyboard has gone elsewhere, or the mouse takes over."""
        del now
        handle = self.handle_state()
        if self._held and (handle is None or handle.name != self._held or self.stage.mouse.holding):
            if not self.stage.mouse.holding:
                self._let_go()
            self._held = ""
        return False

    def _let_go(self) -> None:
        """Of what is held, unless it went with the scene that it was in."""
        if f"{CANVAS}/{self._held}" in self.stops():
            self.stage.send(Release(self._held))

    def draw(self, painter: Painter) -> None:
        """The ring round the canvas and the handle, when Tab has brought the keyboard here."""
        if not self.stage.focus.ring.startswith(CANVAS):
            return
        handle = self.handle_state()
        for _, camera, rect in self.stage.picture.panes():
            draw_ring(painter, rect.inflate(-round(4 * painter.scale), -round(4 * painter.scale)))
            if handle is not None:
                x, y = camera.to_screen(handle.x, handle.y)
                if math.isfinite(x) and math.isfinite(y):
                    radius = 1.9 * KNOB * painter.scale
                    width, colour = 3.0 * painter.scale, ring_colour(painter.theme)
                    painter.ring(x, y, radius, width, colour, clip=rect)
