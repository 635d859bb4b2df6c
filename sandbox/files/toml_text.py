"""Plain data as TOML text. Python reads TOML and does not write it; this is as much as files of this program need."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import TypeGuard


def toml_text(data: Mapping[str, object]) -> str:
    """``data`` as a TOML document: values first, then tables, then lists of tables, each in their order.

    Knows text, numbers, switches, lists of those, and one level of tables. Raises ValueError for anything else.
    """
    tables = {k: v for k, v in data.items() if isinstance(v, Mapping)}
    lists = {k: v for k, v in data.items() if _are_tables(v)}
    lines = [_line(k, v) for k, v in data.items() if k not in tables and k not in lists]
    for name, table in tables.items():
        lines += ["", f"[{_key(name)}]", *(_line(k, v) for k, v in table.items())]
    for name, rows in lists.items():
        for row in rows:
            lines += ["", f"[[{_key(name)}]]", *(_line(k, v) for k, v in row.items())]
    return "\n".join(lines) + "\n"


def _are_tables(value: object) -> TypeGuard[Sequence[Mapping[str, object]]]:
    return isinstance(value, (list, tuple)) and any(isinstance(v, Mapping) for v in value)


def _line(key: str, value: object) -> str:
    return f"{_key(key)} = {_value(value)}"


def _key(key: str) -> str:
    plain = key.replace("_", "").replace("-", "")
    return key if plain.isascii() and plain.isalnum() else _value(key)


def _value(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # A basic string of TOML has JSON's escapes, and wants one sign more to be escaped.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float) and math.isfinite(value):
        return repr(value)
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_value(v) for v in value)}]"
    raise ValueError(f"{value!r} has no place in a file of this program")
