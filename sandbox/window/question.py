"""Asks what is to be written before it is: the curves for programs or for the Excel of this country, or the run as a page."""

from __future__ import annotations

import pygame

from sandbox.draw.pages.question import Asked, draw_question
from sandbox.draw.painter import Painter
from sandbox.files.table import PLAIN, Spelling, for_excel
from sandbox.window.export import export
from sandbox.window.keys import PACKING_ACTIONS, Action, action_of
from sandbox.window.parts import Silent
from sandbox.window.reel import Reel
from sandbox.window.stage import Stage
from sandbox.words import words

ANSWERS = 3
PAGE = 2  # the last of them
STEPS = {Action.UP: -1, Action.LEFT: -1, Action.DOWN: 1, Action.RIGHT: 1}


class ExportQuestion(Silent):
    """While it is asked all keys and the mouse are for it; the answer of last time comes first."""

    def __init__(self, stage: Stage, reel: Reel) -> None:
        self.stage, self.reel = stage, reel
        self.asking = False
        self.place = 0
        self._answers: list[pygame.Rect] = []

    def act(self, action: Action) -> bool:
        """The key that asks, and what answers; any other takes the question away and means what it always does."""
        if not self.asking:
            if action is Action.EXPORT:
                self.stage.mouse.release(self.stage.send)
                self.asking = True
                self.stage.redraw(True)
            return self.asking
        if action in STEPS:
            self.place = (self.place + STEPS[action]) % ANSWERS
        elif action in PACKING_ACTIONS[:ANSWERS]:
            self.answer(PACKING_ACTIONS.index(action))
        elif action in (Action.ENTER, Action.PAUSE, Action.EXPORT):
            self.answer(self.place)
        else:
            self.asking = False
            return action is Action.BACK
        return True

    def handle(self, event: pygame.event.Event) -> bool:
        """Keys before any other part, and the mouse: an answer, or beside them."""
        if not self.asking:
            return False
        if event.type == pygame.KEYDOWN:
            if event.key == pygame.K_TAB:
                return self.act(Action.DOWN)
            action = action_of(event)
            return action is not None and self.act(action)
        if event.type == pygame.MOUSEMOTION:
            for index, rect in enumerate(self._answers):
                if rect.collidepoint(event.pos):
                    self.place = index
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            hit = [k for k, rect in enumerate(self._answers) if rect.collidepoint(event.pos)]
            self.asking = False
            if hit:
                self.answer(hit[0])
        return event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEWHEEL)

    def answer(self, place: int) -> None:
        """The question is answered."""
        self.asking, self.place = False, place
        if place == PAGE:
            self.stage.toast(self.reel.save())
            return
        frames = [pane[0] for pane in self.stage.picture.panes()]
        shown = self.stage.panes.curves.shown(frames[0])
        self.stage.toast(export(frames, shown, _spelling(place)))

    @staticmethod
    def answers() -> tuple[tuple[str, str], ...]:
        """What there is to choose from, with a line about each."""
        return (
            (words.EXPORT_PLAIN, words.EXPORT_PLAIN_HELP),
            (words.EXPORT_EXCEL, words.EXPORT_EXCEL_HELP),
            (words.EXPORT_PAGE, words.EXPORT_PAGE_HELP),
        )

    def draw_over(self, painter: Painter) -> None:
        """The card over all other parts, while it asks."""
        if self.asking:
            asked = Asked(words.EXPORT_ASK, self.answers(), words.EXPORT_WITHOUT)
            self._answers = draw_question(painter, asked, self.place)


def _spelling(place: int) -> Spelling:
    return for_excel(words.decimal_sign(), words.say) if place else PLAIN
