"""A question of a lesson: an option is chosen, a number typed, a curve drawn onto the plot; and nothing moves meanwhile."""

from __future__ import annotations

import math

import numpy as np
import pygame

from sandbox.draw.pages.tour_card import FIELD, OPTION, Field
from sandbox.draw.painter import Painter
from sandbox.draw.sketch import COLUMNS, Beside, Sketch, draw_sketch
from sandbox.draw.widgets.scale import shown, typed
from sandbox.lessons.answers import Given
from sandbox.lessons.lesson import Predict
from sandbox.window.canvas.arrows import WAYS
from sandbox.window.keys import Action
from sandbox.window.panel.line_edit import Edit
from sandbox.window.parts import Silent
from sandbox.window.sketched import beside
from sandbox.window.stage import Stage
from sandbox.words import words

SKETCH = "tour/sketch"  # where the keyboard is while it draws
UP_STEP = 1.0 / 40.0  # of the plot's height, a press of an arrow key
MOVES = frozenset((*WAYS, Action.PROTOCOL, Action.STEP, Action.PAUSE, Action.FORWARD))
LONGEST = 12  # signs of a number


class Asking(Silent):
    """What is asked, and what was answered so far; a sketch stays over the plot when it has been handed over."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.predict: Predict | None = None  # that waits for an answer
        self.chosen: int | None = None
        self.edit = Edit.of(FIELD, "")
        self.sketch: Sketch | None = None
        self._last: tuple[float, float] | None = None  # of the stroke under way
        self._drawing = False

    @property
    def on(self) -> bool:
        """Does something wait for an answer?"""
        return self.predict is not None

    def begin(self, predict: Predict) -> None:
        """Ask."""
        self.forget()
        self.predict = predict
        if predict.kind == "sketch":
            self.sketch = Sketch(predict.axes)
            self.stage.renderer.plot_least = predict.axes
        stops = self.stops()
        self.stage.focus.go(stops[0], self.stage.focus.shown)
        self.stage.panes.hold()

    def end(self) -> None:
        """No more of the question; go on. A sketch stays."""
        if self.predict is not None:
            self.predict = None
            self._last, self._drawing = None, False
            if self.sketch is not None:
                self.sketch.cursor = None
            if self.stage.focus.name.startswith((OPTION, FIELD, SKETCH)):
                self.stage.focus.leave()
            self.stage.panes.go_on()

    def forget(self) -> None:
        """Another step begins: nothing is asked, and nothing lies over the plot."""
        self.end()
        self.chosen, self.edit, self.sketch = None, Edit.of(FIELD, ""), None
        self.stage.renderer.plot_least = None

    @property
    def given(self) -> Given | None:
        """The answer so far; None: there is none."""
        if self.predict is None:
            return None
        if self.predict.kind == "choice":
            return None if self.chosen is None else float(self.chosen)
        if self.predict.kind == "number":
            try:
                value = float(typed(self.edit.text))
            except ValueError:
                return None
            return value if math.isfinite(value) else None
        if self.sketch is None or not self.sketch.there:
            return None
        drawn = np.isfinite(self.sketch.up)
        return self.sketch.along[drawn], self.sketch.up[drawn]

    @property
    def field(self) -> Field | None:
        """For the card, where a number is asked for."""
        if self.predict is None or self.predict.kind != "number":
            return None
        typing = self.stage.focus.name == FIELD
        return Field(self.edit.text, self.predict.unit, self.edit.caret if typing else None)

    @property
    def hint(self) -> str:
        """How to answer."""
        if self.predict is None or self.predict.kind != "sketch":
            return ""
        return words.ASK_SKETCH if self.stage.renderer.plot_box is not None else words.ASK_NO_PLOT

    def stops(self) -> list[str]:
        """What Tab goes to."""
        if self.predict is None:
            return []
        if self.predict.kind == "choice":
            return [f"{OPTION}{index}" for index in range(len(self.predict.options))]
        return [FIELD] if self.predict.kind == "number" else [SKETCH]

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """While it asks, nothing is moved; with the keyboard at the sketch, arrow keys draw."""
        if self.predict is None:
            return False
        if self.sketch is not None and self.stage.focus.name == SKETCH and action in WAYS:
            self._go(*WAYS[action])
            return True
        if action in MOVES:
            self.stage.toast(words.ASK_FIRST)
            return True
        return False

    def choose(self, index: int) -> None:
        """One of the options."""
        self.chosen = index
        self.stage.focus.go(f"{OPTION}{index}", self.stage.focus.shown)
        self.stage.redraw(True)

    def handle(self, event: pygame.event.Event) -> bool:
        """Keys for what has the keyboard; the mouse on the plot draws, and takes no handle."""
        if self.predict is None:
            return False
        if event.type == pygame.KEYDOWN:
            return self._key(event)
        if event.type in (pygame.TEXTINPUT, pygame.TEXTEDITING) and self.stage.focus.name == FIELD:
            if event.type == pygame.TEXTINPUT:
                self.edit.write(event.text)
                self.edit.text = self.edit.text[:LONGEST]
                self.edit.caret = self.edit.anchor = min(self.edit.caret, LONGEST)
                self.stage.redraw(True)
            return True
        if event.type == pygame.MOUSEMOTION and self._drawing:
            self._draw_at(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and self._drawing:
            self._drawing, self._last = False, None
            return True
        if event.type != pygame.MOUSEBUTTONDOWN or event.button != 1:
            return False
        box = self.stage.renderer.plot_box
        if (
            self.sketch is not None
            and box is not None
            and self.stage.renderer.layout.plot.collidepoint(event.pos)
        ):
            self.stage.focus.go(SKETCH, False)
            self._drawing, self._last, self.sketch.cursor = True, None, None
            self._draw_at(event.pos)
            return True
        return False

    def refuse(self, pos: tuple[int, int]) -> bool:
        """A press on a canvas: first the answer."""
        if self.predict is None or self.stage.picture.pane_at(pos) is None:
            return False
        self.stage.toast(words.ASK_FIRST)
        return True

    def _key(self, event: pygame.event.Event) -> bool:
        name, key = self.stage.focus.name, event.key
        if name == FIELD:
            return self._type(event)
        if name == SKETCH and self.sketch is not None:
            if key in (pygame.K_BACKSPACE, pygame.K_DELETE):
                self.sketch.up[:] = np.nan
                self._last = None
                return True
            if key == pygame.K_SPACE:
                self._put_down()
                return True
        if not name.startswith(OPTION):
            return False
        assert self.predict is not None
        index, count = int(name.removeprefix(OPTION)), len(self.predict.options)
        if key in (pygame.K_UP, pygame.K_DOWN):
            way = 1 if key == pygame.K_DOWN else -1
            self.stage.focus.go(f"{OPTION}{(index + way) % count}", True)
        elif key == pygame.K_SPACE or (
            key in (pygame.K_RETURN, pygame.K_KP_ENTER) and self.chosen != index
        ):
            self.choose(index)
        elif pygame.K_1 <= key < pygame.K_1 + count:
            self.choose(key - pygame.K_1)
        else:
            return False
        self.stage.redraw(True)
        return True

    def _type(self, event: pygame.event.Event) -> bool:
        """A number is typed; Enter, Tab and Escape are for others."""
        if event.key in (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_TAB, pygame.K_ESCAPE):
            return False
        self.edit.key(event)
        self.stage.redraw(True)
        return True

    def _go(self, across: float, up: float) -> None:
        """The cursor by a step; with the pen down it draws."""
        assert self.sketch is not None
        low, high, bottom, top = self.sketch.axes
        at = self.sketch.cursor or (low, bottom)
        x = min(max(at[0] + across * 2.0 * (high - low) / (COLUMNS - 1), low), high)
        y = min(max(at[1] + up * UP_STEP * (top - bottom), bottom), top)
        self.sketch.cursor = (x, y)
        self.stage.redraw(True)

    def _put_down(self) -> None:
        """A point at the cursor, joined to the one before."""
        assert self.sketch is not None
        at = self.sketch.cursor = self.sketch.cursor or (self.sketch.axes[0], self.sketch.axes[2])
        self.sketch.draw_to(self._last, at)
        self._last = at
        self.stage.redraw(True)

    def _draw_at(self, pos: tuple[int, int]) -> None:
        box = self.stage.renderer.plot_box
        if self.sketch is None or box is None:
            return
        at = box.at(*pos)
        self.sketch.draw_to(self._last, at)
        self._last = at
        self.stage.redraw(True)

    def draw(self, painter: Painter) -> None:
        """The sketch, over what has been measured."""
        box = self.stage.renderer.plot_box
        if self.sketch is not None and box is not None:
            draw_sketch(
                painter,
                box,
                self.sketch,
                asking=self.on,
                ring=self.stage.focus.ring == SKETCH,
                measured=self.measured,
            )

    @property
    def measured(self) -> list[Beside]:
        """What was measured beside the sketch so far; nothing while it is still asked for."""
        if self.on or self.sketch is None:
            return []
        return beside(self.sketch, [frame for frame, _, _ in self.stage.picture.panes()])

    def cursor(self) -> int | None:
        """A cross over the plot."""
        if self.predict is None or self.sketch is None:
            return None
        over = self.stage.renderer.layout.plot.collidepoint(pygame.mouse.get_pos())
        return pygame.SYSTEM_CURSOR_CROSSHAIR if over else None


def said(predict: Predict, given: Given) -> str:
    """An answer in words."""
    if not isinstance(given, float):
        return ""
    if predict.kind == "choice":
        return str(predict.options[round(given)])
    return f"{shown(given)} {predict.unit}".strip()
