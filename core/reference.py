"""Slow, plain twins of the kernels, from the equations in the paper's chart (x, y, θ, a, b).

Haver et al., doi:10.1073/pnas.2317915121, appendix "Numerical model", with the slips of its printed
form mended; numbers in brackets are equations of MODEL.md. For tests and notebooks: the program
never imports this. Nothing is shared with the kernels but the layout of a packing and of the rows
of ``primitives``: no smooth chart, no double angles, no cells, no Newton steps.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from core.arrays import Floats
from core.packing import Packing, PeriodicBox
from core.rigid_contacts import DISC, EDGE

Vector = tuple[float, float]


class Ellipse(NamedTuple):
    """One grain: centre [R], angle θ of the semi-axis a [rad], semi-axes a, b [R], either longer."""

    x: float
    y: float
    theta: float
    a: float
    b: float


class Slopes(NamedTuple):
    """Half-width h [R] of an ellipse along a direction α, and its derivatives."""

    h: float
    by_a: float
    by_b: float
    by_theta: float  # over a² − b²: finite and of use for a circle, where θ means nothing [1/R]
    by_alpha: float  # [R]


def ellipses(packing: Packing) -> list[Ellipse]:
    """The grains of a packing in the paper's chart."""
    a, b = packing.semi_axes
    columns = (packing.x, packing.y, packing.angle, a, b)
    return [Ellipse(*map(float, row)) for row in zip(*columns, strict=True)]


def half_width(grain: Ellipse, alpha: float) -> Slopes:
    """h(α)² = a² cos²(α−θ) + b² sin²(α−θ), the support function of the ellipse (4)."""
    c, s = math.cos(alpha - grain.theta), math.sin(alpha - grain.theta)
    h = math.sqrt((grain.a * c) ** 2 + (grain.b * s) ** 2)
    by_theta = c * s / h
    by_alpha = -(grain.a**2 - grain.b**2) * by_theta
    return Slopes(h, grain.a * c * c / h, grain.b * s * s / h, by_theta, by_alpha)


def elasticity(packing: Packing, i: int, grain: Ellipse) -> tuple[float, float, float]:
    """A grain's own energy [k R²] and the forces on its semi-axes a, b [k R] (2)."""
    nu, stiffness = float(packing.poisson_ratio[i]), float(packing.contact_stiffness[i])
    rest_area = float(packing.rest_radius[i]) ** 2
    kappa = 4.0 * stiffness / ((stiffness - 2.0) * (1.0 - nu**2))
    excess, skew = grain.a * grain.b - rest_area, grain.a - grain.b
    pressure = 0.5 * kappa * (1.0 + nu) * excess / rest_area
    tension = 0.5 * kappa * (1.0 - nu) * skew
    energy = 0.5 * pressure * excess + 0.5 * tension * skew
    return energy, -pressure * grain.b - tension, -pressure * grain.a + tension


def nearest_image(box: PeriodicBox | None, dx: float, dy: float) -> Vector:
    """The shortest of all images of a separation [R], found by trying those around it."""
    if box is None:
        return dx, dy
    best = (dx, dy)
    ups = [0]
    if math.isfinite(box.height):
        level = -math.floor(dy / box.height)
        ups = [level - 1, level, level + 1]
    for up in ups:
        x, y = dx, dy
        if up:
            x, y = dx + up * box.shift, dy + up * box.height
        if math.isfinite(box.width):
            x = min((x - (math.floor(x / box.width) + k) * box.width for k in (0, 1)), key=abs)
        if up == ups[0] or math.hypot(x, y) < math.hypot(*best):
            best = (x, y)
    return best


def near_pairs(packing: Packing, skin: float) -> set[tuple[int, int]]:
    """All pairs i < j whose centres are closer than their longer semi-axes and the skin."""
    longest = packing.semi_axes[0]
    found = set()
    for i in range(len(packing)):
        for j in range(i + 1, len(packing)):
            d = nearest_image(packing.box, packing.x[j] - packing.x[i], packing.y[j] - packing.y[i])
            if math.hypot(*d) < longest[i] + longest[j] + skin:
                found.add((i, j))
    return found


class Contact(NamedTuple):
    """What one contact does to one grain."""

    overlap: float  # Δ [R]
    normal_force: float  # f = C Δ [k R]
    n: Vector  # unit vector on which the overlap is measured, from the other body to the grain
    force: Vector  # on the grain's centre [k R]
    slopes: Slopes  # of the grain's half-width along n
    point: Vector  # where a rigid body feels the opposite of ``force`` [R]


def grain_contact(packing: Packing, grains: list[Ellipse], i: int, j: int) -> Contact | None:
    """Contact of grain i with grain j, or None; the force is the one on grain i.

    Δ = h_i + h_j − r on the line of centres (5); the force is not along it (6).
    """
    dx, dy = nearest_image(packing.box, grains[i].x - grains[j].x, grains[i].y - grains[j].y)
    r = math.hypot(dx, dy)
    alpha = math.atan2(dy, dx)
    mine, other = half_width(grains[i], alpha), half_width(grains[j], alpha)
    overlap = mine.h + other.h - r
    if overlap <= 0.0:
        return None
    c_i, c_j = float(packing.contact_stiffness[i]), float(packing.contact_stiffness[j])
    f = 2.0 * c_i * c_j / (c_i + c_j) * overlap
    force = _along_and_across(f, (dx / r, dy / r), -f * (mine.by_alpha + other.by_alpha) / r)
    return Contact(overlap, f, (dx / r, dy / r), force, mine, (math.nan, math.nan))


