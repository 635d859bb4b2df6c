"""The process that ``sandbox.beside`` starts: compiles the parts that it is given, and is done."""

from __future__ import annotations

import os
import sys
import threading

from core.own_process import OWN
from sandbox import environment
from sandbox.preparation import parts


def _end_with_the_other() -> None:
    """When the process that started this one is gone, nobody wants what is compiled here."""
    sys.stdin.buffer.read()
    os._exit(1)


if __name__ == "__main__":
    OWN.set()
    threading.Thread(target=_end_with_the_other, daemon=True).start()
    environment.prepare_headless()
    if hasattr(os, "nice"):
        os.nice(int(sys.argv[1]))
    parts.carry_out(sys.argv[2:])
