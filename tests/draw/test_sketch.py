"""A sketch over the plot: with what was measured it has a legend, where less lies under it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pygame
import pytest

from sandbox.draw.painter import Painter
from sandbox.draw.plot import PlotBox
from sandbox.draw.sketch import COLUMNS, Beside, Sketch, draw_sketch
from sandbox.draw.text import Type
from sandbox.draw.theme import theme_named
from sandbox.words import words

RECT = pygame.Rect(60, 20, 500, 200)


@pytest.mark.parametrize("theme", ["dark", "light"])
@pytest.mark.parametrize("high", ["left", "right"])
def test_a_legend_names_the_sketch_and_what_was_measured(
    theme: str, high: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    surface = pygame.Surface((640, 260), 0, 32)
    painter = Painter(surface, theme_named(theme), Type(1.0))
    written: dict[str, pygame.Rect] = {}
    text = Painter.text

    def noted(painter: Painter, said: str, x: float, y: float, **more: Any) -> pygame.Rect:
        written[said] = text(painter, said, x, y, **more)
        return written[said]

    monkeypatch.setattr(Painter, "text", noted)
    sketch = Sketch((0.0, 2.0, 0.0, 4.0))
    sketch.up[:] = (
        np.linspace(4.0, 0.0, COLUMNS) if high == "left" else np.linspace(0.0, 4.0, COLUMNS)
    )
    box = PlotBox(RECT, sketch.axes)
    measured = [Beside(f"{name}: 0.25 k R away", 0x3366CC, ()) for name in ("regular", "auxetic")]
    draw_sketch(painter, box, sketch, asking=False, ring=False, measured=measured)
    painter.flush()
    assert list(written) == [words.YOUR_SKETCH, *(each.text for each in measured)]
    for rect in written.values():
        assert RECT.contains(rect)
        assert (rect.centerx > RECT.centerx) == (high == "left")
    heights = [rect.centery for rect in written.values()]
    assert heights == sorted(heights)
    assert len(set(heights)) == 3
    written.clear()
    draw_sketch(painter, box, sketch, asking=True, ring=False)
    assert list(written) == [words.YOUR_SKETCH]
