"""The study of accuracy in words and tables (Markdown), and in one line a scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from sandbox.studies.accuracy.estimate_report import (
    Estimates,
    about_estimates,
    estimate_rows,
    percent,
)
from sandbox.studies.accuracy.fronts import slope

Summary = Mapping[str, Any]
Row = Sequence[str]

OF_THE_INCREMENT = 1e-6  # a tolerance at which the error is that of the increments

INTRODUCTION = """# Error against run time

Each scene walks a short fixed protocol, from the same start, with many numerical settings. Errors are root mean \
squares over all increments (of several starts) against a reference, relative to the mean magnitude of the same \
quantity over the protocol; positions (of grains that bear force) and shapes in R, the radius of a large grain. Run \
time is processor time of the solving thread, without compiling, the middle one of repeated walks; per increment.

A path of grains can bifurcate: from the first place where two tight walks are further apart than {apart} R (root \
mean square over the force-bearing grains), trajectories mean nothing, and errors end. What is meaningful beyond \
it, distributions over seeds, stands in a table of its own. Where a path bifurcates within an increment or two, \
errors are those of the increment instead of the path: against the tightest walk with the same increments, as long \
as tight ones stay together."""

Cell = Callable[[str, Summary], str]


def power(value: float | None) -> str:
    """A small number as text: 1e-05."""
    return "—" if value is None or not math.isfinite(value) else f"{value:.0e}" if value else "0"


def times(value: float | None) -> str:
    """A ratio as text."""
    return "—" if value is None or not math.isfinite(value) else f"{value:.2g}×"


def milliseconds(seconds: float) -> str:
    """A time as text [ms]."""
    return f"{1e3 * seconds:.2g}"


def statement(summary: Summary) -> str:
    """What a scene says about itself in ``list``."""
    if "contact" in summary:
        law = summary["halvings"][0]
        return f"contact distance within {percent(law['error'])} in {1e9 * law['seconds']:.2g} ns a contact"
    default = summary["default"]
    cost = f"in {milliseconds(default['increment'])} ms an increment"
    means = [row for row in summary["beyond"] if row["tolerance"] == default["tolerance"]]
    if summary["against"] == "path" or not means:
        return f"root mean square error of the force {percent(default['force'])}, {cost}"
    off = percent(abs(means[0]["shift"]))
    return f"mean force within {off}, root mean square error of each {percent(default['force'])}, {cost}"


def as_table(statements: Mapping[str, str], estimates: Estimates) -> str:
    """What ``scenes.accuracy`` reads, as TOML: the statement of each scene, and the bounds of each of its packings."""
    lines = [
        "# Written by `python -m sandbox study accuracy`; scenes/accuracy.toml is that of a full run.",
        "# A bound: its factor, the power of what is left, the power of the farthest move; see scenes/accuracy.py.",
    ]
    for name, text in statements.items():
        lines += ["", f"[{name}]", f'statement = "{text}"']
        for packing, found in estimates.get(name, {}).items():
            lines += ["", f"[{name}.{packing}]"]
            for which, bound in found["bounds"].items():
                numbers = ", ".join(f"{float(value):.3g}" for value in bound)
                lines.append(f"{which} = [{numbers}]")
    return "\n".join(lines) + "\n"


def as_markdown(
    summaries: Mapping[str, Summary], estimates: Estimates, about: Mapping[str, Any], apart: float
) -> str:
    """The whole report."""
    relaxing = {name: s for name, s in summaries.items() if "contact" not in s}
    parts = [INTRODUCTION.format(apart=apart), _machine(about)]
    if relaxing:
        parts += [
            _section("What each scene comes to at its defaults", _defaults(relaxing)),
            "The fastest setting within one per cent is on the front of the scene's plot, in any tolerance and increment.",
            _section("Against other minimisers, same energy, same increments", _peers(relaxing)),
            PEERS,
            _section("The reference, and what confirms it", _references(relaxing)),
            REFERENCE,
            _section("Length of the increment", _lengths(relaxing)),
            LENGTHS,
            _section("Contact stiffness C", _stiffness(relaxing)),
            STIFFNESS,
            _section("The contact law against exact contact of ellipses", _overlaps(relaxing)),
            _section("An increment cut short", _budgets(relaxing)),
            BUDGETS,
        ]
        rubbing = {name: s for name, s in relaxing.items() if s["friction"]}
        if rubbing:
            parts += [_section("Contacts beyond the friction cone", _friction(rubbing)), FRICTION]
        parts += [
            _section("Beyond the first bifurcation: distributions over seeds", _beyond(relaxing)),
        ]
    if estimates:
        parts += [
            _section("The live estimate of window and table", estimate_rows(estimates)),
            about_estimates(estimates),
        ]
    for name, summary in summaries.items():
        if "contact" in summary:
            parts.append(
                _section(f"`{name}`: nothing relaxes, contact distance only", _contact(summary))
            )
    pictures = [*summaries, "stiffness"] if relaxing else list(summaries)
    if pictures:
        parts += ["## Plots", *(f"![{name}]({name}.png)" for name in pictures)]
    return "\n\n".join(parts) + "\n"


PEERS = """Ratios of run time of the minimiser at equal error of the force, of the peer's front over ours; above 1 this \
program is ahead. SciPy gets the compiled forces, variables scaled by the same inertias, a first step of the \
right length, and stops at its first evaluation that meets the tolerance; it does not get below a residual of \
about 1e-6, where its line search drowns in the rounding of the energy. The paper's chart is (x, y, θ, a, b), \
the same FIRE, the chain rule included (some 10 to 20 % of an iteration); it is judged by the forces in its own \
chart. Friction is a field of forces and no gradient, so minimisers do not apply there; DF-SANE finds \
roots, with 20,000 evaluations an increment at most. Nor are Newton's method and exact contacts asked there, which start from \
L-BFGS-B."""

