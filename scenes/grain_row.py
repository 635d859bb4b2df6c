"""A row of grains in a box, squeezed from above: the Poisson effect of Haver et al., doi:10.1073/pnas.2317915121.

Regular grains want to grow wider, cannot, and press on the end walls from the start. Auxetic grains draw back from one another:
no force runs sideways.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.generate import Progress, Recipe
from core.packing import Packing
from core.quasistatic import Increment
from core.rigid import Point, RigidBody, RigidWorld
from scenes.checks import Check, Track, below_height, on_bodies
from scenes.drives import depth_after, steps_to
from scenes.grains import FRICTION, MATERIAL, friction
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.relaxing import MAX_ITERATIONS, TOLERANCE
from scenes.remarks import Latest, Remarks
from scenes.scene import STRONGEST, Curve, Handle, Scene, Setup, Values, hand, solver
from scenes.text import Text

WALL = 0.6  # thickness of floor, walls and piston [R]
LIFT = 0.5  # how far the piston may be drawn up [R]
ENDS = ("left wall", "right wall")
SQUEEZED = 1e-9  # [R] an approach that counts


@register
class GrainRow(Scene):
    name = "grain_row"
    title = "Row of grains"
    question = "Press from above: which row pushes sideways?"
    about = (
        "Grains side by side in a box, under a piston. "
        "Regular grains push their neighbours and the walls; auxetic grains make room."
    )
    default_steps = 60
    handle_names = ("piston",)
    parameters = (
        Parameter("grains", 7, "", 1, 100, "number of grains in the row"),
        Parameter(
            "gap", 0.0, "R", 0.0, 0.5, "room between neighbours, and to the walls, at the start"
        ),
        Parameter(
            "compression",
            0.15,
            "",
            1e-3,
            0.35,
            "largest approach of the piston, in diameters",
            live=True,
        ),
        Parameter("friction", 0.0, "", 0.0, 10.0, FRICTION, live=True),
        hand(STRONGEST),
        *MATERIAL,
        Parameter(
            "step", 0.005, "R", 1e-4, 0.05, "longest move of the piston in one increment", live=True
        ),
        replace(TOLERANCE, default=1e-5),
        replace(MAX_ITERATIONS, default=50_000),
    )

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        del progress  # takes no time
        count, gap = int(settings["grains"]), float(settings["gap"])
        grains = Recipe(
            kind=packing,
            auxetic_fraction=float(settings["auxetic_fraction"]),
            regular_poisson_ratio=float(settings["regular_poisson_ratio"]),
            auxetic_poisson_ratio=float(settings["auxetic_poisson_ratio"]),
            small_fraction=0.0,
        )
        radius, nu = grains.grains(count, np.random.default_rng(seed))
        half_width = count + 0.5 * (count + 1) * gap
        x = -half_width + gap + 1.0 + (2.0 + gap) * np.arange(count)
        world = _box(half_width)
        careful = solver(settings)
        return Setup(
            packing=Packing(x, 1.0, radius, nu, float(settings["contact_stiffness"])),
            world=world,
            solver=careful,
            handles=(Handle("piston", "piston", (0.0, -1.0), half_width),),
            bounds=(-half_width - WALL, -WALL, half_width + WALL, 2.0 + LIFT + WALL),
            outline=[
                (-half_width, 0.0),
                (half_width, 0.0),
                (half_width, 2.0 + LIFT),
                (-half_width, 2.0 + LIFT),
            ],
            friction=friction(settings, len(x)),
            curve=Curve(
                "compression [% of a diameter]",
                "sideways force on the walls [k R]",
                lambda _, __: 50.0 * approach(world),
                lambda _, increment: sideways(world, increment),
            ),
        )

    def region(self, setup: Setup) -> list[Point]:
        return below_height(setup.outline, setup.world["piston"].position[1])

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        piston = setup.world["piston"]
        depth = depth_after(increment, setup.solver.step, 2.0 * float(settings["compression"]))
        return None if depth is None else {"piston": (piston.home[0], piston.home[1] - depth)}

    def steps(self, settings: Values) -> int:
        return steps_to(2.0 * float(settings["compression"]), float(settings["step"]))

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        """How much room there is between the grains, and what part of the piston's force goes sideways."""
        del settings
        down = -float(latest.now.reactions[setup.world.index("floor"), 1])
        if down <= 0.0:
            return Remarks()
        count = len(setup.packing)
        share = sideways(setup.world, latest.now) / (down / count)
        room = free_room(setup)
        text = Text("sideways: {share:.0f} % of the force down on one grain", share=100 * share)
        if room > 1e-6:
            text = Text(
                "{sideways}; {room:.2f} R of room beside the grains", sideways=text, room=room
            )
        return Remarks((text,))

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _walls_balance(setup), _poisson_effect(setup, track)]


