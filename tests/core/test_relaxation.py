"""Relaxation: it finds minima, says why it stops, and takes the same steps however it is cut."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation, Report, StopReason
from core.sweeps import collapsed
from tests.core import examples


def dense(seed: int) -> Packing:
    """36 grains of both kinds on a shaken grid in a periodic box: packing fraction by rest area 1."""
    random = np.random.default_rng(seed)
    radius = np.where(random.permutation(36) % 2 == 0, 1.0, 1.0 / 1.4)
    side = float(np.sqrt(np.pi * np.sum(radius**2)))
    x, y = (np.indices((6, 6)).reshape(2, 36) + random.uniform(-0.3, 0.3, (2, 36))) * side / 6.0
    return Packing(x, y, radius, random.choice([-0.8, 0.8], 36), box=PeriodicBox(side, side))


def relax(packing: Packing, **options: float) -> Report:
    settings: dict[str, float] = {"tolerance": 1e-6, "max_iterations": 50_000, **options}
    relaxation = Relaxation(packing, **settings)  # type: ignore[arg-type]
    report = relaxation.run(100_000)
    relaxation.write_back()
    return report


@pytest.mark.parametrize("seed", range(2))
def test_parity_with_lbfgs(seed: int) -> None:
    """SciPy's minimiser on the same energy from the same start. Both must end in a minimum, though not in the same one."""
    optimize = pytest.importorskip("scipy.optimize")
    packing = dense(seed)
    other = packing.copy()

    def objective(values: examples.Floats) -> tuple[float, examples.Floats]:
        other.state[:] = values.reshape(5, -1)
        energy, forces = examples.forces(other)
        return energy, -forces.ravel()

    options = {"maxiter": 20_000, "maxfun": 40_000, "ftol": 0.0, "gtol": 1e-7}
    theirs = optimize.minimize(
        objective, packing.state.ravel(), jac=True, method="L-BFGS-B", options=options
    )
    ours = relax(packing)
    assert ours.reason is StopReason.CONVERGED
    energy, forces = examples.forces(packing)
    assert np.max(np.abs(forces)) == pytest.approx(ours.residual * ours.mean_contact_force)
    assert np.max(np.abs(theirs.jac)) < 1e-5
    assert energy == pytest.approx(ours.energy, rel=1e-12)
    assert 0.5 < theirs.fun / energy < 2.0

    # From beside our minimum there is but one way down. Energies of minima differ by F²/stiffness, second order in residuals.
    start = packing.state + 1e-4 * np.random.default_rng(seed).normal(size=packing.state.shape)
    theirs = optimize.minimize(
        objective, start.ravel(), jac=True, method="L-BFGS-B", options=options
    )
    packing.state[:] = start
    assert relax(packing).energy == pytest.approx(energy, rel=1e-9)
    assert theirs.fun == pytest.approx(energy, rel=1e-9)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(1, 400), min_size=1, max_size=12), st.booleans())
def test_slices_change_nothing(slices: list[int], among_bodies: bool) -> None:
    """Cut into calls of any length the relaxation takes the same course to the last bit."""
    packing = examples.random_grains(25, 9.0, 2) if among_bodies else dense(2)
    primitives = examples.bodies().primitives()[0] if among_bodies else None
    whole = Relaxation(packing, primitives, tolerance=1e-6)
    cut = Relaxation(packing, primitives, tolerance=1e-6)
    expected = whole.run(sum(slices))
    for length in slices:
        report = cut.run(length)
    assert report == expected
    assert np.array_equal(whole._minimizer.state, cut._minimizer.state)
    assert np.array_equal(whole.forces(), cut.forces())


def test_budget_then_iteration_limit() -> None:
    packing = dense(1)
    relaxation = Relaxation(packing, tolerance=1e-6, max_iterations=30)
    first = relaxation.run(10)
    assert (first.reason, first.iterations) == (StopReason.BUDGET, 10)
    last = relaxation.run(1000)
    assert (last.reason, last.iterations) == (StopReason.ITERATION_LIMIT, 30)
    assert relaxation.run(1000) == last
    assert last.residual > 1e-6


def test_a_converged_relaxation_stays_so() -> None:
    relaxation = Relaxation(dense(1), tolerance=1e-3, max_iterations=50_000)
    report = relaxation.run(50_000)
    assert report.reason is StopReason.CONVERGED
    assert report.residual <= 1e-3
    assert relaxation.run(1000) == report
    assert relaxation.report() == report


