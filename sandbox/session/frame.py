"""One picture of the simulation as plain data: everything that drawing needs, and nothing else.

A :class:`Frame` is an immutable snapshot. The solver's thread makes it (by copying), and window,
video and tests read it. It holds no reference to the solver, so a drawing never sees a grain in
the middle of an iteration.

Units are in brackets: lengths in the reference grain radius ``R``, forces in ``k R``, energies in
``k R^2``, where ``k`` is the contact stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.squeezed import squeezed_beyond
from sandbox.session.history import Event
from scenes.parameter import Value

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

BodyRole = Literal["wall", "piston", "intruder", "body"]

CONVERGED = "converged"


def _no_points(columns: int) -> FloatArray:
    return np.empty((0, columns), dtype=np.float64)


def _no_grains() -> IntArray:
    return np.empty(0, dtype=np.int64)


def _no_numbers() -> FloatArray:
    return np.empty(0, dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Touching pairs, as lines that a force chain can be drawn along.

    A grain-grain contact runs from centre to centre; a contact with a rigid body runs from the
    grain's centre to the touching point on the body.
    """

    x0: FloatArray  # (C,) start of the line [R]
    y0: FloatArray  # (C,) [R]
    x1: FloatArray  # (C,) end of the line [R]
    y1: FloatArray  # (C,) [R]
    force: FloatArray  # (C,) normal force, >= 0 [k R]
    rigid: BoolArray  # (C,) True where the line ends on a rigid body

    # Which grains, as numbered in the frame; empty where nobody knows.
    i: IntArray = field(default_factory=_no_grains)  # (C,)
    j: IntArray = field(default_factory=_no_grains)  # (C,) -1: a rigid body

    # The whole force on grain i, friction and all; on the other side the opposite. Empty where nobody knows.
    fx: FloatArray = field(default_factory=_no_numbers)  # (C,) [k R]
    fy: FloatArray = field(default_factory=_no_numbers)  # (C,) [k R]

    @classmethod
    def none(cls) -> Contacts:
        """No contact at all."""
        empty = np.empty(0, dtype=np.float64)
        return cls(empty, empty, empty, empty, empty, np.empty(0, dtype=np.bool_))

    def __len__(self) -> int:
        return int(self.force.shape[0])


@dataclass(frozen=True, slots=True, eq=False)
class BodyShape:
    """The outline of one rigid body in world coordinates: a union of simple shapes."""

    name: str
    role: BodyRole
    discs: FloatArray = field(default_factory=lambda: _no_points(3))  # (n, 3): x, y, radius [R]
    segments: FloatArray = field(
        default_factory=lambda: _no_points(5)
    )  # (n, 5): x0, y0, x1, y1, radius of the capsule [R]
    polygons: tuple[FloatArray, ...] = ()  # each (m, 2): convex, counter-clockwise corners [R]


@dataclass(frozen=True, slots=True, eq=False)
class HandleState:
    """A place where a hand can take hold of a body, and what the hand feels there."""

    name: str  # what a Grab command says
    label: str  # plain words, e.g. "intruder"
    x: float  # where the handle is now [R]
    y: float  # [R]
    target: tuple[float, float] | None  # where the hand wants it [R]; None when nobody holds it
    fx: float  # force that the hand exerts on the body [k R]
    fy: float  # [k R]
    radius: float  # how near a press must be to take hold [R]
    axis: tuple[float, float] | None = None  # unit vector if it can slide only along a line


