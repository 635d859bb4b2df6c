"""One fault of each kind: see ``chaos.py``, which does as many as one likes, at moments by chance.

Three are for every run of the tests, a second after the first sign of life. The others only where CHAOS is set: SIGINT and SIGHUP
are unheard in a program that was started in the background, and the window needs a screen.
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
]

if sys.platform.startswith("linux"):
    from tests.cli import chaos, chaos_window

    ALWAYS = [("film", "SIGKILL"), ("film", "SIGTERM"), ("animation", chaos.FULL)]
    # With these every fault, and every kind of work, once; all pairs of them on demand.
    MORE = [
        ("side by side", "SIGINT"),
        ("replay", "SIGHUP"),
        ("study", "SIGINT"),
        (chaos.WINDOW, "SIGKILL"),
        (chaos.WINDOW, chaos.FULL),
    ]
else:
    ALWAYS = [("film", "SIGKILL"), ("film", "SIGTERM"), ("animation", chaos.FULL)]


@pytest.mark.parametrize(("work", "fault"), ALWAYS)
def test_what_is_left(tmp_path: Path, work: str, fault: str) -> None:
    chaos.once(tmp_path, work, fault, 1.0)


@pytest.mark.skipif("CHAOS" not in os.environ, reason="CHAOS is not set")
@pytest.mark.parametrize(("work", "fault"), MORE)
def test_what_is_left_at_any_moment(tmp_path: Path, work: str, fault: str) -> None:
    if work == chaos.WINDOW and not chaos_window.possible:
        pytest.skip("no screen")
    chaos.once(tmp_path, work, fault, random.uniform(0.5, 4.0))
