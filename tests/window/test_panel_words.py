"""No word of the panel is cut, in any language."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace

import pygame
import pytest

from sandbox.draw.text import SMALL, Type
from sandbox.draw.widgets.controls import (
    PAD,
    Choice,
    Place,
    Slider,
)
from sandbox.draw.widgets.look import Attention, draw_control
from sandbox.draw.widgets.panel_frame import FOOT_LINES
from sandbox.window.panel.panel import Panel
from sandbox.window.panel.parameters import ParameterSection, Wishes
from sandbox.words import language
from scenes import registry
from tests.draw.frames import intruder_frame
from tests.window.desk import Desk


def helps_of_scenes(panel: Panel) -> set[str]:
    """What is said of parameters in every scene."""
    frame, helps = intruder_frame(4), set()
    for name in registry.names():
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(Wishes, "frame", replace(frame, scene=name))
            for section in panel.sections:
                if isinstance(section, ParameterSection):
                    helps |= {control.help for control in section.controls()}  # type: ignore[union-attr]
    return helps


def with_every_word(place: Place) -> Iterator[Place]:
    """A control as it is, a slider at its ends as well, and a choice with each of its options."""
    control = place.control
    yield place
    if isinstance(control, Slider):
        for value in (control.low, control.high):
            yield replace(place, control=replace(control, value=value))
    elif isinstance(control, Choice):
        for option in control.options:
            yield replace(place, control=replace(control, value=option.value))


@pytest.mark.parametrize(("size", "scale"), [((1280, 720), 1.0), ((800, 600), 3.0)], ids=str)
def test_no_word_of_the_panel_is_cut_in_any_language(
    size: tuple[int, int], scale: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All sections, brush and a grain that is looked at too, with the parameters of all scenes."""
    parameters = {p.name: p for name in registry.names() for p in registry.get(name).parameters}
    monkeypatch.setattr(Wishes, "parameters", lambda _: list(parameters.values()))
    original, cut = Type.shortened, []

    def shortened(self: Type, text: str, size: float, width: float, bold: bool = False) -> str:
        shown = original(self, text, size, width, bold)
        cut.extend([text] * (shown != text))
        return shown

    desk = Desk(size, scale)
    with contextlib.closing(desk.app):
        desk.start()
        desk.key(pygame.K_b)
        desk.key(pygame.K_i)
        panel = desk.app.panel
        panel.folded.clear()
        if not panel.drawer.shown:
            panel.fold()
        monkeypatch.setattr(Type, "shortened", shortened)
        for code in language.available():
            language.use(code)
            panel.tick(0.0)
            assert len(panel._places.all) > len(parameters)
            for place in panel._places.all:
                for shown_place in with_every_word(place):
                    draw_control(desk.app.stage.renderer.painter(), shown_place, Attention())
            assert cut == [], code
            if scale == 1.0:  # help, at the foot
                type_, room = desk.app.stage.renderer.type, panel.rect.width - 2 * round(PAD)
                helps = {place.control.help for place in panel._places.all} | helps_of_scenes(panel)
                long = [t for t in helps if len(type_.wrapped(t, SMALL, room)) > FOOT_LINES]
                assert long == [], code
