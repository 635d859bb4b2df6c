"""The curves of the window in files: a table, and a picture of the plot for paper and slides."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import pygame

from core.errors import InputError, reason_of
from core.files import atomic_write
from sandbox.draw.marks import marks
from sandbox.draw.painter import Painter
from sandbox.draw.plot import draw_plot
from sandbox.draw.render import curve_of
from sandbox.draw.text import HEADING, Type
from sandbox.draw.theme import LIGHT
from sandbox.files.table import PLAIN, Spelling, write_csv
from sandbox.session.frame import Frame
from sandbox.window.picture import kept_curve
from sandbox.window.solvers.kept_curves import CurveTable, Kept
from sandbox.words import words
from scenes.text import message

SIZE, SCALE = (1920, 1080), 2.0  # of the picture [px], and of its letters


def export(frames: Sequence[Frame], kept: Sequence[Kept], spelling: Spelling = PLAIN) -> str:
    """Write table and picture into the current folder, under a name that is still free.

    Returns what to tell the person.
    """
    stem = free_stem(f"sandbox-{frames[0].scene}-curves", (".csv", ".png"))
    try:
        write_csv(f"{stem}.csv", CurveTable(frames, kept), spelling)
    except InputError as error:
        return words.say(message(error))
    picture = io.BytesIO()
    pygame.image.save(plot_picture(frames, kept), picture, "picture.png")
    try:
        with atomic_write(f"{stem}.png") as file:
            file.write(picture.getvalue())
    except OSError as error:
        return words.NOT_SAVED.format(name=f"{stem}.png", reason=reason_of(error))
    return words.EXPORTED.format(name=stem)


def plot_picture(frames: Sequence[Frame], kept: Sequence[Kept]) -> pygame.Surface:
    """The plot alone, large and on a light ground."""
    surface = pygame.Surface(SIZE, 0, 32)
    painter = Painter(surface, LIGHT, Type(SCALE))
    painter.fill(painter.everything, LIGHT.panel)
    head = round(50 * SCALE)
    title = words.title(frames[0].scene, frames[0].title)
    painter.text(title, 16 * SCALE, 0.55 * head, size=HEADING, bold=True)
    curves = [*map(curve_of, frames, marks(frames)), *map(kept_curve, kept)]
    labels = words.say(frames[0].curve_label), words.say(frames[0].stroke_label)
    margin = round(10 * SCALE)
    rect = pygame.Rect(margin, head, SIZE[0] - 2 * margin, SIZE[1] - head - margin)
    draw_plot(painter, rect, curves, *labels)
    painter.flush()
    return surface


def free_stem(stem: str, suffixes: Sequence[str]) -> str:
    """``stem-1``, or with the first number for which none of the files exists."""
    number = 1
    while any(Path(f"{stem}-{number}{suffix}").exists() for suffix in suffixes):
        number += 1
    return f"{stem}-{number}"
