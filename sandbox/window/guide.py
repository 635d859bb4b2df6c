"""A guided tour or a lesson in the window: a card that asks, waits until it is done, and explains.

It can be put aside, and be gone on with from the very step.
"""

from __future__ import annotations

import pygame

from core.errors import InputError
from sandbox.draw.pages.tour_card import BACK, CLOSE, FIELD, NEXT, OPTION, TourPage
from sandbox.draw.painter import Painter
from sandbox.lessons import tours
from sandbox.lessons.answers import Answers, Given
from sandbox.lessons.lesson import Lesson, Step
from sandbox.lessons.moments import Moment, met
from sandbox.window.asking import Asking, told
from sandbox.window.card import Card
from sandbox.window.focus import CANVAS
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.shelf import Aside, Shelf
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes.text import message


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
        self.card = Card(stage)
        self.shelf = Shelf(stage)
        self._hover = ""
        self._guessed = False  # by the mouse, which has not moved since

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
        """Begin a lesson; another one that is on is put aside."""
        self._shelve()
        self.shelf.forget(lesson)
        self.lesson = lesson
        self.stage.has_begun()
        self._go(0)

    def close(self) -> None:
        """No more of it."""
        self._leave_step()
        self.asking.forget()
        self.lesson, self._hover, self.done, self.told = None, "", False, False
        if self.stage.focus.name in (NEXT, BACK, CLOSE):
            self.stage.focus.leave()
        self.stage.redraw(True)

    def put_aside(self) -> None:
        """No more of it for now: the key of tours brings it back as it is, which is said."""
        if self.lesson is not None:
            said = words.TOUR_ASIDE if tours.is_tour(self.lesson) else words.LESSON_ASIDE
            self._shelve()
            self.stage.toast(said)

    def leave(self) -> None:
        """Something else is to run. A lesson is put aside; a tour waits in its own scene."""
        if self.lesson is not None and tours.is_tour(self.lesson):
            self._shelve()
        else:
            self.put_aside()

    def _shelve(self) -> None:
        if self.lesson is not None:
            aside = Aside(
                lesson=self.lesson,
                index=self.index,
                done=self.done,
                told=self.told,
                given=self._given,
                question=self.asking.put_aside(),
                then=self._then,
                view=self.stage.renderer.view.name,
                runs=self.shelf.runs,
            )
            self.shelf.put(aside)
            self.close()

    def take_up(self, aside: Aside) -> None:
        """Go on with what was put aside, at that step and with what was answered."""
        self._shelve()
        self.shelf.forget(aside.lesson)
        self.lesson, self.index, self._given = aside.lesson, aside.index, aside.given
        self.done, self.told, self._then = aside.done, aside.told, aside.then
        if aside.runs != self.shelf.runs or self.stage.panes.scene != self.scene:
            self._then = None
            if not self._begin():
                return
        self.stage.renderer.set_view(aside.view)
        self.asking.take_up(aside.question)
        if not self.asking.on:
            self._to_what_is_next()
        page = self.page
        self.stage.toast(words.TOUR_STEP.format(step=page.step + 1, steps=page.steps))
        self.stage.redraw(True)

    def next(self) -> None:
        """The explanation, if it is not shown yet; else the next step; after the last the end."""
        page = self.page
        if self.asking.unreadable:
            self.asking.refuse_number()
        elif self.asking.on:
            self._keep()
        elif page.do and not page.why and self._explains:
            self.told = True
        elif not self._last:
            self._go(self.index + 1)
        else:
            assert self.lesson is not None
            over = words.TOUR_OVER if tours.is_tour(self.lesson) else words.LESSON_OVER
            self.close()
            self.stage.toast(over)
        self.stage.redraw(True)

    def _keep(self) -> None:
        """What was answered is kept, also that nothing was; now it can be tried."""
        assert self.lesson is not None
        self._given = self.asking.given
        self.answers.predicted(self.lesson, self.step, self._given)
        self._tell_trouble()
        self.asking.end()
        self._then, self.done = None, self.step.until is None
        self._to_what_is_next()

    def _to_what_is_next(self) -> None:
        """The keyboard goes where something is to be done: to the handle that is to move, or to the grains."""
        until = self.step.until
        handle = "" if until is None or not until.moved else f"/{until.moved}"
        self.stage.focus.go(f"{CANVAS}{handle}", self.stage.focus.shown)

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
        predict = self.step.predict
        answer = predict is not None and (predict.answer or predict.right is not None)
        return bool(self.step.why or answer)

    @property
    def _last(self) -> bool:
        """Is this the last step?"""
        return self.lesson is None or self.index + 1 == len(self.lesson.steps)

    def back(self) -> None:
        """The step before."""
        if self.index:
            self._go(self.index - 1)

    def _leave_step(self) -> None:
        """Whoever answers it again has seen what is right."""
        if self.lesson is not None and (self.done or self.told):
            self.answers.shown(self.lesson, self.step)

    def _go(self, index: int) -> None:
        self._leave_step()
        self.asking.forget()
        self.index, self.done, self.told, self._then = index, False, False, None
        self._given = None
        step = self.step
        # Back over the beginning of another scene: that of the steps before begins anew.
        anew = bool(step.packings) or self.stage.panes.scene != self.scene
        if anew and not self._begin():
            return
        if step.view:
            self.stage.renderer.set_view(step.view)
        self.done = step.until is None and step.predict is None
        if step.predict is not None:
            self.asking.begin(step.predict)
        else:
            self._to_what_is_next()
        self.stage.redraw(True)

    def _begin(self) -> bool:
        """What the present step begins, or the last one before it that does; False if that cannot be, which is said."""
        assert self.lesson is not None
        begun = self.lesson.steps[: self.index + 1]
        step = next(step for step in reversed(begun) if step.packings)
        several = len(step.packings) > 1
        if not several:
            self.stage.panes.packing = step.packings[0]
        packings = step.packings if several else ()
        try:
            self.stage.start(self.scene, step.settings, packings, self.lesson.seed)
        except InputError as error:
            self.close()
            self.stage.toast(words.say(message(error)))
            return False
        return True

    def tick(self, now: float) -> bool:
        """Has it been done? And the card is to have its place."""
        del now
        self.stage.arrange(card=self.card.width if self.on else 0)
        if not self.on:
            return False
        run = self.stage.panes
        if run.scene != self.scene:
            self.leave()
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
        """The key of tours begins one, puts it aside, or goes on with what was put aside."""
        if action is not Action.TOUR:
            return False
        if self.on:
            self.put_aside()
        elif (aside := self.shelf.latest) is not None:
            self.take_up(aside)
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
        self._hover = self.card.button_at(self.page, event.pos)
        inside = self.rect.collidepoint(event.pos)
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and self._hover:
            self._click(self._hover)
        elif event.type == pygame.MOUSEMOTION:
            self._guessed = False
        pressed = event.type == pygame.MOUSEBUTTONDOWN and event.button == 1
        return inside or (pressed and self.asking.refuse(event.pos))

    def _click(self, name: str) -> None:
        """A button by mouse. What tells the answer may have come under a pointer that has just handed over a guess."""
        if name == NEXT and self._guessed and self._gives_away:
            self.stage.toast(words.ASK_TRY.format(why=words.TOUR_WHY))
            self._guessed = False
            return
        asked = self.asking.on
        self.press(name)
        self._guessed = asked and not self.asking.on

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
        if name == NEXT and self._gives_away:
            self.stage.toast(words.ASK_TRY.format(why=words.TOUR_WHY))
        else:
            self.press(name)
        return True

    @property
    def _gives_away(self) -> bool:
        """Would going on tell the answer before it has been tried? One Enter too many is not to do that."""
        asked = self.step.predict is not None and not self.asking.on
        return asked and not (self.done or self.told)

    def press(self, name: str) -> None:
        """A button, an option, or the field of a number."""
        if name.startswith(OPTION):
            self.asking.choose(int(name.removeprefix(OPTION)))
        elif name == FIELD:
            self.stage.focus.go(FIELD, False)
        else:
            {NEXT: self.next, BACK: self.back, CLOSE: self.put_aside}[name]()

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

    # -- where it is, and what it says --

    @property
    def page(self) -> TourPage:
        """What the card shows now."""
        assert self.lesson is not None
        scene, step = self.scene, self.step
        predict, asking = step.predict, self.asking
        if asking.on and predict is not None:
            nothing = asking.given is None and not asking.unreadable
            onward = words.ASK_WITHOUT if nothing else words.ASK_KEEP
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
        why = why if self.done or self.told else ""
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
        answer = "" if step.predict is None else told(step.predict, self._given)
        why = str(step.why)
        if why and not self.done:  # what has not happened yet is not said as if it had
            why = words.TOUR_AHEAD.format(why=why)
        return " ".join(part for part in (answer, why) if part)

    @property
    def seen(self) -> bool:
        """Is the card there, and not under a panel that somebody has opened over it?"""
        return self.on and not self.rect.colliderect(self.stage.over)

    @property
    def taken(self) -> int:
        """How much of the panel's height the card takes, margins included [px]."""
        if not self.on or not self.stage.renderer.layout.panel.width:
            return 0
        return self.rect.height + 2 * self.card.margin

    @property
    def rect(self) -> pygame.Rect:
        """Where the card is in the window [px]."""
        return self.card.rect(self.page)

    def draw(self, painter: Painter) -> None:
        """The card."""
        if self.seen:
            self.card.draw(painter, self.page, self._hover)
