"""The brush: grains placed, erased and retyped, walls drawn, by mouse and by keyboard."""

from __future__ import annotations

import pygame
import pytest

from sandbox.session.commands import (
    DrawWall,
    Erase,
    EraseWall,
    Place,
    Release,
    Retype,
)
from tests.window.at_panel import go_to, grain_place, sent
from tests.window.desk import Desk

AT_WORK = (1024, 720)  # size of a window in which a scene runs already


def in_world(desk: Desk, place: tuple[float, float]) -> tuple[float, float]:
    return desk.app.stage.picture.panes()[0][1].to_world(round(place[0]), round(place[1]))


def use_tool(desk: Desk, tool: str) -> None:
    desk.app.tick()
    go_to(desk, f"brush/{tool}")
    desk.key(pygame.K_RETURN)
    desk.key(pygame.K_ESCAPE)


def test_brush_places_and_drags(desk: Desk) -> None:
    desk.key(pygame.K_b)
    start = grain_place(desk, 0)
    scale = desk.app.stage.picture.panes()[0][1].scale
    desk.press(start)
    for step in range(1, 9):
        desk.point((start[0] + 0.55 * step * scale, start[1]), pressed=True)
    desk.release((start[0] + 4.4 * scale, start[1]))
    desk.until(lambda: len(sent(desk)) >= 3)
    places = [command for command in sent(desk) if isinstance(command, Place)]
    assert len(places) == 3  # 2 R apart
    assert (places[0].x, places[0].y) == pytest.approx(in_world(desk, start))
    assert {place.kind for place in places} == {"regular"}
    desk.key(pygame.K_ESCAPE)
    assert not desk.app.brush.on


def test_brush_tools_send_their_commands(desk: Desk) -> None:
    desk.key(pygame.K_b)
    spot = grain_place(desk, 0)
    x, y = in_world(desk, spot)
    use_tool(desk, "retype")
    go_to(desk, "brush/kind")
    desk.key(pygame.K_RIGHT)
    go_to(desk, "brush/radius")
    desk.type("3")
    desk.key(pygame.K_RETURN)
    desk.click(spot)
    use_tool(desk, "erase")
    desk.click(spot)
    use_tool(desk, "erase_wall")
    desk.click(spot)
    wanted = [Retype(x, y, 3.0, "auxetic"), Erase(x, y, 3.0), EraseWall(x, y)]
    desk.until(lambda: len(sent(desk)) == 3)
    assert sent(desk) == wanted


def test_wall_is_drawn_by_a_drag(desk: Desk) -> None:
    desk.key(pygame.K_b)
    use_tool(desk, "draw_wall")
    start = grain_place(desk, 0)
    desk.press(start)
    for step in range(1, 6):
        desk.point((start[0] + 20 * step, start[1] + 5 * step), pressed=True)
    desk.release((start[0] + 100, start[1] + 25))
    desk.until(lambda: len(sent(desk)) == 1)
    (wall,) = sent(desk)
    assert isinstance(wall, DrawWall)
    assert len(wall.points) == 6
    assert wall.points[0] == pytest.approx(in_world(desk, start))


def test_brush_by_keyboard(desk: Desk) -> None:
    desk.key(pygame.K_b)
    x0, y0, x1, y1 = desk.app.stage.picture.panes()[0][0].bounds
    desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_UP)
    desk.key(pygame.K_RETURN)
    middle = 0.5 * (x0 + x1) + 0.5, 0.5 * (y0 + y1) + 0.5
    desk.until(lambda: sent(desk) == [Place(*middle, "regular")])
    use_tool(desk, "draw_wall")
    desk.key(pygame.K_RETURN)
    for _ in range(4):
        desk.key(pygame.K_DOWN)
    desk.key(pygame.K_RETURN)
    desk.until(lambda: len(sent(desk)) == 2)
    assert sent(desk)[1] == DrawWall((middle, (middle[0], middle[1] - 2.0)))


def test_hand_comes_before_the_brush(desk: Desk) -> None:
    desk.key(pygame.K_b)
    desk.press(desk.handle_place())
    assert desk.app.stage.mouse.holding
    x, y = desk.handle_place()
    desk.point((x + 40, y), pressed=True)
    desk.release((x + 40, y))
    desk.until(lambda: Release("intruder") in sent(desk))
    assert not any(isinstance(command, Place) for command in sent(desk))