def approach(world: RigidWorld) -> float:
    """How far the piston has come down [R]."""
    piston = world["piston"]
    return piston.home[1] - piston.position[1]


def sideways(world: RigidWorld, increment: Increment) -> float:
    """Outward force on the end walls, mean of both [k R]."""
    left, right = (float(increment.reactions[world.index(name), 0]) for name in ENDS)
    return 0.5 * (right - left)


def free_room(setup: Setup) -> float:
    """Width of the box less that of all grains [R]: negative where grains overlap."""
    right = setup.outline[1][0]
    return 2.0 * right - 2.0 * float(np.sum(setup.packing.p + setup.packing.q1))


def expected_slope(nu: float, stiffness: float, count: int) -> float:
    """Sideways force over approach [k] as a row of equal regular grains begins to be squeezed, without gaps and friction.

    A grain yields to a force F on two sides by (1 − 2/C) F/k of its diameter there and by −ν times that across; each of its
    contacts with a body adds F/C. Down: δ = F_y − ν g F_x, with g = 1 − 2/C. Sideways the box does not give way, and N grains
    share N − 1 contacts of compliance 1/C and two with walls: 0 = N (g F_x − ν g F_y) + (N + 1) F_x/C.
    """
    g = 1.0 - 2.0 / stiffness
    share = nu * g / (g + (count + 1) / (count * stiffness))
    return share / (1.0 - nu * g * share)


def _box(half_width: float) -> RigidWorld:
    """Floor, two end walls and the piston; each wall is a body of its own, whose force is measured."""
    w, high = half_width, 2.0 + LIFT
    piston = RigidBody(
        "piston",
        "piston",
        position=(0.0, 2.0),
        polygons=[(((-w, 0.0), (w, 0.0), (w, WALL), (-w, WALL)), 0.0)],
        axis=(0.0, -1.0),
        travel=(-LIFT, 1.0),
    )

    def wall(name: str, x0: float, x1: float, y0: float, y1: float) -> RigidBody:
        return RigidBody(name, polygons=[(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), 0.0)])

    return RigidWorld(
        [
            wall("floor", -w - WALL, w + WALL, -WALL, 0.0),
            wall(ENDS[0], -w - WALL, -w, 0.0, high + WALL),
            wall(ENDS[1], w, w + WALL, 0.0, high + WALL),
            piston,
        ]
    )


def _wall_forces(setup: Setup) -> tuple[float, float]:
    """Outward force of the grains on the left and the right wall [k R]."""
    _, reactions = on_bodies(setup)
    left, right = (float(reactions[setup.world.index(name), 0]) for name in ENDS)
    return -left, right


def _walls_balance(setup: Setup) -> Check:
    """Without friction nothing else acts sideways."""
    name = "both walls feel the same force"
    left, right = _wall_forces(setup)
    if setup.friction is not None:
        return Check(name, None, "with friction floor and piston hold some of it")
    allowed = len(setup.packing) * setup.solver.tolerance * max(left, right, 1.0)
    return Check(name, abs(left - right) <= allowed, f"{left:.4g} and {right:.4g} k R")


def _poisson_effect(setup: Setup, track: Track) -> Check:
    """Regular: sideways force from the first increment, as by hand. Auxetic: none, and room opens up."""
    name = "sideways force from the start if regular, none if auxetic"
    nu = setup.packing.poisson_ratio
    pressed = np.flatnonzero(track.stroke > 0.0)
    if not len(pressed):
        return Check(name, None, "not squeezed yet")
    if np.all(nu < 0.0):
        force, room = float(np.max(np.abs(track.force))), free_room(setup)
        noise = setup.solver.tolerance  # [k R] of grains that a piston drawn back has let go
        now_squeezed = approach(setup.world) > SQUEEZED
        return Check(
            name,
            force <= noise and (room > 0.0 or not now_squeezed),
            f"largest force {force:.3g} k R, {room:.3f} R of room",
        )
    first = int(pressed[0])
    strain = 0.01 * float(track.stroke[first])
    count = len(setup.packing)
    gapless = setup.outline[1][0] <= count * (1.0 + 1e-12)
    if np.any(nu != nu[0]) or not gapless or setup.friction is not None:
        return Check(name, None, "for rows of one kind without gaps and friction")
    expected = expected_slope(float(nu[0]), float(setup.packing.contact_stiffness[0]), count)
    slope = float(track.force[first]) / (2.0 * strain)
    allowed = 3.0 * strain / (1.0 - float(nu[0]) ** 2) + 10.0 * setup.solver.tolerance
    return Check(
        name,
        abs(slope - expected) <= allowed * (1.0 + expected),
        f"{slope:.4f} k at the start, by hand {expected:.4f} k",
    )
