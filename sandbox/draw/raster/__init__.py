"""Anti-aliased shapes written straight into a pixel array by compiled kernels.

Every shape is a signed distance in pixels (negative inside); the coverage of a pixel is
``clip(1/2 - distance, 0, 1)``. Rows are cut into spans first, so that the distance is evaluated
near an outline only and the inside is a plain fill. Nothing is allocated per shape, the order of
drawing is the order of the arrays, and a shape with a number that is not finite is left out.

A canvas is ``(pixels, clip, to_screen)``: pixels ``uint32 (height, width)`` holding ``0xRRGGBB``,
the centre of pixel ``(row, column)`` being at ``(column + 1/2, row + 1/2)``; the clip
``(left, top, right, bottom)`` in pixels, right and bottom excluded; and ``to_screen = (scale,
x offset, y offset)`` with ``screen x = offset + scale x``, ``screen y = offset - scale y``.

Kernels alone live in this folder: its sources decide which folder of the disk cache they come from.
Those for one small shape keep the interpreter's lock: they take microseconds, and getting the lock
back from a busy solver can take milliseconds.
"""

from core.arrays import Floats
from sandbox.draw.raster.ellipses import draw_ellipses
from sandbox.draw.raster.hulls import draw_hull
from sandbox.draw.raster.lines import draw_few_lines, draw_lines, draw_ring
from sandbox.draw.raster.made_grains import WALL, draw_made_grains
from sandbox.draw.raster.marks import draw_bow_ties
from sandbox.draw.raster.pixels import Canvas, Clip, Colours, Flags, Grains, Pixels, ToScreen

__all__ = [
    "WALL",
    "Canvas",
    "Clip",
    "Colours",
    "Flags",
    "Floats",
    "Grains",
    "Pixels",
    "ToScreen",
    "draw_bow_ties",
    "draw_ellipses",
    "draw_few_lines",
    "draw_hull",
    "draw_lines",
    "draw_made_grains",
    "draw_ring",
]
