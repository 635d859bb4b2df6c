"""What the study of stability found: a table of all cases, JSON, and pictures of how the work grows with the material."""

from __future__ import annotations

import io
import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from core.elasticity import GUARD_AREA
from sandbox.draw.theme import AUXETIC, MIXED, REGULAR
from sandbox.ensemble.style import RESOLUTION, STYLE
from sandbox.files.folder import write_bytes
from sandbox.studies.stability.case import FAILS, HOLDS, NOT_SOLVED, Outcome

FORMAT, VERSION = "auxetic-sandbox stability", 1
KINDS = {"regular": REGULAR, "auxetic": AUXETIC, "mixed": MIXED}
SHOWN = (0.0, 0.8, 0.9999)  # |ν| of the lines

# What an outcome means, for a reader of the list.
WHY = {
    "iteration limit": "the bound came first. Contacts of stiffness C know a force to about C · 1e-15 k R, as lengths of some R \
are known to 1e-15: a finer tolerance is out of reach, and the work grows as √C on the way there",
    "collapsed": "a hand of up to 40 k R squeezed a grain until b ≤ 0; the increment was taken back, the hand stopped and told",
    "sunk": "a hand of up to 40 k R, with friction of 10 more than that, overpowered contacts of stiffness 50 k: a grain was \
pressed into a wall or through its face; the increment was taken back, the hand stopped and told",
}

INTRODUCTION = """# Numerical stability: {cases} hard cases

{verdicts}. {solved} of {increments:,} increments converged; {iterations:.3g} force evaluations in {minutes:.1f} minutes of \
one core ({machine}).

After every increment of every case the following is looked at, and a case fails if it does not hold:

- every number that is kept is finite, or the increment ended with the reason `not finite` and was taken back;
- every grain has a > 0 and b > 0, or the increment ended with the reason `collapsed` and was taken back;
- no grain has left the container, and no centre of a grain lies in a body, or the increment ended with the reason `sunk` and \
was taken back;
- a relaxation, at bodies that stand still, has not ended above the energy at which it began;
- converged: the forces on all grains and bodies add up to zero, and the stress tensor is symmetric, both to within what the \
reported residual leaves open.

Each case adds its own expectations. None has more force evaluations or time than its bound. A case whose increments end with \
a named reason instead of equilibrium, where that was to be expected of it, is "not solved" and listed with the reason."""


def as_markdown(outcomes: Sequence[Outcome], about: Mapping[str, Any]) -> str:
    """All cases in groups, the unsolved ones by name first."""
    verdicts = Counter(outcome.verdict for outcome in outcomes)
    increments = sum(outcome.increments for outcome in outcomes)
    unconverged = sum(outcome.unconverged for outcome in outcomes)
    machine = about.get("machine", {})
    lines = [
        INTRODUCTION.format(
            cases=len(outcomes),
            verdicts=", ".join(f"{verdicts[v]} {v}" for v in (HOLDS, NOT_SOLVED, FAILS)),
            solved=f"{increments - unconverged:,}",
            increments=increments,
            iterations=float(sum(outcome.iterations for outcome in outcomes)),
            minutes=sum(outcome.seconds for outcome in outcomes) / 60.0,
            machine=f"{machine.get('processor', 'unknown')}, Python {machine.get('python', '?')}",
        ),
        "",
    ]
    for verdict, title in ((FAILS, "Failed"), (NOT_SOLVED, "Not solved, with the reason")):
        chosen = [outcome for outcome in outcomes if outcome.verdict == verdict]
        if chosen:
            lines += [f"## {title}", ""]
            endings = {o.ended for o in chosen} & set(WHY)
            lines += [f"`{ending}`: {WHY[ending]}.\n" for ending in sorted(endings)]
            lines += [f"- {_cell(o.group)}: {_cell(o.name)}: {_reason(o)}" for o in chosen] + [""]
    lines += _guarded(outcomes)
    lines += ["## All cases", ""]
    for group in dict.fromkeys(outcome.group for outcome in outcomes):
        lines += _table(group, [outcome for outcome in outcomes if outcome.group == group])
    return "\n".join(lines)


