"""Several packings in the window, one hand; curves kept and exported; films of the window."""

from __future__ import annotations

import csv
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import imageio.v2
import pygame
import pytest

from core.errors import InputError
from sandbox.record.video import VideoWriter
from sandbox.session.commands import Change, Grab, Move, Protocol, Recall, Release, Reset, Undo
from sandbox.window import film as record
from sandbox.window.solvers.in_step import NOT_ALL, way_back
from sandbox.window.solvers.wanted import Wanted
from sandbox.words import words
from tests.draw.frames import intruder_frame
from tests.window.desk import Desk

SIDES = ("regular", "mixed", "auxetic")


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Desk]:
    monkeypatch.chdir(tmp_path)
    place = Desk((1000, 700))
    place.start()
    yield place
    place.app.close()


def compare(desk: Desk) -> None:
    desk.key(pygame.K_c)
    desk.until(lambda: [seen.phase for seen in desk.app.stage.panes.snapshots] == ["running"] * 3)
    desk.app.tick()


def counts(desk: Desk) -> tuple[int, ...]:
    return len(desk.app.stage.picture.panes()), len(desk.app.stage.renderer.layout.canvases)


def alone(desk: Desk) -> bool:
    return desk.app.stage.panes.packings == ("mixed",)


def recording(desk: Desk) -> bool:
    return desk.app.stage.recorder.recording


def said(desk: Desk) -> str:
    return desk.app.stage.notices.latest


def test_compare_and_back(desk: Desk) -> None:
    compare(desk)
    assert desk.app.stage.panes.packings == SIDES
    assert [session.packing for session in desk.sessions] == ["mixed", "regular", "auxetic"]
    assert counts(desk) == (3, 3)
    desk.key(pygame.K_2)
    assert said(desk) == words.COMPARE_ALL
    assert desk.app.stage.panes.packings == SIDES
    desk.key(pygame.K_c)
    assert alone(desk)
    desk.app.tick()
    assert counts(desk) == (1, 1)
    desk.key(pygame.K_a)
    desk.until(lambda: desk.sessions[0].increments > 2)
    assert desk.sessions[1].increments == 0  # nobody holds the one that stays up


@pytest.mark.parametrize("side", [0, 1, 2])
def test_a_press_in_any_canvas_moves_all(desk: Desk, side: int) -> None:
    compare(desk)
    frame, camera, rect = desk.app.stage.picture.panes()[side]
    place = camera.to_screen(frame.handles[0].x, frame.handles[0].y)
    assert rect.collidepoint(place)
    desk.press(place)
    assert desk.app.stage.mouse.holding
    for step in range(1, 6):
        desk.point((place[0] + 4 * step, place[1]), pressed=True)
    wanted = desk.app.stage.mouse.hand.target
    assert wanted is not None
    assert wanted[0] == pytest.approx(camera.to_world(place[0] + 20, 0)[0], abs=1.0 / camera.scale)
    desk.release((place[0] + 20, place[1]))
    desk.until(lambda: all(Release("intruder") in one.commands for one in desk.sessions))
    first = desk.sessions[0].commands
    assert first[0] == Grab("intruder")
    assert [command for command in first if isinstance(command, Move)][-1].x == wanted[0]
    assert all(one.commands == first for one in desk.sessions)


def test_who_comes_late_is_brought_to_where_the_first_is(desk: Desk) -> None:
    desk.key(pygame.K_a)
    desk.until(lambda: desk.seen >= 8)
    compare(desk)
    assert said(desk) == words.COMPARE_ON
    desk.key(pygame.K_SPACE)
    desk.until(lambda: len({session.increments for session in desk.sessions}) == 1)
    assert desk.sessions[0].increments >= 8
    assert Reset() not in desk.sessions[0].commands
    assert desk.sessions[2].commands == [Protocol(True)]


