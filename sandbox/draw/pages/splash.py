"""The first picture: what is being prepared, and two grains between plates that keep moving.

Drawn with pygame alone. The compiled kernels cannot be used yet: while another thread compiles,
the first call of a kernel in this one would wait for it, and the window would freeze.
"""

from __future__ import annotations

import math

import pygame

from sandbox.draw.text import BODY, TITLE, Type, page_scale
from sandbox.draw.theme import Theme, channels, mix
from sandbox.words import words

_FINE = 4  # shapes are drawn this much larger, then shrunk: that makes their edges smooth
_PERIOD = 3.2  # of the plates' motion [s]


def draw_splash(
    surface: pygame.Surface,
    theme: Theme,
    type_: Type,
    *,
    text: str,
    fraction: float,
    seconds: float,
) -> None:
    """Title, the squeezed pair, a progress bar with what is going on, one sentence."""
    width, height = surface.get_size()
    scale = page_scale(type_.scale, (width, height))
    type_ = type_ if scale == type_.scale else Type(scale)
    surface.fill(channels(theme.ground))
    room = width - round(40 * scale)
    lines = type_.wrapped(words.SPLASH_ABOUT, BODY, min(room, round(560 * scale)))
    line = type_.height(BODY)
    head = type_.height(TITLE, bold=True)
    bar = max(round(8 * scale), 4)
    texts = head + bar + line * (1 + len(lines)) + round(52 * scale)
    if texts > height:
        lines = []
        texts = head + bar + line + round(40 * scale)
    picture = min(round(150 * scale), height - texts - round(20 * scale))
    y = (height - texts - max(picture, 0)) // 2
    if picture >= 48:
        pair = _squeezed_pair(theme, picture, seconds)
        surface.blit(pair, ((width - pair.get_width()) // 2, y))
        y += picture + round(6 * scale)

    def write(content: str, size: float, colour: int, bold: bool = False) -> None:
        nonlocal y
        shown = type_.render(type_.shortened(content, size, room, bold), size, colour, bold)
        surface.blit(shown, ((width - shown.get_width()) // 2, y))
        y += shown.get_height()

    write(words.SPLASH_TITLE, TITLE, theme.text, bold=True)
    y += round(16 * scale)
    length = min(round(420 * scale), room)
    track = pygame.Rect((width - length) // 2, y, length, bar)
    pygame.draw.rect(surface, channels(theme.hairline), track, border_radius=bar // 2)
    if math.isfinite(fraction):
        done = track.copy()
        done.width = max(round(length * min(max(fraction, 0.0), 1.0)), bar)
        pygame.draw.rect(surface, channels(theme.good), done, border_radius=bar // 2)
    y += bar + round(10 * scale)
    write(text, BODY, theme.text)
    y += round(14 * scale)
    for content in lines:
        write(content, BODY, theme.soft_text)


def _squeezed_pair(theme: Theme, size: int, seconds: float) -> pygame.Surface:
    """A regular grain that bulges and an auxetic one that shrinks, under one moving plate."""
    squeeze = 0.5 - 0.5 * math.cos(2.0 * math.pi * seconds / _PERIOD)
    fine = size * _FINE
    picture = pygame.Surface((2 * fine, fine), 0, 32)
    picture.fill(channels(theme.ground))
    radius = 0.34 * fine
    half = radius * (1.0 - 0.24 * squeeze)
    floor = 0.93 * fine
    plate = pygame.Rect(0, 0, round(1.84 * fine), round(0.05 * fine))
    for colour, place, wide, hole in (
        (theme.regular, 0.5, radius * (1.0 + 0.2 * squeeze), 0.0),
        (theme.auxetic, 1.5, radius * (1.0 - 0.2 * squeeze), 1.0 - squeeze),
    ):
        outer = pygame.Rect(0, 0, round(2 * wide), round(2 * half))
        outer.midbottom = (round(place * fine), round(floor))
        pygame.draw.ellipse(picture, channels(mix(colour, 0x000000, 0.38)), outer)
        edge = round(0.012 * fine)
        pygame.draw.ellipse(picture, channels(colour), outer.inflate(-2 * edge, -2 * edge))
        if hole:
            _bow_tie(picture, outer, hole, theme.ground)
    for middle in (floor + plate.height / 2, floor - 2 * half - plate.height / 2):
        plate.center = (fine, round(middle))
        pygame.draw.rect(picture, channels(theme.piston), plate, border_radius=plate.height // 2)
    return pygame.transform.smoothscale(picture, (2 * size, size))


def _bow_tie(picture: pygame.Surface, grain: pygame.Rect, openness: float, colour: int) -> None:
    half_x, half_y = 0.5 * grain.width, 0.5 * grain.height
    x, y = grain.center
    end = max(0.46 * openness, 0.02) * half_x
    waist = max(0.10 * openness, 0.02) * half_x
    height = 0.52 * half_y
    corners = [(-end, -height), (end, -height), (waist, 0), (end, height), (-end, height)]
    corners.append((-waist, 0))
    pygame.draw.polygon(picture, channels(colour), [(x + dx, y + dy) for dx, dy in corners])
