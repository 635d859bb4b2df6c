"""The same increments solved by other means: SciPy's L-BFGS-B, and a Newton polish as a check that shares nothing with FIRE.

Both see exactly what FIRE sees: the compiled energy and forces, the prediction to start from, the tolerance and the way to
measure it. Friction is a field of forces and no gradient, so there is no energy to go down: there SciPy's DF-SANE looks for the
root of the forces. Written for ``Knobs.solve``: they leave their answer in the relaxation.
"""

from __future__ import annotations

import numpy as np

from core.arrays import Floats
from core.problem import Problem
from core.relaxation import Relaxation

MEMORY = 10  # pairs that L-BFGS-B remembers: 5 to 40 were tried, and make no difference
MOST_EVALUATIONS = 60_000
NEWTON_FROM = 1e-5  # relative residual at which the polish takes over from L-BFGS-B
NEWTON_STEPS = 12
DIFFERENCE = 1e-7  # [R] of the finite differences of the Hessian
SHIFT = 1e-8  # of the stiffest diagonal entry: holds rattlers, whose stiffness is nil


MOST_OF_ROOT = 20_000  # evaluations of DF-SANE


class _Solved(Exception):
    """The tolerance is met, or the evaluations are used up."""


def l_bfgs_b(relaxation: Relaxation, tolerance: float) -> int:
    """SciPy's L-BFGS-B, stopped at its first evaluation that meets the tolerance. Returns its evaluations."""
    problem = Problem(relaxation, tolerance)
    minimize(problem)
    return problem.evaluations


def df_sane(relaxation: Relaxation, tolerance: float) -> int:
    """SciPy's DF-SANE, a spectral method for roots that needs no energy, stopped as ``l_bfgs_b``. Returns its evaluations."""
    from scipy import optimize

    problem = Problem(relaxation, tolerance)
    z = problem.start()
    problem(z)
    stiffness = float(problem.relaxation.packing.contact_stiffness.max())
    last = z

    def ask(trial: Floats) -> Floats:
        nonlocal last
        last = trial
        _, slope = problem(trial)
        if problem.solved or problem.evaluations >= MOST_OF_ROOT:
            raise _Solved
        return slope / stiffness  # so that its first step is one of steepest descent

    if not problem.solved:
        try:
            options = {"fatol": 0.0, "ftol": 0.0, "maxfev": MOST_OF_ROOT}
            last = optimize.root(ask, z, method="df-sane", options=options).x
        except _Solved:
            pass
    problem.put(last)
    return problem.evaluations


def minimize(problem: Problem) -> None:
    """Solve ``problem`` by L-BFGS-B and leave the answer in its relaxation."""
    best = problem.start()
    for _ in range(
        3
    ):  # its line search can give up at rounding, and go on from there when asked again
        best = _descend(problem, best)
        if problem.solved or problem.evaluations >= MOST_EVALUATIONS:
            break
    problem.put(best)


def newton(relaxation: Relaxation, tolerance: float) -> int:
    """L-BFGS-B to ``NEWTON_FROM``, then Newton steps with a Hessian of finite differences, down to rounding."""
    problem = Problem(relaxation, max(NEWTON_FROM, tolerance))
    z = _descend(problem, problem.start())
    problem.tolerance = tolerance
    _, gradient = problem(z)
    residual = problem.residual
    for _ in range(NEWTON_STEPS):
        if residual <= tolerance:
            break
        trial = z - np.linalg.solve(hessian(problem, z, gradient), gradient)
        _, slope = problem(trial)
        if not problem.residual < residual:
            break
        z, gradient, residual = trial, slope, problem.residual
    problem.put(z)
    return problem.evaluations


def hessian(problem: Problem, z: Floats, gradient: Floats) -> Floats:
    """Second derivatives (n, n) at z by forward differences, symmetric, with a small shift along the diagonal."""
    size = len(z)
    matrix = np.empty((size, size))
    for k in range(size):
        moved = z.copy()
        moved[k] += DIFFERENCE
        matrix[k] = (problem(moved)[1] - gradient) / DIFFERENCE
    matrix += matrix.T
    matrix *= 0.5
    matrix[np.diag_indices(size)] += SHIFT * float(matrix.diagonal().max(initial=1.0))
    return matrix


def _descend(problem: Problem, z: Floats) -> Floats:
    """Run L-BFGS-B from z; the z of the evaluation that met the tolerance, else its best.

    Its first step has the length 1 whatever the forces are. Numbers are scaled so that this is one of steepest descent with
    the stiffness of a contact; unscaled it wastes a dozen evaluations on every increment.
    """
    from scipy import optimize

    energy, gradient = problem(z)
    if problem.solved:
        return z
    size = float(np.linalg.norm(gradient))
    stiffness = float(problem.relaxation.packing.contact_stiffness.max())
    scale = stiffness / size if size > 0.0 else 1.0
    last = z

    def ask(scaled: Floats) -> tuple[float, Floats]:
        nonlocal last
        last = scaled / scale
        value, slope = problem(last)
        if problem.solved:
            raise _Solved
        return value - energy, slope / scale

    try:
        found = optimize.minimize(
            ask,
            z * scale,
            method="L-BFGS-B",
            jac=True,
            options={
                "gtol": 0.0,
                "ftol": 0.0,
                "maxiter": MOST_EVALUATIONS,
                "maxfun": MOST_EVALUATIONS - problem.evaluations,
                "maxcor": MEMORY,
            },
        )
    except _Solved:
        return last
    answer: Floats = np.asarray(found.x, dtype=np.float64) / scale
    return answer
