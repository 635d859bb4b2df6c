"""Libraries that only some commands need, each in an extra of the installation: missing ones are told before any work is done."""

from __future__ import annotations

import importlib.util

from core.errors import InputError


def require(what: str, module: str, library: str, extra: str) -> None:
    """Raise InputError if ``what`` needs a ``library`` that is not installed: ``module``, which ``extra`` brings along."""
    if importlib.util.find_spec(module) is None:
        raise InputError(
            f"{what} {library}, which is not installed: run: python -m pip install 'auxetic-sandbox[{extra}]'"
        )


def require_matplotlib() -> None:
    """Raise InputError if figures cannot be drawn."""
    require("figures need", "matplotlib", "matplotlib", "study")


def require_scipy() -> None:
    """Raise InputError if SciPy is missing."""
    require("this needs", "scipy", "SciPy", "study")
