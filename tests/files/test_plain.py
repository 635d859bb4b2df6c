"""Values by their annotations."""

from __future__ import annotations

from types import GenericAlias, SimpleNamespace
from typing import Any, TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray

from core.errors import InputError
from sandbox.files.plain import Plain

Kind = TypeVar("Kind", bound=np.generic)
# What ``type NDArray[Kind] = ...`` makes, which Python 3.11 cannot say.
NAMED: Any = SimpleNamespace(
    __value__=np.ndarray[tuple[Any, ...], np.dtype[Kind]]  # type: ignore[valid-type]
)


@pytest.mark.parametrize("kind", [NDArray[np.float64], GenericAlias(NAMED, (np.float64,))])
def test_an_array_is_known_by_any_name_of_its_type(kind: Any) -> None:
    plain, arrays = Plain({}, frozenset()), {"it": np.arange(3.0), "other": np.arange(3)}
    assert plain.read(kind, None, "it", arrays) == pytest.approx([0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="other is missing, or of another kind"):
        plain.read(kind, None, "other", arrays)


def test_half_a_letter_is_refused() -> None:
    for text in ("\ud800", {"text": "", "template": "\udfff", "values": {}}):
        with pytest.raises(InputError, match="not what it should be"):
            Plain({}, frozenset()).read(str, text, "it", {})