REFERENCE = """Check: the first increment of the reference solved again by L-BFGS-B and Newton with a Hessian of finite \
differences; and the forces of the slow twin, written from the equations in another chart, at the relaxed start, \
relative to the mean contact force. With friction or drag the twin is compared in the tests instead. A walk with twice the \
reference's increments: with friction or drag, where errors are in proportion to the increment, that is about the \
error of the reference itself."""

STIFFNESS = """Against C → ∞, extrapolated by a parabola in 1/C through the three stiffest; the doubt is its distance from a \
line. C = 50 is what this program takes for the scenes; the paper's own runs have C between 42 and 1022."""

BUDGETS = """Error of the force if an increment ended after so many force evaluations. The window never does that: it shows \
the state of the last finished increment and goes on with the next one's relaxation in slices, which changes no \
bit of it."""

LENGTHS = """Error of the force at a tolerance of 1e-6, so that it is that of the increments, and the power of the increment \
that it follows. No number where errors are those of the increment, and not of the path."""

FRICTION = """Share of the contacts that pull harder than 1.05 μ times their normal force, counted anew after each increment \
of the scene's own length; mean over increments and starts."""


def _section(title: str, rows: Iterator[Row]) -> str:
    header, *body = rows
    lines = [f"## {title}", "", f"| {' | '.join(header)} |", f"|{' --- |' * len(header)}"]
    return "\n".join(lines + [f"| {' | '.join(row)} |" for row in body])


def _machine(about: Mapping[str, Any]) -> str:
    machine = about["machine"]
    quick = "Quick run. " if about["quick"] else ""
    return (
        f"{quick}Machine: {machine['processor']}, {machine['cores']} cores, {machine['system']}, "
        f"Python {machine['python']}; one thread a walk, {about['jobs']} at a time."
    )


