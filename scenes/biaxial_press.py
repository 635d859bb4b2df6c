"""A V-shaped press: Fig. 2ab and "Experimental uniaxial setup" of Haver et al., doi:10.1073/pnas.2317915121.

The grains lie in a square that stands on its corner, between a V-shaped floor and a lid that is an inverted V. The lid comes
down along the diagonal, so that the grains are compressed equally from two directions.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from core import observables
from core.errors import InputError
from core.generate import Progress, pack
from core.quasistatic import Increment
from core.rigid import Point, RigidBody, RigidWorld, offset_path, wall
from scenes.checks import Check, Track, on_bodies
from scenes.drives import depth_after, steps_to
from scenes.grains import FRICTION, MATERIAL, PAPER, SIZES, friction, recipe
from scenes.parameter import Parameter, whole_above
from scenes.registry import register
from scenes.relaxing import SOLVER, step
from scenes.scene import Curve, Handle, Scene, Setup, Values, hand, solver
from scenes.text import Text

FLOOR = 1.6  # thickness; the ends of the lid slide into it [R]
LID = 0.8  # thickness [R]
BRIM = 2.5  # of the floor above the corners at the sides [R]
LEAST_SIDE = 4.0  # of the square: two large grains beside one another [R]
DEEPEST = 0.6  # volumetric strain at which the lid stops


@register
class BiaxialPress(Scene):
    name = "biaxial_press"
    title = "V-shaped press"
    question = "Squeezed from two sides at once: which packing gives way more?"
    about = (
        "A square of grains standing on its corner, under a lid shaped like a roof. "
        "Auxetic grains just shrink; regular ones cannot, and push back."
    )
    default_steps = 52
    handle_names = ("lid",)
    parameters = (
        Parameter("grains", 100, "", 10, 2000, "number of grains; the press grows with it"),
        Parameter(
            "packing_fraction",
            0.78,
            "",
            0.3,
            1.0,
            "rest area of the grains over the area open to them, at the start",
        ),
        Parameter(
            "compression", 0.2, "", 0.01, 0.5, "largest loss of area, as a share of it", live=True
        ),
        Parameter("friction", 0.0, "", 0.0, 10.0, FRICTION, live=True),
        hand(40.0),
        *SIZES,
        *MATERIAL,
        *PAPER,
        *SOLVER,
    )

    def validate(self, settings: Values) -> None:
        if _square(settings) < LEAST_SIDE:
            least = float(settings["grains"]) * (LEAST_SIDE / _square(settings)) ** 2
            raise InputError(
                Text(
                    "too few grains of these sizes for a press: it takes {least}, or larger ones",
                    least=whole_above(least),
                )
            )

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        grains = recipe(settings, packing)
        fraction = float(settings["packing_fraction"])
        side = _square(settings)
        half = side / math.sqrt(2.0)
        outline: list[Point] = [(0.0, 0.0), (half, half), (0.0, 2.0 * half), (-half, half)]
        brim = half + BRIM
        world = RigidWorld(
            [wall("floor", [(-brim, brim), (0.0, 0.0), (brim, brim)], FLOOR), _lid(half)]
        )
        packed = pack(
            grains,
            seed=seed,
            outline=outline,
            world=world,
            packing_fraction=fraction,
            progress=progress,
        )
        margin = FLOOR / math.sqrt(2.0)
        return Setup(
            packing=packed,
            world=world,
            solver=solver(settings),
            handles=(Handle("lid", "lid", (0.0, -1.0), 0.3 * half),),
            bounds=(-brim - margin, -2.0 * margin, brim + margin, 2.0 * half + 2.0 * LID),
            outline=outline,
            friction=friction(settings, len(packed)),
            curve=Curve(
                "less area [%]",
                "pressure [k]",
                lambda _, __: 100.0 * less_area(world, side),
                lambda _, increment: press(world, increment, side),
            ),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        lid = setup.world["lid"]
        end = way_down(_side(setup), float(settings["compression"]))
        depth = depth_after(increment, setup.solver.step, end)
        return None if depth is None else {"lid": (lid.home[0], lid.home[1] - depth)}

    def steps(self, settings: Values) -> int:
        return steps_to(way_down(_square(settings), float(settings["compression"])), step(settings))

    def region(self, setup: Setup) -> list[Point]:
        """The square between floor and lid."""
        half = 0.5 * setup.world["lid"].position[1]
        return [(0.0, 0.0), (half, half), (0.0, 2.0 * half), (-half, half)]

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _balance(setup), _pushes_back(track)]


def _square(settings: Values) -> float:
    """Side of the square at the start [R]."""
    area = float(settings["grains"]) * recipe(settings, "mixed").mean_area()
    return math.sqrt(area / float(settings["packing_fraction"]))


def way_down(side: float, compression: float) -> float:
    """How far the lid comes down [R] until a square of that side has lost the share ``compression`` of its area."""
    return math.sqrt(2.0) * side * (1.0 - math.sqrt(1.0 - compression))


def side_now(world: RigidWorld, side: float) -> float:
    """Length of the square's sides [R]: the lid's faces stand at 45° to its way."""
    lid = world["lid"]
    return side - (lid.home[1] - lid.position[1]) / math.sqrt(2.0)


def less_area(world: RigidWorld, side: float) -> float:
    """1 − L²/L0², minus the volumetric strain, with L0 the side at the start, where there is hardly any pressure yet."""
    return 1.0 - (side_now(world, side) / side) ** 2


def press(world: RigidWorld, increment: Increment, side: float) -> float:
    """Pressure on the lid's two faces [k]: the force along its way is √2 times pressure times length of a face.

    The paper divides the force by the length of both faces, which is this pressure over √2.
    """
    up = float(increment.reactions[world.index("lid"), 1])
    return up / (math.sqrt(2.0) * side_now(world, side))


def _side(setup: Setup) -> float:
    return math.sqrt(2.0) * setup.outline[1][0]


def _lid(half: float) -> RigidBody:
    """The inverted V, a body whose place is its inner apex."""
    line = offset_path([(half, -half), (0.0, 0.0), (-half, -half)], 0.5 * LID, closed=False)
    pairs = itertools.pairwise(line)
    return RigidBody(
        "lid",
        "piston",
        position=(0.0, 2.0 * half),
        segments=[(*a, *b, 0.5 * LID) for a, b in pairs],
        axis=(0.0, -1.0),
        travel=(0.0, way_down(math.sqrt(2.0) * half, DEEPEST)),
    )


def _balance(setup: Setup) -> Check:
    """What the lid presses, the floor bears: every grain may be off by the tolerance times the mean contact force."""
    pairs = observables.grain_contacts(setup.packing)
    contacts, reactions = on_bodies(setup)
    name = "the floor bears what the lid presses"
    if setup.friction is not None:
        return Check(name, None, "with friction its faces bear tangential forces too")
    forces = np.concatenate([pairs.normal_force, contacts.normal_force])
    scale = max(float(np.mean(forces)) if len(forces) else 0.0, setup.solver.force_floor)
    lid, floor = (reactions[setup.world.index(body)] for body in ("lid", "floor"))
    off = float(np.hypot(*(lid[:2] + floor[:2])))
    allowed = len(setup.packing) * 2.0 * setup.solver.tolerance * scale
    return Check(name, off <= allowed, f"{lid[1]:.4f} and {-floor[1]:.4f} k R, off by {off:.1e}")


def _pushes_back(track: Track) -> Check:
    """The pressure at the most compressed state so far."""
    name = "squeezed by a tenth, the packing pushes back"
    most = int(np.argmax(track.stroke))
    if track.stroke[most] < 10.0:
        return Check(name, None, "not squeezed that far yet")
    pressure = float(track.force[most])
    return Check(name, pressure > 0.0, f"{pressure:.4f} k at {track.stroke[most]:.1f} % less area")
