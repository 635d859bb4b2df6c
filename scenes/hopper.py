"""Grains pushed by a piston through a funnel: Fig. 6e–g of Haver et al., doi:10.1073/pnas.2317915121."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.arches import arch
from core.errors import InputError
from core.generate import Progress, pack
from core.quasistatic import Increment
from core.rigid import Point, RigidBody, RigidWorld, offset_path, wall
from scenes.checks import below_height
from scenes.drives import depth_after, steps_to
from scenes.falls import sudden_fall, who_took_part
from scenes.grains import FRICTION, MATERIAL, PAPER, SIZES, friction, recipe
from scenes.outlet import Outlet
from scenes.parameter import Parameter, round_down, round_up, whole_above
from scenes.registry import register
from scenes.relaxing import SOLVER, step
from scenes.remarks import Holding, Latest, Remarks
from scenes.scene import Bounds, Handle, Scene, Setup, Values, hand, solver
from scenes.text import Text

WALL = 0.8  # thickness; the funnel's lips are round with half of it [R]
PISTON = 1.6  # thickness of the piston [R]
LEFT_BEHIND = 0.8  # a grain whose centre is this far below the lips has left [R]
ASIDE = (
    20.0  # how far the space under the funnel goes on beside it: no burst throws a grain so far [R]
)
LIFT = 3.0  # how far the piston may be drawn back [R]
LEAST_CHANNEL = 4.0  # height of the filled channel above the funnel [R]
DIAMETER = 2.0  # of a large grain [R]


@register
class Hopper(Scene):
    name = "hopper"
    title = "Hopper"
    question = "Why does this hopper lock, and that one not?"
    about = "A piston pushes grains through an orifice a few grains wide. Watch arches form, carry force, and break."
    default_steps = 440
    handle_names = ("piston",)
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
        Parameter(
            "stroke", 22.0, "R", 0.5, 200.0, "length of the piston's scripted stroke", live=True
        ),
        Parameter("friction", 0.5, "", 0.0, 10.0, FRICTION, live=True),
        hand(8.0),
        *SIZES,
        *MATERIAL,
        *PAPER,
        *SOLVER,
    )

    def validate(self, settings: Values) -> None:
        Shape(settings).check(LEAST_CHANNEL)

    def steps(self, settings: Values) -> int:
        end = min(float(settings["stroke"]), Shape(settings).channel - 1.0)
        return steps_to(end, step(settings))

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        grains = recipe(settings, packing)
        shape = Shape(settings)
        half_width, neck, channel = shape.half_width, shape.neck, shape.channel
        top = neck + channel
        brim = top + LIFT + PISTON
        right: list[Point] = [(shape.lip_x, shape.lip_y), (half_width, neck), (half_width, brim)]
        left: list[Point] = [(-x, y) for x, y in reversed(right)]
        outline: list[Point] = [
            right[0],
            right[1],
            (half_width, top),
            (-half_width, top),
            left[1],
            left[2],
        ]
        world = RigidWorld(
            [
                wall("right wall", right, WALL),
                wall("left wall", left, WALL),
                _piston(half_width, top, channel - 1.0),
                wall("gate", [(-shape.lip_x, shape.lip_y), (shape.lip_x, shape.lip_y)], WALL),
            ]
        )
        packed = pack(
            grains,
            seed=seed,
            outline=outline,
            world=world,
            packing_fraction=shape.fraction,
            progress=progress,
        )
        world.remove("gate")
        return Setup(
            packing=packed,
            world=world,
            solver=solver(settings),
            handles=(Handle("piston", "piston", (0.0, -1.0), half_width),),
            bounds=(-half_width - WALL, -4.0, half_width + WALL, brim),
            outline=[(half_width, brim), (-half_width, brim), left[1], left[2], right[0], right[1]],
            outlet=shape.outlet(-LEFT_BEHIND, beside=True),
            focus=(shape.focus(-4.0),),
            friction=friction(settings, len(packed)),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        piston = setup.world["piston"]
        end = min(float(settings["stroke"]), piston.travel[1])
        depth = depth_after(increment, setup.solver.step, end)
        return None if depth is None else {"piston": (piston.home[0], piston.home[1] - depth)}

    def region(self, setup: Setup) -> list[Point]:
        return below_height(setup.outline, setup.world["piston"].position[1])

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        """Clogged: the force has risen over a stroke of one grain diameter while nothing left; an arch: over half of that.

        An avalanche: what held has broken, and the force falls.
        """
        del settings
        stroke, force = latest.curve[:, -1]
        since = float(stroke) - latest.last_exit[0]
        fall = sudden_fall(setup, latest)
        if fall > 0.0:
            text = Text("avalanche: the force fell by {fall:.2g} k R", fall=fall)
            return Remarks((text,), who_took_part(setup.packing, latest), {"avalanche": text})
        if since < 0.5 * DIAMETER or force <= max(latest.last_exit[1], 0.0):
            return Remarks()
        found = self.arch(setup, latest.now)
        if since < DIAMETER:
            if found is None:
                return Remarks()
            text = Text(
                "an arch of {grains} {grains:grain|grains} holds what is above",
                grains=int(found.sum()),
            )
            return Remarks((text,), found, {"arch": text})
        text = Text(
            "clogged: {diameters:.1f} diameters of stroke, no grain came out",
            diameters=since / DIAMETER,
        )
        if found is not None:
            text = Text(
                "{clogged}, held by an arch of {grains} {grains:grain|grains}",
                clogged=text,
                grains=int(found.sum()),
            )
        return Remarks((text,), found, {"clog": text})

    def arch(self, setup: Setup, now: Increment) -> NDArray[np.bool_] | None:
        bodies = now.body_contacts
        body = setup.world.primitives()[1][bodies.primitive]
        side = np.where(body == setup.world.index("left wall"), -1, 0)
        side[body == setup.world.index("right wall")] = 1
        return standing_arch(setup, now, side)

    def what_holds(self, setup: Setup, latest: Latest) -> Holding:
        found = self.arch(setup, latest.now)
        if found is None:
            return super().what_holds(setup, latest)
        return Holding(
            Text("an arch of {grains} {grains:grain|grains} holds", grains=int(found.sum())), found
        )


def _piston(half_width: float, top: float, way: float) -> RigidBody:
    """As wide as the channel, its face at ``top``, from where it can go down by ``way`` [R]."""
    corners = (
        (-half_width, 0.0),
        (half_width, 0.0),
        (half_width, PISTON),
        (-half_width, PISTON),
    )
    return RigidBody(
        "piston",
        "piston",
        position=(0.0, top),
        polygons=[(corners, 0.0)],
        axis=(0.0, -1.0),
        travel=(-LIFT, way),
    )


class Shape:
    """The hopper in numbers [R]. The lips are round, with their centres at y = 0; the orifice is the clear gap between them."""

    def __init__(self, settings: Values) -> None:
        angle = math.radians(float(settings["angle"]))
        self.fraction = float(settings["packing_fraction"])
        self.half_width = 0.5 * float(settings["width"])
        self.opening = DIAMETER * float(settings["orifice"])
        # Where the face of the funnel begins, so that the clear gap between the round lips is exactly the orifice.
        self.lip_x = 0.5 * self.opening + 0.5 * WALL * (1.0 - math.sin(angle))
        self.lip_y = 0.5 * WALL * math.cos(angle)
        self.neck = self.lip_y + (self.half_width - self.lip_x) * math.tan(angle)
        funnel = (self.half_width + self.lip_x) * (self.neck - self.lip_y)
        self.grains, self.grain = float(settings["grains"]), recipe(settings, "mixed").mean_area()
        full = self.grains * self.grain / self.fraction
        self.channel = (full - funnel) / (2.0 * self.half_width)

    def outlet(self, y: float, beside: bool) -> Outlet:
        """Grains leave below ``y`` [R], with ``beside`` also where they lie under the funnel's sides."""
        lip, neck = (self.lip_x, self.lip_y), (self.half_width, self.neck)
        face: list[Point] = [lip, neck, (self.half_width, self.neck + 1.0)]
        end, shoulder, _ = offset_path(face, WALL, closed=False)
        far = self.half_width + ASIDE
        right: list[Point] = [lip, end, shoulder, (far, shoulder[1]), (far, y)]
        left: list[Point] = [(-x, y) for x, y in reversed(right)]
        return Outlet(y, self.opening, (*right, *left), end[0] if beside else math.inf)

    def focus(self, bottom: float, sway: float = 0.0) -> Bounds:
        """The orifice with the arch that may stand over it, and what falls down to ``bottom`` [R]; it may ``sway`` [R]."""
        aside = self.lip_x + 1.0 + sway
        return -aside, bottom, aside, self.lip_y + self.opening + DIAMETER

    def check(self, least_channel: float) -> None:
        """Raises InputError unless the lips stand within the channel, and the grains fill so much of it [R] above the funnel."""
        if self.lip_x > self.half_width - 0.5:
            beyond = self.lip_x - self.half_width + 0.5
            raise InputError(
                Text(
                    "the orifice is wider than the channel: lower orifice to {most:g}, or raise width to {least:g} R",
                    most=round_down((self.opening - 2.0 * beyond) / DIAMETER),
                    least=round_up(2.0 * (self.half_width + beyond)),
                )
            )
        if self.channel < least_channel:
            missing = (least_channel - self.channel) * 2.0 * self.half_width
            grains = self.grains + missing * self.fraction / self.grain
            raise InputError(
                Text(
                    "too few grains to fill the funnel: it takes {least}, or a smaller width or angle",
                    least=whole_above(grains),
                )
            )


def standing_arch(
    setup: Setup, now: Increment, side: NDArray[np.int64]
) -> NDArray[np.bool_] | None:
    """The grains (N,) of the arch over the orifice, or None. ``side`` of each contact with a body: see ``core.arches``."""
    base = min(y for _, y in setup.outline)
    contacts = now.grain_contacts, now.body_contacts
    chain = arch(setup.packing, *contacts, side, base)
    if not len(chain):
        return None
    highlight = np.zeros(len(setup.packing), dtype=bool)
    highlight[chain] = True
    return highlight
