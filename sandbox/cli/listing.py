"""The command ``list``: the scenes, their packings and parameters, for people and for programs."""

from __future__ import annotations

import argparse
import json
import textwrap
from collections.abc import Sequence
from typing import Any

from sandbox.cli.exit_codes import OK

_WIDTH = 100


def list_scenes(options: argparse.Namespace) -> int:
    """Print the scenes and what they know."""
    from scenes import registry

    scenes = [registry.get(name) for name in registry.names()]
    print(as_json(scenes) if options.json else as_text(scenes), flush=True)
    return OK


def as_text(scenes: Sequence[Any]) -> str:
    """One paragraph a scene."""
    return "\n\n".join(_scene_text(scene) for scene in scenes)


def as_json(scenes: Sequence[Any]) -> str:
    """The same as one JSON object, ``{"scenes": [...]}``."""
    return json.dumps({"scenes": [_scene_data(scene) for scene in scenes]}, indent=2)


def _scene_text(scene: Any) -> str:
    lines = [f"{scene.name}: {scene.title}"]
    lines += textwrap.wrap(scene.question, _WIDTH, initial_indent="  ", subsequent_indent="  ")
    lines.append(f"  packings: {', '.join(scene.packings)}")
    lines.append(f"  scripted run: {scene.default_steps} increments")
    if scene.accuracy.statement:
        lines.append(f"  at the defaults: {scene.accuracy.statement}")
    rows = [
        (p.name, _value(p.default), p.unit, f"{_value(p.low)} to {_value(p.high)}", p.help)
        for p in scene.parameters
    ]
    if rows:
        lines.append("  parameters, set by --set NAME=VALUE:")
        name, default, unit, limits = (max(len(row[i]) for row in rows) for i in range(4))
        for row in rows:
            start = (
                f"    {row[0]:<{name}}  {row[1]:>{default}} {row[2]:<{unit}}  {row[3]:<{limits}}"
            )
            lines += textwrap.wrap(
                row[4],
                max(_WIDTH, len(start) + 40),
                initial_indent=f"{start}  ",
                subsequent_indent=" " * (len(start) + 2),
            )
    return "\n".join(line.rstrip() for line in lines)


def _scene_data(scene: Any) -> dict[str, Any]:
    return {
        "name": scene.name,
        "title": scene.title,
        "question": scene.question,
        "about": scene.about,
        "packings": list(scene.packings),
        "default_steps": scene.default_steps,
        "accuracy": scene.accuracy.statement,
        "parameters": [
            {
                "name": p.name,
                "type": type(p.default).__name__,
                "default": p.default,
                "unit": p.unit,
                "low": p.low,
                "high": p.high,
                "help": p.help,
                "top": p.top,
            }
            for p in scene.parameters
        ],
    }


def _value(value: object) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)
