"""A scene on the desk without fast math, by the session and by the page's kernels, in a process of its own.

``python -m tests.web.exact OUT.npz SCENE PACKING SEED STEPS NAME=VALUE … [from=BLOCKS.npz]``: writes the blocks of memory as they
are laid out, and after each increment what the session's state hashes to, what the kernels' does, and how many grains have left.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from core import jit, kernel_cache

Step = tuple[str, float]


def without_fast_math() -> None:
    """Before anything with kernels is imported. What is compiled so is kept apart from all else."""
    target = kernel_cache.target
    kernel_cache.target = lambda: f"{target()} without fast math"
    jit.FAST_MATH = set()


def commands(steps: int) -> dict[int, tuple[str, float]]:
    """What the hand does before which increment: the script, then back, and down again as far as it goes."""
    return {
        0: ("script", 0.0),
        steps // 2: ("move", 0.4),
        steps // 2 + 8: ("move", -3.0),
    }


def main() -> None:
    without_fast_math()
    from sandbox.session.run import Run
    from sandbox.web.increment import course
    from sandbox.web.increment.memory import COUNTS, ROW, Kept
    from sandbox.web.laid_out import laid_out, packing_in, part, state_hash
    from scenes import registry

    out, name, kind, seed, steps, *given = sys.argv[1:]
    scene = registry.get(name)
    named = dict(pair.split("=", 1) for pair in given)
    begun = named.pop("from", None)  # fast math packs grains otherwise in the last bits
    settings = scene.settings(named)
    setup = scene.build(settings, kind, int(seed))
    if begun is not None:
        with np.load(begun) as numbers:
            setup.packing = packing_in((numbers["ints"], numbers["floats"]))
    blocks = laid_out(scene, setup, settings)
    first = tuple(block.copy() for block in blocks)
    kept = Kept(*blocks)
    run = Run(scene, settings, kind, int(seed), setup)
    assert course.advance(kept) == 1
    session_said, kernels_said = [run.state_hash()], [state_hash(blocks)]
    left, shares, curve = [0], [1.0], []
    body = setup.handles[0].body
    driven = setup.world.index(body)
    for step in range(int(steps)):
        what, where = commands(int(steps)).get(step, ("", 0.0))
        if what == "script":
            run.hands.follow_script(True)
            course.command(kept, course.SCRIPT_ON, driven, 0.0, 0.0)
        elif what == "move":
            x, y = setup.world[body].position
            run.hands.grab(body)
            run.hands.move(body, (x, y + where))
            course.command(kept, course.GRAB, driven, 0.0, 0.0)
            course.command(kept, course.MOVE, driven, x, y + where)
        while not run.idle and not run.advance(1000):
            pass
        course.advance(kept)
        session_said.append(run.state_hash())
        kernels_said.append(state_hash(blocks))
        left.append(int(part(blocks, "counts", len(COUNTS))[COUNTS.out]))
        shares.append(run.last.share)
        row = part(blocks, "row", len(ROW))
        newest = run.history[-1]
        curve.append([newest.stroke, row[ROW.stroke], newest.resisting, row[ROW.resisting]])
    np.savez(
        Path(out),
        ints=first[0],
        floats=first[1],
        session=session_said,
        kernels=kernels_said,
        left=left,
        shares=shares,
        curve=curve,
    )


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    main()
