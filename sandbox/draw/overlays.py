"""What is drawn over the grains: force chains, the handle, the hand's line and its force."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw import raster
from sandbox.draw.camera import Camera
from sandbox.draw.interest import Bounds, free_place, held_bodies, places_of_interest
from sandbox.draw.numbers import decimals_for, number
from sandbox.draw.painter import Painter, floats
from sandbox.draw.periodic import cell_rect, images
from sandbox.draw.text import BODY, HEADING, SMALL
from sandbox.draw.theme import HAND, magnitude_colours, mix
from sandbox.draw.world import Look
from sandbox.session.frame import Frame, HandleState
from sandbox.words.words import FORCE_UNIT

CHAIN_WIDTH = 0.62  # of the largest chain, in reference radii [R]
CHAIN_MOST = 13.0  # and never wider than this at scale 1 [px]
FADE = 0.3, 1.0  # of the mean force: where chains begin to show, and show fully
# Over grains that keep their colours chains are narrower and fewer, with a rim of ground colour at scale 1 [px].
SLIM = {"kinds": 0.8, "values": 0.6}
FADE_OVER_GRAINS = 0.6, 1.0
CHAIN_RIM = 0.6
FAINT_FROM, FAINT_TO = 0.004, 0.06  # and the same of the scale's top
KNOB = 11.0  # radius of the handle's knob at scale 1 [px]
ARROW_LONGEST = 96.0  # arrow of a force at the top of its scale, at scale 1 [px]


def draw_chains(
    painter: Painter,
    rect: pygame.Rect,
    camera: Camera,
    frame: Frame,
    top: float,
    look: Look,
) -> None:
    """A line along every contact: width by the root of the force, colour by the force.

    Where colour says something else in this view, the lines have that of the text.
    """
    contacts = frame.contacts
    force = floats(contacts.force)
    carrying = force[np.isfinite(force) & (force > 0.0)]
    if not carrying.size:
        return
    mean = float(carrying.mean())
    alone, plain = look.view.only_chains, look.values is not None
    fade_from, fade_to = FADE if alone else FADE_OVER_GRAINS
    with np.errstate(invalid="ignore"):
        share = np.clip(force / top, 0.0, 1.0)
        alpha = np.minimum(
            np.clip((force / mean - fade_from) / (fade_to - fade_from), 0.0, 1.0),
            np.clip((force / top - FAINT_FROM) / (FAINT_TO - FAINT_FROM), 0.0, 1.0),
        )
    order = np.argsort(share, kind="stable")  # the strongest on top
    x0, y0, x1, y1 = (
        floats(part[order]) for part in (contacts.x0, contacts.y0, contacts.x1, contacts.y1)
    )
    if frame.box is not None:
        outer = np.minimum(x0, x1), np.minimum(y0, y1), np.maximum(x0, x1), np.maximum(y0, y1)
        index, move_x, move_y = images(frame.box, *outer)
        x0, x1 = x0[index] + move_x, x1[index] + move_x
        y0, y1 = y0[index] + move_y, y1[index] + move_y
        order = order[index]
    widest = 0.5 * min(CHAIN_WIDTH * camera.scale, CHAIN_MOST * painter.scale)
    canvas = painter.canvas(cell_rect(rect, camera, frame.box), camera.transform)
    width = widest * np.sqrt(share[order])
    theme = painter.theme
    if not alone:
        width *= SLIM["values" if plain else "kinds"]
        ground = np.full(order.size, theme.ground, dtype=np.uint32)
        rim = width + CHAIN_RIM * painter.scale
        seen_through = (alpha[order] < 1.0) | (width < 0.5)
        hidden = np.where(seen_through, 0.0, width)
        raster.draw_lines(canvas, (x0, y0, x1, y1), rim, ground, alpha[order], hidden)
    if plain:
        colours = np.full(order.size, theme.text, dtype=np.uint32)
    else:
        colours = magnitude_colours(theme, share[order])
    raster.draw_lines(canvas, (x0, y0, x1, y1), width, colours, alpha[order])


def mark_scale(painter: Painter, rect: pygame.Rect) -> float:
    """The scale of knobs and arrows: the UI's, but on a small canvas they leave the grains room."""
    return min(painter.scale, min(rect.width, rect.height) / 260.0)


@dataclass(frozen=True, slots=True)
class Hand:
    """What the person at the window is doing; nothing in a film."""

    hover: str | None = None  # handle under the cursor
    held: str | None = None  # handle in the hand
    target: tuple[float, float] | None = None  # where the hand wants it now [R]


