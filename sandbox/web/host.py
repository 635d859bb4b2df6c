"""The compiled file under Python, by wasmtime: how it can be tested where there is no browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from sandbox.web.laid_out import Blocks


class Host:
    """One run in the memory of an instance of its own."""

    def __init__(self, module: Path, blocks: Blocks) -> None:
        import wasmtime

        engine = wasmtime.Engine()
        self._store = wasmtime.Store(engine)
        program = wasmtime.Module.from_file(engine, str(module))
        self._exports: Any = wasmtime.Instance(self._store, program, []).exports(self._store)
        self._memory: Any = self._exports["memory"]
        self._places = [self._exports["reserve"](self._store, block.nbytes) for block in blocks]
        self._blocks = [block.copy() for block in blocks]
        self.write(blocks)

    def write(self, blocks: Blocks) -> None:
        """Put other numbers into both blocks."""
        for place, block in zip(self._places, blocks, strict=True):
            self._memory.write(self._store, block.tobytes(), place)

    def blocks(self) -> Blocks:
        """Both, as they are now."""
        whole, others = (
            bytes(self._memory.read(self._store, place, place + block.nbytes))
            for place, block in zip(self._places, self._blocks, strict=True)
        )
        return np.frombuffer(whole, np.int64).copy(), np.frombuffer(others, np.float64).copy()

    def call(self, name: str, *values: float) -> Any:
        """An entry, on this run; what it has allocated before is forgotten."""
        self._exports["forget"](self._store)
        sizes = [block.size for block in self._blocks]
        (ints, floats), (whole, others) = self._places, sizes
        return self._exports[name](self._store, ints, whole, floats, others, *values)

    @property
    def size(self) -> int:
        """Bytes of memory."""
        return int(self._memory.data_len(self._store))
