"""One fault of each kind, at a moment by chance: see ``chaos.py``, which does as many as one likes.

Only where CHAOS is set: moments by chance, and kernels that may be compiled meanwhile, are not for every run of the tests.
"""

from __future__ import annotations

import os
import random
import sys
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.end_to_end,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks into /proc"),
    pytest.mark.skipif("CHAOS" not in os.environ, reason="CHAOS is not set"),
]

if sys.platform.startswith("linux"):
    from tests.cli import chaos

    # Every fault, and every kind of work, once; all pairs of them on demand.
    CASES = [
        ("film", "SIGKILL"),
        ("animation", "SIGTERM"),
        ("side by side", "SIGINT"),
        ("replay", "SIGHUP"),
        ("film", chaos.FULL),
        ("study", "SIGINT"),
    ]
else:
    CASES = []


@pytest.mark.parametrize(("work", "fault"), CASES)
def test_what_is_left(tmp_path: Path, work: str, fault: str) -> None:
    chaos.once(tmp_path, work, fault, random.uniform(0.5, 4.0))
