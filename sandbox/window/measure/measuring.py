"""Measuring by mouse or by keyboard: one tool at a time, whose ends are dragged; what it reads stands beside it and in the panel.

A tool lies at the same place in all packings side by side, and reads each of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.marks import Mark, marks
from sandbox.draw.measures import (
    KNOB,
    draw_angle,
    draw_crossings,
    draw_knobs,
    draw_line,
    draw_marks,
)
from sandbox.draw.numbers import number
from sandbox.draw.painter import Painter
from sandbox.draw.widgets.controls import Bars, Button, Control, Fact, Note, Row
from sandbox.draw.widgets.scale import shown
from sandbox.session.frame import Frame
from sandbox.window.canvas.arrows import WAYS
from sandbox.window.canvas.brush import Brush
from sandbox.window.keys import Action
from sandbox.window.measure.gauges import (
    FORCES,
    SHAPES,
    Spread,
    angle,
    between,
    force_through,
    forces_over_mean,
    length_over_width,
    spread,
)
from sandbox.window.parts import Silent
from sandbox.window.sections import Value
from sandbox.window.stage import Stage
from sandbox.words import words

Point = tuple[float, float]

RULER, PROTRACTOR, CUT, MARKS, SPREADS = "ruler", "protractor", "cut", "marks", "spreads"
TOOLS = (RULER, PROTRACTOR, CUT, MARKS, SPREADS)
# Where the ends of a tool lie at first, in shares of the picture's width and height.
FIRST = {
    RULER: ((0.35, 0.5), (0.65, 0.5)),
    PROTRACTOR: ((0.65, 0.4), (0.4, 0.4), (0.55, 0.65)),
    CUT: ((0.03, 0.5), (0.97, 0.5)),
}
STEP = 0.25  # of an end by keyboard, a press [R]
MARK_STEP = 1.0 / 40.0  # of a mark by keyboard, of the plot's width
REACH = 2.2  # an end is taken from so many of its radii
SNAP = 6.0  # an end lies on the centre of a grain that is so near, at scale 1 [px]


class Measuring(Silent):
    """Which tool is in hand, and where its ends are; and the section of the panel that tells what it reads."""

    name = "measure"

    def __init__(self, stage: Stage, brush: Brush) -> None:
        self.stage, self._brush = stage, brush
        self.on = False
        self.tool = RULER
        self.chosen = 0  # the end that is moved; one more than there are: all of them
        self._at: Point = (0.0, 0.0)  # where the tool was taken hold of [R]
        self.marks: tuple[float, float] | None = None
        self._ends: dict[str, list[Point]] = {}
        self._dragging = False
        stage.at_new_scene(self._forget)

    def _forget(self) -> None:
        self.on, self.marks = False, None
        self._ends.clear()

    @property
    def ends(self) -> list[Point]:
        """Of the tool in hand [R]; none of one that has none on the canvas."""
        if self.tool not in FIRST:
            return []
        panes = self.stage.picture.panes()
        if self.tool not in self._ends and panes:
            x0, y0, x1, y1 = panes[0][0].bounds
            shares = FIRST[self.tool]
            self._ends[self.tool] = [(x0 + u * (x1 - x0), y0 + v * (y1 - y0)) for u, v in shares]
            box = panes[0][0].box
            if self.tool == CUT and box is not None and math.isfinite(box[0]):
                # Right across the cell, wherever it begins: a longer one would meet contacts twice.
                self._ends[CUT] = [(x, 0.5 * (y0 + y1)) for x in (0.0, box[0])]
        return self._ends.get(self.tool, [])

    def take(self, tool: str) -> None:
        """Take a tool in hand; nothing puts all away."""
        if tool and self._brush.on:
            self._brush.take(False)
        self.on = bool(tool)
        self.tool = tool or self.tool
        panes = self.stage.picture.panes()
        if tool == CUT and panes and panes[0][0].box is not None:
            self._ends.pop(CUT, None)  # the cell may have another width by now
        self.chosen, self._dragging = 0, False
        box = self.stage.renderer.plot_box
        if self.tool == MARKS and self.marks is None and box is not None:
            self.marks = (
                box.low + 0.25 * (box.high - box.low),
                box.low + 0.75 * (box.high - box.low),
            )
        said = words.MEASURES_HELP[self.tool] if self.tool == SPREADS else words.MEASURE_ON
        said = said.format(tool=words.MEASURES[self.tool])
        self.stage.toast(said if tool else words.MEASURE_OFF)

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """The key that goes through the tools; with one in hand the arrow keys and Enter."""
        if action is Action.MEASURE:
            following = TOOLS[TOOLS.index(self.tool) + 1 :] if self.on else TOOLS
            self.take(following[0] if following else "")
            return True
        if action is Action.BRUSH and self.on:
            self.take("")
            return False
        if not self.on or not self.stage.focus.on_canvas or self.tool == SPREADS:
            return False
        count = 2 if self.tool == MARKS else len(self.ends) + 1
        if action is Action.ENTER and count:
            self.chosen = (self.chosen + 1) % count
            return True
        if action not in WAYS:
            return False
        across, up = WAYS[action]
        if self.tool == MARKS:
            self._move_mark(across)
        else:
            self._shift(STEP * across, STEP * up)
        self.stage.redraw(True)
        return True

    def _shift(self, x: float, y: float) -> None:
        """The chosen end, or all of them, by so much [R]."""
        for index, end in enumerate(self.ends):
            if self.chosen in (index, len(self.ends)):
                self.ends[index] = (end[0] + x, end[1] + y)

    def _move_mark(self, across: float) -> None:
        box = self.stage.renderer.plot_box
        if self.marks is not None and box is not None:
            at = self.marks[self.chosen] + across * MARK_STEP * (box.high - box.low)
            self._put_mark(min(max(at, box.low), box.high))

    def _put_mark(self, at: float) -> None:
        assert self.marks is not None
        self.marks = (at, self.marks[1]) if self.chosen == 0 else (self.marks[0], at)

    def handle(self, event: pygame.event.Event) -> bool:
        """The mouse at an end, or on the plot; Escape puts the tool away."""
        if not self.on:
            return False
        if event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE:
            away = self.stage.focus.on_canvas and not self.stage.focus.shown
            if away:
                self.take("")
            return away
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self._dragging = self._take_end(event.pos)
            if self._dragging:
                self.stage.focus.leave()
            return self._dragging
        if event.type == pygame.MOUSEMOTION and self._dragging:
            self._drag(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and self._dragging:
            self._dragging = False
            return True
        return False

    def _take_end(self, pos: tuple[int, int]) -> bool:
        reach = REACH * KNOB * self.stage.renderer.scale
        if self.tool == MARKS:
            box = self.stage.renderer.plot_box
            if self.marks is None or box is None or not box.rect.collidepoint(pos):
                return False
            self.chosen = min((0, 1), key=lambda k: abs(float(box.x(self.marks[k])) - pos[0]))  # type: ignore[index]
            self._drag(pos)
            return True
        for _, camera, rect in self.stage.picture.panes():
            if rect.collidepoint(pos):
                away = [math.dist(camera.to_screen(*end), pos) for end in self.ends]
                if away and min(away) <= reach:
                    self.chosen = away.index(min(away))
                    return True
                at = camera.to_world(*pos)
                if any(
                    _beside(at, *line) * camera.scale <= 0.5 * reach for line in pairwise(self.ends)
                ):
                    self.chosen, self._at = len(self.ends), at
                    return True
        return False

    def _drag(self, pos: tuple[int, int]) -> None:
        self.stage.redraw(True)
        if self.tool == MARKS:
            box = self.stage.renderer.plot_box
            if box is not None and self.marks is not None:
                self._put_mark(box.at(*pos)[0])
            return
        pane = self.stage.picture.pane_at(pos)
        if pane is not None:
            frame, camera, _ = self.stage.picture.panes()[pane]
            if self.chosen == len(self.ends):
                at = camera.to_world(*pos)
                self._shift(at[0] - self._at[0], at[1] - self._at[1])
                self._at = at
                return
            self.ends[self.chosen] = self._snapped(frame, camera, pos)

    def _snapped(self, frame: Frame, camera: Camera, pos: tuple[int, int]) -> Point:
        """The place under the mouse, or the centre of the grain that is just there."""
        near, least = camera.to_world(*pos), SNAP * self.stage.renderer.scale / camera.scale
        if self.tool == CUT:  # a line through centres would leave open which side they are on
            return near
        for x, y in zip(frame.x.tolist(), frame.y.tolist(), strict=True):
            if (away := math.dist((x, y), camera.to_world(*pos))) < least:
                near, least = (x, y), away
        return near

    def cursor(self) -> int | None:
        """A cross where an end is dragged."""
        return pygame.SYSTEM_CURSOR_CROSSHAIR if self.on and self._dragging else None

    # -- drawing --

    def draw(self, painter: Painter) -> None:
        """The tool in all packings, with what it reads there."""
        if not self.on:
            return
        chosen = self.chosen if self.stage.focus.on_canvas else None
        panes = self.stage.picture.panes()
        box = self.stage.renderer.plot_box
        if self.tool == MARKS and self.marks is not None and box is not None:
            told = marks([frame for frame, _, _ in panes])
            means = [
                (self._between(frame).mean, mark.colour)
                for (frame, _, _), mark in zip(panes, told, strict=True)
            ]
            draw_marks(painter, box, self.marks, means, chosen)
        for frame, camera, rect in panes if self.ends else ():
            if self.tool == PROTRACTOR:
                draw_angle(painter, rect, camera, self.ends, self._angle())
            elif self.tool == RULER:
                draw_line(painter, rect, camera, self.ends, self._length())
            else:
                found = force_through(frame, *self.ends)
                if found is not None:
                    label = words.MEASURE_THROUGH.format(
                        pressing=_value(found.pressing), sliding=_value(found.sliding)
                    )
                    draw_line(painter, rect, camera, self.ends, label, dashed=True)
                    draw_crossings(painter, rect, camera, found.x, found.y)
            draw_knobs(painter, rect, camera, self.ends, chosen)

    def _length(self) -> str:
        return f"{number(math.dist(*self.ends), 2)} R"

    def _angle(self) -> str:
        return f"{number(angle(*self.ends), 1)}°"

    def _between(self, frame: Frame) -> Spread:
        assert self.marks is not None
        return between(frame.curve_stroke, frame.curve_force, self.marks)

    # -- the section of the panel --

    @property
    def title(self) -> str:
        """On the heading."""
        return words.MEASURE_TITLE

    @property
    def there(self) -> bool:
        """While something is measured."""
        return self.on

    def controls(self) -> Sequence[Control]:
        """The tools, and what the one in hand reads in each packing."""
        buttons = [
            Button(
                f"measure/{tool}",
                words.MEASURES[tool],
                tool == self.tool,
                help=words.MEASURES_HELP[tool],
            )
            for tool in TOOLS
        ]
        controls: list[Control] = [Row(tuple(buttons[:2])), Row(tuple(buttons[2:4])), buttons[4]]
        frames = [frame for frame, _, _ in self.stage.picture.panes()]
        for frame, mark in zip(frames, marks(frames), strict=True):
            if len(frames) > 1 and self.tool not in (RULER, PROTRACTOR):
                controls.append(Fact(mark.name, "", strong=True))
            controls += self._read(frame, mark)
            if self.tool in (RULER, PROTRACTOR):
                break  # the same in all
        controls.append(Note(words.MEASURES_HELP[self.tool]))
        controls.append(Note(words.MEASURE_KEYS))
        return controls

    def _read(self, frame: Frame, mark: Mark) -> list[Control]:
        """What the tool in hand reads."""
        if self.tool == RULER:
            return [Fact(words.MEASURE_LENGTH, self._length(), strong=True)]
        if self.tool == PROTRACTOR:
            return [Fact(words.MEASURE_ANGLE, self._angle(), strong=True)]
        if self.tool == SPREADS:
            return _spreads(frame, mark.colour)
        if self.tool == MARKS:
            if self.marks is None:
                return []
            found = self._between(frame)
            low, high = sorted(self.marks)
            return [
                Fact(words.MEASURE_BETWEEN, f"{_value(low)} … {_value(high)}"),
                Fact(words.MEASURE_MEAN, _value(found.mean), strong=True),
                Fact(words.MEASURE_DEVIATION, _value(found.deviation), strong=True),
                Fact(words.MEASURE_COUNT, str(found.count)),
            ]
        through = force_through(frame, *self.ends) if self.ends else None
        if through is None:
            return [Fact(words.MEASURE_PRESSING, "—")]
        return [
            Fact(words.MEASURE_PRESSING, f"{_value(through.pressing, 4)} k R", strong=True),
            Fact(words.MEASURE_SLIDING, f"{_value(through.sliding, 4)} k R", strong=True),
            Fact(words.MEASURE_CONTACTS, str(through.contacts)),
            Fact(words.MEASURE_LENGTH, self._length()),
        ]

    def use(self, name: str, value: Value, done: bool) -> None:
        """Another tool."""
        del value, done
        self.take(name.partition("/")[2])


def _beside(at: Point, start: Point, end: Point) -> float:
    """How far a place is from a line between two others [R]."""
    x, y = end[0] - start[0], end[1] - start[1]
    square = x * x + y * y
    along = ((at[0] - start[0]) * x + (at[1] - start[1]) * y) / square if square > 0.0 else 0.0
    along = min(max(along, 0.0), 1.0)
    return math.dist(at, (start[0] + along * x, start[1] + along * y))


def _spreads(frame: Frame, colour: int) -> list[Control]:
    """Forces and shapes of a packing as bars."""
    carried = frame.contacts.force[frame.contacts.force > 0.0]
    forces, plain = spread(forces_over_mean(frame.contacts), FORCES), spread(carried, FORCES)
    shapes = spread(length_over_width(frame), SHAPES)
    return [
        _bars(words.MEASURE_FORCES, forces, plain, "k R", "0", FORCES[-1], colour),
        _bars(words.MEASURE_SHAPES, shapes, shapes, "", "1", SHAPES[-1], colour),
    ]


def _bars(
    title: str, found: Spread, told: Spread, unit: str, low: str, top: float, colour: int
) -> Bars:
    """Bars of ``found``; mean and spread in words are those of ``told``."""
    value = f"{_value(told.mean)} ± {_value(told.deviation)} {unit}".strip()
    shares = tuple(found.shares.tolist())
    return Bars(
        title, value if found.count else "—", shares, low, f"≥ {number(float(top), 0)}", colour
    )


def _value(value: float, figures: int = 3) -> str:
    """With so many figures that mean something."""
    return shown(float(f"{value:.{figures}g}")) if math.isfinite(value) else "—"
