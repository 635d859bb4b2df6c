"""Random packings: seeded, of regular, auxetic or mixed grains, by packing fraction or by pressure, in any closed outline.

Grains are first placed one after another at random, small enough that none touches another or a wall, so that each is certainly
inside; then all grow together to their size while the packing relaxes between steps of growth.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.arrays import Floats
from core.endless import endless
from core.errors import InputError
from core.jit import kernel
from core.material import DEFAULT_CONTACT_STIFFNESS, DEFAULT_POISSON_RATIO
from core.packing import Packing, PeriodicBox
from core.periodic import nearest
from core.relaxation import Relaxation, StopReason
from core.rigid import Point, RigidWorld, polygon_area
from core.rigid_contacts import EDGE, image

Progress = Callable[[float], None]

SIZE_RATIO = 1.4
PLACED_FRACTION = (
    0.38  # packing fraction of the random placement; random addition of discs saturates at 0.547
)
MOST_DENSE = 1.5  # packing fraction that can be asked for
NO_ROOM = "the grains do not fit: lower the packing fraction or enlarge the container"
GROWTH = 0.02  # largest relative growth of the radii between two relaxations
ROUGH, FINE = 1e-1, 1e-3  # tolerances while growing, and at the end
KINDS = ("regular", "auxetic", "mixed")


@dataclass(frozen=True)
class Recipe:
    """Which grains: kind of packing, sizes and material. Large grains have radius 1 [R]; each kind has its Poisson's ratio.

    Sizes: large and small ones, ``size_ratio`` 1 for grains that are all alike; with ``size_width`` the radii of each of the two
    are spread evenly, the largest of all having 1 [R].
    """

    kind: str = "mixed"
    auxetic_fraction: float = 0.5  # of the grains, in a mixed packing
    regular_poisson_ratio: float = DEFAULT_POISSON_RATIO
    auxetic_poisson_ratio: float = -DEFAULT_POISSON_RATIO
    contact_stiffness: float = DEFAULT_CONTACT_STIFFNESS
    auxetic_contact_stiffness: float | None = None  # None: as that of the regular ones
    size_ratio: float = SIZE_RATIO  # large over small radius
    small_fraction: float = 0.5  # of the grains
    size_width: float = 0.0  # radii of a size are spread from 1 − this to 1 of it

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"unknown packing {self.kind!r}: choose {', '.join(KINDS)}")
        if not (0.0 <= self.auxetic_fraction <= 1.0 and 0.0 <= self.small_fraction <= 1.0):
            raise InputError("fractions of grains must lie between 0 and 1")
        if not self.size_ratio >= 1.0:
            raise InputError("the size ratio is large over small radius: it must be at least 1")
        if not 0.0 <= self.size_width < 1.0:
            raise InputError("the width of the sizes must be at least 0 and less than 1")

    def stiffness(self, poisson_ratio: Floats) -> Floats:
        """Contact stiffness [k] of grains (N,), whose kind is the sign of Poisson's ratio."""
        other = self.auxetic_contact_stiffness
        auxetic = self.contact_stiffness if other is None else other
        return np.where(np.signbit(poisson_ratio), auxetic, self.contact_stiffness)

    def mean_area(self) -> float:
        """Mean rest area of a grain [R²]."""
        spread = 1.0 - self.size_width + self.size_width**2 / 3.0
        area = math.pi * (1.0 - self.small_fraction + self.small_fraction / self.size_ratio**2)
        return area * spread

    @property
    def smallest(self) -> float:
        """Radius that no grain falls below [R]."""
        return (1.0 - self.size_width) / (self.size_ratio if self.small_fraction > 0.0 else 1.0)

    def grains(self, count: int, random: np.random.Generator) -> tuple[Floats, Floats]:
        """Rest radii [R] and Poisson's ratios of ``count`` grains, (count,) each, in random order.

        Numbers of each size, and of each kind within each size, are exact to one grain; so is how radii are spread.
        """
        small = round(count * self.small_fraction) if self.size_ratio > 1.0 else 0
        radius = np.ones(count)
        radius[:small] = 1.0 / self.size_ratio
        if self.size_width > 0.0:
            for size in (radius[:small], radius[small:]):
                size *= 1.0 - self.size_width * (np.arange(len(size)) + 0.5) / max(len(size), 1)
        share = {"regular": 0.0, "auxetic": 1.0, "mixed": self.auxetic_fraction}[self.kind]
        # Counting up by ``share`` spreads the auxetic grains evenly over both sizes.
        steps = np.floor(np.arange(1, count + 1) * share + 1e-9) - np.floor(
            np.arange(count) * share + 1e-9
        )
        nu = np.where(steps > 0.5, self.auxetic_poisson_ratio, self.regular_poisson_ratio)
        order = random.permutation(count)
        return radius[order], nu[order]


