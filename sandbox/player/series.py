"""Moments of one packing as arrays over time: each grain, each contact and each body has a place of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.player.coding import Block, Writer
from sandbox.player.kept import POINTED_AT, QUANTITIES, SQUEEZED, THERE, Floats, Kept
from sandbox.session.frame import BodyShape

PLACE = 1 / 512  # [R] steps of places; of shapes half that
TURN = 1 / 128  # [rad]
LEVELS = 250  # steps up to the top of a scale
OCTAVES = 2  # steps to a factor of two of the unbalanced force: its magnitude is enough
LEAST = 1e-9  # [k R] of it

STEPS = {
    **dict.fromkeys(("x", "y"), PLACE),
    **dict.fromkeys(("p", "q1", "q2", "rest"), PLACE / 2),
    "nu": 1e-3,
    "spin": TURN,
}


@dataclass(frozen=True)
class Tops:
    """What the scales of a page reach up to; a value may go beyond."""

    pressure: float  # [k]
    stress: float  # [k]
    motion: float  # [R]
    force: float  # of contacts [k R]
    hand: float  # [k R]


def grains(writer: Writer, moments: Sequence[Kept], tops: Tops) -> dict[str, Any]:
    """Write what grains do; their labels, and where the blocks are."""
    labels = np.unique(np.concatenate([kept.label for kept in moments]))
    values = np.full((len(QUANTITIES), len(moments), labels.size), np.nan)
    marks = np.zeros((len(moments), labels.size), dtype=np.int64)
    for t, kept in enumerate(moments):
        at = np.searchsorted(labels, kept.label)
        values[:, t, at] = kept.grains
        marks[t, at] = kept.marks
    by_name: dict[str, NDArray[np.float64]] = dict(zip(QUANTITIES, values, strict=True))
    unbalanced = by_name["unbalanced"]
    with np.errstate(invalid="ignore"):
        by_name["unbalanced"] = OCTAVES * np.log2(np.maximum(unbalanced, LEAST) / LEAST)
    steps = {**STEPS, "pressure": tops.pressure / LEVELS, "stress": tops.stress / LEVELS}
    steps |= {"motion": tops.motion / LEVELS, "unbalanced": 1.0}
    blocks = {name: writer.block(by_name[name], steps[name]) for name in QUANTITIES}
    known = bool(np.isfinite(unbalanced).any())
    flags = {"there": THERE, "pointed": POINTED_AT, "squeezed": SQUEEZED}
    marked = {name: writer.block((marks & bit) > 0, 1.0) for name, bit in flags.items()}
    return {"labels": labels.tolist(), "known": known, **blocks, **marked}


def contacts(
    writer: Writer, moments: Sequence[Kept], labels: Sequence[int], top: float
) -> dict[str, Any]:
    """Write all pairs that ever touch, those with bodies last, and what they bear."""
    keys = [_keys(kept) for kept in moments]
    pairs = np.unique(np.concatenate(keys, axis=1), axis=1)
    pairs = pairs[:, np.argsort(pairs[1] < 0, kind="stable")]
    code = _codes(pairs)
    order = np.argsort(code)
    rigid = int(np.count_nonzero(pairs[1] < 0))
    first = pairs.shape[1] - rigid
    force = np.zeros((len(moments), pairs.shape[1]))
    ends = np.full((2, len(moments), rigid), np.nan)
    for t, (kept, key) in enumerate(zip(moments, keys, strict=True)):
        at = order[np.searchsorted(code[order], _codes(key))]
        force[t, at] = np.maximum(kept.force, top / LEVELS)  # what touches is not rounded away
        with_bodies = at[key[1] < 0] - first
        ends[:, t, with_bodies] = kept.ends
    i = np.searchsorted(labels, pairs[0])
    j = np.where(pairs[1] < 0, -1, np.searchsorted(labels, np.maximum(pairs[1], 0)))
    return {
        "i": writer.block(i[:, None], 1.0),
        "j": writer.block(j[:, None], 1.0),
        "force": writer.block(force, top / LEVELS),
        "dx": writer.block(ends[0], 1 / 64),
        "dy": writer.block(ends[1], 1 / 64),
    }


def _keys(kept: Kept) -> NDArray[np.int64]:
    """(2, C): the smaller label and the larger one; for a contact with a body, −1, −2, … in the order of a grain's contacts."""
    first, second = kept.pairs.astype(np.int64)
    rigid = second < 0
    low = np.where(rigid, first, np.minimum(first, second))
    high = np.where(rigid, -1, np.maximum(first, second))
    seen: dict[int, int] = {}
    for k in np.flatnonzero(rigid):
        label = int(low[k])
        seen[label] = seen.get(label, 0) + 1
        high[k] = -seen[label]
    return np.array([low, high])


def _codes(pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    codes: NDArray[np.int64] = (pairs[0] << 32) + pairs[1] + (1 << 16)
    return codes


def bodies(writer: Writer, moments: Sequence[Kept]) -> list[dict[str, Any]]:
    """Write the outlines of bodies; one that changes its make is another body."""
    makes: dict[tuple[Any, ...], list[tuple[int, Floats]]] = {}
    for t, kept in enumerate(moments):
        counts: dict[tuple[Any, ...], int] = {}
        for body in kept.bodies:
            make = (body.role, len(body.discs), len(body.segments), *map(len, body.polygons))
            counts[make] = counts.get(make, -1) + 1
            makes.setdefault((counts[make], *make), []).append((t, _numbers(body)))
    written = []
    for (_, role, discs, segments, *polygons), places in makes.items():
        shape = np.full((len(moments), places[0][1].size), np.nan)
        there = np.zeros((len(moments), 1))
        for t, numbers in places:
            shape[t], there[t] = numbers, 1.0
        where: dict[str, Block] = {
            "shape": writer.block(shape, PLACE),
            "there": writer.block(there, 1.0),
        }
        made = {"role": role, "discs": discs, "segments": segments, "polygons": polygons}
        written.append({**made, **where})
    return written


def _numbers(body: BodyShape) -> Floats:
    """All coordinates and radii of a body, one after the other."""
    parts = [body.discs.ravel(), body.segments.ravel(), *(p.ravel() for p in body.polygons)]
    return np.concatenate(parts).astype(np.float32)


def handles(writer: Writer, moments: Sequence[Kept], top: float) -> list[dict[str, Any]]:
    """Write where handles are, where they are wanted, and the force of the hand on them."""
    written = []
    for k, handle in enumerate(moments[-1].handles):
        rows = np.full((len(moments), 6), np.nan)
        for t, kept in enumerate(moments):
            if k < len(kept.handles):
                now = kept.handles[k]
                rows[t] = now.x, now.y, *(now.target or (now.x, now.y)), now.fx, now.fy
        written.append(
            {
                "name": handle.name,
                "axis": handle.axis,
                "at": writer.block(rows[:, :4], PLACE),
                "force": writer.block(rows[:, 4:], top / LEVELS),
            }
        )
    return written


def box(writer: Writer, moments: Sequence[Kept]) -> dict[str, Any] | None:
    """Write the periodic cell, if there is one; width or height is left out where it is open."""
    cells = np.array([kept.box or (np.inf, np.inf, 0.0) for kept in moments])
    if not np.isfinite(cells[-1, :2]).any():
        return None
    wide, high = map(bool, np.isfinite(cells[-1, :2]))
    return {"wide": wide, "high": high, "size": writer.block(cells, PLACE / 4)}
