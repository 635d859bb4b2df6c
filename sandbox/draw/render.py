"""The whole picture of a Frame, for window and film alike."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pygame
import pygame.surfarray
from numpy.typing import NDArray

from sandbox.draw import words
from sandbox.draw.camera import Camera
from sandbox.draw.layout import Layout, layout
from sandbox.draw.legend import draw_header
from sandbox.draw.numbers import RoundScale, typical_largest
from sandbox.draw.overlays import Hand, draw_chains, draw_handles
from sandbox.draw.painter import Painter
from sandbox.draw.periodic import draw_cell
from sandbox.draw.plot import Curve, draw_plot
from sandbox.draw.status import draw_status
from sandbox.draw.text import BODY, Type
from sandbox.draw.theme import channels, packing_colour, theme_named
from sandbox.draw.views import VIEWS, view_named
from sandbox.draw.world import Look, draw_bodies, draw_grains
from sandbox.frame import Frame

LEAST_CHAIN, LEAST_PUSH = 0.02, 0.1  # tops of the force scales are never below these [k R]
MARGIN = 14.0  # round the scene at scale 1 [px]


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
        self._wanted: dict[str, Any] = {}  # of the layout: panes, panel, timeline
        self.layout: Layout = layout(size, scale)
        self.camera = Camera.fit((-1.0, -1.0, 1.0, 1.0), self.layout.canvas, 0.0)
        self.forget()

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

    def arrange(self, *, panes: int = 1, panel: bool = False, timeline: bool = False) -> None:
        """How many canvases, and whether there is a panel and a time line if there is room."""
        self._wanted = {"panes": panes, "panel": panel, "timeline": timeline}
        self.layout = layout(self.size, self.type.scale, **self._wanted)

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
        frame: Frame,
        *,
        hand: Hand | None = None,
        rate: str = "",
        paused: bool = False,
        notices: tuple[str, ...] = (),
    ) -> pygame.Surface:
        """Draw a frame; returns the renderer's surface, which the next call overwrites.

        ``rate`` is what the status line says about frames a second; ``notices`` are the window's
        own, shown with the frame's.
        """
        painter = self.painter()
        places = self.layout
        self.camera = Camera.fit(frame.bounds, places.canvas, MARGIN * self.scale)
        painter.fill(places.canvas, self.theme.ground)
        look = self._look(frame)
        draw_grains(painter, places.canvas, self.camera, frame, look)
        draw_bodies(painter, places.canvas, self.camera, frame)
        chain_top = None
        if look.chains:
            chain_top = self._chain_scale.follow(typical_largest(frame.contacts.force))
            plain = look.values is not None
            draw_chains(painter, places.canvas, self.camera, frame, chain_top, plain)
        draw_cell(painter, places.canvas, self.camera, frame)
        forces = [math.hypot(handle.fx, handle.fy) for handle in frame.handles]
        hand_top = self._hand_scale.follow(max(forces, default=0.0))
        draw_handles(painter, places.canvas, self.camera, frame, hand or Hand(), hand_top)
        draw_header(painter, places.header, frame, look, chain_top)
        curve = Curve(frame.curve_stroke, frame.curve_force, packing_colour(frame.packing))
        labels = words.say(frame.curve_label), words.say(frame.stroke_label)
        draw_plot(painter, places.plot, [curve], *labels)
        draw_status(painter, places.status, frame, rate=rate, paused=paused)
        self._draw_notices(painter, (*map(words.say, frame.notices), *notices))
        painter.flush()
        return self.surface

    def _look(self, frame: Frame) -> Look:
        """What the view makes of a frame."""
        view = self.view
        chains = self.chains or view.only_chains
        if view.measure is None:
            return Look(view, chains)
        values = view.measure(frame)
        return Look(
            view, chains, values, self._view_scales[view.name].follow(typical_largest(values))
        )

    def _draw_notices(self, painter: Painter, notices: tuple[str, ...]) -> None:
        """Plain words on plates at the foot of the canvas, the newest lowest."""
        scale, canvas = self.scale, self.layout.canvas
        bottom = canvas.bottom - round(10 * scale)
        for notice in reversed(notices):
            room = canvas.width - round(56 * scale)
            text = self.type.shortened(notice, BODY, room)
            plate = pygame.Rect(
                0,
                0,
                self.type.width(text, BODY) + round(32 * scale),
                self.type.height(BODY) + round(12 * scale),
            )
            plate.midbottom = (canvas.centerx, bottom)
            if not text or plate.top < canvas.top:
                return
            painter.box(
                plate,
                self.theme.panel,
                radius=0.5 * plate.height,
                edge=self.theme.hairline,
                edge_width=1.5 * scale,
                alpha=0.94,
            )
            painter.text(text, *plate.center, anchor="centre")
            bottom = plate.top - round(6 * scale)

    def image(self, frame: Frame) -> NDArray[np.uint8]:
        """A frame as an array for films, uint8 (height, width, 3)."""
        pixels = pygame.surfarray.pixels3d(self.draw(frame))
        return np.ascontiguousarray(pixels.transpose(1, 0, 2))
