"""Compile the drawing kernels, or load them from where they are kept, before the first picture needs them."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np

from core.warmup import compiled, compiling
from sandbox.beside import beside
from sandbox.draw import raster

FOLDER = Path(raster.__file__).resolve().parent
DRAWING = "drawing"  # name of this part of the kernels
NICENESS = 5  # solving takes longer to compile


def missing() -> list[str]:
    """This part, unless it is kept."""
    return [] if compiled(FOLDER, DRAWING) else [DRAWING]


def compile_kernels() -> None:
    """Call every kernel once with the types that drawing uses. Touches no pygame."""
    with compiling(FOLDER, DRAWING):
        _draw_something()


def _draw_something() -> None:
    clip = (0, 0, 8, 8)
    canvas = (np.zeros((8, 8), dtype=np.uint32), clip, (1.0, 0.0, 0.0))
    one = np.ones(1)
    colour = np.ones(1, dtype=np.uint32)
    grains = (4.0 * one, -4.0 * one, 3.0 * one, 0.0 * one, 0.0 * one)
    raster.draw_ellipses(canvas, grains, colour, colour, 1.0, 1.0)
    marked = np.ones(1, dtype=np.bool_)
    raster.draw_bow_ties(canvas, grains, 0.0 * one, one, marked, 1, 1.0)
    colours = (colour, colour)
    raster.draw_made_grains(canvas, grains, one, 0.0 * one, one, marked, colours, 1.0, 1.0)
    raster.draw_lines(canvas, (one, -one, 2.0 * one, -one), one, colour, one)
    raster.draw_lines(canvas, (one, -one, 2.0 * one, -one), one, colour, one, one)
    raster.draw_few_lines(canvas, (one, -one, 2.0 * one, -one), one, colour, one)
    raster.draw_hull(canvas, np.zeros((1, 2)), 1.0, 1, 1, 0.0, 1.0)
    raster.draw_ring(canvas, 4.0, -4.0, 2.0, 1.0, 1, 1.0)


class Warmup:
    """Compiles in a thread of its own; ``ready`` says when drawing may begin."""

    def __init__(self) -> None:
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="drawing kernels", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def join(self, timeout: float) -> bool:
        """Wait for the end [s]; True when it has come."""
        self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            with beside(missing(), NICENESS):
                pass
            compile_kernels()
        except Exception as error:  # noqa: BLE001 - raised again in the thread that asks
            self.error = error

    @property
    def ready(self) -> bool:
        """Are all kernels there? Raises what went wrong in the thread."""
        if self._thread.is_alive():
            return False
        if self.error is not None:
            raise self.error
        return True
