"""An almost empty box for what a class wants to try: walls are drawn into it, grains placed, and a disc pushes them."""

from __future__ import annotations

import math

from core.errors import InputError
from core.generate import Progress, pack
from core.rigid import Point, RigidBody, RigidWorld, wall
from scenes.drives import steps_to
from scenes.grains import FRICTION, MATERIAL, PAPER, SIZES, friction, recipe
from scenes.parameter import Parameter, round_down, round_up
from scenes.registry import register
from scenes.relaxing import SOLVER, step
from scenes.scene import Handle, Scene, Setup, Values, hand, solver
from scenes.text import Text

WALL = 0.8  # thickness [R]
MARGIN = 1.0  # between the disc and the walls at both ends of the scripted push [R]
FULLEST = 0.8  # packing fraction at the start: there is to be room to make things


@register
class Workshop(Scene):
    name = "workshop"
    title = "Workshop"
    question = "What can you build that locks, and what always gives way?"
    about = (
        "A box with a few grains and a disc in your hand. "
        "Draw walls, place grains of both kinds, push, and keep what you made as a file."
    )
    default_steps = 1000
    handle_names = ("intruder",)
    parameters = (
        Parameter("grains", 40, "", 0, 3000, "number of grains at the start"),
        Parameter("width", 31.0, "R", 8.0, 120.0, "width of the box"),
        Parameter("height", 20.0, "R", 8.0, 90.0, "height of the box"),
        Parameter("intruder_radius", 2.0, "R", 0.5, 10.0, "radius of the disc"),
        Parameter("friction", 0.0, "", 0.0, 10.0, FRICTION, live=True),
        hand(0.6),
        *SIZES,
        *MATERIAL,
        *PAPER,
        *SOLVER,
    )

    def validate(self, settings: Values) -> None:
        width, height = float(settings["width"]), float(settings["height"])
        radius = float(settings["intruder_radius"])
        if 2.0 * radius + 4.0 * MARGIN > min(width, height):
            raise InputError(
                Text(
                    "the disc does not fit into the box: raise width and height to {least:g} R, "
                    "or lower intruder_radius to {most:g} R",
                    least=round_up(2.0 * radius + 4.0 * MARGIN),
                    most=round_down(0.5 * min(width, height) - 2.0 * MARGIN),
                )
            )
        room = FULLEST * (width * height - math.pi * radius**2)
        most = math.floor(room / recipe(settings, "mixed").mean_area())
        if int(settings["grains"]) > most:
            raise InputError(
                Text(
                    "so many grains leave no room: lower grains to {most}, or raise width or height",
                    most=most,
                )
            )

    def steps(self, settings: Values) -> int:
        return max(2, steps_to(2.0 * _way(settings), step(settings)))

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        width, height = float(settings["width"]), float(settings["height"])
        radius = float(settings["intruder_radius"])
        outline: list[Point] = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
        disc = RigidBody(
            "intruder",
            "intruder",
            position=(radius + MARGIN, 0.5 * height),
            discs=[(0.0, 0.0, radius)],
            held=True,
        )
        world = RigidWorld([wall("walls", outline, WALL, closed=True), disc])
        packed = pack(
            recipe(settings, packing),
            seed=seed,
            outline=outline,
            world=world,
            count=int(settings["grains"]),
            progress=progress,
        )
        return Setup(
            packing=packed,
            world=world,
            solver=solver(settings),
            handles=(Handle("intruder", "disc", (1.0, 0.0), radius),),
            bounds=(-WALL, -WALL, width + WALL, height + WALL),
            outline=outline,
            friction=friction(settings, len(packed)),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        """To the other end and back."""
        if increment >= self.steps(settings):
            return None
        way, home = _way(settings), setup.world["intruder"].home
        gone = min((increment + 1) * setup.solver.step, 2.0 * way)
        return {"intruder": (home[0] + (gone if gone <= way else 2.0 * way - gone), home[1])}


def _way(settings: Values) -> float:
    """From one end of the scripted push to the other [R]."""
    return float(settings["width"]) - 2.0 * (float(settings["intruder_radius"]) + MARGIN)
