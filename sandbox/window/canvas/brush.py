"""The brush: grains placed, taken away or made another kind, walls drawn and taken away; by mouse or by keyboard."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter
from sandbox.draw.theme import kind_colour
from sandbox.draw.widgets.controls import Button, Choice, Control, Note, Option, Row, Slider
from sandbox.draw.widgets.look import ring_colour
from sandbox.draw.widgets.scale import typed
from sandbox.session.commands import DrawWall, Erase, EraseWall, Place, Retype
from sandbox.window.canvas.arrows import WAYS
from sandbox.window.hand import REACH, handle_at
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.sections import Value
from sandbox.window.stage import Stage
from sandbox.words import words

Point = tuple[float, float]

PLACE, ERASE, RETYPE, DRAW_WALL, ERASE_WALL = "place", "erase", "retype", "draw_wall", "erase_wall"
TOOLS = (PLACE, RETYPE, ERASE, DRAW_WALL, ERASE_WALL)
KINDS = ("regular", "auxetic")
LEAST, MOST, USUAL = 0.5, 10.0, 2.0  # radius of the brush [R]
APART = 2.0  # grains placed in one stroke are so far from each other [R]
STEP = 0.5  # of the brush by keyboard, a press [R]
SMOOTH = 0.1  # a drawn wall has its points no closer than this [R]


class Brush(Silent):
    """Which tool, how large, and the stroke under way; and the section of the panel about it."""

    name = "brush"

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.on = False
        self.tool = PLACE
        self.kind = "regular"
        self.radius = USUAL
        self._at: Point | None = None  # where the brush is [R]
        self._pane = 0
        self._stroke: list[Point] = []  # places of the stroke under way, or points of the wall
        self._drawing = False
        stage.at_new_scene(self._put_away)

    def _put_away(self) -> None:
        self.on = False

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """The key that takes it and puts it away; with it in hand the arrow keys and Enter."""
        if action is Action.BRUSH:
            self.take(not self.on)
            return True
        if not self.on or not self.stage.focus.on_canvas:
            return False
        if action in WAYS:
            x, y = self._at or self._middle()
            step_x, step_y = WAYS[action]
            self._at = (x + STEP * step_x, y + STEP * step_y)
            return True
        if action is Action.ENTER:
            self._press_by_key()
            return True
        return False

    def take(self, on: bool) -> None:
        """Take the brush, or put it away."""
        self.on = on
        self._stroke.clear()
        self._drawing = False
        self.stage.toast(words.BRUSH_ON if on else words.BRUSH_OFF)

    def _middle(self) -> Point:
        frame = self.stage.picture.panes()[0][0]
        x0, y0, x1, y1 = frame.bounds
        return 0.5 * (x0 + x1), 0.5 * (y0 + y1)

    def _press_by_key(self) -> None:
        """Use the tool where the brush is; a wall goes from the first press to the second."""
        at = self._at = self._at or self._middle()
        if self.tool != DRAW_WALL:
            self._use_at(at)
        elif not self._stroke:
            self._stroke = [at]
        else:
            self.stage.send(DrawWall((self._stroke[0], at)))
            self._stroke.clear()

    def handle(self, event: pygame.event.Event) -> bool:
        """The mouse on a canvas, unless it is at a handle; Escape puts the brush away."""
        if not self.on:
            return False
        if event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE:
            if self.stage.focus.on_canvas and not self.stage.focus.shown:
                self.take(False)
                return True
            return False
        if event.type == pygame.MOUSEMOTION:
            return self._motion(event.pos)
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._down(event.pos)
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self._drawing:
            self._up()
            return True
        return False

    def _motion(self, pos: tuple[int, int]) -> bool:
        if self.stage.mouse.holding:
            return False
        found = self._camera_at(pos)
        if found is None:
            self._at = self._at if self._drawing else None
            return self._drawing
        self._at = found.to_world(*pos)
        self.stage.redraw(True)
        if self._drawing:
            self._drag(self._at)
        return self._drawing

    def _down(self, pos: tuple[int, int]) -> bool:
        camera = self._camera_at(pos)
        if camera is None or self.stage.mouse.holding:
            return False
        frame = self.stage.picture.panes()[self._pane][0]
        reach = REACH * self.stage.renderer.scale
        if handle_at(pos, frame, camera, reach) is not None and self.tool != DRAW_WALL:
            return False  # the hand comes first
        self.stage.focus.leave()
        self._at = camera.to_world(*pos)
        self._drawing, self._stroke = True, [self._at]
        if self.tool != DRAW_WALL:
            self._use_at(self._at)
        return True

    def _drag(self, at: Point) -> None:
        gaps = {PLACE: APART, DRAW_WALL: SMOOTH, ERASE_WALL: self.radius}
        if math.dist(at, self._stroke[-1]) < gaps.get(self.tool, 0.5 * self.radius):
            return
        self._stroke.append(at)
        if self.tool != DRAW_WALL:
            self._use_at(at)

    def _up(self) -> None:
        if self.tool == DRAW_WALL:
            if self._at is not None and self._at != self._stroke[-1]:
                self._stroke.append(self._at)
            self.stage.send(DrawWall(tuple(self._stroke)))
        self._drawing = False
        self._stroke.clear()

    def _use_at(self, at: Point) -> None:
        x, y = at
        match self.tool:
            case "place":
                self.stage.send(Place(x, y, self.kind))
            case "erase":
                self.stage.send(Erase(x, y, self.radius))
            case "retype":
                self.stage.send(Retype(x, y, self.radius, self.kind))
            case "erase_wall":
                self.stage.send(EraseWall(x, y))

    def _camera_at(self, pos: tuple[int, int]) -> Camera | None:
        for index, (_, camera, rect) in enumerate(self.stage.picture.panes()):
            if rect.collidepoint(pos):
                self._pane = index
                return camera
        return None

    # -- drawing --

    def draw(self, painter: Painter) -> None:
        """The brush's circle in all packings, and the wall under way."""
        if not self.on or self._at is None:
            return
        colour = ring_colour(painter.theme)
        radius = self.radius if self.tool in (ERASE, RETYPE) else 1.0
        if self.tool in (DRAW_WALL, ERASE_WALL):
            radius = 0.3
        line = [*self._stroke, self._at] if self.tool == DRAW_WALL and self._stroke else []
        for _, camera, rect in self.stage.picture.panes():
            x, y = camera.to_screen(*self._at)
            size = max(radius * camera.scale, 4.0 * painter.scale)
            width = 2.5 * painter.scale
            painter.ring(x, y, size, width + 3.0 * painter.scale, painter.theme.ground, 0.7, rect)
            kind = kind_colour(painter.theme, self.kind)
            mark = kind if self.tool in (PLACE, RETYPE) else colour
            painter.ring(x, y, size, width, mark, clip=rect)
            places = [camera.to_screen(*point) for point in line]
            for start, end in pairwise(places):
                painter.line(start, end, 4.0 * painter.scale, colour, clip=rect)

    def cursor(self) -> int | None:
        """A cross over a canvas."""
        inside = self.on and self._at is not None and self.stage.mouse.hover is None
        return pygame.SYSTEM_CURSOR_CROSSHAIR if inside else None

    # -- the section of the panel --

    @property
    def title(self) -> str:
        """On the heading."""
        return words.BRUSH_TITLE

    @property
    def there(self) -> bool:
        """While the brush is in hand."""
        return self.on

    def controls(self) -> Sequence[Control]:
        """Tools, kind and size."""
        tools = [
            Button(
                f"brush/{tool}", words.TOOLS[tool], tool == self.tool, help=words.TOOLS_HELP[tool]
            )
            for tool in TOOLS
        ]
        controls: list[Control] = [Row(tuple(tools[:3])), Row(tuple(tools[3:]))]
        if self.tool in (PLACE, RETYPE):
            theme = self.stage.renderer.theme
            kinds = tuple(Option(k, words.KINDS_SHORT[k], kind_colour(theme, k)) for k in KINDS)
            controls.append(Choice("brush/kind", "", kinds, self.kind, words.BRUSH_KIND_HELP))
        if self.tool in (ERASE, RETYPE):
            controls.append(
                Slider(
                    "brush/radius",
                    words.BRUSH_RADIUS,
                    self.radius,
                    LEAST,
                    MOST,
                    USUAL,
                    "R",
                    at_once=True,
                    help=words.BRUSH_RADIUS_HELP,
                )
            )
        controls.append(Note(words.BRUSH_KEYS))
        return controls

    def use(self, name: str, value: Value, done: bool) -> None:
        """Another tool, kind or size."""
        del done
        what = name.partition("/")[2]
        if what in TOOLS:
            self.tool = what
            self._stroke.clear()
        elif what == "kind":
            self.kind = str(value)
        elif what == "radius":
            try:
                wanted = float(typed(value) if isinstance(value, str) else value)
            except ValueError:
                return
            if math.isfinite(wanted):
                self.radius = min(max(wanted, LEAST), MOST)