@pytest.mark.parametrize(
    ("value", "box"),
    [(np.nan, None), (np.nan, PeriodicBox(12.0, 12.0)), (np.inf, None), (-np.inf, None)],
)
@pytest.mark.parametrize("row", range(5))
def test_not_finite_from_the_start(value: float, box: PeriodicBox | None, row: int) -> None:
    packing = dense(1)
    packing.state[row, 4] = value
    packing.box = box
    report = Relaxation(packing).run(100)
    assert report.reason is StopReason.NOT_FINITE
    assert np.isnan(report.residual)


def test_overflow_on_the_way_is_not_finite() -> None:
    """Sizes that are finite while their squares are not."""
    packing = dense(1)
    packing.state[2:, 4] = 1e200, 0.0, 0.0
    packing.box = None
    report = Relaxation(packing).run(100)
    assert report.reason is StopReason.NOT_FINITE
    assert np.isnan(report.residual)


def test_flat_on_the_way_is_pushed_back() -> None:
    """A grain that is flat in the middle of a relaxation is not the end of it: the guard of its area makes it whole again."""
    packing = Packing([0.0, 1.5], [0.0, 0.0])
    packing.set_axes([1.0, 1.0], [1.0, -0.1], 0.3)
    relaxation = Relaxation(packing)
    minimizer = relaxation._minimizer
    flat = 0
    while relaxation.run(1).reason is StopReason.BUDGET:
        flat += bool(collapsed(minimizer.state))
    assert flat > 0
    assert relaxation.report().reason is StopReason.CONVERGED
    relaxation.write_back()
    assert packing.semi_axes[1].min() > 0.5


@pytest.mark.parametrize(
    ("limit", "met"), [(20_000, True), (7, False)], ids=["converged", "at the limit"]
)
def test_flat_at_the_end_is_collapsed(limit: int, met: bool) -> None:
    """Turned inside out (p < 0) a grain comes to rest, and is no grain."""
    packing = Packing([0.0, 1.5], [0.0, 0.0])
    packing.state[2, 1] = -1.3
    relaxation = Relaxation(packing, max_iterations=limit)
    report = relaxation.run(5)
    assert report.reason is StopReason.BUDGET
    report = relaxation.run(20_000)
    assert report.reason is StopReason.COLLAPSED
    assert (report.residual <= 1e-2) is met
    assert report.iterations <= limit
    assert relaxation.run(100) == report


def test_crushed_but_whole() -> None:
    """Twenty times as much grain as room: the guard of the area lets no grain vanish, however bad the start."""
    random = np.random.default_rng(1)
    x, y = random.uniform(0.0, 7.0, (2, 300))
    packing = Packing(x, y, 1.0, 0.8, box=PeriodicBox(7.0, 7.0))
    relaxation = Relaxation(packing, tolerance=1e-6, max_iterations=5000)
    assert relaxation.run(5000).reason is StopReason.CONVERGED
    relaxation.write_back()
    assert packing.semi_axes[1].min() > 0.0


def test_no_grains() -> None:
    packing = Packing([], [])
    report = relax(packing)
    assert (report.reason, report.iterations, report.energy) == (StopReason.CONVERGED, 0, 0.0)
    assert Relaxation(packing, examples.bodies().primitives()[0]).run(5).iterations == 0


def test_one_grain_finds_its_shape() -> None:
    """Alone, a strained grain becomes a circle of its rest radius: the residual is relative to the floor, 1e-3 k R."""
    packing = Packing([2.0], [3.0], 0.7, -0.8)
    packing.set_axes(0.9, 0.6, 0.4)
    report = relax(packing)
    assert report.reason is StopReason.CONVERGED
    assert packing.state[:, 0] == pytest.approx([2.0, 3.0, 0.7, 0.0, 0.0], abs=1e-8)


def test_coincident_centres() -> None:
    """The direction of their force is undefined; nothing becomes nan, and the others relax."""
    packing = Packing([0.0, 0.0, 1.5, 0.0], [0.0, 0.0, 0.3, 1.6])
    report = relax(packing, max_iterations=3000)
    assert report.reason is not StopReason.NOT_FINITE
    assert np.all(np.isfinite(packing.state))


