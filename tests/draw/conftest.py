"""What the tests of drawing share."""

from __future__ import annotations

from typing import Any

import pygame
import pytest

from sandbox.draw.painter import Painter


@pytest.fixture
def texts(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, pygame.Rect]]:
    """Every text that is drawn, and its place."""
    written: list[tuple[str, pygame.Rect]] = []
    original = Painter.text

    def text(self: Painter, content: str, x: float, y: float, **more: Any) -> pygame.Rect:
        place = original(self, content, x, y, **more)
        if content:
            written.append((content, place))
        return place

    monkeypatch.setattr(Painter, "text", text)
    return written
