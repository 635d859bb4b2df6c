"""What machine and which libraries runs were carried out with."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from sandbox import __version__

LIBRARIES = ("numpy", "numba", "pymunk", "matplotlib")


def machine() -> dict[str, Any]:
    """What this runs on."""
    versions = {"auxetic-sandbox": __version__}
    for name in LIBRARIES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    return {
        "machine": {
            "system": platform.platform(),
            "processor": platform.processor() or platform.machine(),
            "cores": os.cpu_count(),
            "python": platform.python_version(),
        },
        "versions": versions,
    }
