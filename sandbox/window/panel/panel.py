"""The panel at the right: sections of controls, for mouse, touch and keyboard alike."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.widgets.controls import (
    PAD,
    TARGET,
    Control,
    Heading,
    Place,
    Places,
    Row,
    Simple,
    Slider,
    Stepper,
    TextField,
    arranged,
    parts_of,
    slid_to,
)
from sandbox.draw.widgets.look import Attention, Typing, character_at
from sandbox.draw.widgets.panel_frame import draw_tab, foot_height, panel_picture
from sandbox.window.guide import Guide
from sandbox.window.keys import Action
from sandbox.window.panel.drawer import Drawer
from sandbox.window.panel.line_edit import Edit
from sandbox.window.parts import Silent
from sandbox.window.press import Press, keyed, pressed
from sandbox.window.sections import Section, Value
from sandbox.window.stage import Stage

DOUBLE = 0.35  # two clicks within this are one double click [s]
SAME = {"new": "seed"}  # what a lesson hides with something else
PAN = 8.0  # a press that moves this far scrolls, at scale 1 [px]


@dataclass
class Draft:
    """A slider on its way: dragged, or moved by keys and not yet confirmed."""

    name: str
    value: float
    by_mouse: bool


class Panel(Silent):
    """All sections, scrolled; what is hovered over, dragged and typed."""

    def __init__(self, stage: Stage, guide: Guide, folded: set[str]) -> None:
        self.stage, self.guide = stage, guide
        self.sections: list[Section] = []
        self.folded = folded  # names of sections
        self.drawer = Drawer(stage, guide)
        self.scroll = 0
        self.draft: Draft | None = None
        self.edit: Edit | None = None
        self._arranged: object = None  # controls, type and width that the places are for
        self._places = Places((), 0)
        self._hover = ""
        self._press: Press | None = None
        self._clicked = ("", 0.0)
        self._pointer = (-1, -1)
        self._followed = ""
        self._picture: tuple[object, pygame.Surface] | None = None

    # -- where it is --

    @property
    def rect(self) -> pygame.Rect:
        """Its place in the window [px]; of no width when it is not shown."""
        return self.drawer.rect

    def fold(self) -> None:
        """Hide it or show it."""
        self.drawer.switch()
        if not self.drawer.shown and not self.stage.focus.on_canvas:
            self.stage.focus.leave()

    def stops(self) -> Sequence[str]:
        """What the keyboard can go to."""
        return self._places.stops() if self.drawer.shown else ()

    def place_of(self, name: str) -> pygame.Rect | None:
        """Where a control is in the window, whether scrolled into view or not."""
        place = self._places.named(name)
        return None if place is None else place.rect.move(self.rect.left, -self.scroll)

    @property
    def places(self) -> Sequence[Place]:
        """Its controls, unscrolled."""
        return self._places.all

    @property
    def _view(self) -> int:
        """Height of what shows of the controls [px]."""
        return self.rect.height - foot_height(self.rect.height, self.stage.renderer.type)

    # -- once a picture --

    def tick(self, now: float) -> bool:
        """Put the controls together anew; follow the keyboard."""
        del now
        self.stage.over = self.rect if self.drawer.over else pygame.Rect(0, 0, 0, 0)
        if not self.drawer.shown:
            self._arranged, self._places, self.scroll = None, Places((), 0), 0
            return False
        before, wanted = self._places, (self._controls(), self.stage.renderer.type, self.rect.width)
        if wanted != self._arranged:  # to find the places takes a millisecond
            self._arranged, self._places = wanted, arranged(*wanted)
        focus = self.stage.focus
        if self.draft is not None and not self.draft.by_mouse and focus.name != self.draft.name:
            self._finish_draft()
        if self.edit is not None and focus.name != self.edit.name:
            self._finish_edit()
        if focus.ring != self._followed:
            self._followed = focus.ring
            if focus.shown:
                room = round(TARGET * self.stage.renderer.scale)
                self.scroll = self._places.scroll_to(focus.name, self.scroll, self._view, room)
        self.scroll = max(0, min(self.scroll, self._places.height - self._view))
        return self._places is not before

    def _controls(self) -> list[Control]:
        controls: list[Control] = []
        hidden = self.guide.hidden
        for section in self.sections:
            if not section.there or section.name in hidden:
                continue
            is_open = not section.title or section.name not in self.folded
            if section.title:
                controls.append(Heading(section.name, section.title, is_open))
            controls.extend(without(section.controls() if is_open else (), hidden))
        if self.draft is not None:
            draft = self.draft
            controls = [
                replace(control, value=draft.value)
                if isinstance(control, Slider) and control.name == draft.name
                else control
                for control in controls
            ]
        return controls

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """The key that hides and shows it."""
        if action is not Action.FOLD:
            return False
        self.fold()
        return True

    def handle(self, event: pygame.event.Event) -> bool:
        """Mouse and keyboard."""
        if event.type == pygame.KEYDOWN:
            return self._key(event)
        if event.type in (pygame.TEXTINPUT, pygame.TEXTEDITING) and self.edit is not None:
            put = self.edit.write if event.type == pygame.TEXTINPUT else self.edit.compose
            put(event.text)
            return True
        if event.type == pygame.MOUSEMOTION:
            self._pointer = event.pos
        if self.stage.mouse.holding:  # the hand goes on over the panel
            return False
        if not self.drawer.shown:
            return self._on_tab(event)
        inside = self.rect.collidepoint(self._pointer)
        if event.type == pygame.MOUSEMOTION:
            return self._motion(event.pos) or (inside and not any(event.buttons))
        if event.type == pygame.MOUSEBUTTONDOWN:
            self._pointer = event.pos
            inside = self.rect.collidepoint(event.pos)
            if inside and event.button == 1:
                self._down(event.pos)
            elif not inside:
                self._finish_edit()
                if self.drawer.over and event.button == 1:
                    self.fold()
            return inside
        if event.type == pygame.MOUSEBUTTONUP and self._press is not None:
            self._up(event.pos)
            return True
        if event.type == pygame.MOUSEWHEEL and inside:
            self._scroll_by(-event.precise_y * 60.0 * self.stage.renderer.scale)
            return True
        return False

    def _on_tab(self, event: pygame.event.Event) -> bool:
        """A press on what opens the panel."""
        pressed_there = event.type == pygame.MOUSEBUTTONDOWN and event.button == 1
        if pressed_there and self.drawer.tab.collidepoint(event.pos):
            self.fold()
            return True
        return False

    def cursor(self) -> int | None:
        """The system cursor over the panel."""
        if not self.rect.collidepoint(self._pointer):
            return None
        return pygame.SYSTEM_CURSOR_HAND if self._hover else pygame.SYSTEM_CURSOR_ARROW

    def _at(self, place: tuple[int, int]) -> Place | None:
        """The control under the pointer, where it is unscrolled."""
        rect = self.rect
        if not rect.collidepoint(place) or place[1] >= rect.top + self._view:
            return None
        return self._places.at(*self._unscrolled(place))

    def _unscrolled(self, place: tuple[int, int]) -> tuple[int, int]:
        return place[0] - self.rect.left, place[1] - self.rect.top + self.scroll

    def _scroll_by(self, pixels: float) -> None:
        most = max(self._places.height - self._view, 0)
        self.scroll = max(0, min(round(self.scroll + pixels), most))

    def _down(self, pos: tuple[int, int]) -> None:
        place = self._at(pos)
        now = time.perf_counter()
        name = place.control.name if place is not None else ""
        if self.edit is not None and self.edit.name != name:
            self._finish_edit()
        self._finish_draft()
        double = name == self._clicked[0] and now - self._clicked[1] < DOUBLE
        self._clicked = (name, now)
        self._press = Press(pos, self.scroll, place)
        if place is None:
            return
        self.stage.focus.go(name, False)
        control = place.control
        if not isinstance(control, Slider):
            return
        parts = parts_of(control, place.rect, self.stage.renderer.type)
        x, y = self._unscrolled(pos)
        if double and not parts.box.collidepoint(x, y):
            self._press = None
            self.use(name, control.default, True)
        elif parts.track.inflate(2 * round(PAD * self.stage.renderer.scale), 0).collidepoint(x, y):
            self._press.slides = True
            self.draft = Draft(name, control.value, by_mouse=True)
            self._slide(pos)

    def _motion(self, pos: tuple[int, int]) -> bool:
        press = self._press
        if press is None:
            place = self._at(pos)
            hover = "" if place is None else place.control.name
            changed, self._hover = hover != self._hover, hover
            self.stage.redraw(changed)
            return False
        if press.slides:
            self._slide(pos)
        elif press.pans or abs(pos[1] - press.start[1]) > PAN * self.stage.renderer.scale:
            press.pans = True
            self.scroll = press.scroll
            self._scroll_by(press.start[1] - pos[1])
        return True

    def _slide(self, pos: tuple[int, int]) -> None:
        place = self._places.named(self.draft.name) if self.draft is not None else None
        if self.draft is None or place is None or not isinstance(place.control, Slider):
            return
        parts = parts_of(place.control, place.rect, self.stage.renderer.type)
        value = slid_to(place.control, parts, self._unscrolled(pos)[0])
        if value != self.draft.value:
            self.draft.value = value
            self.use(self.draft.name, value, False)

    def _up(self, pos: tuple[int, int]) -> None:
        press, self._press = self._press, None
        if press is None or press.pans:
            return
        if press.slides:
            self._finish_draft()
            return
        place = self._at(pos)
        if place is None or press.place is None:
            return
        if place.control.name == press.place.control.name:
            self._activate(place, self._unscrolled(pos))

    def _activate(self, place: Place, at: tuple[int, int]) -> None:
        control = place.control
        if isinstance(control, Heading):
            self.toggle(control.name)
            return
        parts = parts_of(control, place.rect, self.stage.renderer.type)
        if isinstance(control, (Slider, Stepper, TextField)) and parts.box.collidepoint(at):
            if self.edit is None:
                self._begin_edit(control)
            else:
                at_character = character_at(
                    self._typing(self.edit), parts.box, at[0], self.stage.renderer.type
                )
                self.edit.put_caret(at_character)
            return
        value = pressed(control, parts, at)
        if value is not None:
            self.use(control.name, value, True)

    # -- keyboard --

    def _key(self, event: pygame.event.Event) -> bool:
        if self.edit is not None:
            return self._key_of_edit(self.edit, event)
        place = self._places.named(self.stage.focus.name) if self.drawer.shown else None
        if place is None:
            return False
        control = place.control
        if isinstance(control, Slider) and self.draft is not None:
            control = replace(control, value=self.draft.value)
        if event.key == pygame.K_ESCAPE and self.draft is not None:
            self.draft = None
            return True
        if event.key in (pygame.K_RETURN, pygame.K_KP_ENTER) and self.draft is not None:
            self._finish_draft()
            return True
        asked = keyed(control, event)
        if asked is None:
            return False
        self.stage.focus.go(control.name, True)
        if isinstance(control, Heading):
            if control.open != asked.value:
                self.toggle(control.name)
        elif asked.edits:
            self._begin_edit(control)  # a first sign comes as text, after its key
        elif isinstance(control, Slider) and not asked.done:
            self.draft = Draft(control.name, float(asked.value), by_mouse=False)
            self.use(control.name, asked.value, False)
        else:
            self.use(control.name, asked.value, True)
        return True

    def _key_of_edit(self, edit: Edit, event: pygame.event.Event) -> bool:
        if edit.composed:
            pass  # the keys are the input method's
        elif event.key == pygame.K_ESCAPE:
            self.edit = None
        elif event.key in (pygame.K_RETURN, pygame.K_KP_ENTER):
            self._finish_edit()
        elif event.key == pygame.K_TAB:
            self._finish_edit()
            return False
        else:
            edit.key(event)
        return True

    def _begin_edit(self, control: Simple) -> None:
        match control:
            case Slider(value=value, whole=whole):
                text = str(round(value)) if whole else f"{value:.6g}"
            case Stepper(value=value):
                text = str(value)
            case TextField(text=text):
                pass
            case _:
                text = ""
        self.edit = Edit.of(control.name, text)

    @staticmethod
    def _typing(edit: Edit) -> Typing:
        """For drawing."""
        return Typing(edit.name, edit.text, edit.caret, edit.anchor, edit.composed)

    def _finish_edit(self) -> None:
        """Hand over what was typed, if anything was."""
        edit, self.edit = self.edit, None
        if edit is not None and edit.changed:
            self.use(edit.name, edit.text, True)

    def _finish_draft(self) -> None:
        draft, self.draft = self.draft, None
        if draft is not None:
            self.use(draft.name, draft.value, True)

    def toggle(self, section: str) -> None:
        """Fold a section, or unfold it."""
        self.folded ^= {section}
        self.stage.redraw(True)

    def use(self, name: str, value: Value, done: bool) -> None:
        """A control got a value, as a section has it."""
        owner = name.partition("/")[0]
        for section in self.sections:
            if section.name == owner:
                section.use(name, value, done)
        self.stage.redraw(True)

    # -- drawing --

    def draw(self, painter: Painter) -> None:
        """All that is in view, from a picture that is kept as long as nothing has changed."""
        rect = self.rect
        if not self.drawer.shown:
            draw_tab(painter, self.drawer.tab)
            return
        focus = self.stage.focus
        attention = Attention(focus.ring, self._hover)
        if (edit := self.edit) is not None:
            attention = replace(attention, typing=self._typing(edit))
            if (
                place := self.place_of(edit.name)
            ) is not None:  # where an input method shows its own
                pygame.key.set_text_input_rect(place)
        look = self._places, self.scroll, attention, painter.theme, painter.type
        if self._picture is None or self._picture[0] != (rect.size, *look):
            self._picture = (rect.size, *look), panel_picture(rect.size, *look)
        painter.picture(self._picture[1], rect.topleft)


def without(controls: Sequence[Control], hidden: frozenset[str]) -> list[Control]:
    """The controls that a lesson does not keep out of sight."""
    if not hidden:
        return list(controls)
    left: list[Control] = []
    for control in controls:
        if not isinstance(control, Row):
            left += [] if _is_hidden(control, hidden) else [control]
            continue
        kept = [part for part in control.controls if not _is_hidden(part, hidden)]
        shares = zip(control.controls, control.shares, strict=False)
        some = tuple(share for part, share in shares if part in kept)
        left += [Row(tuple(kept), some)] if kept else []
    return left


def _is_hidden(control: Simple, hidden: frozenset[str]) -> bool:
    what = control.name.partition("/")[2]
    return SAME.get(what, what) in hidden
