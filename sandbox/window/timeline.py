"""Time: play, single increments, how fast, and the way back through the increments that are kept."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.timeline import Bar, draw_bar, draw_plate
from sandbox.draw.widgets.controls import (
    Button,
    Choice,
    Control,
    Option,
    Place,
    Places,
    Row,
    Simple,
    parts_of,
)
from sandbox.draw.widgets.look import Attention, draw_control, draw_ring
from sandbox.session.commands import Recall, Redo, Undo
from sandbox.session.frame import Frame
from sandbox.window.actions import Actions
from sandbox.window.display import FRAMES
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.press import keyed, pressed
from sandbox.window.sections import Value
from sandbox.window.stage import Stage
from sandbox.words import words

# Increments a picture, at most; the last one: as many as the solver manages.
SPEEDS = (1 / 8, 1 / 4, 1 / 2, 1.0, 2.0, 4.0, math.inf)
SPEED_NAMES = ("1/8", "1/4", "1/2", "1", "2", "4", "max")
PAGE = 10  # increments that a page key goes
PATIENCE = 0.5  # with an increment that was asked for [s]
BAR = "time/bar"
GAP, SPEED_WIDTH, SPEED_SHARE = 8.0, 150.0, 0.3  # at scale 1 [px]; and of the line's width at most


class Timeline(Silent):
    """The bar under the canvas, and the keys that go through time. Where there is no room for it, a row in the panel."""

    name = "time"
    title = ""

    def __init__(self, stage: Stage, actions: Actions) -> None:
        self.stage, self.actions = stage, actions
        self.speed = len(SPEEDS) - 1  # index into SPEEDS
        self._wish: int | None = None  # increment to go to, not sent yet
        self._asked: int | None = None  # increment on its way
        self._sent = (0.0, 0)  # when [s], and the snapshot's serial then
        self._dragging = False
        self._hover = ""
        self._pointer = (-1, -1)

    # -- where things are --

    @property
    def rect(self) -> pygame.Rect:
        """Its place in the window [px]; of no height where there is no room."""
        return self.stage.renderer.layout.timeline

    @property
    def frame(self) -> Frame | None:
        """What is shown now."""
        return self.stage.panes.snapshot.frame

    def places(self) -> Places:
        """Its controls in the window; nothing where there is no room for them."""
        line = self.rect
        if not line.height or not line.width:
            return Places((), 0)
        scale = self.stage.renderer.scale
        gap = round(GAP * scale)
        play = pygame.Rect(line.left + gap, line.top, line.height, line.height)
        step = play.move(line.height + gap // 2, 0)
        wide = round(min(SPEED_WIDTH * scale, SPEED_SHARE * line.width))
        speed = pygame.Rect(line.right - gap - wide, line.top, wide, line.height)
        rects = (play, step, speed)
        each = zip(self._buttons(), rects, strict=True)
        return Places(tuple(Place(control, rect) for control, rect in each), line.height)

    def _buttons(self) -> tuple[Simple, ...]:
        """Play, step, speed."""
        options = tuple(
            Option(name, words.SPEED.format(speed=name) if name != "max" else words.SPEED_MOST)
            for name in SPEED_NAMES
        )
        paused = self.stage.panes.paused
        return (
            Button(
                "time/play",
                "▶" if paused else "⏸",
                help=words.PLAY_HELP,
                spoken=words.PLAY if paused else words.PAUSE,
            ),
            Button("time/step", "⏭", help=words.STEP_HELP, spoken=words.STEP),
            Choice("time/speed", "", options, SPEED_NAMES[self.speed], words.SPEED_HELP),
        )

    def bar(self) -> Bar | None:
        """The bar between the buttons."""
        places, frame = self.places(), self.frame
        if not places.all or frame is None:
            return None
        left, right = places.all[1].rect.right, places.all[2].rect.left
        pad = round(2 * GAP * self.stage.renderer.scale)
        rect = pygame.Rect(left + pad, self.rect.top, right - left - 2 * pad, self.rect.height)
        now = frame.increment if self._going is None else self._going
        last = max(frame.last_kept, frame.increment)
        events = frame.events + (frame.ahead.events if frame.ahead is not None else ())
        return Bar(rect, min(frame.first_kept, frame.increment), last, now, events)

    @property
    def _going(self) -> int | None:
        """The increment that was asked for and is not there yet."""
        return self._asked if self._wish is None else self._wish

    def stops(self) -> Sequence[str]:
        """What the keyboard can go to."""
        if self.bar() is None:
            return ()
        return ("time/play", "time/step", BAR, "time/speed")

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """Keys that mean time, wherever the keyboard is."""
        match action:
            case Action.UNDO:
                self.stage.mouse.forget()
                self.stage.send(Undo())
            case Action.REDO:
                self.stage.mouse.forget()
                self.stage.send(Redo())
            case Action.BACKWARD:
                self.go_by(-1)
            case Action.FORWARD:
                self.go_by(1)
            case Action.SLOWER:
                self.set_speed(self.speed - 1)
            case Action.FASTER:
                self.set_speed(self.speed + 1)
            case _:
                return False
        return True

    def set_speed(self, index: int) -> None:
        """How many increments a picture, at most."""
        self.speed = min(max(index, 0), len(SPEEDS) - 1)
        limit = SPEEDS[self.speed]
        self.stage.panes.set_speed(limit * FRAMES)
        if math.isinf(limit):
            self.stage.toast(words.SPEED_TOAST_MOST)
        else:
            self.stage.toast(words.SPEED_TOAST.format(count=limit * FRAMES))

    def go_by(self, increments: int) -> None:
        """Back, or on through what is kept; beyond that one more increment."""
        frame = self.frame
        if frame is None:
            return
        now = frame.increment if self._going is None else self._going
        if increments == 1 and now >= frame.last_kept:
            self.stage.panes.step()
        else:
            self.go_to(now + increments)

    def go_to(self, increment: int) -> None:
        """To an increment that is kept, with the next picture."""
        frame = self.frame
        if frame is None or frame.last_kept <= frame.first_kept:
            self.stage.toast(words.NOTHING_KEPT)
            return
        self._wish = min(max(increment, frame.first_kept), frame.last_kept)
        self.stage.mouse.forget()

    def tick(self, now: float) -> bool:
        """Send where to go, once a picture."""
        frame, serial = self.frame, self.stage.panes.snapshot.serial
        # Of a long run not every increment is kept: then the solver goes to the nearest before it.
        near = serial != self._sent[1] and now - self._sent[0] > PATIENCE
        if frame is not None and (frame.increment == self._asked or near):
            self._asked = None
        if self._wish is None:
            return False
        if self._asked is None or self._wish != self._asked:
            self.stage.send(Recall(self._wish))
            self._asked, self._sent = self._wish, (now, serial)
        self._wish = None
        return True

    def handle(self, event: pygame.event.Event) -> bool:
        """Mouse and keyboard."""
        if event.type == pygame.KEYDOWN:
            return self._key(event)
        if event.type == pygame.MOUSEMOTION:
            return self._motion(event)
        if self.stage.mouse.holding:
            return False
        if event.type == pygame.MOUSEBUTTONDOWN and self.rect.collidepoint(event.pos):
            if event.button == 1:
                self._down(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and self._dragging:
            self._dragging = False
            return True
        return False

    def cursor(self) -> int | None:
        """The system cursor over the line."""
        if not self.rect.collidepoint(self._pointer):
            return None
        return pygame.SYSTEM_CURSOR_HAND if self._hover else pygame.SYSTEM_CURSOR_ARROW

    def _motion(self, event: pygame.event.Event) -> bool:
        self._pointer = event.pos
        if self.stage.mouse.holding:
            return False
        bar = self.bar()
        if self._dragging and bar is not None:
            self.go_to(bar.increment_at(event.pos[0]))
            return True
        place = self.places().at(*event.pos)
        hover = "" if place is None else place.control.name
        if bar is not None and bar.rect.collidepoint(event.pos):
            hover = BAR
        self.stage.redraw(hover != self._hover or hover == BAR)
        self._hover = hover
        return self.rect.collidepoint(event.pos) and not any(event.buttons)

    def _down(self, pos: tuple[int, int]) -> None:
        bar, place = self.bar(), self.places().at(*pos)
        if place is not None:
            self.stage.focus.go(place.control.name, False)
            value = pressed(
                place.control, parts_of(place.control, place.rect, self.stage.renderer.type), pos
            )
            if value is not None:
                self.use(place.control.name, str(value), True)
        elif bar is not None and bar.rect.inflate(round(4 * GAP), 0).collidepoint(pos):
            self.stage.focus.go(BAR, False)
            self._dragging = True
            self.go_to(bar.increment_at(pos[0]))

    def _key(self, event: pygame.event.Event) -> bool:
        name, frame = self.stage.focus.name, self.frame
        if name == BAR and frame is not None:
            ways = {pygame.K_LEFT: -1, pygame.K_RIGHT: 1, pygame.K_DOWN: -1, pygame.K_UP: 1}
            ways |= {pygame.K_PAGEUP: -PAGE, pygame.K_PAGEDOWN: PAGE}
            if event.key in ways:
                self.go_by(ways[event.key])
            elif event.key in (pygame.K_HOME, pygame.K_END):
                self.go_to(frame.first_kept if event.key == pygame.K_HOME else frame.last_kept)
            else:
                return False
            return True
        place = self.places().named(name)
        asked = None if place is None else keyed(place.control, event)
        if place is None or asked is None:
            return False
        self.use(name, str(asked.value), True)
        return True

    # -- as a section of the panel --

    @property
    def there(self) -> bool:
        """Where the window has no room for the line."""
        return self.bar() is None

    def controls(self) -> Sequence[Control]:
        """The same buttons."""
        return (Row(self._buttons(), (1.0, 1.0, 3.0)),)

    def use(self, name: str, value: Value, done: bool) -> None:
        """Play, step, or another speed."""
        del done
        if name == "time/play":
            self.actions.act(Action.PAUSE)
        elif name == "time/step":
            self.actions.act(Action.STEP)
        else:
            self.set_speed(SPEED_NAMES.index(str(value)))

    # -- drawing --

    def draw(self, painter: Painter) -> None:
        """Buttons, bar, and what the pointer is at on it."""
        bar, line = self.bar(), self.rect
        if bar is None:
            return
        painter.fill(line, painter.theme.panel)
        thin = max(round(painter.scale), 1)
        painter.fill(pygame.Rect(line.left, line.top, line.width, thin), painter.theme.hairline)
        focus = self.stage.focus.ring
        for place in self.places().all:
            control = place.control
            draw_control(painter, place, Attention(focus, self._hover))
            if control.help and control.name in (self._hover, focus):
                draw_plate(painter, control.help, place.rect.centerx, place.rect.top)
        at = self._pointer[0] if self._hover == BAR or self._dragging else None
        draw_bar(painter, bar, at)
        if focus == BAR:
            draw_ring(painter, bar.rect.inflate(round(2 * GAP * painter.scale), -2))
