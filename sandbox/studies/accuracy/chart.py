"""FIRE in the paper's chart (x, y, θ, a, b): the same minimiser, the same compiled forces, other degrees of freedom.

Haver et al., doi:10.1073/pnas.2317915121, appendix "Numerical model". The chain rule turns the forces on (p, q1, q2) into
those on (θ, a, b); an iteration costs that much more. Inertias are those of the smooth chart where they carry over: 2 for a
and b, which is 4 for p and |q|. For θ it would be 16 |q|², nothing at a circle, so a constant has to do: ``TURN_MASS`` R0²,
the best of 0.01, 0.03, 0.1, 0.25 and 1. It stops when the forces in its own chart meet the tolerance. Those on θ vanish with
the stretch of a grain, so it stops sooner than by the forces on q1, q2, which need twenty times as many iterations; a
work–precision plot is fair to both.
"""

from __future__ import annotations

import math

import numpy as np

from core import fire, sweeps
from core.jit import kernel
from core.minimizer import fresh_control
from core.problem import Problem
from core.relaxation import Relaxation
from core.steering import steer

TURN_MASS = 0.01
MOST_EVALUATIONS = 60_000
STALE = fire.LISTS_STALE


@kernel(allocates=True)  # rows are copied whole
def to_smooth(chart, state):
    """x, y, θ, a, b → x, y, p, q1, q2; with friction the sixth row as it is."""
    for i in range(chart.shape[1]):
        half = 0.5 * (chart[3, i] - chart[4, i])
        state[0, i] = chart[0, i]
        state[1, i] = chart[1, i]
        state[2, i] = 0.5 * (chart[3, i] + chart[4, i])
        state[3, i] = half * math.cos(2.0 * chart[2, i])
        state[4, i] = half * math.sin(2.0 * chart[2, i])
    for row in range(5, chart.shape[0]):
        state[row] = chart[row]


@kernel(allocates=True)  # rows are copied whole
def to_chart(state, chart):
    """The way back: a is the longer semi-axis; of a circle θ = 0."""
    for i in range(chart.shape[1]):
        stretch = math.sqrt(state[3, i] ** 2 + state[4, i] ** 2)
        chart[0, i] = state[0, i]
        chart[1, i] = state[1, i]
        chart[2, i] = 0.5 * math.atan2(state[4, i], state[3, i])
        chart[3, i] = state[2, i] + stretch
        chart[4, i] = state[2, i] - stretch
    for row in range(5, chart.shape[0]):
        chart[row] = state[row]


@kernel(allocates=True)  # rows are copied whole
def chart_forces(chart, force, turned):
    """Forces on x, y, p, q1, q2 → forces on x, y, θ, a, b, by the chain rule."""
    for i in range(chart.shape[1]):
        c = math.cos(2.0 * chart[2, i])
        s = math.sin(2.0 * chart[2, i])
        radial = c * force[3, i] + s * force[4, i]
        across = c * force[4, i] - s * force[3, i]
        turned[0, i] = force[0, i]
        turned[1, i] = force[1, i]
        turned[2, i] = (chart[3, i] - chart[4, i]) * across
        turned[3, i] = 0.5 * (force[2, i] + radial)
        turned[4, i] = 0.5 * (force[2, i] - radial)
    for row in range(5, chart.shape[0]):
        turned[row] = force[row]


@kernel(allocates=True)
def run(
    m, box, rigid, friction, weight, limits, chart, velocity, turned, inverse_mass, record, most
):
    """``fire.run`` in the paper's chart, with all its rules. Returns (reason, evaluations)."""
    control = record[0]
    flat = chart.reshape(-1)
    speed = velocity.reshape(-1)
    push = turned.reshape(-1)
    light = inverse_mass.reshape(-1)
    for iteration in range(most):
        dt = control.dt
        if not control.pending:
            sweeps.kick(speed, push, light, control.keep, control.push)
            control.fastest_bits = sweeps.largest(speed.view(np.int64))
            fastest = control.fastest
            step = dt if fastest * dt <= limits.clamp else limits.clamp / fastest
            sweeps.drift(flat, speed, step)
            to_smooth(chart, m.state)
            if not sweeps.farthest(m.state, m.reference) <= 0.5 * limits.skin:
                control.pending = True
                return STALE, iteration
        control.pending = False
        control.energy = fire.evaluate(m, box, rigid, friction, weight, None)
        chart_forces(chart, m.force, turned)
        power, force_square, speed_square = sweeps.second_kick(speed, push, light, 0.5 * dt)
        control.fastest_bits = sweeps.largest(push.view(np.int64))
        largest_force = control.fastest
        if not abs(power + force_square + speed_square + control.energy) < np.inf:
            return fire.NOT_FINITE, iteration + 1
        control.countdown -= 1
        if control.countdown <= 0 or largest_force <= limits.tolerance * control.scale:
            control.countdown = fire.SCALE_EVERY
            control.scale = max(fire.mean_contact_force(m, box, rigid), limits.force_floor)
        if largest_force <= limits.tolerance * control.scale:
            return fire.CONVERGED, iteration + 1
        control.dt, control.alpha, control.keep, control.push = steer(
            power, force_square, speed_square, dt, control.alpha, limits.dt_max
        )
    return fire.BUDGET, most


def paper_chart(
    relaxation: Relaxation, tolerance: float, most: int = MOST_EVALUATIONS, mass: float = TURN_MASS
) -> int:
    """Relax in the paper's chart; for ``Knobs.solve``. Returns the evaluations."""
    problem = Problem(relaxation, tolerance)
    limits = relaxation._limits
    m = relaxation._minimizer
    chart = np.empty_like(m.state)
    to_chart(m.state, chart)
    velocity, turned = np.zeros_like(chart), np.zeros_like(chart)
    control = fresh_control(limits.dt_max)
    left = most
    while True:
        m = relaxation._minimizer
        inverse_mass = m.inverse_mass.copy()
        inverse_mass[2] = 1.0 / (mass * m.grains.rest_area)
        inverse_mass[3:5] = 2.0 * m.inverse_mass[2]
        code, used = run(
            m,
            relaxation._box,
            relaxation._rigid,
            relaxation.friction_terms,
            relaxation._weight,
            limits,
            chart,
            velocity,
            turned,
            inverse_mass,
            control,
            left,
        )
        left -= used
        if code != STALE or left <= 0:
            break
        place = np.argsort(m.identity)
        problem.relist()
        order = place[relaxation._minimizer.identity]
        chart, velocity, turned = (
            np.ascontiguousarray(v[:, order]) for v in (chart, velocity, turned)
        )
    relaxation._minimizer.velocity[:] = 0.0
    return int(most - left)
