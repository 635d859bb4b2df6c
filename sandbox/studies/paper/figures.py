"""Figures of a study, with matplotlib and without a screen."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sandbox.draw.theme import AUXETIC, MIXED, REGULAR
from sandbox.ensemble.style import RESOLUTION, STYLE, plain_numbers
from sandbox.files.folder import write_bytes
from sandbox.studies.paper.claims import Figure, Line, Panel
from sandbox.studies.paper.runs import Result

COLOURS = {"regular": REGULAR, "auxetic": AUXETIC, "mixed": MIXED, "other": 0x555555}
# Shape tells kinds apart where colour does not.
MARKS = {"regular": "o", "auxetic": "s", "mixed": "D", "other": "^"}
PANEL = (4.8, 3.7)  # of one pair of axes [inch]
MOST_ACROSS = 2


def draw(figure: Figure, results: Sequence[Result], path: Path) -> None:
    """Draw ``figure`` from the runs to a PNG. Raises InputError if it cannot be written."""
    import matplotlib as mpl

    panels = figure.panels(results)
    down = -(-len(panels) // MOST_ACROSS)
    across = min(len(panels), MOST_ACROSS)
    picture = io.BytesIO()
    with mpl.rc_context(STYLE):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure as Canvas

        canvas = Canvas(figsize=(PANEL[0] * across, PANEL[1] * down + 0.4), layout="constrained")
        FigureCanvasAgg(canvas)
        canvas.suptitle(figure.title)
        for place, panel in enumerate(panels):
            _draw_panel(canvas.add_subplot(down, across, place + 1), panel)
        canvas.savefig(picture, format="png", dpi=RESOLUTION)
    write_bytes(path, picture.getvalue())


def _draw_panel(axes: Any, panel: Panel) -> None:
    for line in panel.lines:
        _draw_line(axes, line)
    axes.set_title(panel.title)
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    if panel.log_x:
        axes.set_xscale("log")
        plain_numbers(axes.xaxis, *axes.get_xlim())
    if panel.log_y:
        axes.set_yscale("log")
        plain_numbers(axes.yaxis, *axes.get_ylim())
    if any(line.label for line in panel.lines):
        axes.legend()


def _draw_line(axes: Any, line: Line) -> None:
    colour = f"#{COLOURS[line.kind]:06X}"
    style = {"color": colour, "label": line.label or None}
    if line.points:
        inside = "none" if line.dashed else colour
        style |= {"linestyle": "none", "marker": MARKS[line.kind], "markerfacecolor": inside}
    else:
        style |= {"linestyle": "--" if line.dashed else "-"}
    if line.spread is None:
        axes.plot(line.x, line.y, **style)
    else:
        axes.errorbar(line.x, line.y, yerr=line.spread, capsize=2.5, **style)
