"""How evenly a held body follows the hand in the window, as a person sees it: a scripted mouse, and every picture looked at.

``python -m sandbox.window.smoothness CASE`` opens a window, with CASE the fields of ``Case`` as JSON, and prints what was seen,
working ahead and not, by turns in the same window, so that what else the machine does meanwhile is the same for both.

A picture counts if the hand was elsewhere than the body in the picture before: then the body should have moved. How soon a
turn is seen: the mouse jumps back to where it began; until the body is drawn on its way there.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any

import pygame

from sandbox.window.app import App
from sandbox.window.display import Looks
from sandbox.window.solvers.ahead import DEPTH
from sandbox.window.solvers.panes import Panes

NEAR = 0.02  # [R] half a pixel, about: a body nearer to the hand than that need not move
MOVED = 1e-4  # [R] and one that has gone further has moved
PATIENCE = 600.0  # until a scene is built, at a first start [s]
TURN = 1.0  # [s] until a turn is given up

Point = tuple[float, float]


@dataclass(frozen=True)
class Case:
    """What is dragged in the first of the ``packings``, and so in those beside it.

    ``way`` is a unit vector, ``speed`` that of the hand [R/s], for so many ``seconds``, ``rounds`` times, in a window of
    ``size`` [px].
    """

    scene: str
    packings: tuple[str, ...]
    settings: Mapping[str, object] = field(default_factory=dict)
    way: Point = (1.0, 0.0)
    speed: float = 3.0
    seconds: float = 3.0
    rounds: int = 2
    size: tuple[int, int] = (1280, 720)


@dataclass(frozen=True)
class Picture:
    """One that was drawn."""

    time: float  # [s]
    body: Point  # [R]
    hand: Point  # as the program knew it by then [R]


@dataclass(frozen=True)
class Drag:
    """What was seen of one drag."""

    depth: int
    pictures: int
    due: int  # of them, in which the body should have moved
    moved: int  # of those, in which it had
    rate: float  # pictures a second
    lag: float  # of the body behind the hand, mean [R]
    stood: float  # the longest that it stood still [s]
    turn: float | None  # until a turn was seen [s]; None: it was not


def drag(case: Case, depths: Sequence[int] = (0, DEPTH)) -> list[Drag]:
    """One for each round and each of ``depths``, increments that are made ahead."""
    panes = Panes(case.packings[0], 1)
    app = App(panes, Looks(case.size))
    try:
        return [_one(app, case, depth) for _ in range(case.rounds) for depth in depths]
    finally:
        app.close()


def _one(app: App, case: Case, depth: int) -> Drag:
    stage = app.stage
    stage.panes.depth = depth
    stage.start(case.scene, case.settings, case.packings)
    end = time.monotonic() + PATIENCE
    while app.shows_splash or stage.panes.snapshot.phase != "running":
        if time.monotonic() > end:
            raise TimeoutError(f"{case.scene} was not built within {PATIENCE:.0f} s")
        app.tick()
    mouse = _Mouse(app)
    start = mouse.body
    mouse.press()
    begun = time.perf_counter()
    while (now := time.perf_counter() - begun) < case.seconds:
        gone = case.speed * now
        mouse.point((start[0] + gone * case.way[0], start[1] + gone * case.way[1]))
        mouse.tick()
    pictures = mouse.pictures.copy()
    turned = time.perf_counter()
    back: float | None = None
    mouse.point((start[0] - case.way[0], start[1] - case.way[1]))
    while back is None and time.perf_counter() < turned + TURN:
        mouse.tick()
        back = _turned(mouse.pictures[len(pictures) - 1 :], case.way)
    mouse.release()
    return _told(depth, pictures, None if back is None else back - turned)


class _Mouse:
    """Posts what a mouse does, and notes every picture that is drawn."""

    def __init__(self, app: App) -> None:
        self._app = app
        self._place = (0, 0)
        self.pictures: list[Picture] = []

    def tick(self) -> None:
        """One picture."""
        self._app.tick()
        stage = self._app.stage
        frame, target = stage.picture.drawn[0], stage.mouse.hand.target
        if frame is not None and target is not None:
            handle = frame.handles[0]
            self.pictures.append(Picture(time.perf_counter(), (handle.x, handle.y), target))

    @property
    def body(self) -> Point:
        """Where the handle is [R]."""
        frame = self._app.stage.panes.snapshot.frame
        assert frame is not None
        return frame.handles[0].x, frame.handles[0].y

    def press(self) -> None:
        """Take the handle."""
        x, y = self._app.stage.renderer.camera.to_screen(*self.body)
        self._place = round(x), round(y)
        self._post(pygame.MOUSEMOTION, rel=(0, 0), buttons=(0, 0, 0))
        self._post(pygame.MOUSEBUTTONDOWN, button=1)

    def point(self, place: Point) -> None:
        """Move to a place of the scene [R]."""
        x, y = self._app.stage.renderer.camera.to_screen(*place)
        self._place = round(x), round(y)
        self._post(pygame.MOUSEMOTION, rel=(0, 0), buttons=(1, 0, 0))

    def release(self) -> None:
        """Let go."""
        self._post(pygame.MOUSEBUTTONUP, button=1)
        self._app.tick()

    def _post(self, kind: int, **more: Any) -> None:
        pygame.event.post(pygame.event.Event(kind, pos=self._place, **more))


def _turned(pictures: Sequence[Picture], way: Point) -> float | None:
    """When the body was first drawn going back [s]."""
    for before, after in pairwise(pictures):
        (x, y), (x2, y2) = before.body, after.body
        if (x2 - x) * way[0] + (y2 - y) * way[1] < -MOVED:
            return after.time
    return None


def _told(depth: int, pictures: Sequence[Picture], turn: float | None) -> Drag:
    """The numbers of a drag."""
    due = moved = 0
    stood = since = 0.0
    for before, after in pairwise(pictures):
        went = math.dist(before.body, after.body) > MOVED
        if math.dist(before.hand, before.body) > NEAR:
            due, moved = due + 1, moved + went
            since = 0.0 if went else since + after.time - before.time
            stood = max(stood, since)
    seconds = pictures[-1].time - pictures[0].time
    lag = sum(math.dist(one.hand, one.body) for one in pictures) / len(pictures)
    rate = (len(pictures) - 1) / seconds
    return Drag(depth, len(pictures), due, moved, rate, lag, stood, turn)


def main(words: Sequence[str]) -> int:
    """One line of JSON for each drag."""
    os.environ.setdefault("SDL_AUDIODRIVER", "dummy")
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    given: dict[str, Any] = json.loads(words[0])
    fields: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in given.items()}
    for seen in drag(Case(**fields)):
        sys.stdout.write(f"{json.dumps(asdict(seen))}\n")
    sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
