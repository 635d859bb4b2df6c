"""A hopper that empties by itself, under gravity: the term that Haver et al., doi:10.1073/pnas.2317915121, name as missing.

Compare their Fig. 6e–g, where a piston pushes instead. Clogging by arches: To, Lai and Pak, doi:10.1103/PhysRevLett.86.71.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.friction import Friction
from core.generate import Progress, pack
from core.packing import Packing
from core.quasistatic import Increment, Quasistatic
from core.rigid import Point, RigidBody, RigidWorld, wall
from scenes.checks import Check, Track
from scenes.drives import there_and_back
from scenes.falls import who_took_part
from scenes.grains import FRICTION, MATERIAL, PAPER, SIZES, friction, recipe
from scenes.hopper import WALL, Shape, standing_arch
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.relaxing import solver_parameters
from scenes.remarks import Latest, Remarks
from scenes.scene import STRONGEST, Curve, Handle, Ingredients, Scene, Setup, Values, hand, solver
from scenes.text import Text, counted

DROP = 5.0  # a grain this far below the lips has left [R]
ROOM = 3.0  # between the grains and the brim at the start [R]
SHAKE = 1.0  # how far the funnel can be shaken to either side [R]
LEAST_CHANNEL = 1.0  # height of the filled channel above the funnel [R]
PAUSE = 60  # increments; a grain that nothing holds has left, or found a hold, long before
REST, TREMBLE = 240, 80  # increments of the scripted drive without and with shaking


@register
class GravityHopper(Scene):
    """No piston: the grains sink.

    A quasistatic solver knows no inertia and no time, so an increment here is a step of slow motion: a drag, as of honey,
    lets a free grain sink by ``fall`` and holds nothing that rests. Arches and clogs are those of Coulomb's law; the rate of
    the flow is that of the honey. Once everything has come to rest the hopper is empty or clogged, and waits for a hand.
    """

    name = "gravity_hopper"
    title = "Hopper under gravity"
    question = "Will it run empty, or will an arch hold the rest?"
    about = (
        "The grains sink through a narrow orifice by their own weight. "
        "When an arch blocks it, take the funnel and shake it."
    )
    default_steps = 960
    handle_names = ("funnel",)
    parameters = (
        Parameter("grains", 200, "", 20, 2000, "number of grains, near enough"),
        Parameter(
            "orifice",
            3.0,
            "diameters",
            0.3,
            8.0,
            "width of the orifice in diameters of a large grain",
        ),
        Parameter(
            "angle", 45.0, "deg", 0.0, 75.0, "angle of the funnel's sides from the horizontal"
        ),
        Parameter("width", 20.0, "R", 8.0, 80.0, "width of the channel"),
        Parameter(
            "tilt", 0.0, "deg", -40.0, 40.0, "tilt of the hopper: turns gravity to the right"
        ),
        Parameter(
            "gravity", 0.01, "k/R", 0.0005, 0.05, "weight of a large grain over R²", live=True
        ),
        Parameter(
            "fall",
            0.1,
            "R",
            0.01,
            0.3,
            "how far a grain that nothing holds sinks in one increment",
            live=True,
        ),
        Parameter("shake", 0.8, "R", 0.0, SHAKE, "amplitude of the scripted shaking", live=True),
        Parameter("friction", 0.5, "", 0.0, 10.0, FRICTION, live=True),
        Parameter("packing_fraction", 0.84, "", 0.3, 0.9, "packing fraction at the start"),
        hand(STRONGEST),
        *SIZES,
        *MATERIAL,
        *PAPER,
        # Shaking is the rougher, the further the funnel goes in one increment: a drag is all that inertia is here.
        *solver_parameters(step=0.1),
    )

    def ingredients(self, settings: Values) -> Ingredients:
        return Ingredients(friction=float(settings["friction"]) > 0.0, gravity=True)

    def validate(self, settings: Values) -> None:
        Shape(settings).check(LEAST_CHANNEL)

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        shape = Shape(settings)
        half_width, neck, lip = shape.half_width, shape.neck, (shape.lip_x, shape.lip_y)
        top = neck + shape.channel
        gravity, drag = _pull(settings)
        brim = top + ROOM + half_width * abs(math.tan(math.radians(float(settings["tilt"]))))
        right: list[Point] = [lip, (half_width, neck), (half_width, brim)]
        left: list[Point] = [(-x, y) for x, y in reversed(right)]
        full: list[Point] = [
            lip,
            (half_width, neck),
            (half_width, top),
            (-half_width, top),
            *left[1:],
        ]
        walls = [wall("right", right, WALL), wall("left", left, WALL)]
        px, py = (
            half_width,
            neck,
        )  # the hand takes the funnel by its shoulder, not in front of the orifice
        funnel = RigidBody(
            "funnel",
            "body",
            position=(px, py),
            segments=[
                (x0 - px, y0 - py, x1 - px, y1 - py, radius)
                for side in walls
                for x0, y0, x1, y1, radius in side.segments
            ],
            axis=(1.0, 0.0),
            travel=(-SHAKE, SHAKE),
        )
        lid = wall("lid", [(half_width, top), (-half_width, top)], WALL)
        gate = wall("gate", [(-lip[0], lip[1]), lip], WALL)
        packed = pack(
            recipe(settings, packing),
            seed=seed,
            outline=full,
            world=RigidWorld([*walls, lid, gate]),
            packing_fraction=shape.fraction,
            progress=progress,
        )
        return Setup(
            packing=packed,
            world=RigidWorld([funnel]),
            solver=solver(settings),
            handles=(Handle("funnel", "funnel", (1.0, 0.0), 3.0),),
            bounds=(-half_width - WALL - SHAKE, -DROP, half_width + WALL + SHAKE, brim),
            outline=[*left, *right],
            outlet=shape.outlet(-DROP, beside=False),  # they are seen to sink on
            focus=(shape.focus(-DROP, SHAKE),),
            friction=friction(settings, len(packed)),
            gravity=gravity,
            drag=drag,
            curve=Curve("increments", "grains that have left", None, None),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        """Shaking now and then: pauses of ``REST`` increments, then ``TREMBLE`` of shaking."""
        if not len(setup.packing):
            return None
        amplitude, funnel = float(settings["shake"]), setup.world["funnel"]
        k = increment % (REST + TREMBLE) - REST
        if k < 0 or amplitude == 0.0:
            return {"funnel": funnel.home}
        quarter = max(1, math.ceil(amplitude / setup.solver.step))
        sway = amplitude * there_and_back((k + 1) / quarter)
        return {"funnel": (funnel.home[0] + sway, funnel.home[1])}

    def adjust(self, setup: Setup, settings: Values, changed: frozenset[str]) -> None:
        super().adjust(setup, settings, changed)
        if not changed.isdisjoint(("gravity", "fall")):
            setup.gravity, setup.drag = _pull(settings)

    def place_in_drive(self, increment: int, before: Values, after: Values) -> int:
        del before, after  # it goes by pauses
        return increment

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        del settings
        count = len(setup.packing)
        if not count:
            return Remarks(("empty",))
        if latest.left and latest.waited > PAUSE and count + latest.left < latest.at_start:
            text = Text(
                "avalanche: it flows again, {count} {count:grain is|grains are} left", count=count
            )
            return Remarks((text,), who_took_part(setup.packing, latest), {"avalanche": text})
        if not latest.at_rest:
            return Remarks(("flowing",) if latest.left else ())
        found = self.arch(setup, latest.now)
        if found is None:
            text = Text(
                "at rest: {count} {count:grain stays|grains stay} on the funnel's sides",
                count=count,
            )
            return Remarks((text,))
        arch = int(found.sum())
        if count == latest.at_start:
            text = Text(
                "never started: an arch of {arch} holds all {count} {count:grain|grains}. Shake the funnel",
                arch=arch,
                count=count,
            )
            return Remarks((text,), found, {"arch": text})
        text = Text(
            "clogged: an arch of {arch} holds {count} {count:grain|grains}. Shake the funnel",
            arch=arch,
            count=count,
        )
        return Remarks((text,), found, {"clog": text})

    def arch(self, setup: Setup, now: Increment) -> NDArray[np.bool_] | None:
        middle = setup.world["funnel"].position[0] - setup.world["funnel"].home[0]
        return standing_arch(setup, now, np.where(now.body_contacts.x < middle, -1, 1))

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _nothing_hangs(setup, track)]

    def general_checks(self, setup: Setup, track: Track) -> list[Check]:
        funnel = setup.world["funnel"]
        moved = funnel.position[0] - funnel.home[0]
        outlet = setup.outlet
        assert outlet is not None
        there = replace(
            setup,
            outline=[(x + moved, y) for x, y in setup.outline],
            outlet=replace(outlet, below=tuple((x + moved, y) for x, y in outlet.below)),
        )
        return super().general_checks(there, track)


def _pull(settings: Values) -> tuple[Point, float]:
    """Gravity [k/R], and the drag [k/R²] that lets a free grain sink by ``fall``."""
    tilt, weight = math.radians(float(settings["tilt"])), float(settings["gravity"])
    gravity = (weight * math.sin(tilt), -weight * math.cos(tilt))
    return gravity, weight / float(settings["fall"])


def _nothing_hangs(setup: Setup, track: Track) -> Check:
    name = "no grain hangs in the air"
    out = track.grains_out
    if len(out) <= PAUSE or out[-1] > out[-PAUSE]:
        return Check(name, None, "the grains are on their way")
    loose = ~_held(setup.packing, setup.world)
    if not loose.any():
        return Check(name, True, f"all of {counted(len(loose), 'grain')} touch something")
    # The shaken funnel lets grains go at any time: those sink, or land, in one more increment.
    friction = None
    if setup.friction is not None:
        friction = Friction(setup.friction.coefficient, len(loose))
    further = Quasistatic(replace(setup, packing=setup.packing.copy(), friction=friction))
    further.begin({})
    while further.relax(1_000) is None:
        pass
    way = np.hypot(*(further.packing.state[:2] - setup.packing.state[:2]))
    weight = np.hypot(*setup.gravity) if setup.gravity is not None else 0.0
    sinks = way > 0.5 * weight / setup.drag if weight > 0.0 else np.zeros(len(way), dtype=bool)
    hangs = int((loose & ~sinks & ~_held(further.packing, setup.world)).sum())
    return Check(name, hangs == 0, f"{hangs} of the {int(loose.sum())} that touch nothing")


def _held(packing: Packing, world: RigidWorld) -> NDArray[np.bool_]:
    """True for the grains that touch something, (N,)."""
    pairs = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, world.primitives()[0])
    held = np.zeros(len(packing), dtype=np.bool_)
    for grains in (pairs.i, pairs.j, bodies.grain):
        held[grains] = True
    return held
