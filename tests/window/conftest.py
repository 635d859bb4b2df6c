"""Windows of tests know nothing of what the person at this computer has left unfinished."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox import autosave


@pytest.fixture(autouse=True)
def own_autosaves(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A folder for autosaves that nobody else uses."""
    place = tmp_path_factory.mktemp("autosave")
    monkeypatch.setattr(autosave, "folder", lambda: place)
    return place
