"""The whole picture of a Frame, for window and film alike."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pygame
import pygame.surfarray
from numpy.typing import NDArray

from sandbox.draw.camera import ALL, Camera
from sandbox.draw.flashes import Flash, draw_flash
from sandbox.draw.layout import Layout, layout
from sandbox.draw.legend import draw_header
from sandbox.draw.marks import Mark, marks
from sandbox.draw.numbers import RoundScale, typical_largest
from sandbox.draw.overlays import Hand, draw_chains, draw_handles
from sandbox.draw.painter import Painter
from sandbox.draw.pane import cut, draw_strip, draw_words, said_of
from sandbox.draw.periodic import draw_cell
from sandbox.draw.plot import Axes, Curve, PlotBox, draw_plot, finite_part
from sandbox.draw.squeezed import draw_squeezed
from sandbox.draw.status import draw_status
from sandbox.draw.text import Type
from sandbox.draw.theme import channels, theme_named
from sandbox.draw.views import VIEWS, view_named
from sandbox.draw.world import Look, draw_bodies, draw_grains
from sandbox.session.frame import Frame
from sandbox.words import words

LEAST_CHAIN, LEAST_PUSH = 0.02, 0.1  # tops of the force scales are never below these [k R]
MARGIN = 14.0  # round the scene at scale 1 [px]
END_OF_WORDS = 46.0  # at scale 1 [px]


class Renderer:
    """Draws Frames of one run into one surface. Needs no display.

    It remembers the tops of its scales only, so that they don't jump from picture to
    picture; call :meth:`forget` when another run begins.
    """

    def __init__(
        self,
        size: tuple[int, int] = (1280, 720),
        scale: float = 1.0,
        theme: str = "dark",
        view: str = "kind",
        chains: bool | None = None,
    ) -> None:
        """``chains`` None: as suits the view."""
        self.set_view(view)
        if chains is not None:
            self.chains = chains
        self.theme = theme_named(theme)
        self.type = Type(scale)
        self.surface = pygame.Surface(size, 0, 32)
        self._wanted: dict[str, Any] = {}  # of the layout: panes, panel, timeline, card
        self.layout: Layout = layout(size, scale)
        self.cameras: tuple[Camera, ...] = (
            Camera.fit((-1.0, -1.0, 1.0, 1.0), self.layout.canvas, 0.0),
        )
        self.sight = ALL  # the same part of each canvas
        self.wholes: tuple[Camera, ...] = self.cameras  # that would show all
        self.bodies = [self.layout.canvas]  # what of each canvas the grains have
        self.plot_least: Axes | None = None  # axes that the plot has at least
        self.plot_box: PlotBox | None = None  # inside the axes, of the latest picture
        self.labels: list[pygame.Rect] = []  # where numbers stand on the canvases
        self.forget()

    @property
    def camera(self) -> Camera:
        """That of the first canvas."""
        return self.cameras[0]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.surface.get_size()

    @property
    def scale(self) -> float:
        """UI scale: 1 is for a screen on the desk, 2 or 3 for the back row."""
        return self.type.scale

    def resize(self, size: tuple[int, int], scale: float | None = None) -> None:
        """Another window size or UI scale."""
        if scale is not None and scale != self.type.scale:
            self.type = Type(scale)
        if size != self.size:
            self.surface = pygame.Surface(size, 0, 32)
        self.layout = layout(size, self.type.scale, **self._wanted)

    def arrange(
        self, *, panes: int = 1, panel: bool = False, timeline: bool = False, card: int = 0
    ) -> None:
        """How many canvases, is there a panel and a time line if there is room, and how wide a card in the panel's stead?"""
        self._wanted = {"panes": panes, "panel": panel, "timeline": timeline, "card": card}
        self.layout = layout(self.size, self.type.scale, **self._wanted)

    @property
    def words_place(self) -> pygame.Rect:
        """Where the window's own words stand under the canvases, between what else it has there at both ends."""
        return self.layout.said.inflate(-2 * self.end_of_words, 0)

    @property
    def end_of_words(self) -> int:
        """Width of either end of the place for words, which is for what can be pressed and for marks [px]."""
        return round(END_OF_WORDS * self.scale)

    def set_theme(self, name: str) -> None:
        """Dark or light."""
        self.theme = theme_named(name)

    def set_view(self, name: str) -> None:
        """One of the views, with force chains or without, as suits it. Raises InputError."""
        self.view = view_named(name)
        self.chains = self.view.chains

    def forget(self) -> None:
        """Start the scales afresh."""
        self._chain_scale = RoundScale(LEAST_CHAIN)
        self._hand_scale = RoundScale(LEAST_PUSH)
        self._view_scales = {name: RoundScale(view.least) for name, view in VIEWS.items()}

    def clear(self) -> None:
        """Nothing but the ground."""
        self.surface.fill(channels(self.theme.ground))

    def painter(self) -> Painter:
        """For drawing more on the surface; flush it afterwards."""
        return Painter(self.surface, self.theme, self.type)

    def draw(
        self,
        frames: Frame | Sequence[Frame | None],
        *,
        hand: Hand | None = None,
        rate: str = "",
        paused: bool = False,
        notices: Sequence[str] = (),
        told: Sequence[Sequence[str]] = (),
        kept: Sequence[Curve] = (),
        flashes: Sequence[Flash] = (),
    ) -> pygame.Surface:
        """Draw a frame, or several side by side; returns the renderer's surface, which the next call overwrites.

        A frame that is not there yet leaves its canvas empty; at least one must be there. ``rate`` is what the status
        line says about frames a second; ``notices`` are the window's own, and ``told`` those of each pane, shown with
        the frame's: below the canvases, so that they cover nothing. ``kept`` are curves of earlier runs, drawn behind those
        of the frames.
        """
        panes = [frames] if isinstance(frames, Frame) else list(frames)
        if len(panes) != len(self.layout.canvases):
            self.arrange(**{**self._wanted, "panes": len(panes)})
        shown = [frame for frame in panes if frame is not None]
        painter = self.painter()
        told_apart = marks(shown)
        bodies, feet = self._canvases(painter, panes, told_apart)
        self.bodies = bodies
        bounds = [(frame or shown[0]).bounds for frame in panes]
        views = list(zip(bounds, bodies, strict=True))
        self.wholes = Camera.fit_all(views, MARGIN * self.scale)
        seen = zip(self.wholes, bodies, strict=True)
        self.cameras = tuple(self.sight.camera(whole, body) for whole, body in seen)
        looks, chain_top = self._looks(shown)
        forces = [math.hypot(handle.fx, handle.fy) for frame in shown for handle in frame.handles]
        hand_top = self._hand_scale.follow(max(forces, default=0.0))
        waiting = iter(looks)
        self.labels = []
        for pane, frame in enumerate(panes):
            rect, camera = bodies[pane], self.cameras[pane]
            if frame is not None:
                self._draw_scene(painter, rect, camera, frame, next(waiting), chain_top)
                for flash in flashes:
                    if flash.pane == pane:
                        draw_flash(painter, rect, camera, frame, flash)
                held = hand or Hand()
                self.labels += draw_handles(painter, rect, camera, frame, held, hand_top)
            said = () if frame is None else said_of(frame)
            said = (*said, *(told[pane] if pane < len(told) else ()))
            if feet:
                draw_words(painter, feet[pane], said)
            else:
                notices = (*said, *notices)
        painter.fill(self.layout.said, self.theme.ground)
        draw_words(painter, self.words_place, notices)
        draw_header(painter, self.layout.header, shown, looks[0], chain_top)
        labels = words.say(shown[0].curve_label), words.say(shown[0].stroke_label)
        limit = shown[0].hand_limit
        curves = [*map(curve_of, shown, told_apart), *kept]
        least = self.plot_least
        self.plot_box = draw_plot(painter, self.layout.plot, curves, *labels, limit, least)
        painter.fill(self.layout.timeline, self.theme.panel)
        painter.fill(self.layout.panel, self.theme.panel)
        painter.fill(self.layout.card, self.theme.panel)
        draw_status(painter, self.layout.status, shown, rate=rate, paused=paused)
        painter.flush()
        return self.surface

    def _canvases(
        self, painter: Painter, panes: Sequence[Frame | None], told_apart: Sequence[Mark]
    ) -> tuple[list[pygame.Rect], list[pygame.Rect]]:
        """Clear the canvases, title them if there are several; returns what is left for the grains, and for words to each."""
        canvases = self.layout.canvases
        if len(canvases) == 1:
            painter.fill(canvases[0], self.theme.ground)
            return [canvases[0]], []
        painter.fill(canvases[0].unionall(canvases[1:]), self.theme.hairline)  # shows in the seams
        bodies, feet, waiting = [], [], iter(told_apart)
        for canvas, frame in zip(canvases, panes, strict=True):
            strip, body, foot = cut(canvas, self.type, canvases[0].width)
            painter.fill(canvas, self.theme.ground)
            if frame is not None:
                draw_strip(painter, strip, frame, next(waiting))
            bodies.append(body)
            feet.append(foot)
        return bodies, feet

    def _draw_scene(
        self,
        painter: Painter,
        rect: pygame.Rect,
        camera: Camera,
        frame: Frame,
        look: Look,
        chain_top: float | None,
    ) -> None:
        """Grains, bodies, chains, and crosses where a grain is no longer to be believed."""
        draw_grains(painter, rect, camera, frame, look)
        draw_bodies(painter, rect, camera, frame)
        if chain_top is not None:
            draw_chains(painter, rect, camera, frame, chain_top, look)
        draw_squeezed(painter, rect, camera, frame)
        draw_cell(painter, rect, camera, frame)

    def _looks(self, frames: Sequence[Frame]) -> tuple[list[Look], float | None]:
        """What the view makes of the frames, on one scale for all; and the top of the chains' scale, if there are any."""
        view = self.view
        chains = self.chains or view.only_chains
        chain_top = None
        if chains:
            strongest = max(typical_largest(frame.contacts.force) for frame in frames)
            chain_top = self._chain_scale.follow(strongest)
        if view.measure is None:
            return [Look(view, chains)] * len(frames), chain_top
        values = [view.measure(frame) for frame in frames]
        top = self._view_scales[view.name].follow(max(map(typical_largest, values)))
        return [Look(view, chains, each, top) for each in values], chain_top

    def image(
        self, frames: Frame | Sequence[Frame | None], *, flashes: Sequence[Flash] = ()
    ) -> NDArray[np.uint8]:
        """A frame, or several side by side, as an array for films, uint8 (height, width, 3)."""
        pixels = pygame.surfarray.pixels3d(self.draw(frames, flashes=flashes))
        return np.ascontiguousarray(pixels.transpose(1, 0, 2))


def curve_of(frame: Frame, mark: Mark) -> Curve:
    """A frame's own curve."""
    ahead = None
    if frame.ahead is not None:  # from the point that is shown now
        stroke = np.append(frame.curve_stroke[-1:], frame.ahead.stroke)
        force = np.append(frame.curve_force[-1:], frame.ahead.force)
        ahead = finite_part(Curve(stroke, force, mark.colour))
    return Curve(
        frame.curve_stroke,
        frame.curve_force,
        mark.colour,
        mark.dash,
        mark.name,
        events=frame.events,
        ahead=ahead,
    )
