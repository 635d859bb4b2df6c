"""A scene file, made once for a module, and a copy of it for who spoils it."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.files.scene_file import write_scene
from sandbox.session.session import Session
from tests.files.scene_files import workshop


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Session]:
    session = workshop(friction=0.4)
    path = tmp_path_factory.mktemp("scenes") / "made.scene"
    write_scene(path, session.made())
    return path, session


@pytest.fixture
def copy(made: tuple[Path, Session], tmp_path: Path) -> Path:
    """The file, to be spoilt."""
    (tmp_path / made[0].name).write_bytes(made[0].read_bytes())
    return tmp_path / made[0].name
