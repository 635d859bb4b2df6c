"""Plots of the study of accuracy: work against precision, one picture a scene, and the contact stiffness of all scenes."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from sandbox.ensemble.style import STYLE, plain_numbers
from sandbox.files.folder import write_bytes

Summary = Mapping[str, Any]
Points = Sequence[tuple[float, float]]

# Okabe and Ito's colours, which stay apart for all kinds of colour vision; marks tell them apart without colour.
INCREMENTS = {
    2.0: ("#56B4E9", "v"),
    1.0: ("#0072B2", "o"),
    0.5: ("#009E73", "s"),
    0.25: ("#E69F00", "D"),
}
PEERS = {
    "SciPy L-BFGS-B": ("#000000", "x"),
    "SciPy DF-SANE": ("#CC79A7", "x"),
    "paper's chart": ("#D55E00", "+"),
}
QUANTITIES = {
    "force": ("#0072B2", "o", "force"),
    "stress": ("#009E73", "s", "stress"),
    "energy": ("#E69F00", "D", "energy"),
    "position": ("#CC79A7", "^", "positions [R]"),
    "shape": ("#56B4E9", "v", "shapes [R]"),
}
SCENES = ("#0072B2", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#D55E00", "#000000")
MARKS = "osD^vx+*<>"
SIZE = (10.4, 5.0)  # [inch]
RESOLUTION = 100  # [dots an inch]
FRONT = "#BBBBBB"
LEGEND: Any = {  # under the axes: it hides no point
    "loc": "upper center",
    "bbox_to_anchor": (0.5, -0.14),
    "ncols": 3,
    "columnspacing": 1.4,
}


def draw_scene(name: str, title: str, summary: Summary, path: Path) -> None:
    """The picture of one scene. Raises InputError if it cannot be written."""
    panels: list[Callable[[Any], None]]
    if "contact" in summary:
        panels = [lambda axes: _halvings(axes, summary), lambda axes: _aspects(axes, summary)]
    else:
        panels = [lambda axes: _work(axes, summary), lambda axes: _quantities(axes, summary)]
    _draw(f"{title} (`{name}`)".replace("`", ""), panels, path)


def draw_stiffness(summaries: Mapping[str, Summary], path: Path) -> None:
    """Model error and cost against the contact stiffness, all scenes. Raises InputError if it cannot be written."""
    relaxing = {name: s["stiffness"] for name, s in summaries.items() if "stiffness" in s}
    if relaxing:
        panels = [lambda axes: _model_error(axes, relaxing), lambda axes: _cost(axes, relaxing)]
        _draw("Contact stiffness C", panels, path)


def _draw(title: str, panels: Sequence[Callable[[Any], None]], path: Path) -> None:
    import matplotlib as mpl

    picture = io.BytesIO()
    with mpl.rc_context(STYLE):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        canvas = Figure(figsize=SIZE, layout="constrained")
        FigureCanvasAgg(canvas)
        canvas.suptitle(title)
        for place, panel in enumerate(panels):
            panel(canvas.add_subplot(1, len(panels), place + 1))
        canvas.savefig(picture, format="png", dpi=RESOLUTION)
    write_bytes(path, picture.getvalue())


def _points(dots: Iterable[Mapping[str, Any]]) -> Points:
    """(time [ms], error), without what a logarithm cannot show."""
    found = [(1e3 * dot["solving"], dot["force"]) for dot in dots]
    return [(x, y) for x, y in found if x > 0.0 and y > 0.0 and math.isfinite(y)]


def _line(axes: Any, points: Points, **style: Any) -> None:
    if points:
        axes.plot(*zip(*points, strict=True), **style)


def _logarithmic(axes: Any, x: str, y: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    plain_numbers(axes.xaxis, *axes.get_xlim())
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.legend(**LEGEND)


def _work(axes: Any, summary: Summary) -> None:
    shown = summary["shown"]
    _line(axes, _points(shown["front"]), color=FRONT, linewidth=7, label="front", zorder=1)
    own = float(summary["increment"])
    path = summary["against"] == "path"
    for step, (colour, mark) in INCREMENTS.items():
        if not path and step != 1.0:
            continue  # each against its own increments: costs are not to be compared
        dots = [dot for dot in shown["dots"] if dot["step"] == step]
        label = f"increments of {own * step:g} R"
        _line(axes, _points(dots), color=colour, marker=mark, linewidth=1.2, label=label)
    for name, (colour, mark) in PEERS.items():
        dots = summary["peers"].get(name, ())
        style = {"color": colour, "marker": mark, "linestyle": "--", "linewidth": 1.2}
        _line(axes, _points(dots), label=name, **style)
    _line(
        axes,
        _points([shown["default"]]),
        color="#CC79A7",
        marker="*",
        markersize=17,
        markeredgecolor="black",
        linestyle="none",
        label="default",
        zorder=5,
    )
    axes.set_title("work and precision" + ("" if path else " of the relaxation alone"))
    _logarithmic(axes, "processor time of an increment's way [ms]", "error of the force, relative")


def _quantities(axes: Any, summary: Summary) -> None:
    dots = sorted(
        (dot for dot in summary["dots"] if dot["step"] == 1.0), key=lambda dot: dot["tolerance"]
    )
    for name, (colour, mark, label) in QUANTITIES.items():
        points = [(dot["tolerance"], dot[name]) for dot in dots]
        shown = [(x, y) for x, y in points if y and y > 0.0 and math.isfinite(y)]
        _line(axes, shown, color=colour, marker=mark, linewidth=1.2, label=label)
    axes.axvline(summary["tolerance"], color="#CC79A7", linestyle=":", label="default")
    axes.set_title(f"increments of {summary['increment']:g} R")
    _logarithmic(axes, "tolerance", "error")


def _halvings(axes: Any, summary: Summary) -> None:
    rows = summary["halvings"]
    points = [(1e9 * row["seconds"], row["error"]) for row in rows]
    shown = [(x, max(y, 1e-16)) for x, y in points]
    _line(axes, shown[1:], color="#0072B2", marker="o", linewidth=1.2, label="exact, by halving")
    style = {"color": "#CC79A7", "marker": "*", "markersize": 17, "markeredgecolor": "black"}
    _line(axes, shown[:1], linestyle="none", label="contact law (default)", **style)
    axes.set_title("work and precision, aspect ratio 1.4")
    _logarithmic(axes, "time of a contact [ns]", "error of the contact distance, relative")


def _aspects(axes: Any, summary: Summary) -> None:
    rows = summary["contact"]
    for name, (colour, mark) in {"most": ("#D55E00", "s"), "mean": ("#0072B2", "o")}.items():
        points = [(row["aspect"] - 1.0, row[name]) for row in rows]
        label = "at most" if name == "most" else "mean over tilts"
        _line(axes, points, color=colour, marker=mark, linewidth=1.2, label=label)
    axes.set_title("contact law")
    _logarithmic(axes, "aspect ratio − 1", "contact starts early by, of a diameter")


def _model_error(axes: Any, scenes: Mapping[str, Mapping[str, Any]]) -> None:
    for k, (name, found) in enumerate(scenes.items()):
        pairs = zip(found["stiffness"], found["force"], strict=True)
        shown = [(x, y) for x, y in pairs if y and y > 0.0 and math.isfinite(y)]
        style = {"color": SCENES[k % len(SCENES)], "marker": MARKS[k % len(MARKS)]}
        _line(axes, shown, linewidth=1.2, label=name, **style)
    axes.axvline(50.0, color=FRONT, linestyle=":")
    axes.set_title("model error of the force against C → ∞")
    _logarithmic(axes, "C [k]", "error, relative")
    axes.legend(fontsize=7, **LEGEND)


def _cost(axes: Any, scenes: Mapping[str, Mapping[str, Any]]) -> None:
    for k, (_, found) in enumerate(scenes.items()):
        at_50 = dict(zip(found["stiffness"], found["solving"], strict=True))[50.0]
        points = [(x, y / at_50) for x, y in zip(found["stiffness"], found["solving"], strict=True)]
        style = {"color": SCENES[k % len(SCENES)], "marker": MARKS[k % len(MARKS)]}
        _line(axes, points, linewidth=1.2, **style)
    x = (12.5, 800.0)
    root = [(value, math.sqrt(value / 50.0)) for value in x]
    _line(axes, root, color="black", linestyle="--", label="√C")
    axes.axvline(50.0, color=FRONT, linestyle=":")
    axes.set_title("run time at the default tolerance")
    _logarithmic(axes, "C [k]", "time over that of C = 50")
