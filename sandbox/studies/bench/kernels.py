"""Pair forces against the plain kernel, what friction and bodies add, and what an iteration is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core import contacts, elasticity, fire, rigid_contacts, sweeps
from core.arrays import Floats
from core.friction import Friction
from core.generate import Recipe, pack
from core.jit import kernel
from core.minimizer import relist
from core.relaxation import Relaxation
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.studies.bench import scalar_kernel
from sandbox.studies.bench.report import Row, Section, at_most
from sandbox.studies.bench.times import Times, in_turn

GRAINS, PACKING_FRACTION = 1000, 0.9
CASES = {"without a box": False, "periodic box": True}
RATIO = 0.45  # production over plain, time per listed pair
FRICTION = 0.5  # coefficient
FRICTION_SIZES = {"hopper": 300, "gravity_hopper": 200}
FRICTION_RATIO = 1.2  # an evaluation of the forces with friction over one without
BODY_RATIO = (
    1.3  # a pair of a grain and a body over one of two grains, with what each grain costs besides
)
SETTLE = 10  # increments before friction is measured
BEST_KNOWN = 7.7  # [ns] a pair, the fastest layout in pure Numba found before this program …
BEST_KNOWN_PLAIN = 20.7  # [ns] … where a plain kernel took this


@dataclass(frozen=True)
class HalfList:
    """Each near pair once: the partners of grain i are neighbor[start[i]:start[i + 1]]."""

    start: NDArray[np.int64]  # (N + 1,)
    neighbor: NDArray[np.int64]  # (P,)
    stiffness: Floats  # (P,) [k]

    def __len__(self) -> int:
        return len(self.neighbor)


def half_list(minimizer: fire.Minimizer) -> HalfList:
    """The pairs of the production lists, each once, for the plain kernel: the same pairs, the same order of grains."""
    lists, count = minimizer.lists, minimizer.state.shape[1]
    first, second, stiffness = [], [], []
    for width, offset in zip(lists.width, lists.offset, strict=True):
        grain = np.arange(width)
        partner = lists.neighbor[offset : offset + width].astype(np.int64)
        once = grain < partner
        first.append(grain[once])
        second.append(partner[once])
        stiffness.append(lists.stiffness[offset : offset + width][once])
    i, j, c = (np.concatenate(part) for part in (first, second, stiffness))
    order = np.lexsort((j, i))
    return HalfList(np.searchsorted(i[order], np.arange(count + 1)), j[order], c[order])


@kernel
def repeat_pairs(times, m, box):
    """The production pair forces of a whole packing, several times, for the clock."""
    energy = 0.0
    for _ in range(times):
        state, force, support, lists = m.state, m.force, m.support, m.lists
        contacts.prepare(
            state[2],
            state[3],
            state[4],
            support[0],
            support[1],
            support[2],
            force[0],
            force[1],
            force[2],
            force[3],
            force[4],
        )
        energy = contacts.add_contact_forces(
            0,
            state.shape[1],
            state,
            support,
            force,
            lists.width,
            lists.offset,
            lists.neighbor,
            lists.stiffness,
            box,
        )
    return energy


@kernel
def repeat_forces(times, m, box, rigid, friction, weight):
    """All forces of a packing, several times, for the clock."""
    energy = 0.0
    for _ in range(times):
        energy = fire.evaluate(m, box, rigid, friction, weight, None)
    return energy


@kernel
def repeat_bodies(times, m, box, rigid, friction):
    """Those of bodies on grains alone. The forces grow; nobody looks at them."""
    energy = 0.0
    for _ in range(times):
        energy += rigid_contacts.add_rigid_forces(
            m.state, m.support, m.grains.contact_stiffness, m.force, rigid, box, friction
        )
    return energy


@kernel
def repeat_updates(times, m):
    """What FIRE does besides forces, on a copy, several times, for the clock; dt is 0, so that nothing moves."""
    state, velocity = m.state.reshape(-1), m.velocity.reshape(-1)
    force, inverse_mass = m.force.reshape(-1), m.inverse_mass.reshape(-1)
    chunk = sweeps.CHUNK * m.state.shape[0]
    total = 0.0
    for _ in range(times):
        total += sweeps.first_kick(velocity, force, inverse_mass, 0.9, 0.0, chunk)
        sweeps.drift(state, velocity, 0.0)
        power, force_square, speed_square, most = sweeps.last_kick(
            velocity, force, inverse_mass, 0.0, chunk
        )
        total += power + force_square + speed_square + most
    return total


def example(grains: int, *, periodic: bool) -> Relaxation:
    """A dense periodic packing of mixed grains with fresh neighbour lists; or the same grains in the open."""
    packing = pack(Recipe("mixed"), seed=1, count=grains, packing_fraction=PACKING_FRACTION)
    if not periodic:
        packing.box = None
    relaxation = Relaxation(packing, tolerance=1e-14, max_iterations=1_000_000_000)
    relaxation.run(1)
    return relaxation


def disagreement(minimizer: fire.Minimizer, box: tuple[float, ...] | None) -> float:
    """Largest difference between the forces and energies of both kernels, over the largest force."""
    pairs = half_list(minimizer)
    plain = np.empty_like(minimizer.force)
    energy = float(
        scalar_kernel.contact_forces(
            minimizer.state, pairs.start, pairs.neighbor, pairs.stiffness, box, plain
        )
    )
    fast_energy = float(repeat_pairs(1, minimizer, box))
    p, q1, q2 = minimizer.state[2:5]
    nothing = np.zeros_like(p)
    elasticity.finish(p, q1, q2, nothing, nothing, nothing, *minimizer.force[2:5])
    largest = max(float(np.abs(plain).max()), 1e-300)
    worst = float(np.abs(minimizer.force - plain).max()) / largest
    return max(worst, abs(fast_energy - energy) / max(abs(energy), 1e-300))


def measure_pairs(grains: int, seconds: float) -> dict[str, dict[str, Any]]:
    """Nanoseconds per listed pair of both kernels, without and with a periodic box, and how far they disagree.

    All four are timed in turn, so that a neighbour on the same machine who is busy for seconds spoils none of them.
    """
    jobs: dict[str, Callable[[int], object]] = {}
    counts, apart = {}, {}
    for case, periodic in CASES.items():
        relaxation = example(grains, periodic=periodic)
        m, box = relaxation._minimizer, relaxation._box
        pairs, force = half_list(m), np.empty_like(m.force)
        jobs[f"plain {case}"] = partial(
            scalar_kernel.repeat,
            state=m.state,
            start=pairs.start,
            neighbor=pairs.neighbor,
            stiffness=pairs.stiffness,
            box=box,
            force=force,
        )
        jobs[f"production {case}"] = partial(repeat_pairs, m=m, box=box)
        counts[case], apart[case] = len(pairs), disagreement(m, box)
    times = in_turn(jobs, seconds=seconds)
    found = {}
    for case in CASES:
        plain, fast, unit = times[f"plain {case}"], times[f"production {case}"], 1e-9 * counts[case]
        found[case] = {
            "grains": grains,
            "pairs": counts[case],
            "plain_ns": plain.data(unit),
            "production_ns": fast.data(unit),
            "ratio": fast.least / plain.least,
            "ratio_of_medians": fast.middle / plain.middle,
            "disagreement": apart[case],
        }
    return found


def measure_iteration(grains: int, seconds: float) -> dict[str, Any]:
    """Microseconds of a rebuild of the lists, of all forces, of the FIRE update, and of a whole iteration."""
    relaxation = example(grains, periodic=True)
    m, box, skin = relaxation._minimizer, relaxation._box, relaxation._limits.skin
    whole = example(grains, periodic=True)

    def rebuild(times: int) -> None:
        for _ in range(times):
            relist(m, box, None, skin)

    jobs: dict[str, Callable[[int], object]] = {
        "rebuild": rebuild,
        "forces": lambda n: repeat_forces(n, m, box, None, None, None),
        "update": lambda n: repeat_updates(n, m),
        "iteration": lambda n: whole.run(n),
    }
    times: dict[str, Times] = in_turn(jobs, seconds=seconds)
    return {"grains": grains, **{f"{name}_us": t.data(1e-6) for name, t in times.items()}}


def rubbing(scene: str, grains: int) -> tuple[Relaxation, Relaxation]:
    """A scene's grains after some increments, near new lists, with friction and without."""
    session = Session(scene, "mixed", 1, {"grains": grains})
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < SETTLE and not (done and session.idle):
        done += session.advance(1000)
    engine = session.run.engine
    primitives, owner = engine.world.primitives()
    still = engine.world.placement()
    friction = Friction(FRICTION, len(engine.packing))
    origin = friction.begin(engine.packing, primitives, owner, still, still)
    both = [
        Relaxation(engine.packing, primitives, one, engine.system.gravity, tolerance=1e-14)
        for one in (origin, None)
    ]
    for relaxation in both:
        relaxation.run(1)
    return both[0], both[1]


