"""Dataclasses as plain data and arrays, and back by their annotations: what goes into a file, and what comes out of one.

Arrays are put aside under the path of their field, and so is what has a ``Form`` of its own. What comes back has the types that
the annotations say, or is refused; whether its numbers make sense, somebody else must ask.
"""

from __future__ import annotations

import math
import re
import string
import sys
import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from scenes.text import Text

LONGEST = 100_000  # letters of a text
DEEPEST = 4  # texts within texts
_NOT_FINITE = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}
_HALF = re.compile("[\ud800-\udfff]")  # of a letter: no file takes it
_SPEC = re.compile(r"[+]?(\.\d)?[defgn%]?|[^{}|]*(\|[^{}|]*)+")  # of a number, or forms

Arrays = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Form:
    """How something that is no dataclass is put into arrays under a path, and taken from those that are there."""

    arrays: Callable[[Any], Mapping[str, NDArray[Any]]]
    of_arrays: Callable[[Mapping[str, NDArray[Any]]], Any]


class Plain:
    """Writes and reads; ``forms`` are those of classes that have one, ``loose`` the fields whose numbers may be none."""

    def __init__(self, forms: Mapping[type, Form], loose: frozenset[str]) -> None:
        self._forms, self._loose = forms, loose

    def write(self, value: object, path: str, arrays: Arrays) -> Any:
        """Plain data of ``value``; its arrays are put into ``arrays``."""
        if isinstance(value, np.ndarray):
            arrays[path] = value
            return None
        if (form := self._forms.get(type(value))) is not None:
            arrays.update({f"{path}.{name}": a for name, a in form.arrays(value).items()})
            return None
        if isinstance(value, Text):
            own = {k: self.write(v, path, arrays) for k, v in value.values.items()}
            return {"text": str(value), "template": value.template, "values": own}
        if is_dataclass(value):
            names = [f.name for f in fields(value)]
            return {n: self.write(getattr(value, n), f"{path}.{n}", arrays) for n in names}
        if isinstance(value, Mapping):
            return {str(k): self.write(v, f"{path}.{k}", arrays) for k, v in value.items()}
        if isinstance(value, (set, frozenset)):
            return sorted(value)
        if isinstance(value, (list, tuple)):
            return [self.write(v, f"{path}.{k}", arrays) for k, v in enumerate(value)]
        if isinstance(value, (float, np.floating)):
            return float(value) if math.isfinite(value) else str(float(value))
        if isinstance(value, np.integer):
            return int(value)
        return str(value) if isinstance(value, Enum) else value

    def read(self, kind: Any, data: Any, path: str, arrays: Arrays) -> Any:
        """The ``kind`` that was written as ``data`` under ``path``; takes its arrays out of ``arrays``. Raises InputError."""
        kind = _meant(kind)
        origin, inner = get_origin(kind), get_args(kind)
        if origin in (Union, types.UnionType):
            return self._one_of(inner, data, path, arrays)
        if kind in self._forms:
            own = {n: arrays.pop(n) for n in [*arrays] if n.startswith(f"{path}.")}
            return self._forms[kind].of_arrays({n[len(path) + 1 :]: a for n, a in own.items()})
        if origin is np.ndarray:
            return _array(inner, path, arrays)
        if origin is Literal:
            return _known(data in inner, data, path)
        if origin is None and is_dataclass(kind):
            return self._dataclass(kind, data, path, arrays)
        if origin in (list, set):
            _known(isinstance(data, list), data, path)
            return origin(self.read(inner[0], v, f"{path}.{k}", arrays) for k, v in enumerate(data))
        if origin is tuple:
            return self._tuple(inner, data, path, arrays)
        if isinstance(origin, type) and issubclass(origin, Mapping):
            _known(isinstance(data, dict), data, path)
            keys = [self.read(inner[0], k, path, arrays) for k in data]
            values = [self.read(inner[1], data[k], f"{path}.{k}", arrays) for k in data]
            return dict(zip(keys, values, strict=True))
        return self._scalar(kind, data, path)

    def _one_of(self, kinds: tuple[Any, ...], data: Any, path: str, arrays: Arrays) -> Any:
        there = data is not None or any(n == path or n.startswith(f"{path}.") for n in arrays)
        if not there and type(None) in kinds:
            return None
        choices = [kind for kind in kinds if kind is not type(None)]
        if len(choices) == 1:
            return self.read(choices[0], data, path, arrays)
        return _known(type(data) in choices, data, path)  # plain ones: a number, a switch

    def _dataclass(self, kind: Any, data: Any, path: str, arrays: Arrays) -> Any:
        _known(isinstance(data, dict), data, path)
        hints, own = _hints(kind), {}
        for field in fields(kind):
            here = f"{path}.{field.name}"
            there = field.name in data or here in arrays
            if there or (field.default is MISSING and field.default_factory is MISSING):
                own[field.name] = self.read(hints[field.name], data.get(field.name), here, arrays)
        if unknown := set(data) - set(hints):
            raise InputError(f"{path} has something unknown: {min(unknown)[:80]!r}")
        return kind(**own)

    def _tuple(self, inner: tuple[Any, ...], data: Any, path: str, arrays: Arrays) -> Any:
        _known(isinstance(data, list), data, path)
        if inner[1:] == (Ellipsis,):
            inner = inner[:1] * len(data)
        _known(len(data) == len(inner), data, path)
        pairs = enumerate(zip(inner, data, strict=True))
        return tuple(self.read(kind, v, f"{path}.{k}", arrays) for k, (kind, v) in pairs)

    def _scalar(self, kind: Any, data: Any, path: str) -> Any:
        if kind is float:
            if isinstance(data, str) and path.rpartition(".")[2] in self._loose:
                _known(data in _NOT_FINITE, data, path)
                return _NOT_FINITE[data]
            number = isinstance(data, (int, float)) and not isinstance(data, bool)
            _known(number and abs(data) <= sys.float_info.max, data, path)
            return float(data)
        if kind is str:
            return _text(data, path)
        if isinstance(kind, type) and issubclass(kind, Enum):
            return kind(_known(data in [str(one) for one in kind], data, path))
        return _known(type(data) is kind and (kind is not int or abs(data) < 2**63), data, path)