def draw_handles(
    painter: Painter,
    rect: pygame.Rect,
    camera: Camera,
    frame: Frame,
    hand: Hand,
    force_top: float,
) -> list[pygame.Rect]:
    """Lines to the hand's targets, knobs, and force arrows with their numbers; returns where the numbers stand [px]."""
    for handle in frame.handles:
        here = camera.to_screen(handle.x, handle.y)
        if not (math.isfinite(here[0]) and math.isfinite(here[1])):
            continue
        held = hand.held == handle.name
        target = hand.target if held and hand.target is not None else handle.target
        if target is not None:
            _draw_taut_line(painter, rect, here, camera.to_screen(*target))
        active = held or handle.target is not None
        lively = active or hand.hover == handle.name
        _draw_knob(painter, rect, here, handle, lively=lively)
    knob = 1.4 * KNOB * mark_scale(painter, rect)
    taken = places_of_interest(frame, camera, rect, knob)
    labels: list[pygame.Rect] = []
    for handle in frame.handles:
        own = held_bodies(frame, handle.name)
        label = _draw_force(painter, rect, camera, handle, own, force_top, [*taken, *labels])
        labels += [] if label is None else [label]
    return labels


def _draw_taut_line(
    painter: Painter,
    rect: pygame.Rect,
    here: tuple[float, float],
    there: tuple[float, float],
) -> None:
    scale = mark_scale(painter, rect)
    if not all(map(math.isfinite, there)) or math.dist(here, there) < 2.0 * scale:
        return
    painter.line(here, there, 4.5 * scale, painter.theme.ground, 0.7, rect)
    painter.line(here, there, 2.0 * scale, HAND, clip=rect)
    painter.disc(*there, 7.0 * scale, painter.theme.ground, alpha=0.7, clip=rect)
    painter.ring(*there, 5.5 * scale, 2.5 * scale, HAND, clip=rect)


def _draw_knob(
    painter: Painter,
    rect: pygame.Rect,
    here: tuple[float, float],
    handle: HandleState,
    *,
    lively: bool,
) -> None:
    """An orange disc with arrow heads along the ways it can go."""
    scale = mark_scale(painter, rect)
    size = KNOB * scale * (1.25 if lively else 1.0)
    ground = painter.theme.ground
    x, y = here
    painter.disc(x, y, size + 2.0 * scale, ground, alpha=0.75, clip=rect)
    painter.disc(x, y, size, HAND, edge=mix(HAND, 0x000000, 0.3), edge_width=1.5 * scale, clip=rect)
    if handle.axis is None:
        ways = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    else:
        ways = [handle.axis, (-handle.axis[0], -handle.axis[1])]
    for way_x, way_y in ways:
        tip = (x + 0.78 * size * way_x, y - 0.78 * size * way_y)
        base = (x + 0.36 * size * way_x, y - 0.36 * size * way_y)
        side = (-way_y * 0.36 * size, -way_x * 0.36 * size)
        corners = [
            tip,
            (base[0] + side[0], base[1] + side[1]),
            (base[0] - side[0], base[1] - side[1]),
        ]
        _triangle(painter, rect, corners, 0x101418)


def _triangle(
    painter: Painter, rect: pygame.Rect, corners: list[tuple[float, float]], colour: int
) -> None:
    places = np.array([[px, -py] for px, py in corners])
    painter.hull(places, 0.0, colour, clip=rect)