def pack(
    recipe: Recipe,
    *,
    seed: int,
    outline: list[Point] | None = None,
    world: RigidWorld | None = None,
    box: PeriodicBox | None = None,
    packing_fraction: float | None = None,
    count: int | None = None,
    target_pressure: float | None = None,
    tolerance: float = FINE,
    progress: Progress | None = None,
) -> Packing:
    """A random packing inside ``outline`` (corners [R]) between the bodies of ``world``, or in a periodic ``box``.

    Give ``packing_fraction`` and the outline or box: the number of grains follows, to within half a grain. Or give ``count`` and
    ``packing_fraction`` with ``box=None`` and no outline: a square periodic box of the right size is made, exact. With
    ``target_pressure`` [k] the packing is then compressed or released to that pressure within 1 %: a periodic box changes its
    size, inside an outline the grains change theirs. ``progress`` is called with the share done.

    Raises InputError if the request cannot be met, and never leaves a grain outside.
    """
    if seed < 0:
        raise InputError("the seed must be 0 or a positive whole number")
    if packing_fraction is None:
        packing_fraction = 0.84
    if not 0.01 <= packing_fraction <= MOST_DENSE:
        raise InputError(f"the packing fraction must lie between 0.01 and {MOST_DENSE}")
    if count is not None and count < 0:
        raise InputError("the number of grains must be 0 or more")
    counted = count is not None
    random = np.random.default_rng(seed)
    world = world or RigidWorld()
    if outline is None and box is None:
        if count is None:
            raise InputError("give an outline, a periodic box, or a number of grains")
        if count == 0:
            raise InputError("a packing without grains has no size: give an outline or a box")
        side = math.sqrt(count * recipe.mean_area() / packing_fraction)
        box = PeriodicBox(side, side)
    elif count is None:
        count = round(packing_fraction * open_area(outline, world, box) / recipe.mean_area())
    if count == 0 and target_pressure is not None:
        raise InputError(
            "a packing without grains has no pressure: give more grains, or no pressure"
        )
    radius, nu = recipe.grains(count, random)
    if outline is None and box is not None and np.isfinite(box.height) and not world.bodies:
        area = box.area
    else:
        area = open_area(outline, world, box)
    fraction = float(np.pi * np.sum(radius**2)) / area
    if counted and fraction > MOST_DENSE:
        raise InputError(NO_ROOM)
    scale = min(1.0, math.sqrt(PLACED_FRACTION / max(fraction, 1e-9)))
    x, y = _place(radius * scale, outline, world, box, random)
    packing = Packing(x, y, radius, nu, recipe.stiffness(nu), box=box)
    primitives, _ = world.primitives()
    _grow(packing, primitives, scale, tolerance, progress)
    if target_pressure is not None:
        packing = _to_pressure(packing, primitives, area, target_pressure, tolerance)
    # A region that is periodic in one direction has both: the outline is then one period of it.
    if outline is not None and not np.all(inside(outline, *packing.folded())):
        raise InputError(NO_ROOM)
    return packing


def open_area(
    outline: list[Point] | None, world: RigidWorld, box: PeriodicBox | None = None
) -> float:
    """Area that the grains can have [R²]: that of the outline or box, less that of the bodies inside it."""
    if outline is not None:
        area = abs(polygon_area(outline))
    elif box is not None and np.isfinite(box.area):
        area = box.area
    else:
        raise InputError("an open or half-open region needs an outline")
    for body in world.bodies:
        if body.role != "wall" and body.area() > 0.0:
            centre = np.array([body.position])
            if outline is None or inside(outline, centre[:, 0], centre[:, 1])[0]:
                area -= body.area()
    if area <= 0.0:
        raise InputError("there is no room for grains: the bodies fill the container")
    return area