def _defaults(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    yield (
        "scene",
        "grains",
        "tolerance",
        "errors of",
        "force",
        "worst",
        "stress",
        "positions [R]",
        "shapes [R]",
        "energy",
        "ms an increment",
        "frames at 60 Hz",
        "fastest within 1 %",
        "bifurcates at [increments]",
    )
    for name, summary in summaries.items():
        dot = summary["default"]
        yield (
            f"`{name}`",
            str(summary["grains"]),
            power(dot["tolerance"]),
            summary["against"],
            percent(dot["force"]),
            percent(dot["force_most"]),
            percent(dot["stress"]),
            power(dot["position"]),
            power(dot["shape"]),
            percent(dot["energy"]),
            milliseconds(dot["increment"]),
            f"{max(summary['frames'], 0.01):.2g}",
            _fastest(summary, 0.01),
            ", ".join("no" if place is None else f"{place:g}" for place in summary["bifurcations"]),
        )


def _fastest(summary: Summary, error: float) -> str:
    good = [dot for dot in summary["shown"]["front"] if dot["force"] <= error]
    if not good:
        return "none"
    dot = good[0]
    return f"{power(dot['tolerance'])}, {dot['step']:g} × {summary['increment']:g} R: {milliseconds(dot['solving'])} ms"


def _peers(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    names = list(dict.fromkeys(name for summary in summaries.values() for name in summary["lead"]))
    yield ("scene", *(f"{name}: {what}" for name in names for what in ("mean", "least")))
    for scene, summary in summaries.items():
        lead = summary["lead"]
        yield (
            f"`{scene}`",
            *(
                times(lead.get(name, {}).get(what))
                for name in names
                for what in ("middle", "least")
            ),
        )


def _references(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    yield (
        "scene",
        "increment",
        "largest residual",
        "converged",
        "twice the increment: force",
        "force, Newton",
        "positions [R]",
        "slow twin",
    )
    for name, summary in summaries.items():
        reference, check = summary["reference"], summary["check"] or {}
        yield (
            f"`{name}`",
            f"1/{1.0 / reference['step']:.0f} of {summary['increment']:g} R",
            power(reference["residual"]),
            f"{100.0 * reference['converged']:.0f} %",
            percent(reference["increment_error"]),
            *(power(check.get(what)) for what in ("force", "position", "twin_residual")),
        )


def _stiffness(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    values = next(iter(summaries.values()))["stiffness"]["stiffness"]
    yield ("scene", *(f"C = {value:g}" for value in values), "doubt", "error ∝ C^", "time ∝ C^")
    for name, summary in summaries.items():
        found = summary["stiffness"]
        yield (
            f"`{name}`",
            *(percent(error) for error in found["force"]),
            percent(found["force_doubt"]),
            f"{found['error_power']:.2f}",
            f"{found['cost_power']:.2f}",
        )


def _overlaps(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    yield ("scene", "mean aspect ratio", "force", "stress", "positions [R]", "energy")
    for name, summary in summaries.items():
        found = summary["overlap"]
        if found is None:
            continue
        yield (
            f"`{name}`",
            f"{found['aspect']:.3f}",
            percent(found["force"]),
            percent(found["stress"]),
            power(found["position"]),
            percent(found["energy"]),
        )


def _budgets(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    budgets = [dot["budget"] for dot in next(iter(summaries.values()))["budgets"]]
    yield ("scene", *(str(budget) for budget in budgets), "same bits in slices")
    for name, summary in summaries.items():
        yield (
            f"`{name}`",
            *(percent(dot["force"]) for dot in summary["budgets"]),
            "yes" if summary["sliced"] else "NO",
        )


def _lengths(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    steps = sorted(
        {dot["step"] for summary in summaries.values() for dot in summary["dots"]}, reverse=True
    )
    yield ("scene", "increment", *(f"{step:g} ×" for step in steps), "error ∝ increment^")
    for name, summary in summaries.items():
        path = summary["against"] == "path"
        found = {
            dot["step"]: dot["force"]
            for dot in summary["dots"]
            if path and dot["tolerance"] == OF_THE_INCREMENT
        }
        grown = slope(list(found), list(found.values()))
        yield (
            f"`{name}`",
            f"{summary['increment']:g} R",
            *(percent(found.get(step)) for step in steps),
            f"{grown:.2f}" if math.isfinite(grown) else "—",
        )


def _friction(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    tolerances = sorted(
        {dot["tolerance"] for summary in summaries.values() for dot in summary["dots"]},
        reverse=True,
    )
    yield ("scene", *(f"tolerance {power(tolerance)}" for tolerance in tolerances))
    for name, summary in summaries.items():
        found = {dot["tolerance"]: dot for dot in summary["dots"] if dot["step"] == 1.0}
        yield (f"`{name}`", *(percent(found[t]["beyond_cone"]) for t in tolerances))


def _beyond(summaries: Mapping[str, Summary]) -> Iterator[Row]:
    yield ("scene", "tolerance", "mean force", "mean drop", "mean force against the tightest")
    for name, summary in summaries.items():
        for row in summary["beyond"]:
            yield (
                f"`{name}`",
                power(row["tolerance"]),
                _spread(row["force"], row["force_spread"]),
                _spread(row["drop"], row["drop_spread"]),
                f"{100.0 * row['shift']:+.1f} %",
            )


def _spread(mean: float, spread: float) -> str:
    return f"{mean:.3g} ± {spread:.2g}" if math.isfinite(spread) else f"{mean:.3g}"


def _contact(summary: Summary) -> Iterator[Row]:
    yield ("aspect ratio", "starts early by, mean", "at most")
    for row in summary["contact"]:
        yield (f"{row['aspect']:g}", percent(row["mean"]), percent(row["most"]))
