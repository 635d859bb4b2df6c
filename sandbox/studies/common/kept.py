"""Rows of finished runs, a line each, in a file that lasts until a study is done: an interrupted one goes on from there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sandbox.interrupts import deferred


def keep(path: Path, key: str, row: Mapping[str, Any]) -> None:
    """Add a finished run, whole or not at all."""
    with deferred(), path.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"key": key, **row}, ensure_ascii=False) + "\n")


def read(path: Path) -> dict[str, dict[str, Any]]:
    """Runs that an interrupted study has left, by key; a damaged line is done again."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return {}
    found = {}
    for line in lines:
        try:
            row = json.loads(line)
            found[str(row.pop("key"))] = row
        except (ValueError, KeyError, TypeError, AttributeError):
            continue
    return found
