"""Grains sheared between two serrated plates: Figs. 3 and 4 of Haver et al., doi:10.1073/pnas.2317915121."""

from __future__ import annotations

import math

from core import observables
from core.errors import InputError
from core.generate import Progress, Recipe, pack
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment
from core.rigid import Point, RigidBody, RigidWorld
from core.shear import plate_stress
from scenes.checks import Check, Track, on_bodies
from scenes.drives import there_and_back
from scenes.falls import sudden_fall, who_took_part
from scenes.grains import FRICTION, MATERIAL, PAPER, SIZES, friction, recipe
from scenes.parameter import Parameter, whole_above
from scenes.registry import register
from scenes.relaxing import SOLVER, step
from scenes.remarks import Latest, Remarks
from scenes.scene import STRONGEST, Curve, Handle, Ingredients, Scene, Setup, Values, hand, solver
from scenes.text import Text

TOOTH = 2.0  # period of the teeth [R]
TOOTH_DISCS = 4  # in one period
DISC = 1.0 / 3.5  # radius of a plate's discs [R]
# Notches in which one large grain fits: the discs' centres lie on a circle about it, from tip to tip.
NOTCH = 1.0 + DISC
TIP_ANGLE = math.asin(0.5 * TOOTH / NOTCH)
TIP = NOTCH * math.cos(TIP_ANGLE)  # of the tips' centres below that of a grain in its notch [R]
GRAINS_A_TOOTH = 16  # of the usual sizes: 800 grains on 50 teeth, which are 100 R
AREA_A_TOOTH = GRAINS_A_TOOTH * Recipe().mean_area()  # [R²]
LEAST_TEETH = 5
STEADY, SMALL, MIDDLE, LARGE = range(4)
# Amplitudes of the cycles in shear strain; the paper's 0.1°, 2° and 100° of its cell.
AMPLITUDE = {SMALL: 0.002, MIDDLE: 0.04, LARGE: 2.0}
QUARTER = 10  # increments in a quarter of a cycle, at least


@register
class Couette(Scene):
    """Fixed volume, periodic in x; the lower plate is fixed, the upper one slides. The paper's numbers: grains=800."""

    name = "couette"
    title = "Shear cell"
    question = "How hard is it to make one half of the grains slide over the other?"
    about = (
        "Two plates with teeth, and the grains between them. "
        "Drag the upper plate: regular grains resist more, unless the pressure is the same."
    )
    default_steps = 428
    handle_names = ("upper plate",)
    parameters = (
        Parameter(
            "grains",
            400,
            "",
            160,
            4000,
            "number of grains, in steps of 16; the cell is 2 R long for every 16 of the usual sizes (paper: 800)",
        ),
        Parameter(
            "packing_fraction",
            0.88,
            "",
            0.5,
            1.2,
            "rest area of the grains over the area between the plates; jammed above 0.84",
        ),
        Parameter(
            "protocol",
            STEADY,
            "",
            STEADY,
            LARGE,
            "0 steady shear; cycles of 1 small (strain 0.002), 2 middle (0.04), 3 large (2.0) amplitude",
        ),
        Parameter("strain", 1.0, "", 0.01, 20.0, "shear strain of the steady shear", live=True),
        Parameter("cycles", 2, "", 1, 50, "number of cycles", live=True),
        Parameter("friction", 0.0, "", 0.0, 10.0, FRICTION, live=True),
        hand(STRONGEST),
        *SIZES,
        *MATERIAL,
        *PAPER,
        *SOLVER,
    )

    def validate(self, settings: Values) -> None:
        if _teeth(settings) < LEAST_TEETH:
            raise InputError(
                Text(
                    "too few grains of these sizes for a cell: it takes {least}, or larger ones",
                    least=whole_above(LEAST_TEETH * _grains_a_tooth(settings)),
                )
            )

    def ingredients(self, settings: Values) -> Ingredients:
        return Ingredients(periodic=True, friction=float(settings["friction"]) > 0.0)

    def steps(self, settings: Values) -> int:
        if int(settings["protocol"]) != STEADY:
            return 4 * _quarter(settings) * int(settings["cycles"])
        return max(1, round(float(settings["strain"]) * _cell(settings)[2] / step(settings)))

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        grains = recipe(settings, packing)
        teeth, width, height = _cell(settings)
        depth = NOTCH - TIP
        world = RigidWorld(
            [
                RigidBody("lower plate", "wall", discs=_discs(teeth, 1.0)),
                RigidBody(
                    "upper plate",
                    "piston",
                    position=(0.5 * width, height),
                    discs=[(x - 0.5 * width, y, r) for x, y, r in _discs(teeth, -1.0)],
                    axis=(1.0, 0.0),
                ),
            ]
        )
        # One period of the region, to the bottom of the notches.
        outline: list[Point] = [
            (0.0, -depth),
            (width, -depth),
            (width, height + depth),
            (0.0, height + depth),
        ]
        packed = pack(
            grains,
            seed=seed,
            outline=outline,
            world=world,
            box=PeriodicBox(width),
            count=round(teeth * _grains_a_tooth(settings)),
            tolerance=min(1e-3, float(settings["tolerance"])),
            progress=progress,
        )
        top = world["upper plate"]

        def reach(_: Packing, __: str, target: Point) -> Point:
            # A plate that goes round: a hand means the image of a place that is nearest to it.
            turns = round((top.position[0] - target[0]) / width)
            return target[0] + turns * width, target[1]

        return Setup(
            packing=packed,
            world=world,
            solver=solver(settings),
            handles=(Handle("upper plate", "upper plate", (1.0, 0.0), 3.0),),
            bounds=(0.0, -depth - 2.0 * DISC, width, height + depth + 2.0 * DISC),
            outline=outline,
            friction=friction(settings, len(packed)),
            reach=reach,
            curve=Curve(
                "shear strain",
                "shear stress [k]",
                lambda _, __: shear_strain(world, height),
                lambda _, increment: plate_stresses(world, width, increment)[0],
            ),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        if increment >= self.steps(settings):
            return None
        _, _, height = _cell(settings)
        top = setup.world["upper plate"]
        return {
            "upper plate": (top.home[0] + height * _strain(settings, increment + 1), top.home[1])
        }

    def place_in_drive(self, increment: int, before: Values, after: Values) -> int:
        if int(after["protocol"]) == STEADY:
            return super().place_in_drive(increment, before, after)
        return round(increment * _quarter(after) / _quarter(before))

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        width = _cell(settings)[1]
        shear, normal = plate_stresses(setup.world, width, latest.now)
        if normal <= 0.0:
            return Remarks(("the grains do not reach from plate to plate: nothing holds",))
        template = "pressure {normal:.4f} k, shear stress over pressure {ratio:+.3f}"
        stresses = Text(template, normal=normal, ratio=shear / normal)
        fall = sudden_fall(setup, latest)
        if fall == 0.0:
            return Remarks((stresses,))
        text = Text("avalanche: the shear stress fell by {fall:.2g} k", fall=fall)
        highlight = who_took_part(setup.packing, latest)
        return Remarks((stresses, text), highlight, {"avalanche": text})

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _stresses_agree(setup)]


