"""Pictures of a sweep, with matplotlib: probabilities along an axis and over two, and how many avalanches survive a size."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.theme import AUXETIC, EVENT, HAND, MIXED, REGULAR
from sandbox.ensemble.style import RESOLUTION, STYLE
from sandbox.files.folder import write_bytes
from sandbox.sweep.request import Request
from sandbox.sweep.sizes import mean_size, survival
from sandbox.sweep.summary import Cell
from scenes import registry

COLOURS = {"regular": REGULAR, "auxetic": AUXETIC, "mixed": MIXED}
OTHERS = (REGULAR, AUXETIC, MIXED, HAND, EVENT, 0x555555)
MARKS = "osD^vP"
PANEL = (4.8, 3.9)  # of one pair of axes [inch]
MOST_PANELS = 6
MOST_LINES = len(OTHERS)
ASIDE = 0.008  # of the axis
LEAST_CLOGS = 5  # for a line of survival
# Widths of an interval from which on a cell is hatched: fifty runs at one half are at 0.27.
UNSURE = ((0.5, "////"), (0.3, "//"))
STOPS = "share that stops, of what has started"

Group = tuple[str, list[Cell]]


@dataclass(frozen=True)
class View:
    """A sweep laid out: its cells by packing and by all axes but the first ``across``."""

    request: Request
    cells: Sequence[Cell]
    across: int

    def groups(self) -> list[Group]:
        """What each panel or line is of, and its cells."""
        found: dict[str, list[Cell]] = {}
        for cell in self.cells:
            rest = zip(self.request.axes[self.across :], cell.values[self.across :], strict=True)
            words = [cell.packing] if len(self.request.packings) > 1 else []
            words += [f"{axis.name.replace('_', ' ')} {value:g}" for axis, value in rest]
            found.setdefault(", ".join(words) or cell.packing, []).append(cell)
        return list(found.items())


def axis_label(request: Request, place: int) -> str:
    """Name and unit of a parameter that is varied."""
    name = request.axes[place].name
    unit = next(p.unit for p in registry.get(request.scene).parameters if p.name == name)
    words = name.replace("_", " ")
    return f"{words} [{unit}]" if unit else words


def draw_all(request: Request, cells: Sequence[Cell], folder: Path) -> list[str]:
    """All pictures that make sense of these cells, as PNG; their names. Raises InputError if one cannot be written."""
    made = []
    if request.axes and any(cell.stopped for cell in cells):
        lines = View(request, cells, 1).groups()
        if len(lines) <= MOST_LINES:
            save([("", lambda axes: along(axes, request, lines))], folder / "probability.png")
            made.append("probability.png")
    if len(request.axes) >= 2:
        groups = View(request, cells, 2).groups()[:MOST_PANELS]
        panels = [(name, _mapper(request, some)) for name, some in groups]
        save(panels, folder / "map.png")
        made.append("map.png")
    falling = [
        (name, some)
        for name, some in View(request, cells, 1 if request.axes else 0).groups()
        if any(cell.clogs >= LEAST_CLOGS for cell in some)
    ][:MOST_PANELS]
    if falling:
        save([(name, _faller(request, some)) for name, some in falling], folder / "avalanches.png")
        made.append("avalanches.png")
    return made


def along(axes: Any, request: Request, lines: Sequence[Group]) -> None:
    """Probability along the first axis, with Wilson's intervals, a line a group."""
    span = float(max(request.axes[0].values)) - float(min(request.axes[0].values))
    for place, (name, some) in enumerate(lines):
        known = [(float(c.values[0]), c.stopped) for c in some if c.stopped is not None]
        if not known:
            continue
        # Lines stand a little aside of each other, so that none hides another's interval.
        aside = ASIDE * span * (place - 0.5 * (len(lines) - 1))
        x = [at + aside for at, _ in known]
        values = np.array([share.value for _, share in known])
        low, high = np.array([share.interval() for _, share in known]).T
        colour = _colour(some[0] if len(request.axes) == 1 else None, place)
        axes.errorbar(
            x,
            values,
            yerr=np.maximum([values - low, high - values], 0.0),
            color=colour,
            marker=MARKS[place % len(MARKS)],
            capsize=3.0,
            label=name,
        )
    axes.locator_params(axis="x", nbins=5)  # more would touch each other
    axes.set(xlabel=axis_label(request, 0), ylabel=STOPS, ylim=(-0.03, 1.03))
    if len(lines) > 1:
        axes.legend()