def _guarded(outcomes: Sequence[Outcome]) -> list[str]:
    """Where the answer is not the paper's energy alone."""
    touched = [outcome for outcome in outcomes if outcome.guarded]
    flat = [outcome for outcome in outcomes if outcome.flattest <= 0.2]
    words = (
        f"The guard that keeps a grain from vanishing adds energy below {GUARD_AREA:g} of a grain's rest area, where it is as "
        "small as a circle of a fifth of its radius, and nothing above: everywhere else results are those of the paper's energy "
        f"to the last bit. It was at work after some increment in {len(touched)} of {len(outcomes)} cases. "
        f"Some grain was flatter than b = 0.2 a in {len(flat)}; in no other was b/a less than "
        f"{min((o.flattest for o in outcomes if o not in flat), default=1.0):.2f}."
    )
    lines = ["## The guard of the area", "", words, ""]
    lines += [
        f"- {_cell(o.group)}: {_cell(o.name)}: {o.guarded} of {o.increments:,} increments, flattest b = {o.flattest:.2g} a"
        for o in touched
    ]
    return [*lines, ""] if touched else lines


def _table(group: str, outcomes: Sequence[Outcome]) -> list[str]:
    expectations = dict.fromkeys(outcome.expectation for outcome in outcomes)
    return [
        f"### {group[0].upper() + group[1:]}",
        "",
        *(f"Expected: {_cell(text)}.\n" for text in expectations),
        "| case | outcome | increments | iterations each | s | nearest to its bound | verdict |",
        "| --- | --- | ---: | ---: | ---: | --- | --- |",
        *map(_row, outcomes),
        "",
    ]


def _row(outcome: Outcome) -> str:
    each = outcome.iterations / outcome.increments if outcome.increments else 0.0
    nearest = f"{outcome.closest}: {outcome.share:.2g}" if outcome.share > 0.0 else "—"
    verdict = outcome.verdict if outcome.verdict == HOLDS else f"**{outcome.verdict}**"
    cells = (
        outcome.name,
        outcome.ended + (f" ({outcome.message})" if outcome.message else ""),
        f"{outcome.increments:,}",
        f"{each:,.0f}",
        f"{outcome.seconds:.2g}",
        nearest,
        verdict,
    )
    return f"| {' | '.join(map(_cell, cells))} |"


def _reason(outcome: Outcome) -> str:
    words = f"{outcome.ended} ({outcome.message})" if outcome.message else outcome.ended
    return _cell("; ".join([words, *outcome.broken]))


def _cell(text: str) -> str:
    """Text that cannot break out of a table's cell."""
    return " ".join(text.split()).replace("|", "\\|")


def as_json(outcomes: Sequence[Outcome], about: Mapping[str, Any]) -> str:
    """Everything, one entry a case."""
    cases = [outcome.as_data() for outcome in outcomes]
    for case in cases:
        case["share"] = case["share"] if math.isfinite(case["share"]) else None
    verdicts = Counter(outcome.verdict for outcome in outcomes)
    data = {"format": FORMAT, "version": VERSION, **about, "verdicts": verdicts, "cases": cases}
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def draw(outcomes: Sequence[Outcome], folder: Path) -> None:
    """The map of ν × C, and lines along C, where the cases with a place were carried out."""
    placed = [outcome for outcome in outcomes if outcome.place is not None and outcome.increments]
    if not placed:
        return
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        _save(_map(placed), folder / "fig-map.png")
        _save(_lines(placed), folder / "fig-stiffness.png")