def _draw_force(
    painter: Painter,
    rect: pygame.Rect,
    camera: Camera,
    handle: HandleState,
    held: Sequence[Bounds],
    top: float,
    taken: Sequence[pygame.Rect],
) -> pygame.Rect | None:
    """An arrow from the handle along the force of the hand, and the force as a number; returns where that stands.

    It stands behind a body, where the hand comes from: in front of it is where things happen. Where the body is what all is in
    it stands outside.
    """
    size = math.hypot(handle.fx, handle.fy)
    x, y = camera.to_screen(handle.x, handle.y)
    if not math.isfinite(size + x + y) or size < 0.005 * top or not rect.collidepoint(x, y):
        return None
    scale = mark_scale(painter, rect)
    way = (handle.fx / size, -handle.fy / size)
    start = (KNOB + 6.0) * scale
    root = (x + start * way[0], y + start * way[1])
    tip = _draw_arrow(painter, rect, root, way, min(size / top, 1.2) * ARROW_LONGEST * scale)

    inside = rect.inflate(-round(4 * scale), -round(4 * scale))
    label, type_ = f"{number(size, decimals_for(top) + 2)} {FORCE_UNIT}", painter.type
    reach = _reach(camera, handle, held, start)
    front = way if held else (inside.centerx - x, inside.centery - y)
    for letters in (HEADING, BODY, SMALL, SMALL / type_.scale):  # the last: as small as can be read
        width = type_.width(label, letters, bold=True) + round(14 * scale)
        height = type_.height(letters, bold=True) + round(4 * scale)
        wanted = _beside((x, y), way, front, reach, tip, (width, height), inside)
        plate, covered = free_place((width, height), wanted, taken, inside)
        if not covered and inside.contains(plate):
            break
    if covered or not inside.contains(plate):
        return (
            None  # rather no number, which the plot has too, than one that covers what it is about
        )
    painter.box(
        plate,
        painter.theme.panel,
        radius=6.0 * scale,
        edge=HAND,
        edge_width=1.5 * scale,
        alpha=0.94,
    )
    painter.text(label, *plate.center, size=letters, bold=True, anchor="centre", clip=rect)
    return plate


def _reach(
    camera: Camera, handle: HandleState, held: Sequence[Bounds], knob: float
) -> tuple[float, float, float, float]:
    """How far the held body goes from its handle, to the left, up, to the right and down [px]; at least ``knob``."""
    ends = [(handle.x - b[0], b[3] - handle.y, b[2] - handle.x, handle.y - b[1]) for b in held]
    reach = [max([knob, *(camera.scale * end[side] for end in ends)]) for side in range(4)]
    return reach[0], reach[1], reach[2], reach[3]


def _beside(
    place: tuple[float, float],
    way: tuple[float, float],
    front: tuple[float, float],
    reach: tuple[float, float, float, float],
    tip: tuple[float, float],
    size: tuple[int, int],
    inside: pygame.Rect,
) -> list[tuple[float, float]]:
    """Middles for a number [px], best first: away from the ``front``, at the sides, at the arrow's tip, anywhere near."""
    (x, y), (half_x, half_y), gap = place, (0.5 * size[0], 0.5 * size[1]), 5.0
    left, up, right, down = reach
    sides = {
        (-1.0, 0.0): (x - left - half_x - gap, y),
        (0.0, -1.0): (x, y - up - half_y - gap),
        (1.0, 0.0): (x + right + half_x + gap, y),
        (0.0, 1.0): (x, y + down + half_y + gap),
    }
    behind = sorted(sides, key=lambda side: side[0] * front[0] + side[1] * front[1])
    away = half_x * abs(way[0]) + half_y * abs(way[1]) + gap
    found = [sides[side] for side in behind[:3]]
    found.append((tip[0] + away * way[0], tip[1] + away * way[1]))
    found.append(sides[behind[3]])
    spots = [
        (inside.left + inside.width * column / 6, inside.top + inside.height * row / 6)
        for row in range(7)
        for column in range(7)
    ]
    return found + sorted(spots, key=lambda spot: math.dist(spot, place))


def _draw_arrow(
    painter: Painter,
    rect: pygame.Rect,
    root: tuple[float, float],
    way: tuple[float, float],
    length: float,
) -> tuple[float, float]:
    """From ``root`` along ``way``, a unit vector; where its tip is [px]."""
    scale = mark_scale(painter, rect)
    head = 13.0 * scale
    neck = (root[0] + length * way[0], root[1] + length * way[1])
    tip = (neck[0] + head * way[0], neck[1] + head * way[1])
    ground = painter.theme.ground
    side = (-way[1] * 0.62 * head, way[0] * 0.62 * head)
    wings = [
        tip,
        (neck[0] + side[0], neck[1] + side[1]),
        (neck[0] - side[0], neck[1] - side[1]),
    ]
    corners = np.array([[px, -py] for px, py in wings])
    # A rim of ground colour sets the arrow off from grains of any colour.
    painter.line(root, neck, 9.0 * scale, ground, 0.85, rect)
    painter.hull(corners, 2.0 * scale, ground, alpha=0.85, clip=rect)
    painter.line(root, neck, 5.0 * scale, HAND, clip=rect)
    painter.hull(corners, 0.0, HAND, clip=rect)
    return tip
