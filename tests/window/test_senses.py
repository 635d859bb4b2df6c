"""For eye and ear: little motion, the force as a tone, and what is kept of both."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.files import preferences
from sandbox.files.preferences import Preferences
from sandbox.session.history import Event
from sandbox.window import motion
from sandbox.window.sound import RATE
from sandbox.window.tone import HIGHEST, LOWEST, STILL, Tone, pitch, wave
from sandbox.words import words
from tests.draw.frames import intruder_frame
from tests.window.desk import Desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1024, 720))
    place.start()
    place.app.tick()
    yield place
    place.app.close()


# -- preferences --


@pytest.mark.parametrize(
    "text", ["", "{", "[1]", '{"still": "yes", "tone": 3}', '{"later": true}', "\ud800"]
)
def test_what_cannot_be_read_counts_as_not_chosen(own_preferences: Path, text: str) -> None:
    own_preferences.write_bytes(text.encode("utf-8", "surrogatepass"))
    assert preferences.read() == Preferences()


def test_preferences_are_kept(own_preferences: Path) -> None:
    for chosen in (Preferences(), Preferences(still=True), Preferences(still=False, tone=True)):
        preferences.write(chosen)
        assert preferences.read() == chosen
    assert [path.name for path in own_preferences.parent.iterdir()] == ["preferences.json"]


def test_a_choice_is_there_in_the_next_window(desk: Desk) -> None:
    desk.app.panel.use("looks/motion", True, True)
    assert preferences.read() == Preferences(still=True)
    desk.app.close()
    again = Desk((800, 600))
    try:
        assert again.app.stage.still
        assert again.app.stage.picture.still
    finally:
        again.app.close()


def test_a_choice_that_cannot_be_kept_says_so(
    desk: Desk, own_preferences: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own_preferences.parent.joinpath("file").touch()
    monkeypatch.setattr(preferences, "path", lambda: own_preferences.parent / "file" / "p.json")
    desk.app.panel.use("looks/motion", True, True)
    assert "p.json" in desk.app.stage.notices.latest
    assert desk.app.stage.still  # for this window all the same


# -- motion --


@pytest.mark.parametrize(
    ("system", "said", "wished"),
    [
        ("linux", "false\n", True),
        ("linux", "true\n", False),
        ("linux", "", False),
        ("darwin", "1\n", True),
        ("darwin", "0\n", False),
    ],
)
def test_the_system_is_asked(
    system: str, said: str, wished: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(shutil, "which", lambda name: name)
    done = subprocess.CompletedProcess((), 0, said)
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: done)
    assert motion.little_motion_wished.__wrapped__() is wished


def test_a_system_that_does_not_answer_has_no_wish(monkeypatch: pytest.MonkeyPatch) -> None:
    def slow(*_: object, **__: object) -> None:
        raise subprocess.TimeoutExpired("gsettings", 1.0)

    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(shutil, "which", lambda name: name)
    monkeypatch.setattr(subprocess, "run", slow)
    assert motion.little_motion_wished.__wrapped__() is False


def test_with_little_motion_nothing_flashes_and_the_sound_stays(desk: Desk) -> None:
    frame, picture = intruder_frame(4), desk.app.stage.picture
    mask, events = np.ones(frame.grains, dtype=bool), (Event("clog", 3, 0.1, 1.0, "clogged"),)
    lit = [replace(frame, highlight=mask, events=events[:k]) for k in (0, 1)]
    for still in (False, True):
        picture.forget()
        picture.still = still
        found = [picture._lights([seen], 1.0 + k) for k, seen in enumerate(lit)]
        assert bool(found[1]) is not still
        assert picture.events == ("clog",)


# -- the tone --


def test_pitch_follows_the_force() -> None:
    assert pitch(0.0) == pitch(float("nan")) == pitch(float("inf")) == 0.0
    assert pitch(1.0) == pytest.approx(220.0)
    assert pitch(4.0) == pitch(-4.0) == pytest.approx(440.0)
    heard = [pitch(force) for force in np.geomspace(0.02, 1000.0, 200)]
    assert heard == sorted(heard)
    assert heard[0] == pytest.approx(LOWEST, rel=0.02)
    assert heard[-1] == pytest.approx(HIGHEST, rel=0.02)


@pytest.mark.parametrize("hertz", [80.0, 220.0, 1760.0])
def test_a_wave_has_its_pitch_and_no_seam(hertz: float) -> None:
    samples = wave(hertz).astype(float)
    periods = np.argmax(np.abs(np.fft.rfft(samples)))
    assert periods * RATE / len(samples) == pytest.approx(hertz, rel=1e-3)
    steps = np.abs(np.diff(np.append(samples, samples[0])))
    assert steps[-1] <= steps.max() * 1.01


def test_it_sounds_while_something_moves() -> None:
    heard, frame = Tone(), intruder_frame(4)
    frames = [
        replace(frame, increment=k, curve_force=np.array([force]))
        for k, force in enumerate((1.0, 4.0, 0.0))
    ]
    assert heard.switch()
    heard.follow(frames[0], 10.0)
    assert heard.pitch == pytest.approx(220.0)
    heard.follow(frames[1], 10.1)
    assert heard.pitch == pytest.approx(440.0)
    heard.follow(frames[1], 10.1 + 2 * STILL)  # nothing new
    assert heard.pitch == 0.0
    heard.follow(frames[0], 20.0)
    heard.follow(None, 20.1)  # a page lies over it
    assert heard.pitch == 0.0
    heard.follow(frames[2], 30.0)  # no force
    assert heard.pitch == 0.0
    heard.follow(frames[0], 31.0)
    assert heard.switch()
    assert (heard.on, heard.pitch) == (False, 0.0)
    heard.close()


def test_the_tone_has_a_key_and_is_kept(desk: Desk) -> None:
    for on, said in ((True, words.TONE_ON), (False, words.TONE_OFF)):
        desk.key(pygame.K_o, "O", pygame.KMOD_LSHIFT)
        assert desk.app.stage.tone.on is on
        assert desk.app.stage.notices.latest == said
        assert preferences.read().tone is on
    assert not desk.app.stage.sound.on


def test_without_a_device_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise pygame.error("no device")

    preferences.write(Preferences(tone=True))
    monkeypatch.setattr(pygame.mixer, "init", none)
    place = Desk((800, 600))
    try:
        assert not place.app.stage.tone.on
        assert place.app.stage.notices.latest == words.NO_SOUND
    finally:
        place.app.close()