def _grains_a_tooth(settings: Values) -> float:
    """So many that the plates are as far apart whatever the sizes of the grains."""
    return AREA_A_TOOTH / recipe(settings, "mixed").mean_area()


def _teeth(settings: Values) -> int:
    """Of each plate."""
    return int(int(settings["grains"]) / _grains_a_tooth(settings))


def _cell(settings: Values) -> tuple[int, float, float]:
    """Teeth of a plate, width of the cell, and height from the lower to the upper tips' centres [R]."""
    teeth = _teeth(settings)
    width = TOOTH * teeth
    grains = teeth * AREA_A_TOOTH
    # What is open of a notch under the line of the tips: the circle's segment less one half of each disc.
    segment = NOTCH**2 * (TIP_ANGLE - math.sin(TIP_ANGLE) * math.cos(TIP_ANGLE))
    notch = segment - 0.5 * TOOTH_DISCS * math.pi * DISC**2
    height = (grains / float(settings["packing_fraction"]) - 2.0 * teeth * notch) / width
    return teeth, width, height


def _discs(teeth: int, up: float) -> list[tuple[float, float, float]]:
    """Discs of a plate whose tips' centres lie at y = 0 and whose grains are above (``up`` = 1) or below it (−1)."""
    discs = []
    for tooth in range(teeth):
        for k in range(TOOTH_DISCS):
            angle = TIP_ANGLE * (2.0 * k / TOOTH_DISCS - 1.0)
            x = TOOTH * (tooth + 0.5) + NOTCH * math.sin(angle)
            discs.append((x, up * (TIP - NOTCH * math.cos(angle)), DISC))
    return discs


def shear_strain(world: RigidWorld, height: float) -> float:
    """Way of the upper plate over the height between the plates."""
    top = world["upper plate"]
    return (top.position[0] - top.home[0]) / height


def plate_stresses(world: RigidWorld, width: float, increment: Increment) -> tuple[float, float]:
    """(shear stress, normal stress) [k] on the upper plate."""
    return plate_stress(increment.reactions[world.index("upper plate")], width)


def _quarter(settings: Values) -> int:
    """Increments in a quarter of a cycle."""
    way = AMPLITUDE[int(settings["protocol"])] * _cell(settings)[2]
    return max(QUARTER, math.ceil(way / step(settings)))


def _strain(settings: Values, increments: int) -> float:
    """Shear strain that the script asks for after so many increments."""
    protocol = int(settings["protocol"])
    if protocol == STEADY:
        return increments * step(settings) / _cell(settings)[2]
    return AMPLITUDE[protocol] * there_and_back(increments / _quarter(settings))


def _stresses_agree(setup: Setup) -> Check:
    """The paper's two ways to the stress: the force on the plates, and the sum over the contacts."""
    name = "normal stress from the plates' force and from the contacts agree within 10 %"
    if setup.friction is not None:
        return Check(name, None, "contacts are measured without their friction")
    contacts, forces = on_bodies(setup)
    assert setup.packing.box is not None
    width = setup.packing.box.width
    _, plate = plate_stress(forces[setup.world.index("upper plate")], width)
    depth = setup.outline[2][1] - setup.outline[1][1]
    area = width * (depth - (NOTCH - TIP))  # between the plates' mean lines
    pairs = observables.grain_contacts(setup.packing)
    inside = float(observables.stress(pairs, area, contacts, setup.packing)[1, 1])
    if plate < 1e-3:
        return Check(name, None, f"pressure {plate:.2g} k: too low to compare")
    return Check(name, abs(inside - plate) < 0.1 * plate, f"{plate:.4f} and {inside:.4f} k")
