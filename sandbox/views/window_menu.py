"""The scene menu's state: which card is chosen, how far the cards are scrolled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.draw.cards import MenuEntry, MenuLayout, draw_menu
from sandbox.draw.painter import Painter
from sandbox.views.window_keys import Action


@dataclass(frozen=True, slots=True)
class Choice:
    """What a person picked: a scene, or a packing."""

    scene: str | None = None
    packing: str | None = None


class Menu:
    """All scenes as cards; keyboard and mouse."""

    def __init__(self, entries: Sequence[MenuEntry], packings: Sequence[str]) -> None:
        self.entries = tuple(entries)
        self.packings = tuple(packings)
        self.chosen = 0
        self.scroll = 0
        self._clickable = False  # is the mouse over something that can be clicked?
        self._places: MenuLayout | None = None

    def choose(self, scene: str) -> None:
        """Put the choice on a scene."""
        names = [entry.name for entry in self.entries]
        if scene in names:
            self.chosen = names.index(scene)

    def key(self, action: Action) -> Choice:
        """Arrows move the choice, Enter takes it."""
        if not self.entries:
            return Choice()
        columns = self._columns()
        moves = {
            Action.LEFT: -1,
            Action.RIGHT: 1,
            Action.UP: -columns,
            Action.DOWN: columns,
        }
        if action in moves:
            wanted = self.chosen + moves[action]
            if 0 <= wanted < len(self.entries):
                self.chosen = wanted
            self._follow()
        elif action in (Action.ENTER, Action.PAUSE):
            return Choice(scene=self.entries[self.chosen].name)
        return Choice()

    def hover(self, place: tuple[int, int]) -> None:
        """The mouse is there."""
        index = self._card_at(place)
        if index is not None:
            self.chosen = index
        self._clickable = index is not None or self._chip_at(place) is not None

    def cursor(self) -> int:
        """The system cursor for where the mouse is."""
        return pygame.SYSTEM_CURSOR_HAND if self._clickable else pygame.SYSTEM_CURSOR_ARROW

    def click(self, place: tuple[int, int]) -> Choice:
        """The mouse was pressed there."""
        index = self._card_at(place)
        if index is not None:
            self.chosen = index
            return Choice(scene=self.entries[index].name)
        chip = self._chip_at(place)
        return Choice(packing=None if chip is None else self.packings[chip])

    def wheel(self, notches: float, step: int) -> None:
        """Scroll by notches of ``step`` pixels."""
        if self._places is not None:
            most = max(self._places.content - self._places.view.height, 0)
            self.scroll = max(0, min(round(self.scroll - notches * step), most))

    def draw(self, painter: Painter, packing: str, notice: str) -> None:
        """Draw the whole page."""
        self._places = draw_menu(
            painter,
            self.entries,
            self.packings,
            chosen=self.chosen,
            packing=packing,
            scroll=self.scroll,
            notice=notice,
        )

    def place_of(self, scene: str) -> pygame.Rect | None:
        """Where a scene's card was drawn."""
        names = [entry.name for entry in self.entries]
        if self._places is None or scene not in names:
            return None
        return self._places.cards[names.index(scene)].move(0, -self.scroll)

    def _columns(self) -> int:
        if self._places is None or not self._places.cards:
            return 1
        top = self._places.cards[0].top
        return sum(card.top == top for card in self._places.cards)

    def _follow(self) -> None:
        if self._places is not None:
            self.scroll = self._places.scroll_to(self.chosen, self.scroll)

    def _card_at(self, place: tuple[int, int]) -> int | None:
        if self._places is None or not self._places.view.collidepoint(place):
            return None
        x, y = place
        for index, card in enumerate(self._places.cards):
            if card.collidepoint(x, y + self.scroll):
                return index
        return None

    def _chip_at(self, place: tuple[int, int]) -> int | None:
        if self._places is None:
            return None
        index = pygame.Rect(place, (1, 1)).collidelist(list(self._places.chips))
        return None if index < 0 else index
