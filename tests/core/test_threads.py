"""Several threads do the same work as one, to the last bit; nobody who did not ask for them pays for them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from core import fire, threads
from core.errors import InputError
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.sweeps import CHUNK
from core.system import System
from tests.core import examples

MOST = threads.most_threads()
several = pytest.mark.skipif(MOST < 2, reason="this machine has one core")
COUNT = 2 * CHUNK + 300  # in three chunks, the last of which is not full


def shaken_grid(periodic: bool) -> Packing:
    """Grains of all kinds, shapes and tilts, every one with neighbours."""
    random = np.random.default_rng(3)
    columns = 48
    place = np.arange(COUNT)
    x, y = 1.9 * np.array([place % columns, place // columns]) + random.uniform(
        -0.3, 0.3, (2, COUNT)
    )
    box = PeriodicBox(1.9 * columns, 1.9 * (COUNT // columns + 1), 0.7) if periodic else None
    packing = Packing(
        x,
        y,
        random.uniform(0.7, 1.0, COUNT),
        random.choice([-0.8, 0.8], COUNT),
        box=box,
    )
    a, b = random.uniform(0.8, 1.1, (2, COUNT))
    packing.set_axes(a, b, random.uniform(-2.0, 2.0, COUNT))
    return packing


def course(number: int, *, periodic: bool) -> tuple[list[object], np.ndarray, np.ndarray]:
    """Reports on the way, and state and forces at the end."""
    packing = shaken_grid(periodic)
    bodies = None if periodic else examples.bodies().primitives()[0]
    relaxation = Relaxation(packing, bodies, tolerance=1e-9, threads=number)
    reports: list[object] = [relaxation.run(n) for n in (1, 60, 7, 150)]
    relaxation.write_back()
    return reports, packing.state, relaxation.forces()


@several
@pytest.mark.slow
@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "among bodies"])
def test_one_and_two_threads_have_the_same_bits(periodic: bool) -> None:
    alone = course(1, periodic=periodic)
    shared = course(2, periodic=periodic)
    assert shared[0] == alone[0]
    assert np.array_equal(shared[1], alone[1])
    assert np.array_equal(shared[2], alone[2])
    # The passes for several threads, on one: what they sum up does not depend on who did it.
    relaxation = Relaxation(shaken_grid(periodic), threads=2)
    relaxation.threads = 1
    numba.set_num_threads(1)
    again = Relaxation(shaken_grid(periodic), threads=2)
    found = relaxation.run(100)
    assert numba.get_num_threads() == 1
    assert again.run(100) == found
    assert numba.get_num_threads() == 2
    assert np.array_equal(relaxation.forces(), again.forces())


@several
@pytest.mark.slow
def test_an_increment_with_friction_on_two_threads() -> None:
    """Through the settings of a run, with every term of it; two chunks."""

    def end(number: int) -> tuple[str, str, list[float]]:
        random = np.random.default_rng(5)
        count = CHUNK + 100
        place = np.arange(count)
        x, y = 1.7 * np.array([place % 40, place // 40]) + random.uniform(-0.1, 0.1, (2, count))
        packing = Packing(x, y, 0.9, random.choice([-0.8, 0.8], count))
        plate = RigidBody(
            "plate",
            position=(33.0, -1.5),
            segments=[(-40.0, 0.0, 40.0, 0.0, 0.4)],
            axis=(0.0, 1.0),
        )
        engine = Quasistatic(
            System(
                packing,
                RigidWorld([plate]),
                Settings(threads=number, max_iterations=300),
                Friction(0.5, count),
                (0.0, -1e-3),
            )
        )
        energies = []
        for step in (1, 2):
            engine.begin({"plate": (33.0, -1.5 + 0.05 * step)})
            increment = engine.relax(10_000)
            assert increment is not None
            assert increment.report.reason in (StopReason.CONVERGED, StopReason.ITERATION_LIMIT)
            energies.append(increment.report.energy)
        assert engine.friction is not None
        return packing.hash(), engine.friction.hash(), energies

    assert end(2) == end(1)


@pytest.mark.parametrize("number", [0, -1, MOST + 1])
def test_impossible_numbers_of_threads(number: int) -> None:
    with pytest.raises(InputError, match=f"between 1 and {MOST}"):
        Relaxation(shaken_grid(True), threads=number)


def test_nothing_is_compiled_for_one_thread() -> None:
    """A relaxation and an increment on one thread: not a kernel for several, no pool of threads."""
    program = (
        "from core import threads\n"
        "from core.relaxation import Relaxation\n"
        "from tests.core import examples\n"
        "assert Relaxation(examples.random_grains(30, 9.0, 5)).run(100).iterations == 100\n"
        "passes = [threads.first_kick, threads.move, threads.all_forces, threads.last_kick]\n"
        "assert not any(p.signatures for p in passes)\n"
        "from numba.np.ufunc import parallel\n"
        "assert not parallel._is_initialized\n"
    )
    subprocess.run(
        [sys.executable, "-c", program], cwd=Path(__file__).parents[2], check=True, timeout=300
    )
    assert Settings().threads == 1


def test_the_kernels_see_no_threads_of_their_own() -> None:
    """On one thread the argument for several is None in every kernel that was compiled."""
    Relaxation(examples.random_grains(30, 9.0, 5)).run(10)
    assert any(str(signature[-1]) == "none" for signature in fire.run.signatures)
    assert threads.share(1, 5000) is None
