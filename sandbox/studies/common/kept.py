"""Rows of finished runs, a line each, in a file that lasts until a study is done: an interrupted one goes on from there."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sandbox.files.lines import append_lines


def keep(path: Path, key: str, row: Mapping[str, Any]) -> None:
    """Add a finished run, whole or not at all."""
    add(path, {"key": key, **row})


def read(path: Path) -> dict[str, dict[str, Any]]:
    """Runs that an interrupted study has left, by key; a damaged line is done again."""
    return {str(row.pop("key")): row for row in lines(path) if "key" in row}


def add(path: Path, line: Mapping[str, Any]) -> None:
    """Add a line, whole or not at all. Raises InputError if that cannot be."""
    append_lines(path, json.dumps(line, ensure_ascii=False) + "\n")


def lines(path: Path) -> Iterator[dict[str, Any]]:
    """What the lines hold, without the damaged ones."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        return
    for line in text.splitlines():
        try:
            data = json.loads(line)
        except ValueError:
            continue
        if isinstance(data, dict):
            yield data
