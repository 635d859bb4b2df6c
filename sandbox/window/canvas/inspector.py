"""Looking at one grain: a click chooses it, the panel says all about it, I goes to the next one in contact."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.numbers import number
from sandbox.draw.painter import Painter
from sandbox.draw.periodic import images
from sandbox.draw.widgets.controls import Button, Control, Fact, Note
from sandbox.draw.widgets.scale import shown
from sandbox.session.frame import Frame
from sandbox.window.canvas.inspection import Inspection, grain_at, inspect
from sandbox.window.hand import REACH, handle_at
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.sections import Value
from sandbox.window.stage import Stage
from sandbox.words import words

STILL = 6.0  # a press that moves less than this is a click, at scale 1 [px]


class Inspector(Silent):
    """Which grain is looked at, in which of the packings side by side; and the section that tells about it."""

    name = "grain"

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.label: int | None = None
        self.pane = 0
        self._scene = ""
        self._press: tuple[int, int] | None = None
        self._seen: list[int] = []  # labels looked at, the latest last

    @property
    def frame(self) -> Frame | None:
        """The packing that the grain belongs to."""
        panes = self.stage.picture.panes()
        return panes[self.pane][0] if self.pane < len(panes) else None

    @property
    def inspection(self) -> Inspection | None:
        """What there is to say now."""
        frame = self.frame
        return None if frame is None or self.label is None else inspect(frame, self.label)

    def look(self, label: int | None, pane: int | None = None) -> None:
        """Look at a grain; None: at none."""
        self.label = label
        self.pane = self.pane if pane is None else pane
        self._seen = [seen for seen in self._seen if seen != label]
        if label is None:
            self._seen.clear()
        else:
            self._seen.append(label)
        self.stage.redraw(True)

    def next_in_contact(self) -> None:
        """Along the strongest contact to a grain not yet looked at, else to the one looked at longest ago.

        From a grain that touches no other: to the nearest.
        """
        found, frame = self.inspection, self.frame
        if frame is None or not frame.grains:
            return
        if found is None:
            self.look(self._first(frame))
            return
        near = [touch.label for touch in found.touches if touch.label is not None]
        new = [label for label in near if label not in self._seen]
        if new:
            self.look(new[0])
        elif near:
            self.look(min(near, key=self._seen.index))
        else:
            self.look(self._nearest(frame, found.x, found.y))

    def _first(self, frame: Frame) -> int:
        """The grain nearest to the first handle, or to the middle."""
        x0, y0, x1, y1 = frame.bounds
        if frame.handles:
            return self._nearest(frame, frame.handles[0].x, frame.handles[0].y)
        return self._nearest(frame, 0.5 * (x0 + x1), 0.5 * (y0 + y1))

    def _nearest(self, frame: Frame, x: float, y: float) -> int:
        """The nearest grain to a place [R] that was not looked at yet; the nearest of all if there is no other."""
        away = np.hypot(frame.x - x, frame.y - y)
        away = np.where(np.isfinite(away), away, np.inf)
        new = np.where(np.isin(frame.label, self._seen), np.inf, away)
        return int(frame.label[int(np.argmin(new if np.isfinite(new).any() else away))])

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """The key for the next grain."""
        if action is not Action.NEXT_CONTACT:
            return False
        self.next_in_contact()
        return True

    def handle(self, event: pygame.event.Event) -> bool:
        """A click on a grain, Escape."""
        if event.type == pygame.KEYDOWN:
            on_canvas = self.stage.focus.on_canvas and not self.stage.focus.shown
            if event.key == pygame.K_ESCAPE and self.label is not None and on_canvas:
                self.look(None)
                return True
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self._press = None if self.stage.mouse.holding else event.pos
        elif event.type == pygame.MOUSEBUTTONUP and event.button == 1:
            press, self._press = self._press, None
            still = press is not None and math.dist(press, event.pos) <= (
                STILL * self.stage.renderer.scale
            )
            if still and not self.stage.mouse.holding:
                self._click(event.pos)
        return False

    def _click(self, pos: tuple[int, int]) -> None:
        for index, (frame, camera, rect) in enumerate(self.stage.picture.panes()):
            if not rect.collidepoint(pos):
                continue
            if handle_at(pos, frame, camera, REACH * self.stage.renderer.scale) is None:
                self.stage.focus.leave()
                self.look(grain_at(frame, *camera.to_world(*pos)), index)

    def tick(self, now: float) -> bool:
        """A grain that is no more, or another scene: look at none."""
        del now
        frame = self.frame
        if self.label is None or frame is None:
            return False
        if frame.scene != self._scene or self.inspection is None:
            gone, self._scene = self._scene == frame.scene, frame.scene
            if gone or self.inspection is None:
                self.look(None)
            return True
        return False

    def draw(self, painter: Painter) -> None:
        """A ring round the grain, at all its images in a periodic cell."""
        found = self.inspection
        panes = self.stage.picture.panes()
        if found is None or self.pane >= len(panes):
            return
        frame, camera, rect = panes[self.pane]
        for x, y in _images(frame, found):
            _draw_outline(painter, rect, camera, found, x, y)

    # -- the section of the panel --

    @property
    def title(self) -> str:
        """On the heading."""
        return words.GRAIN_TITLE

    @property
    def there(self) -> bool:
        """While a grain is looked at."""
        return self.inspection is not None

    def controls(self) -> Sequence[Control]:
        """All about the grain; every neighbour is a button that leads to it."""
        found = self.inspection
        if found is None:
            return ()
        kind = words.KINDS_SHORT["auxetic" if found.auxetic else "regular"]
        facts: list[Control] = [
            Fact(words.GRAIN_LABEL.format(label=found.label), kind, strong=True),
            Fact(words.GRAIN_RATIO, shown(round(found.poisson_ratio, 4))),
            Fact(words.GRAIN_AXES, f"{number(found.a, 4)} × {number(found.b, 4)} R"),
            Fact(words.GRAIN_ANGLE, f"{number(found.angle, 1)}°"),
            Fact(words.GRAIN_REST, f"{number(found.rest_radius, 4)} R"),
            Fact(words.GRAIN_AREA, f"{number(100.0 * found.area_change, 2)} %"),
            Fact(words.GRAIN_PRESSURE, f"{number(found.pressure, 4)} k"),
            Fact(words.GRAIN_CONTACTS, str(len(found.touches))),
            Fact(words.GRAIN_TOTAL, f"{number(found.total_force, 4)} k R"),
            Fact(words.GRAIN_UNBALANCED, _unbalanced(found), strong=True),
        ]
        for touch in found.touches:
            force = f"{number(touch.force, 4)} k R"
            if touch.label is None:
                facts.append(Fact(words.GRAIN_WALL, force))
            else:
                title = words.GRAIN_OTHER.format(label=touch.label, force=force)
                facts.append(Button(f"grain/{touch.label}", title, help=words.GRAIN_OTHER_HELP))
        facts.append(Note(words.GRAIN_KEYS))
        return facts

    def use(self, name: str, value: Value, done: bool) -> None:
        """Go to a neighbour."""
        del value, done
        label = name.partition("/")[2]
        if label.lstrip("-").isdigit():
            self.look(int(label))


def _unbalanced(found: Inspection) -> str:
    """The sum of all forces, and what part of the contact forces that is."""
    if not math.isfinite(found.unbalanced):
        return "—"
    text = f"{shown(float(f'{found.unbalanced:.2g}'))} k R"
    if found.total_force > 0.0:
        share = 100.0 * found.unbalanced / found.total_force
        text += f" ({shown(float(f'{share:.2g}'))} %)"
    return text


def _images(frame: Frame, found: Inspection) -> list[tuple[float, float]]:
    """Where the grain is drawn [R]."""
    if frame.box is None:
        return [(found.x, found.y)]
    reach = np.array([found.a])
    x, y = np.array([found.x]), np.array([found.y])
    _, move_x, move_y = images(frame.box, x - reach, y - reach, x + reach, y + reach)
    return [
        (found.x + float(dx), found.y + float(dy)) for dx, dy in zip(move_x, move_y, strict=True)
    ]


def _draw_outline(
    painter: Painter, rect: pygame.Rect, camera: Camera, found: Inspection, x: float, y: float
) -> None:
    """An ellipse a little outside the grain's, on a rim of ground colour."""
    scale = painter.scale
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    tilt = math.radians(found.angle)
    grown = 3.0 * scale / camera.scale
    u, v = (found.a + grown) * np.cos(turn), (found.b + grown) * np.sin(turn)
    centre_x, centre_y = camera.to_screen(x, y)
    px = centre_x + camera.scale * (u * math.cos(tilt) - v * math.sin(tilt))
    py = centre_y - camera.scale * (u * math.sin(tilt) + v * math.cos(tilt))
    if np.isfinite(px).all() and np.isfinite(py).all():
        painter.polyline(px, py, 7.0 * scale, painter.theme.ground, rect)
        painter.polyline(px, py, 3.5 * scale, painter.theme.text, rect)
