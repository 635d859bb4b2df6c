"""Where the card of a lesson is, and how large its letters are."""

from __future__ import annotations

import pygame

from sandbox.draw.pages.tour_card import (
    CardLayout,
    TourPage,
    card_layout,
    draw_tour_card,
    fitting_type,
)
from sandbox.draw.painter import Painter
from sandbox.draw.text import Type
from sandbox.window.stage import Stage

WIDTH = 352.0  # of the card where there is no panel, at scale 1 [px]
MARGIN = 10.0  # round it, at scale 1 [px]
LEAST_PANEL = 180.0  # a panel under the card is at least so high at scale 1 [px]


class Card:
    """It stands above the panel, or where the panel would be: it covers nothing of what it speaks of."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._fitted: tuple[object, Type] | None = None
        self._measured: tuple[object, CardLayout] | None = None

    def rect(self, page: TourPage) -> pygame.Rect:
        """Where it is in the window [px]."""
        column, margin = self._column, self.margin
        width = max(column.width - 2 * margin, 1)
        height = min(self.layout(page, width).height, column.height - 2 * margin)
        return pygame.Rect(column.left + margin, column.top + margin, width, max(height, 1))

    def layout(self, page: TourPage, width: int) -> CardLayout:
        """The card at that width [px]; measured again only when it has changed."""
        type_ = self._type(page)
        key = (page, width, type_.scale)
        if self._measured is None or self._measured[0] != key:
            self._measured = key, card_layout(page, type_, width)
        return self._measured[1]

    def button_at(self, page: TourPage, place: tuple[int, int]) -> str:
        """Name of the button there; empty if there is none."""
        rect = self.rect(page)
        for name, button in self.layout(page, rect.width).buttons.items():
            if button.move(rect.topleft).collidepoint(place):
                return name
        return ""

    @property
    def width(self) -> int:
        """How wide a column it is to have where there is no panel [px]."""
        return round((WIDTH + 2.0 * MARGIN) * self.stage.renderer.scale)

    @property
    def margin(self) -> int:
        """Round it [px]."""
        return round(MARGIN * self.stage.renderer.scale)

    @property
    def _column(self) -> pygame.Rect:
        """At the top of the panel, or in a column of its own in the panel's stead."""
        layout = self.stage.renderer.layout
        return layout.panel if layout.panel.width else layout.card

    def _type(self, page: TourPage) -> Type:
        """Smaller than elsewhere where the card would not fit, or leave nothing of the panel."""
        own, column = self.stage.renderer.type, self._column
        least = LEAST_PANEL * own.scale if self.stage.renderer.layout.panel.width else 0.0
        key = (page, column.size, own)
        if self._fitted is None or self._fitted[0] != key:
            width, height = column.width - 2 * self.margin, column.height - 2 * self.margin
            self._fitted = key, fitting_type(page, own, width, round(height - least))
        return self._fitted[1]

    def draw(self, painter: Painter, page: TourPage, hover: str) -> None:
        """Draw it."""
        own, type_ = painter, self._type(page)
        if type_ is not painter.type:
            painter.flush()
            own = Painter(painter.surface, painter.theme, type_)
        draw_tour_card(own, self.rect(page), page, focus=self.stage.focus.ring, hover=hover)
        own.flush()
