"""One packing among several: the strip above its canvas, and words at the foot of a canvas."""

from __future__ import annotations

import math
from collections.abc import Sequence

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
SWATCH, SWATCH_SHARE = 31.0, 0.25  # of the packing's curve, and of a narrow strip at most
LINES, MOST_LINES = 2, 5  # at the foot of a canvas
SENTENCE = 900.0  # length of what is said at most at scale 1 [px]: a narrow canvas has more lines
FOOT_SHARE = 0.34  # of a canvas' height, for them, at most
FRESH = 40  # an event is spoken of for so many increments


def cut(
    canvas: pygame.Rect, type_: Type, narrowest: int
) -> tuple[pygame.Rect, pygame.Rect, pygame.Rect]:
    """A canvas cut into its strip, what is left for the grains, and a foot for words: as high as the narrowest needs it [px]."""
    strip = min(round(STRIP * type_.scale), canvas.height // 3)
    letters = type_.pixels(BODY) / BODY
    lines = min(max(math.ceil(SENTENCE * letters / max(narrowest, 1)), LINES), MOST_LINES)
    wanted = lines * type_.leading(BODY) + 6 * type_.scale
    foot = round(min(wanted, FOOT_SHARE * canvas.height))
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
    pad, gap = round(min(12 * scale, 0.05 * strip.width)), round(14 * scale)
    left, right = strip.left + pad, strip.right - pad
    swatch = min(SWATCH * scale, SWATCH_SHARE * strip.width)

    dash = [length * scale for length in mark.dash]
    ends = np.array([left, left + swatch])
    painter.polyline(ends, np.array([middle, middle]), 3.0 * scale, mark.colour, strip, dash)
    x = left + swatch + min(round(8 * scale), pad)
    size = type_.fitting(mark.name, BODY, right - x, bold=True)
    name = type_.shortened(mark.name, size, right - x, bold=True)
    x = painter.text(name, x, middle, size=size, bold=True, clip=strip).right + gap

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


def draw_words(painter: Painter, rect: pygame.Rect, texts: Sequence[str]) -> None:
    """Words in a place of their own, so that they cover nothing: smaller rather than cut."""
    type_ = painter.type
    room = rect.width - round(8 * painter.scale)
    said = [text for text in texts if text]
    if not said or room <= 0 or rect.height <= 0:
        return
    size, lines = type_.whole(said, BODY, room, rect.height - 1)
    line = type_.leading(size)
    y = rect.centery - 0.5 * (len(lines) - 1) * line
    for text in lines:
        painter.text(text, rect.centerx, y, size=size, anchor="centre", clip=rect)
        y += line
