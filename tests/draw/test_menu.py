"""The scene menu: a picture for every scene, the same page every time, and texts that say when more follows."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.draw.pages.menu_layout import SCENE, START, Card, Chip, Contents
from sandbox.draw.pages.menu_page import BANNER_PICTURES, draw_menu
from sandbox.draw.pages.thumbnail import fitted, path_of
from sandbox.draw.painter import Painter
from sandbox.draw.render import Renderer
from sandbox.draw.theme import channels, theme_named
from scenes import registry
from tests.draw.test_render import GOLDEN
from tests.draw.test_side_by_side import without_text

LARGEST = 15_000  # bytes of a thumbnail
LEVELS = 4  # SDL scales pictures a little differently from processor to processor
CARDS = (
    Card(f"{SCENE}hopper", "One", "Does it fit?", "A sentence.", "hopper", True),
    Card(f"{SCENE}intruder", "Two", "Does it fit as well, and if so, why?", "More.", "intruder"),
    Card(f"{SCENE}none", "Three", "No picture?", "There is none."),
)
CHIPS = (Chip("packing/mixed", "mixed", True), Chip("theme", "dark"))


@pytest.mark.parametrize("theme", ["dark", "light"])
@pytest.mark.parametrize("name", [*registry.names(), *BANNER_PICTURES])
def test_every_scene_has_a_small_picture_in_both_themes(name: str, theme: str) -> None:
    path = path_of(name, theme)
    assert path.stat().st_size <= LARGEST
    picture = fitted(name, theme, 132, 132)
    assert picture is not None
    assert max(picture.get_size()) == 132
    pixels = pygame.surfarray.array3d(picture).astype(int)
    ground = np.array(channels(theme_named(theme).ground))
    assert np.abs(ground - pixels).max(axis=2).mean() > 5.0, "nothing can be seen"


def test_no_picture_where_there_is_none() -> None:
    assert fitted("no such scene", "dark", 100, 100) is None
    assert fitted("hopper", "dark", 0, 100) is None


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_golden_menu(theme: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Painter, "flush", without_text)
    renderer = Renderer((900, 600), theme=theme)
    contents = Contents(CARDS, CHIPS, "Something was left.")
    draw_menu(renderer.painter(), contents, chosen=START, scroll=40)
    image = pygame.surfarray.array3d(renderer.surface)
    path = Path(GOLDEN) / f"menu-{theme}.png"
    if os.environ.get("SANDBOX_REGENERATE_GOLDEN"):
        pygame.image.save(renderer.surface, str(path))
    wanted = pygame.surfarray.array3d(pygame.image.load(str(path)))
    assert wanted.shape == image.shape
    difference = np.abs(wanted.astype(int) - image.astype(int)).max(axis=-1)
    assert difference.max() <= LEVELS, f"{(difference > LEVELS).sum()} pixels differ from {path}"


def test_a_long_text_says_that_more_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[str] = []
    original = Painter.text

    def text(self: Painter, content: str, *place: float, **more: object) -> pygame.Rect:
        written.append(content)
        return original(self, content, *place, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(Painter, "text", text)
    long = Card(f"{SCENE}long", "Title", "Why? " * 60, "Because. " * 60, "hopper")
    draw_menu(Renderer((900, 600)).painter(), Contents((long,)), chosen="", scroll=0)
    assert sum(text.endswith("…") for text in written) == 2