def test_rest_is_left_alone() -> None:
    """No force at all: done after one look, and not a bit is changed."""
    packing = Packing([0.0, 2.5, 0.0], [0.0, 0.0, 2.5], 1.0, [-0.8, 0.0, 0.8])
    before = packing.copy()
    report = relax(packing)
    assert (report.reason, report.iterations, report.residual) == (StopReason.CONVERGED, 1, 0.0)
    assert packing.hash() == before.hash()


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 3000), st.sampled_from([6.0, 9.0]))
def test_never_ends_above_its_start(seed: int, limit: int, size: float) -> None:
    """Not even where it is cut off in the middle. Rounding of the sum: 1e-12 of it."""
    packing = examples.random_grains(25, size, seed)
    start = examples.energy(packing)
    report = relax(packing, max_iterations=limit)
    assert report.start_energy == pytest.approx(start, rel=1e-12)
    if report.reason in (StopReason.CONVERGED, StopReason.ITERATION_LIMIT):
        assert report.energy <= start * (1.0 + 1e-12)
        assert examples.energy(packing) <= start * (1.0 + 1e-12)


@pytest.mark.parametrize("tolerance", [1e-9, 1e-13, 1e-300])
def test_tiny_tolerances(tolerance: float) -> None:
    """Where rounding sets the end it is the iteration limit, and the residual that was reached is told.

    Rounding: an overlap of some 0.01 R is a difference of lengths of some R, so forces are good to some 1e-14 of themselves.
    """
    report = relax(dense(1), tolerance=tolerance, max_iterations=20_000)
    if tolerance > 1e-12:
        assert report.reason is StopReason.CONVERGED
    else:
        assert report.reason is StopReason.ITERATION_LIMIT
        assert report.residual < 1e-10
    assert np.isfinite(report.energy)


@pytest.mark.parametrize("seed", range(3))
def test_nothing_pushes_the_packing_as_a_whole(seed: int) -> None:
    """Contacts act in pairs and all centres have one inertia, so the centre of them all stays. N steps of rounding."""
    packing = dense(seed)
    before = packing.state[:2].mean(axis=1)
    report = relax(packing)
    assert packing.state[:2].mean(axis=1) == pytest.approx(before, abs=1e-15 * report.iterations)


def test_the_packing_changes_on_demand_only() -> None:
    packing = dense(1)
    before = packing.hash()
    relaxation = Relaxation(packing)
    relaxation.run(50)
    assert packing.hash() == before
    relaxation.write_back()
    assert packing.hash() != before


def test_more_contacts_than_room() -> None:
    """Lists that turn out too short are made longer, with the same result as ever."""
    x, y = np.random.default_rng(2).uniform(0.0, 1.0, (2, 60))
    packing = Packing(x, y)
    energy, forces = examples.forces(packing)
    d = np.hypot(packing.x[:, None] - packing.x, packing.y[:, None] - packing.y)
    overlap = (2.0 - d)[np.triu_indices(60, 1)]
    assert energy == pytest.approx(25.0 * np.sum(overlap**2), rel=1e-12)
    assert np.all(np.isfinite(forces))


def test_more_bodies_than_room() -> None:
    rows = np.tile([[0.0, -5.0, 0.0, 1.0, 0.0, 5.0, 0.0, 0.0]], (200, 1))
    energy, forces = examples.forces(Packing([0.0], [0.9]), rows)
    assert energy == pytest.approx(200 * 25.0 * 0.1**2, rel=1e-12)
    assert forces[1, 0] == pytest.approx(200 * 50.0 * 0.1, rel=1e-12)


@pytest.mark.parametrize("options", [{"tolerance": 0.0}, {"tolerance": -1.0}, {"force_floor": 0.0}])
def test_impossible_tolerances(options: dict[str, float]) -> None:
    with pytest.raises(InputError, match="greater than 0"):
        Relaxation(dense(1), **options)  # type: ignore[arg-type]


def test_box_too_small() -> None:
    with pytest.raises(InputError, match="periodic box is too small"):
        Relaxation(Packing([0.0], [0.0], box=PeriodicBox(4.0, 100.0)))
    Relaxation(Packing([0.0], [0.0], box=PeriodicBox(5.0)))
