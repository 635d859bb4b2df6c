"""Scene files in a folder, for the menu: which there are, and what scene each was made from. Nothing is built."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

FORMAT = "auxetic-sandbox scene"
SUFFIX = ".toml"
LARGEST = 1 << 18  # bytes of a file that is looked into
MOST = 24  # files that are shown, the newest first
MOST_LOOKED_AT = 400


@dataclass(frozen=True, slots=True)
class SceneHere:
    """A scene file: where it is, and the name of the scene that it was made from."""

    path: Path
    scene: str


def scenes_here(folder: Path) -> tuple[SceneHere, ...]:
    """The scene files of a folder, the newest first; what cannot be read is left out."""
    try:
        paths = sorted(folder.glob(f"*{SUFFIX}"))[:MOST_LOOKED_AT]
        dated = sorted(((path.stat().st_mtime, path) for path in paths), reverse=True)
    except OSError:
        return ()
    found = (_look(path) for _, path in dated)
    return tuple(scene for scene in found if scene is not None)[:MOST]


def _look(path: Path) -> SceneHere | None:
    try:
        if not path.is_file() or path.stat().st_size > LARGEST:
            return None
        head = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    scene = head.get("scene")
    if head.get("format") != FORMAT or not isinstance(scene, str):
        return None
    return SceneHere(path, scene)
