"""A guided tour or a lesson in the window: a card that asks, waits until it is done, and explains.

It stands above the panel, or where the panel would be: it covers nothing of what it speaks of.
"""

from __future__ import annotations

import pygame

from core.errors import InputError
from sandbox.draw.pages.tour_card import (
    BACK,
    CLOSE,
    FIELD,
    NEXT,
    OPTION,
    CardLayout,
    TourPage,
    card_layout,
    draw_tour_card,
    fitting_type,
)
from sandbox.draw.painter import Painter
from sandbox.draw.text import Type
from sandbox.lessons import tours
from sandbox.lessons.answers import Answers, Given
from sandbox.lessons.lesson import Lesson, Step
from sandbox.lessons.moments import Moment, met
from sandbox.window.asking import Asking, said
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes.text import message

WIDTH = 352.0  # of the card where there is no panel, at scale 1 [px]
MARGIN = 10.0  # round it, at scale 1 [px]
LEAST_PANEL = 180.0  # a panel under the card is at least so high at scale 1 [px]


class Guide(Silent):
    """Which lesson is on, which step, and whether it is done."""

    def __init__(self, stage: Stage, answers: Answers | None = None) -> None:
        self.stage = stage
        self.asking = Asking(stage)
        self.answers = answers or Answers()
        self.lesson: Lesson | None = None
        self.index = 0
        self.done = False
        self.told = False  # explained before it is done, as somebody wished
        self._given: Given | None = None  # what was predicted in this step
        self._then: Moment | None = None  # what there was when the step began
        self._hover = ""
        self._fitted: tuple[object, Type] | None = None
        self._measured: tuple[object, CardLayout] | None = None

    @property
    def on(self) -> bool:
        """Is a lesson on?"""
        return self.lesson is not None

    @property
    def step(self) -> Step:
        """The present one."""
        assert self.lesson is not None
        return self.lesson.steps[self.index]

    @property
    def scene(self) -> str:
        """That of the present step; nothing where no lesson is on."""
        return "" if self.lesson is None else self.lesson.scene_of(self.index)

    # -- going through it --

    def start(self, scene: str) -> None:
        """Begin the tour of a scene."""
        found = tours.tour(scene)
        if found is None:
            self.stage.toast(words.NO_TOUR)
        else:
            self.begin(found)

    def begin(self, lesson: Lesson) -> None:
        """Begin a lesson."""
        self.lesson = lesson
        self.stage.has_begun()
        self._go(0)

    def close(self) -> None:
        """No more of it."""
        self.asking.forget()
        self.lesson, self._hover = None, ""
        if self.stage.focus.name in (NEXT, BACK, CLOSE):
            self.stage.focus.leave()
        self.stage.redraw(True)

    def next(self) -> None:
        """The explanation, if it is not shown yet; else the next step; after the last the end."""
        page = self.page
        if self.asking.on:
            self._keep()
        elif page.do and not page.why and self._explains:
            self.told = True
        elif not self._last:
            self._go(self.index + 1)
        else:
            over = (
                words.LESSON_OVER
                if self.lesson is not None and self.lesson.title
                else words.TOUR_OVER
            )
            self.close()
            self.stage.toast(over)
        self.stage.redraw(True)

    def _keep(self) -> None:
        """What was answered is kept, if anything was; now it can be tried."""
        assert self.lesson is not None
        self._given = self.asking.given
        if self._given is not None:
            self.answers.predicted(self.lesson, self.step, self._given)
            self._tell_trouble()
        self.asking.end()
        self._then, self.done = None, self.step.until is None

    def _tell_trouble(self) -> None:
        if self.answers.trouble:
            self.stage.toast(self.answers.trouble)

    @property
    def hidden(self) -> frozenset[str]:
        """Controls that the lesson keeps out of sight."""
        return frozenset() if self.lesson is None else self.lesson.hide | self.step.hide

    @property
    def _explains(self) -> bool:
        """Is there anything to explain in this step?"""
        return bool(self.step.why or (self.step.predict is not None and self.step.predict.answer))

    @property
    def _last(self) -> bool:
        """Is this the last step?"""
        return self.lesson is None or self.index + 1 == len(self.lesson.steps)

    def back(self) -> None:
        """The step before."""
        if self.index:
            self._go(self.index - 1)

    def _go(self, index: int) -> None:
        self.asking.forget()
        self.index, self.done, self.told, self._then = index, False, False, None
        self._given = None
        step = self.step
        # Back over the beginning of another scene: that of the steps before begins anew.
        if step.packings or self.stage.panes.scene != self.scene:
            try:
                self._begin()
            except InputError as error:
                self.close()
                self.stage.toast(words.say(message(error)))
                return
        if step.view:
            self.stage.renderer.set_view(step.view)
        if step.predict is not None:
            self.asking.begin(step.predict)
        self.done = step.until is None and step.predict is None
        self.stage.redraw(True)

    def _begin(self) -> None:
        """What the present step begins, or the last one before it that does."""
        assert self.lesson is not None
        begun = self.lesson.steps[: self.index + 1]
        step = next(step for step in reversed(begun) if step.packings)
        several = len(step.packings) > 1
        if not several:
            self.stage.panes.packing = step.packings[0]
        packings = step.packings if several else ()
        self.stage.start(self.scene, step.settings, packings, self.lesson.seed)

    def tick(self, now: float) -> bool:
        """Has it been done? And the card is to have its place."""
        del now
        self.stage.arrange(card=self.wanted)
        if not self.on:
            return False
        run = self.stage.panes
        if run.scene != self.scene:
            self.close()
            return True
        if self.asking.on:
            run.hold()  # a page that was closed may have let it go on
            return False
        frames = [seen.frame for seen in run.snapshots if seen.phase == "running"]
        there = [frame for frame in frames if frame is not None]
        if self.done or self.step.until is None or len(there) < max(len(run.snapshots), 1):
            return False
        moment = Moment.of(there, self.stage.renderer.view.name)
        if self._then is None:
            self._then = moment
        self.done = met(self.step.until, self._then, moment)
        if self.done and self._given is not None and self.lesson is not None:
            self.answers.measured(self.lesson, self.step, self._given, there)
            self._tell_trouble()
        return self.done

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """The key of tours begins one, or ends it."""
        if action is not Action.TOUR:
            return False
        if self.on:
            self.close()
        else:
            self.start(self.stage.panes.scene)
        return True

    def handle(self, event: pygame.event.Event) -> bool:
        """Buttons by mouse; Enter, Backspace and Escape while the keyboard is at no other control."""
        if not self.seen:
            return False
        if self.asking.handle(event):
            return True
        if event.type == pygame.KEYDOWN:
            return self._key(event.key)
        if event.type not in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN):
            return False
        if self.stage.mouse.holding:
            return False
        self._hover = self._button_at(event.pos)
        inside = self.rect.collidepoint(event.pos)
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and self._hover:
            self.press(self._hover)
        pressed = event.type == pygame.MOUSEBUTTONDOWN and event.button == 1
        return inside or (pressed and self.asking.refuse(event.pos))

    def _key(self, key: int) -> bool:
        focus = self.stage.focus
        enter = key in (pygame.K_RETURN, pygame.K_KP_ENTER)
        if focus.name in self.asking.stops():
            pass  # Enter goes on from there, Backspace does not go back
        elif focus.name in self.stops():
            if enter or key == pygame.K_SPACE:
                self.press(focus.name)
                return True
            return False
        keys = {pygame.K_BACKSPACE: BACK, pygame.K_ESCAPE: CLOSE}
        name = NEXT if enter else keys.get(key, "")
        at_question = name in (NEXT, CLOSE) and focus.name in self.asking.stops()
        if not name or not (focus.on_canvas or at_question):
            return False
        self.press(name)
        return True

    def press(self, name: str) -> None:
        """A button, an option, or the field of a number."""
        if name.startswith(OPTION):
            self.asking.choose(int(name.removeprefix(OPTION)))
        elif name == FIELD:
            self.stage.focus.go(FIELD, False)
        else:
            {NEXT: self.next, BACK: self.back, CLOSE: self.close}[name]()

    @property
    def titles(self) -> dict[str, str]:
        """What its buttons say."""
        return {NEXT: self.page.onward, BACK: words.TOUR_BACK, CLOSE: words.CLOSE}

    def stops(self) -> list[str]:
        """Buttons that Tab goes to."""
        if not self.seen:
            return []
        buttons = [NEXT, CLOSE] if self.index == 0 else [NEXT, BACK, CLOSE]
        return [*self.asking.stops(), *buttons]

    def cursor(self) -> int | None:
        """A hand over a button, an arrow over the card."""
        if not self.seen or self.stage.mouse.holding:
            return None
        if not self.rect.collidepoint(pygame.mouse.get_pos()):
            return None
        return pygame.SYSTEM_CURSOR_HAND if self._hover else pygame.SYSTEM_CURSOR_ARROW

    def _button_at(self, place: tuple[int, int]) -> str:
        rect = self.rect
        buttons = self._layout(rect.width).buttons
        for name, button in buttons.items():
            if button.move(rect.topleft).collidepoint(place):
                return name
        return ""

    # -- where it is, and what it says --

    @property
    def page(self) -> TourPage:
        """What the card shows now."""
        assert self.lesson is not None
        scene, step = self.scene, self.step
        predict, asking = step.predict, self.asking
        if asking.on and predict is not None:
            onward = words.ASK_WITHOUT if asking.given is None else words.ASK_KEEP
            return TourPage(
                title=str(self.lesson.title) or words.title(scene) or scene,
                step=self.index,
                steps=len(self.lesson.steps),
                say=str(step.say),
                onward=onward,
                ask=str(predict.ask),
                options=tuple(map(str, predict.options)),
                chosen=asking.chosen,
                field=asking.field,
                hint=asking.hint,
                ready=asking.given is not None,
            )
        do, why = str(step.do), self._why(step)
        waiting = bool(do and why and not self.done and not self.told)
        if not self.done:
            # What has not happened yet is not said as if it had.
            why = words.TOUR_AHEAD.format(why=why) if self.told else ""
        onward = words.TOUR_WHY if waiting else words.TOUR_END if self._last else words.TOUR_NEXT
        return TourPage(
            title=str(self.lesson.title) or words.title(scene) or scene,
            step=self.index,
            steps=len(self.lesson.steps),
            say=str(step.say),
            do=do,
            done=self.done,
            why=why,
            onward=onward,
        )

    def _why(self, step: Step) -> str:
        """What explains a step, after what was predicted in it."""
        predict, given = step.predict, self._given
        parts = []
        if predict is not None and isinstance(given, float):
            verdict = predict.is_right(given)
            parts.append(words.ASK_SAID.format(given=said(predict, given)))
            if verdict:
                parts.append(words.ASK_RIGHT)
            elif verdict is False and predict.right is not None:
                parts.append(words.ASK_RATHER.format(right=said(predict, predict.right)))
        if predict is not None:
            parts.append(str(predict.answer))
        return " ".join(part for part in (*parts, str(step.why)) if part)

    @property
    def seen(self) -> bool:
        """Is the card there, and not under a panel that somebody has opened over it?"""
        return self.on and not self.rect.colliderect(self.stage.over)

    @property
    def taken(self) -> int:
        """How much of the panel's height the card takes, margins included [px]."""
        layout = self.stage.renderer.layout
        if not self.on or not layout.panel.width:
            return 0
        return self.rect.height + 2 * self._margin

    @property
    def rect(self) -> pygame.Rect:
        """Where the card is in the window [px]."""
        column, margin = self._column, self._margin
        width = max(column.width - 2 * margin, 1)
        height = min(self._layout(width).height, column.height - 2 * margin)
        return pygame.Rect(column.left + margin, column.top + margin, width, max(height, 1))

    @property
    def _column(self) -> pygame.Rect:
        """At the top of the panel, or in a column of its own in the panel's stead: it covers nothing of the canvases."""
        layout = self.stage.renderer.layout
        return layout.panel if layout.panel.width else layout.card

    @property
    def wanted(self) -> int:
        """How wide a column the card is to have where there is no panel [px]."""
        return round((WIDTH + 2.0 * MARGIN) * self.stage.renderer.scale) if self.on else 0

    @property
    def _type(self) -> Type:
        """The type on the card: smaller than elsewhere where it would not fit, or leave nothing of the panel."""
        own, column = self.stage.renderer.type, self._column
        least = LEAST_PANEL * own.scale if self.stage.renderer.layout.panel.width else 0.0
        key = (self.page, column.size, own)
        if self._fitted is None or self._fitted[0] != key:
            width, height = column.width - 2 * self._margin, column.height - 2 * self._margin
            self._fitted = key, fitting_type(self.page, own, width, round(height - least))
        return self._fitted[1]

    @property
    def _margin(self) -> int:
        return round(MARGIN * self.stage.renderer.scale)

    def _layout(self, width: int) -> CardLayout:
        """The card at that width [px]; measured again only when it has changed."""
        page, type_ = self.page, self._type
        key = (page, width, type_.scale)
        if self._measured is None or self._measured[0] != key:
            self._measured = key, card_layout(page, type_, width)
        return self._measured[1]

    def draw(self, painter: Painter) -> None:
        """The card."""
        if not self.seen:
            return
        own = painter
        if self._type is not painter.type:
            painter.flush()
            own = Painter(painter.surface, painter.theme, self._type)
        draw_tour_card(own, self.rect, self.page, focus=self.stage.focus.ring, hover=self._hover)
        own.flush()
