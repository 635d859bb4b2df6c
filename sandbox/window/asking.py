"""A question of a lesson: an option is chosen, a number typed, a curve drawn onto the plot; and nothing moves meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.pages.tour_card import FIELD, OPTION, Field
from sandbox.draw.painter import Painter
from sandbox.draw.sketch import COLUMNS, Beside, Sketch, draw_sketch
from sandbox.draw.widgets.scale import shown
from sandbox.lessons.answers import Given
from sandbox.lessons.lesson import Predict
from sandbox.window.canvas.arrows import WAYS
from sandbox.window.keys import Action
from sandbox.window.number_field import NumberField
from sandbox.window.parts import Silent
from sandbox.window.sketched import beside
from sandbox.window.stage import Stage
from sandbox.words import words

SKETCH = "tour/sketch"  # where the keyboard is while it draws
UP_STEP = 1.0 / 40.0  # of the plot's height, a press of an arrow key
MOVES = frozenset((*WAYS, Action.PROTOCOL, Action.STEP, Action.PAUSE, Action.FORWARD))


@dataclass(frozen=True, slots=True)
class Open:
    """A question that was put aside, with what was answered so far."""

    predict: Predict | None  # None: it was answered, and a sketch lies over the plot
    chosen: int | None
    number: NumberField
    sketch: Sketch | None


class Asking(Silent):
    """What is asked, and what was answered so far; a sketch stays over the plot when it has been handed over."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.predict: Predict | None = None  # that waits for an answer
        self.chosen: int | None = None
        self.number = NumberField()
        self.sketch: Sketch | None = None
        self._refused = ""  # what was handed over and could not be read
        self._fresh = False  # has no key been pressed since it was asked?
        self._last: tuple[float, float] | None = None  # of the stroke under way
        self._drawing = False

    @property
    def on(self) -> bool:
        """Does something wait for an answer?"""
        return self.predict is not None

    def begin(self, predict: Predict) -> None:
        """Ask."""
        sketch = Sketch(predict.axes) if predict.kind == "sketch" else None
        self.take_up(Open(predict, None, NumberField(predict.unit), sketch))

    def take_up(self, question: Open) -> None:
        """Ask where it was left."""
        self.forget()
        self.predict, self.chosen = question.predict, question.chosen
        self.number, self.sketch = question.number, question.sketch
        if self.sketch is not None:
            self.stage.renderer.plot_least = self.sketch.axes
        self._fresh = True
        if self.predict is not None:
            # The ring says where the keyboard is: what is asked can be answered at once.
            self.stage.focus.go(self.stops()[self.chosen or 0], True)
            self.stage.panes.hold()

    def put_aside(self) -> Open:
        """Ask no more for now; what was answered so far."""
        question = Open(self.predict, self.chosen, self.number, self.sketch)
        self.forget()
        return question

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
        self.chosen, self.number, self.sketch, self._refused = None, NumberField(), None, ""
        self.stage.renderer.plot_least = None

    @property
    def given(self) -> Given | None:
        """The answer so far; None: there is none."""
        if self.predict is None:
            return None
        if self.predict.kind == "choice":
            return None if self.chosen is None else float(self.chosen)
        if self.predict.kind == "number":
            return self.number.value
        if self.sketch is None or not self.sketch.there:
            return None
        drawn = np.isfinite(self.sketch.up)
        return self.sketch.along[drawn], self.sketch.up[drawn]

    @property
    def unreadable(self) -> bool:
        """Was something written where a number is asked for, and is none?"""
        return self.predict is not None and self.number.unreadable

    def refuse_number(self) -> None:
        """It stays there to be corrected, and the card says so."""
        self._refused = self.number.text
        self.stage.focus.go(FIELD, True)

    @property
    def field(self) -> Field | None:
        """For the card, where a number is asked for."""
        if self.predict is None or self.predict.kind != "number":
            return None
        typing = self.stage.focus.name == FIELD
        edit = self.number.edit
        return Field(edit.text, self.predict.unit, edit.caret if typing else None)

    @property
    def hint(self) -> str:
        """How to answer; what is wrong with what was written."""
        if self._refused and self._refused == self.number.text:
            return words.ASK_UNREADABLE.format(text=self._refused.strip())
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
        return action in MOVES and self.refuses()

    def refuses(self) -> bool:
        """Is nothing to be moved before there is an answer? Then that is said."""
        if self.predict is not None:
            self.stage.toast(words.ASK_FIRST)
        return self.predict is not None

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
            self._fresh = False
            return self._key(event)
        if event.type in (pygame.TEXTINPUT, pygame.TEXTEDITING) and self.stage.focus.name == FIELD:
            # The letter of the key that has led here is nothing that was written.
            written = event.type == pygame.TEXTINPUT and not self._fresh
            if written and not self.number.write(event.text):
                self.stage.toast(words.ASK_DIGITS)
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
        return self.stage.picture.pane_at(pos) is not None and self.refuses()

    def _key(self, event: pygame.event.Event) -> bool:
        name, key = self.stage.focus.name, event.key
        if name == FIELD:
            self.stage.redraw(True)
            return self.number.key(event)
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


def told(predict: Predict, given: Given | None) -> str:
    """What was answered, and what is right, where anything is; then what the lesson says to it."""
    parts = [words.ASK_SAID.format(given=_said(predict, given))] if isinstance(given, float) else []
    if isinstance(given, float) and predict.is_right(given):
        parts.append(words.ASK_RIGHT)
    elif predict.right is not None:
        parts.append(words.ASK_RATHER.format(right=_said(predict, predict.right)))
    return " ".join(part for part in (*parts, str(predict.answer)) if part)


def _said(predict: Predict, given: float) -> str:
    """An answer in words."""
    if predict.kind == "choice":
        return words.ASK_QUOTED.format(text=str(predict.options[round(given)]))
    return f"{shown(given)} {predict.unit}".strip()
