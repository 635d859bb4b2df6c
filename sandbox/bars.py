"""How bars of progress are drawn in a terminal, and what is left of them elsewhere."""

from __future__ import annotations

import sys
from typing import Any


def bar_options() -> dict[str, Any]:
    """A line every ten seconds is enough where nobody watches the bar move."""
    watched = sys.stderr.isatty()
    return {
        "file": sys.stderr,
        "dynamic_ncols": watched,
        "ncols": None if watched else 100,
        "mininterval": 0.1 if watched else 10.0,
    }