def inside(outline: list[Point], x: Floats, y: Floats) -> NDArray[np.bool_]:
    """True for points (n,) inside the closed outline (even–odd rule)."""
    corners = np.asarray(outline, dtype=np.float64)
    sides = np.hstack([corners, np.roll(corners, -1, axis=0)])
    x0, y0, x1, y1 = sides[sides[:, 1] != sides[:, 3]].T[:, :, None]
    left = x < x0 + (y - y0) * (x1 - x0) / (y1 - y0)
    odd: NDArray[np.bool_] = np.logical_xor.reduce(((y0 > y) != (y1 > y)) & left, axis=0)
    return odd


def _place(
    radius: Floats,
    outline: list[Point] | None,
    world: RigidWorld,
    box: PeriodicBox | None,
    random: np.random.Generator,
) -> tuple[Floats, Floats]:
    """Random sequential addition of discs (N,), largest first: none touches another, a body, or the outside."""
    if outline is not None:
        low, high = np.min(outline, axis=0), np.max(outline, axis=0)
    else:
        assert box is not None
        low, high = np.zeros(2), np.array([box.width, box.height])
    primitives = endless(world.primitives()[0], box)
    reach = 2.0 * float(radius.max(initial=1.0))
    columns = max(1, int((high[0] - low[0]) / reach))
    rows = max(1, int((high[1] - low[1]) / reach))
    # The grains of a cell are a chain, the latest first: however many small ones lie where a large one would have room.
    latest = np.full(columns * rows, -1, dtype=np.int64)
    before = np.full(len(radius), -1, dtype=np.int64)
    x, y = np.zeros(len(radius)), np.zeros(len(radius))
    box_form = None if box is None else box.kernel_form()
    placed, tries = 0, 0
    order = np.argsort(-radius, kind="stable")
    while placed < len(radius):
        batch = max(1000, 4 * len(radius))
        tries += batch
        if tries > 4000 * len(radius) + 200_000:
            raise InputError(NO_ROOM)
        candidates = low + random.random((batch, 2)) * (high - low)
        if outline is not None:
            candidates = candidates[inside(outline, candidates[:, 0], candidates[:, 1])]
        for body in world.bodies:
            for corners, _ in body.polygons:
                hidden = inside(
                    [(cx, cy) for cx, cy in body.to_world(corners)],
                    candidates[:, 0],
                    candidates[:, 1],
                )
                candidates = candidates[~hidden]
        spacing = np.array([(high[0] - low[0]) / columns, (high[1] - low[1]) / rows])
        placed = add(
            x,
            y,
            radius,
            order,
            placed,
            candidates,
            primitives,
            latest,
            before,
            columns,
            rows,
            low,
            spacing,
            box_form,
        )
    return x, y


@kernel
def add(
    x,
    y,
    radius,
    order,
    placed,
    candidates,
    primitives,
    latest,
    before,
    columns,
    rows,
    low,
    spacing,
    box,
):
    """Try candidates (C, 2) in turn for the next grains; returns how many grains are placed now."""
    for c in range(candidates.shape[0]):
        if placed == radius.shape[0]:
            break
        i = order[placed]
        px = candidates[c, 0]
        py = candidates[c, 1]
        free = True
        for m in range(primitives.shape[0]):
            dx, dy = image(primitives, m, px, py, box)
            dx -= primitives[m, 1]
            dy -= primitives[m, 2]
            if primitives[m, 0] == EDGE:
                ux = primitives[m, 3]
                uy = primitives[m, 4]
                length = (primitives[m, 5] - primitives[m, 1]) * ux + (
                    primitives[m, 6] - primitives[m, 2]
                ) * uy
                along = min(max(dx * ux + dy * uy, 0.0), length)
                dx -= along * ux
                dy -= along * uy
            apart = radius[i] + primitives[m, 7]
            if dx * dx + dy * dy < apart * apart:
                free = False
                break
        if not free:
            continue
        column = min(int((px - low[0]) / spacing[0]), columns - 1)
        row = min(int((py - low[1]) / spacing[1]), rows - 1)
        for dr in range(-1, 2):
            for dc in range(-1, 2):
                near_row = (row + dr) % rows
                near_column = (column + dc) % columns
                cell = near_row * columns + near_column
                j = latest[cell]
                while free and j >= 0:
                    dx, dy = nearest(px - x[j], py - y[j], box)
                    apart = radius[i] + radius[j]
                    free = dx * dx + dy * dy >= apart * apart
                    j = before[j]
        if free:
            x[i] = px
            y[i] = py
            cell = row * columns + column
            before[i] = latest[cell]
            latest[cell] = i
            placed += 1
    return placed


