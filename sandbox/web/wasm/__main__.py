"""``python -m sandbox.web.wasm OUT.wasm [periodic]``: all that a page calls, as one file. In a process of its own."""

from __future__ import annotations

import sys
from pathlib import Path

from sandbox.web.wasm.target import aim

aim()

from sandbox.web.increment import cell  # noqa: E402

cell.PERIODIC = sys.argv[2:] == ["periodic"]

from sandbox.web.increment.entries import ENTRIES  # noqa: E402
from sandbox.web.wasm.linking import build  # noqa: E402

build(ENTRIES, Path(sys.argv[1]))
