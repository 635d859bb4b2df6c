"""Processor time of one thread, on a machine that also does other things."""

from __future__ import annotations

import sys
import time


def clock() -> float:
    """Processor time of this thread [s]: another program that takes its turn does not count.

    On Windows that clock ticks 64 times a second only, so there it is the time on the wall.
    """
    return time.perf_counter() if sys.platform == "win32" else time.thread_time()
