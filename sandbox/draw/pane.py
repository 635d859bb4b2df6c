"""One packing among several: the strip above its canvas, and plates with words at the foot of a canvas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.lamp import lamp
from sandbox.draw.marks import Mark
from sandbox.draw.painter import Painter
from sandbox.draw.status import draw_lamp, lamp_space
from sandbox.draw.text import BODY, SMALL, Type
from sandbox.session.frame import Frame
from sandbox.words import words

STRIP = 32.0  # height of the strip above a canvas at scale 1 [px]
SWATCH = 31.0  # of the packing's curve
CAPTION_LINES = 2  # at the foot of a canvas, and one more on a narrow one
NARROW = 330.0  # at scale 1 [px]
FOOT_SHARE = 0.18  # of a canvas' height, for them, at most
MOST_LINES = 3  # on a plate
COVERED = 0.4  # of a canvas' height, by plates, at most
FRESH = 40  # an event is spoken of for so many increments


def cut(canvas: pygame.Rect, type_: Type) -> tuple[pygame.Rect, pygame.Rect, pygame.Rect]:
    """A canvas cut into its strip, what is left for the grains, and a foot for words.

    On a small canvas the foot has fewer lines, or no height.
    """
    strip = min(round(STRIP * type_.scale), canvas.height // 4)
    most = CAPTION_LINES + (canvas.width < NARROW * type_.scale)
    feet = [lines * type_.height(BODY) + round(6 * type_.scale) for lines in range(most, 0, -1)]
    foot = next((height for height in feet if height <= FOOT_SHARE * canvas.height), 0)
    top, bottom = canvas.top + strip, canvas.bottom - foot
    return (
        pygame.Rect(canvas.left, canvas.top, canvas.width, strip),
        pygame.Rect(canvas.left, top, canvas.width, bottom - top),
        pygame.Rect(canvas.left, bottom, canvas.width, foot),
    )


def draw_strip(painter: Painter, strip: pygame.Rect, frame: Frame, mark: Mark) -> None:
    """Which run this is, in the colour and dash of its curve; whether to believe it; grains out."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.fill(strip, theme.panel)
    thin = max(round(scale), 1)
    painter.fill(pygame.Rect(strip.left, strip.bottom - thin, strip.width, thin), theme.hairline)
    middle = strip.centery
    pad, gap = round(12 * scale), round(14 * scale)
    left, right = strip.left + pad, strip.right - pad

    dash = [length * scale for length in mark.dash]
    ends = np.array([left, left + SWATCH * scale])
    painter.polyline(ends, np.array([middle, middle]), 3.0 * scale, mark.colour, strip, dash)
    x = left + SWATCH * scale + round(8 * scale)
    name = type_.shortened(mark.name, BODY, right - x, bold=True)
    x = painter.text(name, x, middle, bold=True, clip=strip).right + gap

    state = lamp(frame, theme)
    out = words.GRAINS_OUT.format(count=frame.grains_out) if frame.grains_out else ""
    room = right - x - lamp_space(painter)
    choices = [(state.words, out), (state.short, out), (state.state, out), (state.state, "")]
    for said, aside in choices:
        if type_.width(said, SMALL) + (type_.width(aside, SMALL) + gap) * bool(aside) <= room:
            break
    else:
        said = aside = ""
    if room >= 0:
        draw_lamp(painter, x, middle, state.colour)
        painter.text(said, x + lamp_space(painter), middle, size=SMALL, clip=strip)
    if aside:
        tint = theme.soft_text
        painter.text(aside, right, middle, size=SMALL, colour=tint, anchor="right", clip=strip)


def said_of(frame: Frame) -> tuple[str, ...]:
    """What a frame has to say: its notices, or else an event that has just happened."""
    notices = [words.say(notice) for notice in frame.notices]
    if not notices and frame.events and frame.increment - frame.events[-1].increment < FRESH:
        notices.append(words.say(frame.events[-1].text))
    return tuple(notices)


def draw_caption(painter: Painter, foot: pygame.Rect, notices: Sequence[str]) -> None:
    """The latest words at the foot of a canvas, so that they cover nothing."""
    type_, line = painter.type, painter.type.height(BODY)
    room = foot.width - round(20 * painter.scale)
    lines: list[str] = []
    for notice in reversed(notices):
        free = int(foot.height // line) - len(lines)
        if free:
            lines = [*_at_most(type_, type_.wrapped(notice, BODY, room), free, room), *lines]
    y = foot.centery - 0.5 * (len(lines) - 1) * line
    for text in lines:
        painter.text(text, foot.centerx, y, anchor="centre", clip=foot)
        y += line


@dataclass(frozen=True, slots=True)
class Plate:
    """Words in a rounded box, a line or a few."""

    rect: pygame.Rect
    lines: tuple[str, ...]


def place_plates(
    type_: Type, canvas: pygame.Rect, notices: Sequence[str], bottom: float
) -> list[Plate]:
    """Plates from ``bottom`` [px] upwards, the newest lowest; what finds no room on the canvas is left out."""
    scale = type_.scale
    line, pad = type_.height(BODY), round(12 * scale)
    room = canvas.width - round(40 * scale)
    top = canvas.bottom - max(COVERED * canvas.height, line + pad)
    placed: list[Plate] = []
    for notice in reversed(notices):
        fitting = min(int((bottom - top - pad) // line), MOST_LINES)
        if fitting < 1 and placed:
            break
        lines = _at_most(type_, type_.wrapped(notice, BODY, room), max(fitting, 1), room)
        width = max((type_.width(text, BODY) for text in lines), default=0)
        rect = pygame.Rect(0, 0, width + round(32 * scale), len(lines) * line + pad)
        rect.midbottom = (canvas.centerx, round(bottom))
        if not lines or rect.top < canvas.top:
            break
        placed.append(Plate(rect, tuple(lines)))
        bottom = rect.top - 6 * scale
    return placed


def _at_most(type_: Type, lines: list[str], most: int, room: float) -> list[str]:
    """So many lines, the last of which says that there were more."""
    if len(lines) <= most:
        return lines
    return [*lines[: most - 1], type_.shortened(f"{lines[most - 1]} …", BODY, room)]


def draw_plates(painter: Painter, plates: Sequence[Plate]) -> None:
    """Plain words on plates."""
    scale, line = painter.scale, painter.type.height(BODY)
    for plate in plates:
        painter.box(
            plate.rect,
            painter.theme.panel,
            radius=0.5 * line + 6.0 * scale,
            edge=painter.theme.hairline,
            edge_width=1.5 * scale,
            alpha=0.94,
        )
        y = plate.rect.top + 0.5 * (plate.rect.height - len(plate.lines) * line) + 0.5 * line
        for text in plate.lines:
            painter.text(text, plate.rect.centerx, y, anchor="centre")
            y += line


def above(canvas: pygame.Rect, plates: Sequence[Plate], least: float) -> pygame.Rect:
    """The canvas without the part that plates cover; all of it if less than ``least`` [px] were left."""
    top = min((plate.rect.top for plate in plates), default=canvas.bottom)
    free = canvas.copy()
    free.height = top - canvas.top
    return free if free.height >= least else canvas
