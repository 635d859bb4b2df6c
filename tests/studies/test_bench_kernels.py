"""The plain kernel of the bench against the program's own, and against the slow twin."""

from __future__ import annotations

import numpy as np
import pytest

from core.packing import PeriodicBox
from core.relaxation import Relaxation
from sandbox.studies.bench import kernels as bench_kernels
from sandbox.studies.bench import scalar_kernel
from tests.core.examples import random_grains

BOXES = [None, PeriodicBox(16.0, 17.0), PeriodicBox(16.0, 17.0, 2.3), PeriodicBox(16.0)]


def listed(box: PeriodicBox | None, seed: int = 3) -> Relaxation:
    relaxation = Relaxation(random_grains(120, 15.0, seed, box))
    relaxation.run(1)
    return relaxation


@pytest.mark.parametrize("box", BOXES)
def test_plain_and_production_kernel_agree(box: PeriodicBox | None) -> None:
    relaxation = listed(box)
    apart = bench_kernels.disagreement(relaxation._minimizer, relaxation._box)
    assert apart < 1e-12


def test_they_agree_on_the_packings_that_are_timed() -> None:
    for periodic in (False, True):
        relaxation = bench_kernels.example(60, periodic=periodic)
        assert (relaxation._box is not None) is periodic
        assert bench_kernels.disagreement(relaxation._minimizer, relaxation._box) < 1e-12


def test_a_difference_would_be_seen() -> None:
    minimizer = listed(None)._minimizer
    width = int(minimizer.lists.width[0])
    later = minimizer.lists.neighbor[:width] < np.arange(width)
    minimizer.lists.stiffness[:width][later] *= 1.001  # the second of the two entries of a pair
    assert bench_kernels.disagreement(minimizer, None) > 1e-6


def test_half_list_holds_each_pair_once() -> None:
    minimizer = listed(BOXES[1])._minimizer
    pairs = bench_kernels.half_list(minimizer)
    entries = int(minimizer.lists.width.sum())
    assert 2 * len(pairs) == entries
    owner = np.repeat(np.arange(120), np.diff(pairs.start))
    assert np.all(owner < pairs.neighbor)
    assert len(set(zip(owner.tolist(), pairs.neighbor.tolist(), strict=True))) == len(pairs)


def test_plain_forces_are_the_slope_of_their_energy() -> None:
    minimizer = listed(BOXES[1])._minimizer
    box = BOXES[1].kernel_form() if BOXES[1] else None
    pairs = bench_kernels.half_list(minimizer)
    force, other = np.empty_like(minimizer.force), np.empty_like(minimizer.force)
    state = minimizer.state.copy()

    def energy(at: np.ndarray, into: np.ndarray) -> float:
        return float(
            scalar_kernel.contact_forces(
                at, pairs.start, pairs.neighbor, pairs.stiffness, box, into
            )
        )

    energy(state, force)
    step = 1e-6
    for row in range(5):
        there, back = state.copy(), state.copy()
        there[row, 17] += step
        back[row, 17] -= step
        slope = (energy(there, other) - energy(back, other)) / (2.0 * step)
        assert -slope == pytest.approx(force[row, 17], rel=1e-6, abs=1e-5)


def test_repeating_changes_nothing() -> None:
    relaxation = listed(None)
    m = relaxation._minimizer
    once = bench_kernels.repeat_pairs(1, m, None)
    forces = m.force.copy()
    assert bench_kernels.repeat_pairs(3, m, None) == once
    np.testing.assert_array_equal(m.force, forces)
    state = m.state.copy()
    bench_kernels.repeat_updates(2, m)
    np.testing.assert_array_equal(m.state, state)


def test_section_names_what_is_compared() -> None:
    section = bench_kernels.section(seconds=0.05, grains=60, scenes={"gravity_hopper": 100})
    assert section.name == "kernels"
    (friction,) = section.data["friction"]
    assert friction["scene"] == "gravity_hopper"
    assert friction["pairs"] > 60
    assert friction["body_pairs"] > 10
    assert len([row for row in section.rows if "friction" in row.what]) == 3
    for case in section.data["pairs"].values():
        assert case["disagreement"] < 1e-12
        assert case["pairs"] > 60
        assert case["plain_ns"]["min"] <= case["plain_ns"]["median"]
        assert case["ratio"] == pytest.approx(
            case["production_ns"]["min"] / case["plain_ns"]["min"]
        )
    assert {"rebuild_us", "forces_us", "update_us", "iteration_us"} < set(section.data["iteration"])
