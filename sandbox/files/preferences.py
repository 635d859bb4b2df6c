"""What a person has chosen for every window to come: a small JSON file in the folder for settings."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from platformdirs import user_config_path

from core.files import atomic_write


@dataclass(frozen=True, slots=True)
class Preferences:
    """None: as the system has it."""

    still: bool | None = None  # nothing moves by itself but the grains
    tone: bool = False  # the force as a tone


def path() -> Path:
    """The file."""
    return user_config_path("auxetic-sandbox", appauthor=False) / "preferences.json"


def read() -> Preferences:
    """What was chosen; what cannot be read, or is no yes or no, counts as not chosen."""
    try:
        chosen = json.loads(path().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return Preferences()
    if not isinstance(chosen, dict):
        return Preferences()
    names = {each.name for each in fields(Preferences)}
    return Preferences(**{k: v for k, v in chosen.items() if k in names and isinstance(v, bool)})


def write(preferences: Preferences) -> None:
    """Raises OSError where that cannot be."""
    path().parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path()) as file:
        file.write(json.dumps(asdict(preferences), indent=1).encode())
