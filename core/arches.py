"""The arch that holds back everything above an orifice.

An arch is a chain of grains, each touching the next, whose ends rest on the two sides of the orifice (To, Lai and Pak,
doi:10.1103/PhysRevLett.86.71). Many chains span a clogged orifice; the one that carries is taken to be the lowest: that which
encloses the least area over the line through the lips.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator

import numpy as np

from core.arrays import Floats, Indices
from core.observables import GrainContacts, RigidContacts
from core.packing import Packing

WEAK = 0.1  # of the mean contact force: contacts below it hold nothing
LENGTH_COST = (
    0.05  # [R] a chain also pays for its length, so that none climbs up and down for nothing
)


def arch(
    packing: Packing,
    pairs: GrainContacts,
    bodies: RigidContacts,
    side: Indices,
    base: float,
) -> Indices:
    """Grains of the arch from its left end to its right end, (M,); empty if none spans the orifice.

    ``side`` (K,) says for each contact of ``bodies`` where it supports: −1 left of the orifice, +1 right of it, 0 neither.
    ``base`` [R] is the height of the lips. Of all chains of contacts that carry force the one is taken whose
    Σ |Δx| (height over the base) is least.
    """
    forces = np.concatenate([pairs.normal_force, bodies.normal_force])
    if not len(forces):
        return np.zeros(0, dtype=np.int64)
    weak = WEAK * float(forces.mean())
    x, y = packing.x, packing.y
    carrying = pairs.normal_force > weak
    i, j = pairs.i[carrying], pairs.j[carrying]
    links = _Links(i, j, _costs(x[i], y[i], x[j], y[j], base), len(packing))
    resting = (side != 0) & (bodies.normal_force > weak)
    i = bodies.grain[resting]
    costs = _costs(x[i], y[i], bodies.x[resting], bodies.y[resting], base)
    start: dict[int, float] = {}
    end: dict[int, float] = {}
    for grain, at, cost in zip(i.tolist(), side[resting].tolist(), costs.tolist(), strict=True):
        ends = start if at < 0 else end
        ends[grain] = min(cost, ends.get(grain, np.inf))
    return np.array(_cheapest_chain(links, start, end), dtype=np.int64)


def _costs(x0: Floats, y0: Floats, x1: Floats, y1: Floats, base: float) -> Floats:
    """Areas between links (L,) and the base [R²], and a little for their lengths."""
    height = np.maximum(0.5 * (y0 + y1) - base, 0.0)
    return np.abs(x1 - x0) * height + LENGTH_COST * np.hypot(x1 - x0, y1 - y0)


class _Links:
    """Who touches whom (L,) of N grains, and what that costs."""

    def __init__(self, i: Indices, j: Indices, costs: Floats, grains: int) -> None:
        grain, other = np.array([i, j]).T.ravel(), np.array([j, i]).T.ravel()
        order = np.argsort(grain, kind="stable")
        self._other, self._cost = other[order], np.repeat(costs, 2)[order]
        self._first = np.append(0, np.cumsum(np.bincount(grain, minlength=grains)))

    def of(self, grain: int) -> Iterator[tuple[int, float]]:
        """Those that touch a grain, each with the cost of going there."""
        here = slice(self._first[grain], self._first[grain + 1])
        return zip(self._other[here].tolist(), self._cost[here].tolist(), strict=True)


def _cheapest_chain(links: _Links, start: dict[int, float], end: dict[int, float]) -> list[int]:
    """Dijkstra's algorithm from any of ``start`` to any of ``end``, each with the price of beginning or ending there."""
    best = dict(start)
    came: dict[int, int] = {}
    queue = [(cost, grain) for grain, cost in start.items()]
    heapq.heapify(queue)
    done: set[int] = set()
    cheapest = np.inf  # chain so far: what costs more leads to none that is cheaper
    while queue and queue[0][0] <= cheapest:
        cost, grain = heapq.heappop(queue)
        if grain in done:
            continue
        done.add(grain)
        cheapest = min(cheapest, cost + end.get(grain, np.inf))
        for other, link in links.of(grain):
            if cost + link < best.get(other, np.inf):
                best[other] = cost + link
                came[other] = grain
                heapq.heappush(queue, (cost + link, other))
    reached = [(best[grain] + cost, grain) for grain, cost in end.items() if grain in best]
    if not reached:
        return []
    chain = [min(reached)[1]]
    while chain[-1] in came:
        chain.append(came[chain[-1]])
    return chain[::-1]