@dataclass(frozen=True, slots=True, eq=False)
class Ahead:
    """What came after the state that is shown, and is kept until something moves."""

    stroke: FloatArray  # (K,) of the curve, from the increment after the one that is shown
    force: FloatArray  # (K,)
    events: tuple[Event, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """Immutable snapshot of a running scene (N grains, M increments so far)."""

    # What is shown.
    scene: str  # name in the registry
    title: str  # plain words
    packing: str  # "regular", "auxetic" or "mixed"
    seed: int
    increment: int  # load increments finished since the start

    # Grains. Semi-axes are p + |q| and p - |q|; the long axis is at atan2(q2, q1) / 2.
    x: FloatArray  # (N,) centre, in a periodic cell folded into it [R]
    y: FloatArray  # (N,) centre [R]
    p: FloatArray  # (N,) mean semi-axis [R]
    q1: FloatArray  # (N,) elongation along x [R]
    q2: FloatArray  # (N,) elongation along the diagonal [R]
    rest_radius: FloatArray  # (N,) radius with no force on the grain [R]
    poisson_ratio: FloatArray  # (N,) negative where auxetic
    label: IntArray  # (N,) stays with a grain for life
    pressure: FloatArray  # (N,) mean pressure in the grain, from its contact forces [k]
    stress_difference: FloatArray  # (N,) of the principal stresses in the grain [k]
    motion: FloatArray  # (2, N) x and y, in the latest increment beyond the periodic cell's [R]

    # What touches what, and what holds it.
    contacts: Contacts
    bodies: tuple[BodyShape, ...]
    handles: tuple[HandleState, ...]
    bounds: tuple[float, float, float, float]  # xmin, ymin, xmax, ymax that the camera shows [R]

    # Where the computation stands.
    stroke: float  # path of the drive so far [R]
    grains_out: int  # grains that have left and are counted
    energy: float  # [k R^2]
    residual: float  # largest generalised force relative to the mean contact force
    tolerance: float  # the residual that counts as converged
    iterations: int  # of the minimiser, in this increment
    stop_reason: (
        str  # "converged", "budget", "iteration limit", "not finite", "collapsed" or "sunk"
    )
    busy: bool  # an increment is being relaxed: the hand waits
    protocol: bool  # the scripted drive is on
    notices: tuple[str, ...]  # plain words for the person at the window

    # Force against stroke so far; positive force resists the drive.
    curve_stroke: FloatArray  # (M,) [R]
    curve_force: FloatArray  # (M,) [k R]
    curve_label: str  # e.g. "force on the intruder [k R]"

    stroke_label: str = "stroke [R]"
    # Where it happens, besides at the handles: xmin, ymin, xmax, ymax of each place.
    focus: tuple[tuple[float, float, float, float], ...] = ()  # [R]
    # Strength of the hand [k R], where it has a limit and its force is what is plotted.
    hand_limit: float | None = None

    # Only in a periodic cell: width and height (inf where open) and the shift of the image above.
    box: tuple[float, float, float] | None = None  # [R]

    # Grains that the scene points at: an arch, an avalanche.
    highlight: BoolArray | None = None  # (N,)

    # Only with friction: the angle that each grain has turned by, to draw a radius line.
    spin: FloatArray | None = None  # (N,) [rad]

    # Share of contacts that pull harder than friction allows; 0 without friction.
    beyond_cone: float = 0.0

    # How far every grain is from equilibrium: its unbalanced force; empty where nobody knows.
    residual_force: FloatArray = field(default_factory=_no_numbers)  # (N,) [k R]

    # Estimates for the handle's force, over its mean magnitude so far: usually, and nine times of ten, it is no further off.
    usual_error: float = math.nan
    force_error: float = math.nan

    # What is set, and what can be gone back to.
    settings: Mapping[str, Value] = field(default_factory=dict)  # of the scene's parameters, now
    first_kept: int = 0  # increments from here
    last_kept: int = 0  # to here can be recalled; after a recall, later ones until something moves
    can_undo: bool = False
    can_redo: bool = False
    events: tuple[Event, ...] = ()  # all since the start, the newest last
    ahead: Ahead | None = None  # only after a recall

    # What was asked for and could not be done: how often, and why the last time, in plain words.
    refusals: int = 0
    refusal: str = ""

    @property
    def grains(self) -> int:
        """How many grains there are."""
        return int(self.x.shape[0])

    @property
    def auxetic(self) -> BoolArray:
        """Which grains are auxetic, (N,)."""
        return np.less(self.poisson_ratio, 0.0)

    @property
    def squeezed(self) -> BoolArray:
        """Which grains are squeezed further than what they are made of could be, (N,): see ``core.squeezed``."""
        return squeezed_beyond(self.p, self.q1, self.q2, self.rest_radius, self.poisson_ratio)

    @property
    def converged(self) -> bool:
        """Is what is shown relaxed to the tolerance?"""
        return self.stop_reason == CONVERGED and not self.busy
