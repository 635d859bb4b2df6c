"""Small pictures of Frames; those of scenes for the menu are found again as files.

These are made by ``.ci/make_thumbnails.py`` and lie beside this module in an installed program, in assets/ in the repository.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.numbers import typical_largest
from sandbox.draw.overlays import draw_chains
from sandbox.draw.painter import Painter
from sandbox.draw.periodic import draw_cell
from sandbox.draw.text import Type
from sandbox.draw.theme import theme_named
from sandbox.draw.views import view_named
from sandbox.draw.world import Look, draw_bodies, draw_grains
from sandbox.session.frame import Frame

SIDE = 256  # of a picture [px]
MARGIN = 6.0  # round the scene [px]
LEAST_CHAIN = 0.02  # the top of the force scale is never below this [k R]
KEPT = 64  # pictures that are held ready at one size


def drawn(
    frame: Frame, theme: str, size: tuple[int, int] = (SIDE, SIDE), margin: float = MARGIN
) -> pygame.Surface:
    """A picture of a frame, of that width and height, with a margin round the scene [px]."""
    surface = pygame.Surface(size, 0, 32)
    painter = Painter(surface, theme_named(theme), Type(1.0))
    rect = surface.get_rect()
    painter.fill(rect, painter.theme.ground)
    camera = Camera.fit(frame.bounds, rect, margin)
    look = Look(view_named("kind"), True)
    draw_grains(painter, rect, camera, frame, look)
    draw_bodies(painter, rect, camera, frame)
    top = max(typical_largest(frame.contacts.force), LEAST_CHAIN)
    draw_chains(painter, rect, camera, frame, top, look)
    draw_cell(painter, rect, camera, frame)
    painter.flush()
    return surface


def path_of(name: str, theme: str) -> Path:
    """The file of a thumbnail; it need not exist."""
    here = Path(__file__).resolve().parent
    file = f"{name}-{theme}.png"
    packaged = here / "thumbnails" / file
    return packaged if packaged.is_file() else here.parents[2] / "assets" / "thumbnails" / file


@lru_cache(maxsize=KEPT)
def fitted(name: str, theme: str, width: int, height: int) -> pygame.Surface | None:
    """The thumbnail as large as it goes into so many pixels; None where there is none."""
    path = path_of(name, theme)
    if not path.is_file() or min(width, height) < 1:
        return None
    read = pygame.image.load(str(path))  # a palette: only true colours can be scaled smoothly
    picture = pygame.Surface(read.get_size(), 0, 32)
    picture.blit(read, (0, 0))
    share = min(width / picture.get_width(), height / picture.get_height())
    size = round(picture.get_width() * share), round(picture.get_height() * share)
    return pygame.transform.smoothscale(picture, (max(size[0], 1), max(size[1], 1)))
