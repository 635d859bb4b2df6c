"""What an increment works on, as arrays that kernels can write into: grains, bodies, settings, memories. N grains, B bodies."""

from __future__ import annotations

from typing import NamedTuple

from core.arrays import Floats, Indices

# Columns of ``Bodies.places``.
X, Y, TURN, HOME_X, HOME_Y, AXIS_X, AXIS_Y, LEAST, MOST, RADIUS = range(10)
PLACES = 10
# Columns of ``System.wanted``.
ASKED, TO_X, TO_Y = range(3)


class Grains(NamedTuple):
    """As ``core.packing.Packing`` has them."""

    state: Floats  # (5, N) x, y, p, q1, q2 [R]
    rest_radius: Floats  # (N,) [R]
    poisson_ratio: Floats  # (N,)
    contact_stiffness: Floats  # (N,) [k]
    label: Indices  # (N,)


class Bodies(NamedTuple):
    """Bodies that stand fast, slide or are dragged without turning, and the M primitives that they are made of."""

    # (B, PLACES) where each is and was at first [R, rad], its axis or 0, its travel [R], and the radius of a disc that is dragged
    # anywhere [R], 0 for all others.
    places: Floats
    local: Floats  # (M, 8) rows of ``core.rigid_contacts`` with points as seen from the body [R]
    owner: Indices  # (M,)
    joints: Indices  # (M, 2) the edges that a vertex ends, counted from 1, and below 0 where it is their start; 0: none


class Settings(NamedTuple):
    """``core.settings.Settings``, the coefficient of friction, μ, and what pulls grains down and holds them back."""

    step: float
    tolerance: float
    force_floor: float
    skin: float
    max_iterations: int
    hand_strength: float
    coefficient: float
    gravity_x: float  # [k/R]
    gravity_y: float
    drag: float  # [k/R²]


class Memory(NamedTuple):
    """What frictional contacts remember, as ``core.friction.Friction`` has it, in arrays with room for more of them."""

    spin: Floats  # (N,) [rad]
    keys: Indices  # (room,)
    slips: Floats  # (room,) [R]
    known: Indices  # (1,) how many remember something


class Past(NamedTuple):
    """What an increment needs to know of the one before."""

    last: Floats  # (5, N) displacement [R]
    moved: Floats  # (B, 2) of the bodies [R]
    reactions: Floats  # (B, 3) of the grains on the bodies [k R, k R²]


class System(NamedTuple):
    """All of it."""

    grains: Grains
    bodies: Bodies
    settings: Settings
    memory: Memory
    past: Past
    wanted: Floats  # (B, 3) is the body asked for, and where it is to go [R]
    box: tuple[float, ...] | None  # the cell, as kernels of core have it
