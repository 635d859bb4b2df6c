"""Other minimisers, other charts, exact contacts: on small packings, against FIRE, the slow twins and finite differences."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.exact import contact_distance
from core.packing import Packing, PeriodicBox
from core.problem import Problem
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from sandbox.studies.accuracy.chart import chart_forces, paper_chart, to_chart, to_smooth
from sandbox.studies.accuracy.exact import ExactProblem, contact, near_contacts
from sandbox.studies.accuracy.peers import l_bfgs_b, newton


def squeezed(seed: int = 3, count: int = 12) -> Packing:
    """A few overlapping grains in a periodic box."""
    rng = np.random.default_rng(seed)
    box = PeriodicBox(7.2, 5.4)
    places = np.array([(x, y) for x in range(4) for y in range(3)], dtype=float)[:count] * 1.8
    x, y = (places + rng.uniform(-0.2, 0.2, places.shape)).T
    nu = np.where(np.arange(count) % 2, -0.8, 0.8)
    return Packing(x, y, 1.0, nu, 50.0, box=box)


def relaxed(packing: Packing, tolerance: float = 1e-10) -> Packing:
    """The same after FIRE."""
    done = packing.copy()
    relaxation = Relaxation(done, tolerance=tolerance, max_iterations=200_000)
    assert relaxation.run(200_000).reason is StopReason.CONVERGED
    relaxation.write_back()
    return done


def test_problem_is_the_relaxations_energy_and_forces() -> None:
    packing = squeezed()
    problem = Problem(Relaxation(packing, tolerance=1e-3), 1e-3)
    z = problem.start()
    _, gradient = problem(z)
    rng = np.random.default_rng(1)
    for _ in range(3):
        way = rng.normal(size=len(z))
        step = 1e-6
        difference = (problem(z + step * way)[0] - problem(z - step * way)[0]) / (2.0 * step)
        assert difference == pytest.approx(float(gradient @ way), rel=1e-5)


def test_lists_are_renewed_when_grains_go_far() -> None:
    packing = squeezed()
    problem = Problem(Relaxation(packing, tolerance=1e-3), 1e-3)
    z = problem.start()
    energy, gradient = problem(z)
    moved = z.copy()
    moved[: len(packing)] += packing.box.width if packing.box else 0.0  # once round: the same place
    again, same = problem(moved)
    assert again == pytest.approx(energy, rel=1e-12)
    assert same == pytest.approx(gradient, abs=1e-11)


@pytest.mark.parametrize(("solve", "tolerance"), [(l_bfgs_b, 1e-5), (newton, 1e-9)])
def test_peers_find_what_fire_finds(solve: object, tolerance: float) -> None:
    start = relaxed(squeezed())
    start.state[:2] += np.random.default_rng(2).normal(scale=1e-3, size=start.state[:2].shape)
    fire = relaxed(start)
    relaxation = Relaxation(start, tolerance=tolerance, max_iterations=1)
    assert callable(solve)
    assert solve(relaxation, tolerance) > 0
    report = relaxation.run(1)
    assert report.reason is StopReason.CONVERGED
    relaxation.write_back()
    exact = Relaxation(fire, tolerance=1e-12, max_iterations=1).run(1)
    assert report.energy == pytest.approx(exact.energy, rel=10.0 * tolerance)


def test_charts_lead_there_and_back() -> None:
    packing = relaxed(squeezed(), 1e-6)
    chart, back = np.empty((5, len(packing))), np.empty((5, len(packing)))
    to_chart(packing.state, chart)
    a, b = packing.semi_axes
    assert chart[3:] == pytest.approx(np.array([a, b]))
    to_smooth(chart, back)
    assert back == pytest.approx(packing.state, abs=1e-14)


def test_forces_in_the_papers_chart_are_the_slopes_of_the_same_energy() -> None:
    packing = relaxed(squeezed(), 1e-2)
    problem = Problem(Relaxation(packing, tolerance=1e-3), 1e-3)
    mass = np.array([1.0, 1.0, 2.0, 2.0, 2.0])[:, None]  # roots of the inertias

    def energy(chart: np.ndarray) -> tuple[float, np.ndarray]:
        smooth = np.empty_like(chart)
        to_smooth(chart, smooth)
        value, gradient = problem((smooth * mass).reshape(-1))
        return value, -gradient.reshape(5, -1) * mass

    chart = np.empty((5, len(packing)))
    to_chart(packing.state, chart)
    _, force = energy(chart)
    turned = np.empty_like(chart)
    chart_forces(chart, force, turned)
    for row in range(5):
        step = 1e-6
        ahead, behind = chart.copy(), chart.copy()
        ahead[row, 4] += step
        behind[row, 4] -= step
        difference = (energy(ahead)[0] - energy(behind)[0]) / (2.0 * step)
        assert -turned[row, 4] == pytest.approx(difference, rel=1e-5, abs=1e-8)


def test_the_papers_chart_relaxes_too() -> None:
    relaxation = Relaxation(squeezed(), tolerance=1e-3, max_iterations=1)
    assert 0 < paper_chart(relaxation, 1e-3) < 60_000
    report = relaxation.run(1)
    assert report.energy < report.start_energy * (1.0 + 1e-12)
    assert report.residual < 1.0


def test_exact_contact_agrees_with_core_exact() -> None:
    packing = Packing([0.0, 1.7], [0.0, 0.4], [1.0, 0.8], 0.8, 50.0)
    packing.set_axes([1.2, 1.0], [0.8, 0.7], [0.3, -1.1])
    dx, dy = 1.7, 0.4
    angle, distance = math.atan2(dy, dx), math.hypot(dx, dy)
    exact = contact(packing.state, 0, 1, dx, dy, 0.0, True)[0]
    law = contact(packing.state, 0, 1, dx, dy, 0.0, False)[0]
    assert exact == pytest.approx(contact_distance(packing, 0, 1, angle) - distance, abs=1e-12)
    assert exact < law


@pytest.mark.parametrize("discs", [False, True])
def test_exact_forces_are_slopes_of_the_exact_energy(discs: bool) -> None:
    packing = squeezed()
    packing.set_axes(1.1, 0.9, np.linspace(0.0, 3.0, len(packing)))
    world = RigidWorld([RigidBody("pin", "body", position=(2.7, 2.7), discs=[(0.0, 0.0, 0.5)])])
    primitives = world.primitives()[0]
    relaxation = Relaxation(packing, primitives if discs else None, tolerance=1e-3)
    near = near_contacts(packing, primitives if discs else np.zeros((0, primitives.shape[1])))
    assert bool((near.second < 0).any()) is discs
    problem = ExactProblem(relaxation, 1e-3, near)
    z = problem.start()
    energy, gradient = problem(z)
    assert energy < Problem(Relaxation(packing, tolerance=1e-3), 1e-3)(z)[0] or discs
    rng = np.random.default_rng(1)
    for _ in range(3):
        way = rng.normal(size=len(z))
        step = 1e-6
        difference = (problem(z + step * way)[0] - problem(z - step * way)[0]) / (2.0 * step)
        assert difference == pytest.approx(float(gradient @ way), rel=1e-4)