def _grow(
    packing: Packing, primitives: Floats, scale: float, tolerance: float, progress: Progress | None
) -> None:
    """Let all grains grow from ``scale`` times their rest radius to all of it, relaxing between the steps."""
    full = packing.rest_radius.copy()
    packing.rest_radius = full * scale
    packing.state[2] = packing.rest_radius
    steps = max(1, math.ceil(math.log(1.0 / scale) / math.log1p(GROWTH)))
    for step in range(1, steps + 1):
        larger = scale ** (1.0 - step / steps)
        packing.state[2:] *= larger * full[0] / packing.rest_radius[0] if len(full) else 1.0
        packing.rest_radius = full * larger
        last = step == steps
        _relax(packing, primitives, tolerance if last else ROUGH, 60_000 if last else 3_000)
        if progress is not None:
            progress(step / steps)


def _relax(packing: Packing, primitives: Floats, tolerance: float, max_iterations: int) -> None:
    relaxation = Relaxation(packing, primitives, tolerance=tolerance, max_iterations=max_iterations)
    report = relaxation.run(max_iterations)
    if report.reason in (StopReason.NOT_FINITE, StopReason.COLLAPSED):
        raise InputError(
            f"the grains do not fit ({report.reason}): lower the packing fraction or enlarge the container"
        )
    relaxation.write_back()


def _pressure(packing: Packing, primitives: Floats, area: float) -> float:
    contacts = observables.grain_contacts(packing)
    rigid = observables.body_contacts(packing, primitives) if len(primitives) else None
    return observables.pressure(observables.stress(contacts, area, rigid, packing))


def _to_pressure(
    packing: Packing, primitives: Floats, area: float, target: float, tolerance: float
) -> Packing:
    """Scale the grains, or rather the box around them, until the pressure is within 1 % of ``target`` [k]."""
    if not target > 0.0:
        raise InputError("the target pressure must be greater than 0")
    periodic = packing.box is not None and not len(primitives)
    # In lengths of the large grain a shrinking box is a growing grain, and pressure [k] knows no length: grow the grains here,
    # and give the length back to the box at the end.
    start = packing
    scale, step, below = 1.0, 0.01, False
    for _ in range(120):
        trial = packing.copy()
        trial.rest_radius = start.rest_radius * scale
        trial.state[2:] *= trial.rest_radius[0] / packing.rest_radius[0]
        _relax(trial, primitives, tolerance, 60_000)
        reached = _pressure(trial, primitives, area)
        packing = trial
        if abs(reached - target) <= 0.01 * target:
            break
        # Steps that shrink at each turn, and grow again on the way: not a bracket, since a rearrangement shifts the answer.
        turned, below = below is not (reached < target), reached < target
        step = 0.5 * step if turned else min(1.5 * step, 0.01)
        scale *= 1.0 + step if below else 1.0 / (1.0 + step)
    else:
        raise InputError(
            f"a pressure of {target:g} k could not be reached within 1 %; try a value between 0.001 and 0.3"
        )
    if periodic:
        assert packing.box is not None
        packing.rest_radius = start.rest_radius.copy()
        packing.state /= scale
        packing.box = PeriodicBox(
            packing.box.width / scale, packing.box.height / scale, packing.box.shift / scale
        )
    return packing
