"""The hazard of a clog against the width, with both published forms."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.theme import AUXETIC, REGULAR
from sandbox.studies.clogging.fits import Falls, begun, divergence, exponential, falling
from sandbox.sweep.pictures import save
from sandbox.sweep.sizes import hazard
from sandbox.sweep.summary import Cell

FIGURE = "hazard.png"
INK = "#333333"


def draw_hazard(cells: Sequence[Cell], folder: Path) -> bool:
    """Write ``FIGURE`` into the folder; False where too few clogged. Raises InputError if it cannot be written."""
    some = [cell for cell in cells if len(begun(cell)[0])]
    if falling(some) is None:
        return False
    save([("", lambda axes: _draw(axes, some))], folder / FIGURE)
    return True


def _draw(axes: Any, cells: Sequence[Cell]) -> None:
    for cell in cells:
        share = hazard(*begun(cell))
        if share is None:
            continue
        low, high = share.interval()
        width = float(cell.values[0])
        if share.hits:
            axes.plot(width, share.value, "o", color=INK)
            axes.vlines(width, max(low, 1e-9), high, color=INK, lw=1.2)
        else:  # nothing clogged: no more than that
            axes.plot(width, high, "v", color=INK, fillstyle="none")
    falls = Falls.of(cells)
    w = np.linspace(falls.width.min(), falls.width.max(), 200)
    for fit, colour, dash in (
        (exponential(falls), REGULAR, "-"),
        (divergence(falls), AUXETIC, "--"),
    ):
        q = fit.hazard(w)
        label = f"{fit.name}: {fit.words}"
        axes.plot(w[q > 0.0], q[q > 0.0], dash, color=f"#{colour:06X}", label=label)
    axes.set_yscale("log")
    axes.set_ylim(bottom=3e-4, top=1.5)
    axes.set(xlabel="orifice [diameters]", ylabel="clogs a grain that leaves a flow, q")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17))
