"""Hard cases of the material: stiff, soft, auxetic to the limit, of very different sizes, squeezed to 60 % of the area."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.generate import Recipe
from core.material import deformation_stiffness, from_paper
from core.packing import PeriodicBox
from core.relaxation import StopReason
from sandbox.studies.stability import rigs
from sandbox.studies.stability.case import Act, Case
from sandbox.studies.stability.rigs import KINDS, Rig
from sandbox.studies.stability.watch import Watch

POISSON_RATIOS = (-0.9999, -0.99, -0.9, -0.8, -0.5, 0.0, 0.5, 0.8, 0.9, 0.99, 0.9999)
SIZES_OF_NU = (0.0, 0.5, 0.8, 0.9, 0.99, 0.999, 0.9999)
STIFFNESSES = (3.0, 10.0, 50.0, 300.0, 1e3, 1e4, 1e5)
RETURNS = 1e-3  # of the way
SOFTEST = 5e-4  # [k] stiffness of the softest mode of such packings: what a force that is left can still move


def cases() -> Iterator[Case]:
    """All of this module."""
    for nu, stiffness in itertools.product(POISSON_RATIOS, (3.0, 10.0, 50.0, 1e3, 1e5)):
        yield Case(
            "one grain between two plates",
            f"ν = {nu:g}, C = {stiffness:g}",
            "stiffness 1 k at small strain; pressed by a tenth and back it returns",
            _plates(nu, stiffness),
        )
    for kind, nu, stiffness in itertools.product(KINDS, SIZES_OF_NU, STIFFNESSES):
        if nu == 0.0 and kind != "regular":
            continue
        signed = -nu if kind == "auxetic" else nu
        sign = {"regular": "", "auxetic": "−", "mixed": "±"}[kind]
        yield Case(
            "packing squeezed by 8 %, ν × C × kind",
            f"{kind}, ν = {sign}{nu:g}, C = {stiffness:g}",
            "converges; a small path without a change of contacts returns",
            _squeezed(rigs.materials(kind, nu, stiffness)),
            place=(kind, signed, stiffness),
        )
    for lam, mu in itertools.product((0.01, 0.1, 1.0, 10.0, 100.0), (0.1, 1e-2, 1e-3, 1e-4)):
        nu, stiffness = (float(v) for v in from_paper(lam, mu))
        kind = "auxetic" if nu < 0.0 else "regular"
        yield Case(
            "the paper's λ and μ",
            f"λ = {lam:g}, μ = {mu:g} (ν = {nu:.2f}, C = {stiffness:.3g})",
            "converges; a small path without a change of contacts returns",
            _squeezed(rigs.materials(kind, nu, stiffness)),
        )
    for ratio, kind, walls in itertools.product((1.0, 3.0, 5.0, 10.0, 20.0), KINDS, (False, True)):
        yield Case(
            "size ratio",
            f"{ratio:g}, {kind}, {'walls' if walls else 'periodic'}",
            "converges while squeezed",
            _sizes(ratio, kind, walls),
        )
    for kind, stiffness, walls in itertools.product(KINDS, (3.0, 50.0, 1e3), (False, True)):
        yield Case(
            "compressed to 60 % of the area",
            f"{kind}, C = {stiffness:g}, {'walls' if walls else 'periodic'}",
            "converges, no grain vanishes or passes a wall; let go, it rests again",
            _crushed(kind, stiffness, walls),
        )


def finest(nu: ArrayLike, stiffness: ArrayLike) -> NDArray[np.float64]:
    """A relative residual that rounding allows: lengths are known to 1e-15 R, a force of 0.01 k R to 1e-13 of the stiffness."""
    stiffest = np.maximum(stiffness, 2.0 * deformation_stiffness(nu, stiffness))
    least: NDArray[np.float64] = np.maximum(1e-10, 1e-12 * stiffest)
    return least


def _plates(nu: float, stiffness: float) -> Act:
    def act(watch: Watch) -> None:
        solver = rigs.settings(tolerance=float(10.0 * finest(nu, stiffness)), force_floor=1e-3)
        rig = rigs.plates(nu, stiffness, solver)
        rig.rest(watch)
        start = rig.packing.state.copy()
        rig.lid_to(watch, 1e-3)
        force = float(rig.engine.reactions[1, 1])
        watch.expect("stiffness of the grain off by [k]", abs(force / 1e-3 - 1.0), 2e-3)
        rig.lid_to(watch, 0.2)
        rig.lid_to(watch, 0.0)
        back = float(np.max(np.abs(rig.packing.state - start)))
        watch.expect("not back where it was [R]", back, 1e-5)

    return act


def _squeezed(recipe: Recipe) -> Act:
    def act(watch: Watch) -> None:
        rig = rigs.cell(recipe)
        rig.rest(watch)
        rig.squeeze(watch, math.sqrt(0.92))
        there_and_back(watch, rig)

    return act


def there_and_back(watch: Watch, rig: Rig) -> None:
    """A path so short that contacts rarely change; where none did, the packing must return."""
    box = rig.packing.box
    assert box is not None
    packing = rig.packing
    finest_of_all = np.max(finest(packing.poisson_ratio, packing.contact_stiffness))
    rig.engine.system.solver = rigs.settings(tolerance=float(finest_of_all))
    same = watch.step(rig.engine).report.reason is StopReason.CONVERGED
    start, touching = rig.packing.state.copy(), _touching(rig)
    near = PeriodicBox(box.width * (1.0 - 1e-5), box.height * (1.0 - 1e-5), box.shift)
    away = start
    for target in (near, box):
        done = watch.step(rig.engine, box=target)
        same = same and done.report.reason is StopReason.CONVERGED and _touching(rig) == touching
        away = rig.packing.state.copy() if target is near else away
    if not same:
        return
    # A grain that fewer than three others touch may lie anywhere.
    pairs = rig.engine.contacts()[0]
    held = np.bincount(np.concatenate([pairs.i, pairs.j]), minlength=len(rig.packing)) >= 3
    way = float(np.max(np.abs((away - start)[:, held]), initial=1e-12))
    off = (rig.packing.state - start)[:, held]
    # A loose grain that was pushed once pushes back: all others together are then elsewhere, and nothing holds them there.
    off[:2] -= off[:2].mean(axis=1, keepdims=True) if held.any() else 0.0
    left = float(np.max(np.abs(off), initial=0.0))
    force = done.report.residual * done.report.mean_contact_force
    allowed = RETURNS * way + force / SOFTEST
    watch.expect("not back after a small path [R]", left, allowed)


def _touching(rig: Rig) -> set[tuple[int, int]]:
    pairs = rig.engine.contacts()[0]
    return {(min(a, b), max(a, b)) for a, b in zip(pairs.i.tolist(), pairs.j.tolist(), strict=True)}


def _sizes(ratio: float, kind: str, walls: bool) -> Act:
    def act(watch: Watch) -> None:
        recipe = Recipe(kind=kind, size_ratio=ratio, small_fraction=0.8)
        solver = rigs.settings(step=min(0.05, 0.2 / ratio))
        if walls:
            rig = rigs.press(recipe, count=50, solver=solver)
            rig.rest(watch)
            rig.lid_to(watch, 20.0 * solver.step)
        else:
            rig = rigs.cell(recipe, count=60, solver=solver)
            rig.rest(watch)
            rig.squeeze(watch, 0.97)

    return act


def _crushed(kind: str, stiffness: float, walls: bool) -> Act:
    def act(watch: Watch) -> None:
        recipe = rigs.materials(kind, 0.8, stiffness)
        if walls:
            rig = rigs.press(recipe, count=30, fraction=0.84)
            rig.rest(watch)
            height = rig.home[1]
            rig.lid_to(watch, 0.4 * height)
            rig.lid_to(watch, -2.0)
        else:
            rig = rigs.cell(recipe, count=30, fraction=0.84)
            rig.rest(watch)
            rig.squeeze(watch, math.sqrt(0.6))
            rig.squeeze(watch, math.sqrt(1.0 / 0.6))
        a, b = rig.packing.semi_axes
        round_again = float(np.max(np.abs(a * b / rig.packing.rest_radius**2 - 1.0)))
        watch.expect("area of a grain off after letting go", round_again, 0.2)

    return act
