"""Grains pushed by a piston through a funnel: Fig. 6e–g of Haver et al., doi:10.1073/pnas.2317915121."""

from __future__ import annotations

import math

from core.errors import InputError
from core.generate import pack
from core.rigid import Point, RigidBody, RigidWorld, wall
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.scene import (
    FRICTION,
    MATERIAL,
    SOLVER,
    Handle,
    Outlet,
    Progress,
    Scene,
    Setup,
    Values,
    recipe,
    solver,
)

WALL = 0.8  # thickness; the funnel's lips are round with half of it [R]
PISTON = 1.6  # thickness of the piston [R]
LEFT_BEHIND = 0.8  # a grain whose centre is this far below the lips has left [R]
LIFT = 3.0  # how far the piston may be drawn back [R]


@register
class Hopper(Scene):
    name = "hopper"
    title = "Hopper"
    question = "Why does this hopper clog, and that one not?"
    about = "A piston pushes grains through an orifice a few grains wide. Watch arches form, carry force, and break."
    default_steps = 440
    parameters = (
        Parameter(
            "grains", 300, "", 20, 3000, "number of grains, near enough; the channel grows with it"
        ),
        Parameter(
            "orifice",
            3.0,
            "diameters",
            0.3,
            8.0,
            "width of the orifice in diameters of a large grain",
        ),
        Parameter(
            "angle", 45.0, "deg", 10.0, 80.0, "angle of the funnel's sides from the horizontal"
        ),
        Parameter("width", 24.0, "R", 8.0, 80.0, "width of the channel"),
        Parameter(
            "packing_fraction",
            0.84,
            "",
            0.3,
            1.0,
            "rest area of the grains over the area open to them, at the start",
        ),
        Parameter("stroke", 22.0, "R", 0.5, 200.0, "length of the piston's scripted stroke"),
        Parameter("friction", 0.5, "", 0.0, 10.0, FRICTION),
        *MATERIAL,
        *SOLVER,
    )

    def build(
        self, values: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        grains = recipe(values, packing)
        fraction = float(values["packing_fraction"])
        half_width = 0.5 * float(values["width"])
        opening = 2.0 * float(values["orifice"])
        angle = math.radians(float(values["angle"]))
        # The lips are round, with their centres at y = 0; the orifice is the clear gap between them.
        lip = Lip(0.5 * opening, angle)
        if lip.x > half_width - 0.5:
            raise InputError("the orifice is wider than the channel: lower orifice or raise width")
        neck = lip.y + (half_width - lip.x) * math.tan(angle)
        funnel = (half_width + lip.x) * (neck - lip.y)
        channel = (float(values["grains"]) * grains.mean_area() / fraction - funnel) / (
            2.0 * half_width
        )
        if channel < 4.0:
            raise InputError(
                "too few grains to fill the funnel: raise grains, or lower width or angle"
            )
        top = neck + channel
        brim = top + LIFT + PISTON
        right: list[Point] = [(lip.x, lip.y), (half_width, neck), (half_width, brim)]
        left: list[Point] = [(-x, y) for x, y in reversed(right)]
        outline: list[Point] = [
            right[0],
            right[1],
            (half_width, top),
            (-half_width, top),
            left[1],
            left[2],
        ]
        piston = RigidBody(
            "piston",
            "piston",
            position=(0.0, top),
            polygons=[
                (
                    (
                        (-half_width, 0.0),
                        (half_width, 0.0),
                        (half_width, PISTON),
                        (-half_width, PISTON),
                    ),
                    0.0,
                )
            ],
            axis=(0.0, -1.0),
            travel=(-LIFT, channel - 1.0),
        )
        world = RigidWorld(
            [
                wall("right wall", right, WALL),
                wall("left wall", left, WALL),
                piston,
                wall("gate", [(-lip.x, lip.y), (lip.x, lip.y)], WALL),
            ]
        )
        packed = pack(
            grains,
            seed=seed,
            outline=outline,
            world=world,
            packing_fraction=fraction,
            progress=progress,
        )
        world.remove("gate")
        return Setup(
            packing=packed,
            world=world,
            solver=solver(values),
            handles=(Handle("piston", "piston", (0.0, -1.0), half_width),),
            bounds=(-half_width - WALL, -4.0, half_width + WALL, brim),
            outline=[(half_width, brim), (-half_width, brim), left[1], left[2], right[0], right[1]],
            outlet=Outlet(-LEFT_BEHIND, opening),
            friction=float(values["friction"]),
        )

    def drive(self, setup: Setup, values: Values, increment: int) -> dict[str, Point] | None:
        piston = setup.world["piston"]
        end = min(float(values["stroke"]), piston.travel[1])
        depth = (increment + 1) * setup.solver.step
        if depth > end + 1e-9:
            return None
        return {"piston": (piston.home[0], piston.home[1] - depth)}


class Lip:
    """Where the face of the funnel begins, so that the clear gap between the round lips is exactly the orifice."""

    def __init__(self, half_opening: float, angle: float) -> None:
        self.x = half_opening + 0.5 * WALL * (1.0 - math.sin(angle))
        self.y = 0.5 * WALL * math.cos(angle)
