"""The process that ``sandbox.beside`` starts: compiles the parts that it is given, and is done."""

from __future__ import annotations

import sys

from sandbox import environment
from sandbox.beside import IDLE
from sandbox.preparation import parts

if __name__ == "__main__":
    environment.prepare_headless()
    if sys.argv[1] == IDLE:
        parts.be_idle()
    parts.carry_out(sys.argv[2:])