def measure_friction(sizes: Mapping[str, int], seconds: float) -> list[dict[str, Any]]:
    """What friction adds to an evaluation of the forces, and what a pair with a body costs."""
    found = []
    for scene, grains in sizes.items():
        jobs: dict[str, Callable[[int], object]] = {}
        for name, relaxation in zip(("with", "without"), rubbing(scene, grains), strict=True):
            m, box, rigid = relaxation._minimizer, relaxation._box, relaxation._rigid
            terms = relaxation.friction_terms
            forces = partial(repeat_forces, m=m, box=box, friction=terms, weight=relaxation._weight)
            jobs[f"forces {name}"] = partial(forces, rigid=rigid)
            jobs[f"grains {name}"] = partial(forces, rigid=None)
            jobs[f"bodies {name}"] = partial(
                repeat_bodies, m=m, box=box, rigid=rigid, friction=terms
            )
        times = in_turn(jobs, seconds=seconds / len(sizes))
        assert rigid is not None
        one: dict[str, Any] = {"scene": scene, "grains": m.state.shape[1]}
        one["pairs"], one["body_pairs"] = int(m.lists.width.sum()) // 2, int(rigid.used[0])
        one |= {f"{name.replace(' ', '_')}_us": t.data(1e-6) for name, t in times.items()}
        found.append(one)
    return found