def _meant(kind: Any) -> Any:
    """What a named type stands for: NDArray is one since NumPy 2.5."""
    meant = getattr(get_origin(kind), "__value__", None)
    return kind if meant is None else meant[get_args(kind)]


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return get_type_hints(kind)


def _known(right: bool, data: Any, path: str) -> Any:
    if not right:
        raise InputError(f"{path} is missing, or not what it should be")
    return data


def _array(inner: tuple[Any, ...], path: str, arrays: Arrays) -> NDArray[Any]:
    array = arrays.pop(path, None)
    if array is None or array.dtype != np.dtype(get_args(inner[1])[0]):
        raise InputError(f"array {path} is missing, or of another kind")
    return array


def _text(data: Any, path: str, depth: int = 0) -> str:
    """A plain text, or one that remembers what it was made from: a template that asks for nothing but its values."""
    if isinstance(data, str):
        return str(_known(len(data) <= LONGEST and not _HALF.search(data), data, path))
    whole = isinstance(data, dict) and set(data) == {"text", "template", "values"}
    _known(whole and isinstance(data["values"], dict) and depth < DEEPEST, data, path)
    _text(data["text"], path)
    template, values = data["template"], {}
    _known(isinstance(template, str) and _text(template, path) == template, data, path)
    for name, value in data["values"].items():
        number = isinstance(value, (int, float)) and abs(value) <= sys.float_info.max
        values[name] = value if number else _text(value, path, depth + 1)
    try:
        for _, name, spec, turn in string.Formatter().parse(template):
            if name is not None:
                plain = not turn and _SPEC.fullmatch(spec or "") is not None
                _known(name in values and plain, data, path)
        return Text(template, **values)
    except (ValueError, TypeError):
        raise InputError(f"{path} is missing, or not what it should be") from None