def rigid_contact(
    stiffness: float, grain: Ellipse, row: Floats, has_ends: bool = True
) -> Contact | None:
    """Contact of a grain with one row of ``primitives``, or None (7, 8, 9)."""
    kind, x0, y0, ux, uy, wx, wy, radius = map(float, row)
    if kind == DISC:
        dx, dy = grain.x - x0, grain.y - y0
        r = math.hypot(dx, dy)
        mine = half_width(grain, math.atan2(dy, dx))
        overlap = mine.h + radius - r
        if overlap <= 0.0:
            return None
        f = stiffness * overlap
        force = _along_and_across(f, (dx / r, dy / r), -f * mine.by_alpha / r)
        return Contact(overlap, f, (dx / r, dy / r), force, mine, (x0, y0))
    if kind == EDGE:
        before, behind = _past(grain, (x0, y0), (-ux, -uy)), _past(grain, (wx, wy), (ux, uy))
        if has_ends and max(before, behind) > 0.0:
            return None
        alpha = math.atan2(*_facing_normal(grain, (x0, y0), (ux, uy))[::-1])
    else:
        for along in ((ux, uy), (wx, wy)):
            if along != (0.0, 0.0) and _past(grain, (x0, y0), along) <= 0.0:
                return None
        alpha = _nearest_direction(grain, (x0, y0))
    n = (math.cos(alpha), math.sin(alpha))
    mine = half_width(grain, alpha)
    overlap = mine.h + radius - n[0] * (grain.x - x0) - n[1] * (grain.y - y0)
    if overlap <= 0.0:
        return None
    f = stiffness * overlap
    return Contact(overlap, f, n, (f * n[0], f * n[1]), mine, _touching_point(grain, n, mine))


def beside(grain: Ellipse, row: Floats, box: PeriodicBox | None) -> Ellipse:
    """The periodic image of a grain that is nearest to a primitive, for an edge to its middle: first in y, then in x."""
    if box is None:
        return grain
    x, y = float(row[1]), float(row[2])
    if row[0] == EDGE:
        x, y = 0.5 * (x + float(row[5])), 0.5 * (y + float(row[6]))
    dx, dy = grain.x - x, grain.y - y
    if math.isfinite(box.height):
        up = round(dy / box.height)
        dx, dy = dx - up * box.shift, dy - up * box.height
    if math.isfinite(box.width):
        dx -= round(dx / box.width) * box.width
    return grain._replace(x=x + dx, y=y + dy)


def periods(box: PeriodicBox | None) -> list[Vector]:
    """The ways from the cell to the image beside it and to the nearest of those above it [R]."""
    if box is None:
        return []
    beside_it = [(box.width, 0.0)] if math.isfinite(box.width) else []
    if not math.isfinite(box.height):
        return beside_it
    shifts = [box.shift]
    if beside_it:
        turns = math.floor(box.shift / box.width)
        shifts = [box.shift - turns * box.width, box.shift - (turns + 1) * box.width]
    return [*beside_it, (min(shifts, key=abs), box.height)]


def runs_around(row: Floats, box: PeriodicBox | None) -> bool:
    """True for an edge along a periodic direction that is as long as the cell: it has no ends."""
    way = row[5:7] - row[1:3]
    return row[0] == EDGE and any(
        abs(row[3] * vy - row[4] * vx) < 1e-9 and math.hypot(*way) > math.hypot(vx, vy) - 1e-9
        for vx, vy in periods(box)
    )


def around_the_cell(primitives: Floats, box: PeriodicBox | None) -> dict[int, Floats]:
    """The rows by number, without the vertices of edges that have no ends, and with one for two free ends that meet."""
    ends = [
        (end, row[7]) for row in primitives if runs_around(row, box) for end in (row[1:3], row[5:7])
    ]
    rows = {
        m: row.copy()
        for m, row in enumerate(primitives)
        if row[0] in (EDGE, DISC)
        or not any(math.dist(row[1:3], end) < 1e-9 and row[7] == radius for end, radius in ends)
    }
    free = [m for m, row in rows.items() if row[0] not in (EDGE, DISC) and not row[5:7].any()]
    for vx, vy in periods(box):
        for m, n in itertools.permutations(free, 2):
            if m in rows and n in rows and rows[m][7] == rows[n][7]:
                image = rows[m][1] + vx, rows[m][2] + vy
                if math.dist(image, rows[n][1:3]) < 1e-9:
                    rows[m][5:7] = rows.pop(n)[3:5]
    return rows


def _along_and_across(f: float, n: Vector, across: float) -> Vector:
    """f n + across t, with t = n turned by a right angle counter-clockwise."""
    return f * n[0] - across * n[1], f * n[1] + across * n[0]