def _map(placed: Sequence[Outcome]) -> Any:
    """Iterations of an increment over Poisson's ratio and contact stiffness, one panel a kind of packing."""
    from matplotlib.colors import LogNorm

    table = _by_place(placed)
    most = max(_each(outcome) for outcome in placed)
    least = min(_each(outcome) for outcome in placed)
    canvas = _canvas((13.0, 4.6))
    canvas.suptitle("Force evaluations an increment, 40 grains squeezed by 8 %")
    axes = canvas.subplots(1, len(KINDS))
    image = None
    for panel, kind in zip(axes, KINDS, strict=True):
        ratios = sorted({abs(nu) for k, nu, _ in table if k == kind})
        stiffnesses = sorted({c for k, _, c in table if k == kind})
        values = np.full((len(ratios), len(stiffnesses)), np.nan)
        for (k, nu, c), outcome in table.items():
            if k != kind:
                continue
            row, column = ratios.index(abs(nu)), stiffnesses.index(c)
            values[row, column] = _each(outcome)
            sign = {HOLDS: "", NOT_SOLVED: "\nnot solved", FAILS: "\nFAILS"}[outcome.verdict]
            dark = values[row, column] > math.sqrt(least * most)
            panel.text(
                column,
                row,
                f"{_short(values[row, column])}{sign}",
                ha="center",
                va="center",
                fontsize=9.0,
                color="white" if dark else "black",
            )
        norm = LogNorm(least, most)
        image = panel.imshow(values, origin="lower", aspect="auto", cmap="viridis_r", norm=norm)
        mark = {"regular": "", "auxetic": "−", "mixed": "±"}[kind]
        panel.set_yticks(range(len(ratios)), [f"{mark}{nu:g}" for nu in ratios])
        panel.set_xticks(range(len(stiffnesses)), [_power(c) for c in stiffnesses])
        panel.set_title(kind)
        panel.set_xlabel("contact stiffness C [k]")
        panel.grid(False)
    axes[0].set_ylabel("Poisson's ratio ν")
    canvas.colorbar(image, ax=axes, label="force evaluations an increment")
    return canvas


def _lines(placed: Sequence[Outcome]) -> Any:
    """Iterations of an increment against contact stiffness, and the square root of it."""
    table = _by_place(placed)
    canvas = _canvas((8.2, 4.4))
    axes = canvas.add_subplot()
    every = []
    for kind, colour in KINDS.items():
        for nu, style in zip(SHOWN, (":", "-", "--"), strict=True):
            points = sorted(
                (c, _each(o)) for (k, v, c), o in table.items() if k == kind and abs(v) == nu
            )
            if points:
                x, y = zip(*points, strict=True)
                mark = {"regular": "", "auxetic": "−", "mixed": "±"}[kind]
                label = f"{kind}, ν = {mark}{nu:g}"
                axes.plot(x, y, style, color=f"#{colour:06X}", label=label, marker="o")
                every += points
    if every:
        low, high = min(c for c, _ in every), max(c for c, _ in every)
        start = float(np.exp(np.mean([math.log(n / math.sqrt(c)) for c, n in every])))
        ends = np.array([low, high])
        axes.plot(ends, start * np.sqrt(ends), color="#555555", linewidth=1.0, label="∝ √C")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("contact stiffness C [k]")
    axes.set_ylabel("force evaluations an increment")
    axes.set_title("The work grows as √C")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return canvas


def _by_place(placed: Sequence[Outcome]) -> dict[tuple[str, float, float], Outcome]:
    return {outcome.place: outcome for outcome in placed if outcome.place is not None}


def _each(outcome: Outcome) -> float:
    return outcome.iterations / outcome.increments


def _short(value: float) -> str:
    """``830``, ``1.2k``, ``12k``, ``120k``."""
    if value < 1000.0:
        return f"{value:.0f}"
    return f"{value / 1000.0:.1f}k" if value < 9950.0 else f"{value / 1000.0:.0f}k"


def _power(value: float) -> str:
    """``50``, or a power of ten as such."""
    exponent = round(math.log10(value))
    return f"$10^{exponent}$" if exponent > 2 and value == 10.0**exponent else f"{value:g}"


def _canvas(size: tuple[float, float]) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    canvas = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(canvas)
    return canvas


def _save(canvas: Any, path: Path) -> None:
    picture = io.BytesIO()
    canvas.savefig(picture, format="png", dpi=RESOLUTION)
    write_bytes(path, picture.getvalue())