def heat_map(axes: Any, request: Request, some: Sequence[Cell]) -> None:
    """Probability over the first two axes; hatched where the interval is wide."""
    from matplotlib import colormaps
    from matplotlib.patches import Rectangle

    across, up = (list(axis.values) for axis in request.axes[:2])
    grid = np.full((len(up), len(across)), np.nan)
    for cell in some:
        column, row = across.index(cell.values[0]), up.index(cell.values[1])
        share = cell.stopped
        if share is None:
            told = cell.told.replace(" ", "\n")
            axes.text(column, row, told, fontsize=8.0, color="#555555", ha="center", va="center")
            continue
        grid[row, column] = share.value
        low, high = share.interval()
        hatch = next((sign for width, sign in UNSURE if high - low >= width), "")
        dark = share.value < 0.5
        corner = (column - 0.5, row - 0.5)
        if hatch:
            edge = "#FFFFFF" if dark else "#000000"
            axes.add_patch(
                Rectangle(corner, 1, 1, fill=False, hatch=hatch, edgecolor=edge, lw=0, alpha=0.35)
            )
        text = {"ha": "center", "va": "center", "color": "white" if dark else "black"}
        ground = {"facecolor": colormaps["cividis"](share.value), "edgecolor": "none", "pad": 1.5}
        axes.text(column, row, f"{share.value:.2f}", fontsize=9.5, bbox=ground, **text)
    image = axes.imshow(grid, cmap="cividis", vmin=0.0, vmax=1.0, origin="lower", aspect="auto")
    axes.set_xticks(range(len(across)), [f"{value:g}" for value in across])
    axes.set_yticks(range(len(up)), [f"{value:g}" for value in up])
    axes.set(xlabel=axis_label(request, 0), ylabel=axis_label(request, 1))
    axes.grid(False)
    axes.figure.colorbar(image, ax=axes, label=STOPS)


def survive(axes: Any, request: Request, some: Sequence[Cell]) -> None:
    """Share of avalanches that grow larger than a size, and exponentials of the same hazard, a line a cell."""
    enough = [cell for cell in some if cell.clogs >= LEAST_CLOGS]
    # The same colour for the same value in all panels.
    values = request.axes[0].values if request.axes else ()
    step = max(-(-len(values) // MOST_LINES), 1)
    for cell in enough:
        place, left_out = divmod(values.index(cell.values[0]) if values else 0, step)
        if left_out:
            continue
        sizes, clogged = cell.sizes
        at, share = survival(sizes, clogged)
        mean = mean_size(sizes, clogged)[0]
        colour = _colour(None, place)
        where = zip(request.axes[:1], cell.values[:1], strict=True)
        name = (
            ", ".join(f"{axis.name.replace('_', ' ')} {value:g}" for axis, value in where)
            or cell.packing
        )
        axes.step(
            [0.0, *at], [1.0, *share], where="post", color=colour, label=f"{name}: mean {mean:.3g}"
        )
        if np.isfinite(mean):
            x = np.linspace(0.0, float(sizes.max()), 60)
            axes.plot(
                x, np.exp(x * np.log1p(-min(1.0 / mean, 1.0 - 1e-9))), "--", color=colour, lw=1.0
            )
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.004, top=1.15)
    axes.set(xlabel="size s: grains from one clog to the next", ylabel="share larger than s")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)


def _mapper(request: Request, some: Sequence[Cell]) -> Callable[[Any], None]:
    return lambda axes: heat_map(axes, request, some)


def _faller(request: Request, some: Sequence[Cell]) -> Callable[[Any], None]:
    return lambda axes: survive(axes, request, some)


def _colour(cell: Cell | None, place: int) -> str:
    """That of the packing where packings are told apart, else the next."""
    number = OTHERS[place % len(OTHERS)] if cell is None else COLOURS[cell.packing]
    return f"#{number:06X}"


def save(panels: Sequence[tuple[str, Callable[[Any], None]]], path: Path) -> None:
    """Panels, each a title and what draws it, as one PNG. Raises InputError if it cannot be written."""
    import matplotlib as mpl

    picture = io.BytesIO()
    across = min(len(panels), 3)
    down = -(-len(panels) // across)
    with mpl.rc_context(STYLE):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(PANEL[0] * across, PANEL[1] * down), layout="constrained")
        FigureCanvasAgg(figure)
        for place, (title, draw) in enumerate(panels):
            axes = figure.add_subplot(down, across, place + 1)
            axes.set_title(title)
            draw(axes)
        figure.savefig(picture, format="png", dpi=RESOLUTION)
    write_bytes(path, picture.getvalue())
