"""A scene on the desk without fast math, by the session and by the page's kernels, in a process of its own.

``python -m tests.web.exact OUT.npz SCENE PACKING SEED STEPS NAME=VALUE … [from=BLOCKS.npz]``: writes the blocks of memory as they
are laid out, and after each increment what the session's state hashes to, what the kernels' does, and how many grains have left;
what both say about it, and how far apart what both show of the grains is at most.

A disc that is dragged anywhere, which pymunk moves on the desk, goes in that session where the page's rule puts it: so what is
compared there is all of the increments but that rule.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from core import jit, kernel_cache

# What is set on the way, where the grains stand.
CHANGED = {
    "hopper": {"regular_poisson_ratio": 0.5},
    "gravity_hopper": {"gravity": 0.02, "fall": 0.05},
    "intruder": {"friction": 0.3},
    "biaxial_press": {"auxetic_poisson_ratio": -0.4},
    "grain_row": {"hand_strength": 3.0},
    "single_grain": {"poisson_ratio": 0.3},
    "couette": {"friction": 0.3},
}
# Where the script begins in a scene: one that shakes now and then is about to.
BEGUN = {"gravity_hopper": 238}
# How far from where the hand wants a body it says that it does [R]: what goes round comes to the nearest image.
AROUND = {"couette": -60.0}


def without_fast_math() -> None:
    """Before anything with kernels is imported. What is compiled so is kept apart from all else."""
    target = kernel_cache.target
    kernel_cache.target = lambda: f"{target()} without fast math"
    jit.FAST_MATH = set()


def for_periodic_cells() -> None:
    """Before kernels of pages are imported, which are made for the one or the other."""
    target = kernel_cache.target
    kernel_cache.target = lambda: f"{target()} periodic"
    from sandbox.web.increment import cell

    cell.PERIODIC = True


def commands(steps: int) -> dict[int, tuple[str, float]]:
    """What the hand does before which increment: the script, then back, and on again as far as it goes [R]."""
    return {
        0: ("script", 0.0),
        steps // 2: ("move", 0.4),
        steps // 2 + 8: ("move", -3.0),
        steps // 2 + 16: ("set", 0.0),
    }


def entries(name: str, settings: Any) -> list[tuple[str, list[float]]]:
    """What is called where ``CHANGED`` is set: entries of the kernels with their values."""
    from sandbox.web.pages import SLIDES

    changed = {**settings, **CHANGED[name]}
    return [slide.called(changed) for slide in SLIDES if slide.name in CHANGED[name]]


def by_the_rule_of_the_page() -> None:
    """Let no body of a session be moved by pymunk."""
    from core.rigid import SAME_POINT, Point, RigidBody, RigidWorld
    from core.rigid_contacts import EDGE
    from sandbox.web.increment import bodies
    from sandbox.web.increment.systems import PLACES, RADIUS, Bodies, X, Y

    def pulled(
        world: RigidWorld, body: RigidBody, wanted: Any, step: float
    ) -> tuple[Point, str | None]:
        del step
        rows, owner = world.primitives()
        places = np.zeros((len(world.bodies), PLACES))
        places[:, : Y + 1] = world.placement()[:, :2]
        here = world.index(body.name)
        places[here, RADIUS] = body.discs[0][2]
        local = rows.copy()
        local[:, 1:3] -= places[owner, : Y + 1]
        edges = rows[:, 0] == EDGE
        local[edges, 5:7] -= places[owner[edges], : Y + 1]
        there = Bodies(places, local, owner, np.zeros((len(rows), 2), dtype=np.int64))
        at = np.array(body.position)
        x, y = bodies.out_of_walls(there, here, at[X] + wanted[0], at[Y] + wanted[1])
        moved = np.array((x, y)) - at
        body.position = (float(x), float(y))
        asked = float(np.hypot(*wanted))
        short = asked > SAME_POINT and float(np.dot(moved, wanted)) < 0.5 * asked**2
        return (float(moved[0]), float(moved[1])), "wall" if short else None

    RigidWorld._pull = pulled  # type: ignore[method-assign, assignment]


def seen(run: Any) -> dict[str, Any]:
    """What the desk shows of the newest increment: a number a grain each."""
    from sandbox.session.take_frame import take

    frame = take(run, False, False, (0, ""))
    return {
        "pressure": frame.pressure,
        "difference": frame.stress_difference,
        "motion": np.hypot(*(frame.motion - frame.motion.mean(axis=1)[:, None]))
        if frame.grains
        else np.zeros(0),
        "squeezed": frame.squeezed,
        "pointed": np.zeros(frame.grains) if frame.highlight is None else frame.highlight,
        "errors": np.array([frame.usual_error, frame.force_error]),
    }


def said_by(run: Any) -> str:
    """What the desk says about the newest increment, and which events have begun in it."""
    course, newest = run.course, len(run.history) - 1
    events = [(e.kind, e.text) for e in run.history.events if e.increment == newest]
    return repr(
        (
            [str(text) for text in (*course.notices, *course.remarks.notices)],
            [(k, str(t)) for k, t in events],
        )
    )


def main() -> None:
    without_fast_math()
    from scenes import registry

    out, name, kind, seed, steps, *given = sys.argv[1:]
    named = dict(pair.split("=", 1) for pair in given)
    begun = named.pop("from", None)  # fast math packs grains otherwise in the last bits
    scene = registry.get(name)
    settings = scene.settings(named)
    if scene.ingredients(settings).periodic:
        for_periodic_cells()
    by_the_rule_of_the_page()
    from sandbox.session.run import Run
    from sandbox.web.increment import course
    from sandbox.web.increment.memory import COUNTS, ROW, Kept
    from sandbox.web.increment.observe import observe
    from sandbox.web.laid_out import laid_out, packing_in, part, state_hash
    from sandbox.web.sentences import told

    setup = scene.build(settings, kind, int(seed))
    if begun is not None:
        with np.load(begun) as numbers:
            setup.packing = packing_in((numbers["ints"], numbers["floats"]))
    blocks = laid_out(scene, setup, settings, kind)
    first = tuple(block.copy() for block in blocks)
    kept = Kept(*blocks)
    run = Run(scene, settings, kind, int(seed), setup)
    assert course.advance(kept) == 1
    session_said, kernels_said = [run.state_hash()], [state_hash(blocks)]
    left, shares, curve = [0], [1.0], []
    said: list[tuple[str, str]] = []
    shown = ("pressure", "difference", "motion", "squeezed", "pointed", "errors")
    apart = dict.fromkeys(shown, 0.0)

    def look() -> None:
        observe(kept)
        said.append((said_by(run), repr(told(blocks, setup.handles[0].label))))
        errors = part(blocks, "row", len(ROW))[ROW.usual_error : ROW.force_error + 1]
        for what, there in seen(run).items():
            here = errors if what == "errors" else part(blocks, what, len(there))
            size = max(float(np.nanmax(np.abs(there), initial=0.0)), 1.0)
            off = np.nan_to_num(np.abs(here - np.asarray(there, dtype=np.float64)))
            off[np.isnan(here) != np.isnan(there)] = np.inf
            apart[what] = max(apart[what], float(np.max(off, initial=0.0)) / size)

    look()
    body = setup.handles[0].body
    driven, direction = setup.world.index(body), setup.handles[0].direction
    for step in range(int(steps)):
        what, where = commands(int(steps)).get(step, ("", 0.0))
        if what == "script":
            run.hands.follow_script(True)
            course.command(kept, course.SCRIPT_ON, driven, 0.0, 0.0)
            run.course.script = BEGUN.get(name, 0)
            part(blocks, "counts", len(COUNTS))[COUNTS.script] = BEGUN.get(name, 0)
        elif what == "move":
            x, y = setup.world[body].position
            run.hands.grab(body)
            x += where * abs(direction[0]) + AROUND.get(name, 0.0)
            y += where * abs(direction[1])
            run.hands.move(body, (x, y))
            course.command(kept, course.GRAB, driven, 0.0, 0.0)
            course.command(kept, course.MOVE, driven, x, y)
        elif what == "set":
            run.adjust({**settings, **CHANGED[name]}, frozenset(CHANGED[name]))
            for entry, values in entries(name, settings):
                getattr(course, entry)(kept, *values)
        while not run.idle and not run.advance(1000):
            pass
        if course.advance(kept):
            look()
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
        said=said,
        apart=list(apart.values()),
    )


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    main()
