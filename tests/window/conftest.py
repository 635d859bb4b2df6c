"""Windows of tests need no screen, speak English, and know nothing of what the person at this computer has left unfinished."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.files import autosave, preferences
from sandbox.window.access import reader
from sandbox.words import language
from tests.window.desk import Desk


@pytest.fixture(autouse=True)
def own_autosaves(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A folder for autosaves that nobody else uses."""
    place = tmp_path_factory.mktemp("autosave")
    monkeypatch.setattr(autosave, "folder", lambda: place)
    return place


@pytest.fixture(autouse=True)
def own_preferences(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A file of preferences that nobody else uses; there is none yet."""
    place = tmp_path_factory.mktemp("preferences") / "preferences.json"
    monkeypatch.setattr(preferences, "path", lambda: place)
    return place


@pytest.fixture(autouse=True)
def no_screen(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Drivers that show and play nothing, and no screen reader; English before and after, whatever a test switches to."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setenv("SDL_AUDIODRIVER", "dummy")
    monkeypatch.setattr(reader, "accesskit", None)
    language.use(language.SOURCE)
    yield
    language.use(language.SOURCE)


@pytest.fixture
def desk(request: pytest.FixtureRequest) -> Iterator[Desk]:
    """A window; where the module names a size ``AT_WORK``, one of that size in which a scene runs already."""
    size = getattr(request.module, "AT_WORK", None)
    place = Desk() if size is None else Desk(size)
    if size is not None:
        place.start()
        place.app.tick()
    yield place
    place.app.close()


@pytest.fixture
def running(desk: Desk) -> Desk:
    """It, with a scene that runs."""
    desk.start()
    return desk
