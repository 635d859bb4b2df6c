"""Packings of many seeds as one piece: what they have alike once, and of each where its grains are, in whole steps of a grid.

The piece begins with the blocks of the first seed without any state; what those after the first packing have alike with it is 0,
where they are as long. Then come, seed by seed and packing by packing, the parts that differ from seed to seed; and last the
states, all lowest bytes first, then all next ones, as these deflate best. The page unfolds a packing when it is chosen.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.packing import Packing
from sandbox.web.increment.memory import PART, SIZES, Sizes, lengths
from sandbox.web.laid_out import Blocks, part

GRID = 2**20  # of the grid in a radius


def to_grid(packing: Packing) -> None:
    """Move all grains, and their shapes, to the grid: by half a millionth of a radius at most.

    All 52 bits of a random mantissa do not deflate, and are of no use before the first increment has relaxed the packing.
    """
    packing.state[:] = np.rint(packing.state * GRID) / GRID + 0.0  # no number is −0


def packed(blocks: Sequence[Sequence[Blocks]]) -> tuple[dict[str, Any], bytes]:
    """Runs that are laid out on the grid, by seed and packing: how they are read (``Packed`` of ``live.ts``), and the piece."""
    first = blocks[0]
    differing = [_differing([some[kind] for some in blocks]) for kind in range(len(first))]
    rest = [
        part(some[kind], name, length).view(np.uint64)
        for some in blocks
        for kind, parts in enumerate(differing)
        for name, length in parts.items()
    ]
    steps = np.concatenate([_state(both) for some in blocks for both in some]) * GRID
    if not np.array_equal(steps, np.rint(steps)) or np.abs(steps).max(initial=0.0) >= 2**31:
        raise ValueError("grains that are not on the grid, or too far away")
    whole = steps.astype(np.int64)
    folded = np.where(whole < 0, -2 * whole - 1, 2 * whole).astype(
        "<u4"
    )  # small, whatever its sign
    bytewise = folded.view(np.uint8).reshape(-1, 4).T
    about = {
        "steps": GRID,
        "lengths": [[ints.nbytes, floats.nbytes] for ints, floats in first],
        "differing": [
            [
                [_block_of(name), int(both[0][getattr(PART, name)]), length]
                for name, length in parts.items()
            ]
            for both, parts in zip(first, differing, strict=True)
        ],
    }
    return about, b"".join(
        [_against_the_first(first), *(words.tobytes() for words in rest), bytewise.tobytes()]
    )


def _block_of(name: str) -> int:
    """0: whole numbers, 1: others."""
    return int(getattr(PART, name) < PART.label)


def _state(both: Blocks) -> NDArray[np.float64]:
    return part(both, "state", 5 * int(both[0][SIZES.grains]))


def _differing(runs: Sequence[Blocks]) -> dict[str, int]:
    """Parts apart from the state in which runs of one packing differ, and how long they are. All begin at the same places."""
    sizes = Sizes(*map(int, runs[0][0][: len(SIZES)]))
    assert all(np.array_equal(ints[: len(SIZES)], sizes) for ints, _ in runs)
    return {
        name: length
        for name, length in lengths(sizes).items()
        if name != "state"
        and any(
            not np.array_equal(part(runs[0], name, length), part(run, name, length)) for run in runs
        )
    }


def _against_the_first(first: Sequence[Blocks]) -> bytes:
    bare = []
    for ints, floats in first:
        both = ints.copy(), floats.copy()
        _state(both)[:] = 0.0
        bare.append([block.view(np.uint64) for block in both])
    return b"".join(
        (block if both is bare[0] or len(block) != len(model) else block ^ model).tobytes()
        for both in bare
        for block, model in zip(both, bare[0], strict=True)
    )