def rows_of_friction(one: dict[str, Any]) -> list[Row]:
    """What is shown of one scene."""
    rubbed, smooth = _least(one, "forces_with_us"), _least(one, "forces_without_us")
    rows = [
        Row(
            f"forces with friction / without, {one['scene']}, N = {one['grains']}",
            f"{rubbed:.1f} / {smooth:.1f} µs = {rubbed / smooth:.2f}",
            *at_most(rubbed / smooth, FRICTION_RATIO, f"{FRICTION_RATIO}"),
        )
    ]
    for name in ("with", "without"):
        body = 1e3 * _least(one, f"bodies_{name}_us") / one["body_pairs"]
        pair = 1e3 * _least(one, f"grains_{name}_us") / one["pairs"]
        rows.append(
            Row(
                f"a grain and a body / all of two grains, {name} friction, {one['scene']}",
                f"{body:.1f} / {pair:.1f} ns a listed pair = {body / pair:.2f}",
                *at_most(body / pair, BODY_RATIO, f"{BODY_RATIO}"),
            )
        )
    return rows


def section(
    *, seconds: float, grains: int = GRAINS, scenes: Mapping[str, int] = FRICTION_SIZES
) -> Section:
    """The part of the bench about kernels; ``scenes``: those that friction is looked at in, with their grains."""
    cases = measure_pairs(grains, 0.6 * seconds)
    iteration = measure_iteration(grains, 0.2 * seconds)
    friction = measure_friction(scenes, 0.2 * seconds)
    rows = []
    for name, case in cases.items():
        plain, fast, ratio = _least(case, "plain_ns"), _least(case, "production_ns"), case["ratio"]
        rows += [
            Row(
                f"pair forces, {name}: this program / plain scalar Numba",
                f"{fast:.1f} / {plain:.1f} ns a listed pair = {ratio:.2f} "
                f"(medians {case['ratio_of_medians']:.2f}); they agree to {case['disagreement']:.0e}",
                *at_most(ratio, RATIO, f"{RATIO}"),
            )
        ]
    best = BEST_KNOWN / BEST_KNOWN_PLAIN
    relative = float(cases["periodic box"]["ratio"]) / best
    rows += [
        Row(
            "the same over the best layout known before, periodic",
            f"{relative:.2f}",
            *at_most(relative, 1.3, "1.3"),
        ),
        Row(
            f"one iteration at N = {grains}, periodic",
            f"{_least(iteration, 'iteration_us'):.1f} µs: forces {_least(iteration, 'forces_us'):.1f}, "
            f"FIRE update {_least(iteration, 'update_us'):.1f}",
        ),
        Row(
            f"rebuild of the neighbour lists at N = {grains}",
            f"{_least(iteration, 'rebuild_us'):.0f} µs",
        ),
    ]
    rows += [row for one in friction for row in rows_of_friction(one)]
    data = {"pairs": cases, "iteration": iteration, "friction": friction}
    return Section("kernels", "Kernels, one core", tuple(rows), data)


def _least(data: dict[str, Any], name: str) -> float:
    times = data[name]
    return float(times["min"])
