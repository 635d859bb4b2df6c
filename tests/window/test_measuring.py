"""Measuring tools in the window: by key and button, ends by mouse and arrow keys, put away by Escape."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pygame
import pytest

from sandbox.draw.widgets.controls import Bars, Fact
from sandbox.window.measure.measuring import CUT, MARKS, PROTRACTOR, RULER, SPREADS, TOOLS
from sandbox.words import words
from tests.window.desk import Desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1280, 720))
    place.start()
    place.app.tick()
    yield place
    place.app.close()


def test_the_key_goes_through_the_tools(desk: Desk) -> None:
    measuring, seen = desk.app.measuring, []
    for _ in range(len(TOOLS) + 1):
        desk.key(pygame.K_d)
        seen.append(measuring.tool if measuring.on else "")
    assert seen == [*TOOLS, ""]
    desk.key(pygame.K_d)
    desk.key(pygame.K_ESCAPE)
    assert not measuring.on
    assert desk.page() == "run"


def test_brush_and_tool_are_not_both_in_hand(desk: Desk) -> None:
    desk.key(pygame.K_d)
    desk.key(pygame.K_b)
    assert (desk.app.measuring.on, desk.app.brush.on) == (False, True)
    desk.key(pygame.K_d)
    assert (desk.app.measuring.on, desk.app.brush.on) == (True, False)


def test_an_end_by_mouse_sticks_to_a_grain(desk: Desk) -> None:
    measuring = desk.app.measuring
    measuring.take(RULER)
    desk.app.tick()
    frame, camera, _ = desk.app.stage.picture.panes()[0]
    x, y = camera.to_screen(*measuring.ends[1])
    grain = (float(frame.x[0]), float(frame.y[0]))
    centre = camera.to_screen(*grain)
    desk.press((x, y))
    desk.point((centre[0] + 1, centre[1] + 1), pressed=True)
    desk.release(centre)
    assert measuring.ends[1] == grain
    assert not desk.app.stage.mouse.holding
    facts = {c.title: c.value for c in measuring.controls() if isinstance(c, Fact)}
    assert facts[words.MEASURE_LENGTH] == f"{math.dist(*measuring.ends):.2f} R"


def test_ends_by_keyboard(desk: Desk) -> None:
    measuring = desk.app.measuring
    measuring.take(PROTRACTOR)
    before = list(measuring.ends)
    desk.key(pygame.K_RETURN, "\r")
    desk.key(pygame.K_UP)
    desk.key(pygame.K_RIGHT)
    assert measuring.ends[0] == before[0]
    assert measuring.ends[1] == (before[1][0] + 0.25, before[1][1] + 0.25)
    frame = desk.app.stage.panes.snapshot.frame
    assert frame is not None
    assert frame.handles[0].target is None  # the hand was not meant


def test_all_of_a_tool_by_mouse_and_by_keyboard(desk: Desk) -> None:
    measuring = desk.app.measuring
    measuring.take(CUT)
    desk.app.tick()
    (x0, y0), (x1, y1) = measuring.ends
    camera = desk.app.stage.renderer.camera
    middle = camera.to_screen(0.6 * x0 + 0.4 * x1, y0)
    desk.press(middle)
    desk.point((middle[0] + 30, middle[1] - 20), pressed=True)
    desk.release((middle[0] + 30, middle[1] - 20))
    way = 30.0 / camera.scale, 20.0 / camera.scale
    flat = [place for end in measuring.ends for place in end]
    assert flat == pytest.approx([x0 + way[0], y0 + way[1], x1 + way[0], y1 + way[1]], abs=0.1)
    desk.key(pygame.K_RETURN, "\r")  # from all of them to the first
    assert measuring.chosen == 0
    for _ in range(2):
        desk.key(pygame.K_RETURN, "\r")
    before = list(measuring.ends)
    desk.key(pygame.K_UP)
    assert measuring.ends == [(x, y + 0.25) for x, y in before]


def test_marks_on_the_plot(desk: Desk) -> None:
    measuring, box = desk.app.measuring, desk.app.stage.renderer.plot_box
    assert box is not None
    measuring.take(MARKS)
    assert measuring.marks is not None
    low, high = measuring.marks
    y = box.rect.centery
    wanted = 0.9 * box.low + 0.1 * box.high
    desk.press((float(box.x(low)) + 2, y))
    desk.point((float(box.x(wanted)), y), pressed=True)
    desk.release((float(box.x(wanted)), y))
    assert measuring.marks == pytest.approx((wanted, high), abs=0.01 * (box.high - box.low))
    desk.key(pygame.K_RETURN, "\r")
    desk.key(pygame.K_LEFT)
    assert measuring.marks[1] < high


def test_cut_and_spreads_are_read_in_the_panel(desk: Desk) -> None:
    measuring = desk.app.measuring
    measuring.take(CUT)
    desk.app.tick()
    titles = [c.title for c in measuring.controls() if isinstance(c, Fact)]
    assert words.MEASURE_PRESSING in titles
    measuring.take(SPREADS)
    desk.app.tick()
    bars = [c for c in measuring.controls() if isinstance(c, Bars)]
    assert [c.title for c in bars] == [words.MEASURE_FORCES, words.MEASURE_SHAPES]
    assert sum(bars[1].shares) == pytest.approx(1.0)


def test_another_scene_puts_tools_away(desk: Desk) -> None:
    desk.app.measuring.take(CUT)
    assert desk.app.measuring.ends
    desk.app.stage.start("hopper")
    desk.app.tick()
    assert not desk.app.measuring.on