def _facing_normal(grain: Ellipse, point: Vector, along: Vector) -> Vector:
    """The normal of a line, on the side where the grain's centre is."""
    side = along[0] * (grain.y - point[1]) - along[1] * (grain.x - point[0])
    return (-along[1], along[0]) if side >= 0.0 else (along[1], -along[0])


def _touching_point(grain: Ellipse, n: Vector, slopes: Slopes) -> Vector:
    """The point of an ellipse that lies farthest against n: x − h n − h' t."""
    return (
        grain.x - slopes.h * n[0] + slopes.by_alpha * n[1],
        grain.y - slopes.h * n[1] - slopes.by_alpha * n[0],
    )


def _past(grain: Ellipse, end: Vector, along: Vector) -> float:
    """How far beyond the end of an edge the grain touches the edge's line [R].

    ``along`` points along the edge to that end.
    """
    n = _facing_normal(grain, end, along)
    x, y = _touching_point(grain, n, half_width(grain, math.atan2(n[1], n[0])))
    return (x - end[0]) * along[0] + (y - end[1]) * along[1]


def _nearest_direction(grain: Ellipse, point: Vector) -> float:
    """The angle α that minimises h(α) − n·d (8).

    Scan the circle, then halve the interval in which the slope changes sign.
    """
    dx, dy = grain.x - point[0], grain.y - point[1]

    def value(alpha: float) -> float:
        return half_width(grain, alpha).h - math.cos(alpha) * dx - math.sin(alpha) * dy

    def slope(alpha: float) -> float:
        return half_width(grain, alpha).by_alpha + math.sin(alpha) * dx - math.cos(alpha) * dy

    step = 2.0 * math.pi / 360
    best = min((k * step for k in range(360)), key=value)
    low, high = best - step, best + step
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slope(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)


def _contacts(
    packing: Packing, grains: list[Ellipse], primitives: Floats | None
) -> Iterator[tuple[int, float, Contact]]:
    """(grain, its share of the energy, contact) for each side of every contact with a force."""
    for i, j in sorted(near_pairs(packing, 0.0)):
        for me, other in ((i, j), (j, i)):
            contact = grain_contact(packing, grains, me, other)
            if contact is not None:
                yield me, 0.5, contact
    if primitives is not None:
        yield from ((i, 1.0, c) for _, i, c in _with_bodies(packing, grains, primitives))


def _with_bodies(
    packing: Packing, grains: list[Ellipse], primitives: Floats
) -> Iterator[tuple[int, int, Contact]]:
    """(primitive, grain, contact) for every contact with a body that has a force."""
    for m, row in around_the_cell(primitives, packing.box).items():
        has_ends = not runs_around(row, packing.box)
        for i, grain in enumerate(grains):
            image = beside(grain, row, packing.box)
            contact = rigid_contact(float(packing.contact_stiffness[i]), image, row, has_ends)
            if contact is not None:
                yield m, i, contact


def energy_and_forces(packing: Packing, primitives: Floats | None = None) -> tuple[float, Floats]:
    """Energy [k R²] (1) and its negative gradient in the paper's chart, rows x, y, θ, a, b (5, N).

    Forces in [k R]. The row of θ is divided by a² − b², which vanishes for a circle [k]: multiply
    by it for the torque that turns the shape.
    """
    grains = ellipses(packing)
    energy, forces = 0.0, np.zeros((5, len(grains)))
    for i, grain in enumerate(grains):
        own, on_a, on_b = elasticity(packing, i, grain)
        energy += own
        forces[3:, i] = on_a, on_b
    for i, share, contact in _contacts(packing, grains, primitives):
        energy += share * 0.5 * contact.normal_force * contact.overlap
        slopes = contact.slopes
        pushed = (slopes.by_theta, slopes.by_a, slopes.by_b)
        forces[:2, i] += contact.force
        forces[2:, i] -= [contact.normal_force * slope for slope in pushed]
    return energy, forces


def to_smooth_chart(packing: Packing, forces: Floats) -> Floats:
    """Forces as ``energy_and_forces`` gives them (5, N) → forces on x, y, p, q1, q2 (5, N) [k R].

    Chain rule (3): p moves a and b together, a change of |q| moves them apart, and a change across
    q turns the grain by 1/(a−b), which the a² − b² left out of the row of θ makes up for.
    """
    fx, fy, turn, on_a, on_b = forces
    a, b = packing.semi_axes
    c, s = np.cos(2.0 * packing.angle), np.sin(2.0 * packing.angle)
    radial, across = on_a - on_b, (a + b) * turn
    return np.array([fx, fy, on_a + on_b, c * radial - s * across, s * radial + c * across])


def reactions(packing: Packing, primitives: Floats) -> Floats:
    """Force of the grains on each primitive [k R], and torque about the origin [k R²], (M, 3)."""
    total = np.zeros((len(primitives), 3))
    for m, _, contact in _with_bodies(packing, ellipses(packing), primitives):
        (fx, fy), (x, y) = contact.force, contact.point
        total[m] -= fx, fy, x * fy - y * fx
    return total