def test_after_going_back_all_begin_anew(desk: Desk) -> None:
    desk.key(pygame.K_a)
    desk.until(lambda: desk.seen >= 3)
    desk.key(pygame.K_z)
    compare(desk)
    assert said(desk) == words.COMPARE_ANEW
    desk.until(lambda: Reset() in desk.sessions[0].commands)
    desk.key(pygame.K_SPACE)
    desk.until(lambda: len({session.increments for session in desk.sessions}) == 1)


def test_a_build_is_cancelled_by_escape(desk: Desk) -> None:
    gate = threading.Event()
    make = desk.app.stage.panes._make

    def slow(*arguments: object) -> object:
        session = make(*arguments)
        session.block_build = gate  # type: ignore[attr-defined]
        return session

    desk.app.stage.panes._make = slow  # type: ignore[assignment]
    desk.key(pygame.K_c)
    desk.until(lambda: desk.app.stage.panes.snapshots[0].fraction == 0.5)
    for _ in range(3):
        desk.app.tick()  # a canvas without grains yet
    desk.key(pygame.K_ESCAPE)
    assert alone(desk)
    assert desk.page() == "run"
    desk.app.stage.start("intruder")
    desk.until(lambda: desk.app.stage.panes.snapshot.fraction == 0.5)
    desk.key(pygame.K_ESCAPE)
    assert desk.page() == "menu"
    assert not desk.app.stage.panes.exists
    gate.set()


def test_one_that_fails_says_so_and_reset_builds_all_anew(desk: Desk) -> None:
    compare(desk)
    desk.sessions[2].fail = RuntimeError("a grain got lost")
    desk.key(pygame.K_a)
    desk.until(lambda: desk.app.stage.panes.snapshots[2].phase == "failed")
    desk.until(lambda: desk.seen > 3)
    desk.key(pygame.K_r)
    desk.until(lambda: [seen.phase for seen in desk.app.stage.panes.snapshots] == ["running"] * 3)
    assert len(desk.sessions) == 6


def test_any_two_runs_of_a_scene_stand_side_by_side(desk: Desk) -> None:
    """Also of one packing: the first is the one that is looked at, and a reset of what failed builds both as they were."""
    panes = desk.app.stage.panes
    both = [Wanted("intruder", "mixed", seed, {"stroke": 10.0 * seed}) for seed in (4, 5)]
    desk.start()
    desk.app.stage.start_beside(both)
    one, other = desk.sessions[-2:]
    desk.until(lambda: all(seen.phase == "running" for seen in panes.snapshots))
    assert panes.comparing
    assert (panes.seed, panes.packings) == (4, ("mixed", "mixed"))
    assert panes.snapshot is panes.snapshots[0]
    assert [(s.seed, s.settings) for s in (one, other)] == [
        (4, {"stroke": 40.0}),
        (5, {"stroke": 50.0}),
    ]
    desk.app.stage.send(Change("friction", 0.5))
    other.fail = InputError("no more")
    desk.key(pygame.K_a)
    desk.until(lambda: any(seen.phase == "failed" for seen in panes.snapshots))
    desk.key(pygame.K_r)
    assert [(s.seed, s.settings) for s in desk.sessions[-2:]] == [
        (4, {"stroke": 40.0, "friction": 0.5}),
        (5, {"stroke": 50.0, "friction": 0.5}),
    ]


def test_back_goes_only_what_all_can_go(desk: Desk) -> None:
    compare(desk)
    desk.app.stage.send(Undo())
    assert said(desk) == NOT_ALL
    assert all(Undo() not in session.commands for session in desk.sessions)
    near, far = (replace(intruder_frame(6), first_kept=2, last_kept=last) for last in (9, 30))
    assert way_back(Recall(20), [near, far]) == Recall(9)
    assert way_back(Recall(0), [near, far]) == Recall(2)
    able = replace(near, can_undo=True)
    assert way_back(Undo(), [able, replace(far, can_undo=True)]) == Undo()
    with pytest.raises(InputError):
        way_back(Undo(), [able, far])


def test_a_setting_that_cannot_be_is_refused_in_words(desk: Desk) -> None:
    desk.app.stage.send(Change("grains", -5))
    assert "grains" in said(desk)
    assert desk.session.commands == []


def test_curves_are_kept_and_exported(desk: Desk) -> None:
    compare(desk)
    desk.key(pygame.K_r)
    assert [kept.packing for kept in desk.app.stage.panes.curves.of("intruder")] == list(SIDES)
    for answer in (pygame.K_1, pygame.K_2, pygame.K_ESCAPE):
        desk.key(pygame.K_e)
        desk.key(answer)
    assert desk.app.stage.running
    names = sorted(path.name for path in Path().iterdir())
    stems = [f"sandbox-intruder-curves-{number}" for number in (1, 2)]
    assert names == [f"{stem}{suffix}" for stem in stems for suffix in (".csv", ".png")]
    assert pygame.image.load(f"{stems[0]}.png").get_size() == (1920, 1080)
    rows = list(csv.DictReader(Path(f"{stems[0]}.csv").read_text().splitlines()))
    assert {row["packing"] for row in rows} == set(SIDES)
    plain, excel = (Path(f"{stem}.csv").read_bytes() for stem in stems)
    assert excel.startswith(b"\xef\xbb\xbf")
    assert excel.count(b"\n") >= plain.count(b"\n") > 1


def test_a_film_of_the_window_runs_at_a_constant_rate(desk: Desk) -> None:
    desk.key(pygame.K_g)
    assert recording(desk)
    name = desk.app.stage.recorder._film.name  # type: ignore[union-attr]
    begun = desk.app.stage.recorder._film.begun  # type: ignore[union-attr]
    desk.until(lambda: time.perf_counter() - begun > 1.0)
    passed = time.perf_counter() - begun
    desk.key(pygame.K_g)
    desk.until(lambda: said(desk) == words.SAVED.format(name=name))
    assert not recording(desk)
    film = imageio.v2.mimread(name, memtest=False)
    assert len(film) == pytest.approx(30 * passed, abs=12)
    assert film[0].shape == (*reversed(desk.app.stage.renderer.size), 3)


def test_a_film_is_finished_when_the_window_is_closed(desk: Desk) -> None:
    desk.key(pygame.K_g, "G", pygame.KMOD_SHIFT)
    desk.key(pygame.K_c)
    for _ in range(5):
        desk.app.tick()
    desk.app.close()
    assert desk.app.farewell == words.SAVED.format(name="sandbox-intruder-1.gif")
    assert len(imageio.v2.mimread("sandbox-intruder-1.gif", memtest=False)) >= 1


def test_a_window_of_another_size_ends_the_film(desk: Desk) -> None:
    desk.key(pygame.K_g)
    desk.app.stage.renderer.resize((801, 601))
    desk.app.tick()
    assert not recording(desk)
    desk.until(lambda: "mp4" in said(desk) and desk.app.stage.recorder._film is None)
    assert Path("sandbox-intruder-1.mp4").exists()


def test_a_full_disk_is_one_sentence(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    class Full(VideoWriter):
        def write(self, image: object) -> None:
            raise InputError("cannot write x.mp4: no space left on device")

    monkeypatch.setattr(record, "VideoWriter", Full)
    desk.key(pygame.K_g)
    desk.until(lambda: "no space left" in said(desk))
    assert desk.app.stage.running
    assert list(Path().iterdir()) == []


def test_sound_goes_on_and_off(desk: Desk) -> None:
    assert not desk.app.stage.sound.on
    desk.key(pygame.K_o)
    assert said(desk) in (words.SOUND_ON, words.NO_SOUND)
    desk.app.stage.sound.play(("clog", "avalanche", "unheard of"))
    desk.key(pygame.K_o)
    assert not desk.app.stage.sound.on


def test_without_a_sound_device_it_stays_silent(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: object) -> None:
        raise pygame.error("no device")

    monkeypatch.setattr(pygame.mixer, "init", none)
    desk.key(pygame.K_o)
    assert said(desk) == words.NO_SOUND
    desk.app.stage.sound.play(("clog",))
