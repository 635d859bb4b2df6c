"""One grain between plates: Fig. 1ef and "Single Particle Compression" of Haver et al., doi:10.1073/pnas.2317915121.

Every grain of the model answers a squeeze with the same stiffness k, whatever its size; what differs is where the material
goes. Lengths here are in the radius of a large grain, forces in k R. For what the checks compare with, see their functions.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.errors import InputError
from core.generate import Progress
from core.material import area_modulus
from core.packing import Packing
from core.rigid import Point, RigidBody, RigidWorld
from core.settings import LONGEST_STEP, Settings
from scenes.checks import Check, Track, below_height
from scenes.drives import depth_after, steps_to
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.relaxing import MAX_ITERATIONS, TOLERANCE
from scenes.remarks import Latest, Remarks
from scenes.scene import STRONGEST, Handle, Scene, Setup, Values, hand, hand_strength
from scenes.text import Text

APART = 1.7  # half the distance between the centres of two grains, in their radius
PLATE = 0.6  # thickness, in radii of a grain
LIFT = 0.5  # how far the plate may be drawn up, in radii of a grain
OVERHANG = 1.7  # of a plate beyond the centre of a grain, in its radius
NOISE = 1e-6  # of a ratio of two strains, from the tolerance of the relaxation
PLATES = ("left plate", "right plate")


@register
class SingleGrain(Scene):
    name = "single_grain"
    title = "Single grain"
    question = "Squeeze it from above: does it grow wider, or narrower?"
    about = (
        "One grain between two plates, or one of each kind side by side. "
        "At first both are equally stiff; only their width tells them apart."
    )
    default_steps = 80
    handle_names = ("plate",)
    parameters = (
        Parameter(
            "poisson_ratio",
            0.8,
            "",
            0.0,
            0.99,
            "Poisson's ratio of the regular grain; that of the auxetic grain is minus this",
            live=True,
        ),
        Parameter(
            "contact_stiffness",
            50.0,
            "k",
            5.0,
            2000.0,
            "stiffness of a contact over that of a grain: higher is harder and slower",
            live=True,
        ),
        Parameter("radius", 1.0, "R", 0.2, 10.0, "radius of a grain at rest"),
        Parameter("four_plates", False, "", False, True, "squeeze from the sides as well"),
        Parameter(
            "compression",
            0.2,
            "",
            1e-4,
            0.4,
            "largest approach of the plates, in diameters",
            live=True,
        ),
        hand(STRONGEST),
        Parameter(
            "step", 0.005, "R", 1e-4, 0.15, "longest move of the plate in one increment", live=True
        ),
        replace(TOLERANCE, default=1e-8, low=1e-9),
        MAX_ITERATIONS,
    )

    def validate(self, settings: Values) -> None:
        longest = LONGEST_STEP * float(settings["radius"])
        if float(settings["step"]) > longest * (1.0 + 1e-9):
            raise InputError(f"step must be at most {longest:.3g} R for grains of that radius")

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        del seed, progress  # nothing is random, nothing takes long
        radius, nu = float(settings["radius"]), float(settings["poisson_ratio"])
        four = bool(settings["four_plates"])
        ratios = {"regular": [nu], "auxetic": [-nu], "mixed": [nu, -nu]}[packing]
        # Four plates: two grains share a wall between them.
        apart = (1.0 + 0.5 * PLATE if four else APART) * radius
        x = np.array([0.0] if len(ratios) == 1 else [-apart, apart])
        grains = Packing(x, radius, radius, ratios, float(settings["contact_stiffness"]))
        world, half_width = _plates(grains, four)
        side = half_width + (PLATE * radius if four else 0.0)
        plates = tuple((name, world[name].home[0]) for name in PLATES) if four else ()

        def follow(_: Packing, moved: RigidWorld) -> None:
            """The side plates keep the distance of the top plate; between two grains stands a wall, else each goes half."""
            approach = world["plate"].home[1] - moved["plate"].position[1]
            share = 1.0 if len(ratios) == 2 else 0.5
            for (name, home), inwards in zip(plates, (1.0, -1.0), strict=True):
                moved[name].position = (home + inwards * share * approach, radius)

        top = (2.0 + LIFT + PLATE) * radius
        return Setup(
            packing=grains,
            world=world,
            solver=Settings(
                step=float(settings["step"]),
                tolerance=float(settings["tolerance"]),
                max_iterations=int(settings["max_iterations"]),
                hand_strength=hand_strength(settings),
            ),
            handles=(Handle("plate", "plate", (0.0, -1.0), half_width),),
            bounds=(-side - 0.2 * radius, -1.2 * PLATE * radius, side + 0.2 * radius, top),
            outline=[(-side, 0.0), (side, 0.0), (side, top), (-side, top)],
            follow=follow if four else None,
        )

    def adjust(self, setup: Setup, settings: Values, changed: frozenset[str]) -> None:
        super().adjust(setup, settings, changed)
        if "poisson_ratio" in changed:
            nu = float(settings["poisson_ratio"])
            setup.packing.poisson_ratio = np.copysign(nu, setup.packing.poisson_ratio)

    def region(self, setup: Setup) -> list[Point]:
        return below_height(setup.outline, setup.world["plate"].position[1])

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        plate = setup.world["plate"]
        depth = depth_after(increment, setup.solver.step, _way(settings))
        return None if depth is None else {"plate": (plate.home[0], plate.home[1] - depth)}

    def steps(self, settings: Values) -> int:
        return steps_to(_way(settings), float(settings["step"]))

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        """Each grain's height and width, and for two plates their ratio."""
        del settings
        packing = setup.packing
        texts = []
        for i in range(len(packing)):
            tall, wide = _strains(packing)[:, i]
            kind = "auxetic" if packing.auxetic[i] else "regular"
            text = Text(
                "{kind}: height {tall:+.1f} %, width {wide:+.1f} %",
                kind=kind,
                tall=100 * float(tall),
                wide=100 * float(wide),
            )
            if tall < -NOISE and setup.follow is None:
                text = Text(
                    "{strains}, Poisson's ratio {ratio:.2f} ({nu:.2f} at small strain)",
                    strains=text,
                    ratio=float(-wide / tall),
                    nu=float(packing.poisson_ratio[i]),
                )
            texts.append(text)
        return Remarks(tuple(texts) if len(latest.now.body_contacts.grain) else ())

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        own = [_stiffness(setup, track)]
        if setup.follow is None:
            own += [_overlap_share(setup), _poisson_ratio(setup), _width(setup)]
        return super().checks(setup, track) + own


def _plates(grains: Packing, four: bool) -> tuple[RigidWorld, float]:
    """Floor and plate, with ``four`` side plates and a wall between two grains; half the width of the plate [R]."""
    radius = float(grains.rest_radius[0])
    thick = PLATE * radius
    outermost = float(grains.x.max())
    half_width = outermost + (1.0 if four else OVERHANG) * radius
    reach = half_width + (thick if four else 0.0)

    def slab(width: float, height: float) -> list[tuple[tuple[Point, ...], float]]:
        """A rectangle about the origin."""
        w, h = 0.5 * width, 0.5 * height
        return [(((-w, -h), (w, -h), (w, h), (-w, h)), 0.0)]

    top = 2.0 * radius
    bodies = [
        RigidBody("floor", "wall", position=(0.0, -0.5 * thick), polygons=slab(2.0 * reach, thick)),
        RigidBody(
            "plate",
            "piston",
            position=(0.0, top),
            polygons=[
                (
                    (
                        (-half_width, 0.0),
                        (half_width, 0.0),
                        (half_width, thick),
                        (-half_width, thick),
                    ),
                    0.0,
                )
            ],
            axis=(0.0, -1.0),
            travel=(-LIFT * radius, 1.5 * radius),
        ),
    ]
    if four:
        for name, x in zip(PLATES, (-reach, reach), strict=True):
            inner = math.copysign(0.5 * thick, x)
            bodies.append(
                RigidBody(
                    name,
                    "piston",
                    position=(x - inner, radius),
                    polygons=slab(thick, top),
                )
            )
        if len(grains) == 2:
            bodies.append(
                RigidBody("wall", "wall", position=(0.0, radius), polygons=slab(thick, top))
            )
    return RigidWorld(bodies), half_width


def _way(settings: Values) -> float:
    """How far the plate goes [R]."""
    return 2.0 * float(settings["radius"]) * float(settings["compression"])


def _strains(packing: Packing) -> NDArray[np.float64]:
    """Strain of every grain's height and width, (2, N)."""
    tall, wide = packing.p - packing.q1, packing.p + packing.q1
    return np.array([tall, wide]) / packing.rest_radius - 1.0


def _first_squeeze(track: Track) -> int | None:
    """The first increment with the plate pressed down."""
    pressed = np.flatnonzero(track.stroke > 1e-12)
    return int(pressed[0]) if len(pressed) else None


def _stiffness(setup: Setup, track: Track) -> Check:
    """Force over approach at the first increment.

    Two plates: 1 k a grain. Four: C K/(2(2C + K)) with K = κ(1+ν), from the least of 4·C/2 (δ − e)² + K e² over the strain e;
    1/(1 − ν) for hard contacts. The next term is of the order of the strain, and its factor stays below 2.
    """
    packing = setup.packing
    first = _first_squeeze(track)
    if setup.follow is None:
        name, expected = "every grain has the stiffness k", float(len(packing))
    else:
        stiffness = packing.contact_stiffness
        modulus = area_modulus(packing.poisson_ratio, stiffness)
        expected = float(np.sum(stiffness * modulus / (2.0 * (2.0 * stiffness + modulus))))
        name = "squeezed from all sides, a grain has the stiffness of the closed form"
    if first is None:
        return Check(name, None, "not squeezed yet")
    strain = track.stroke[first] / (2.0 * float(packing.rest_radius[0]))
    measured = track.force[first] / track.stroke[first]
    # The residual is bounded by a share of the contact force, or of the floor where the force is less.
    solver = setup.solver
    floor = solver.force_floor * float(packing.rest_radius[0])
    residual = solver.tolerance * (1.0 + floor / (expected * track.stroke[first]))
    return Check(
        name,
        bool(abs(measured / expected - 1.0) < 2.0 * strain + NOISE + residual),
        f"{measured:.4f} k at {100 * strain:.2g} % compression, expected {expected:.4f} k",
    )


def _overlap_share(setup: Setup) -> Check:
    """Between two plates 2/C of the approach is overlap, the rest deformation, as far as the force is k times the approach."""
    packing = setup.packing
    name = "2/C of the approach is overlap, the rest deformation"
    primitives, _ = setup.world.primitives()
    contacts = observables.body_contacts(packing, primitives)
    upright = np.abs(contacts.fy) > np.abs(contacts.fx)
    approach = setup.world["plate"].home[1] - setup.world["plate"].position[1]
    strain = approach / (2.0 * float(packing.rest_radius[0]))
    if not 1e-12 < strain < 0.1:
        return Check(name, None, "for less than a tenth of compression")
    share = float(contacts.overlap[upright].sum()) / (approach * len(packing))
    expected = float(np.mean(2.0 / packing.contact_stiffness))
    solver = setup.solver
    floor = solver.force_floor * float(packing.rest_radius[0])
    residual = solver.tolerance * (1.0 + floor / approach)
    return Check(
        name,
        bool(abs(share / expected - 1.0) < 2.0 * strain + NOISE + residual),
        f"{share:.5f}, expected {expected:.5f}",
    )


def _poisson_ratio(setup: Setup) -> Check:
    """−(strain of the width)/(strain of the height) → ν.

    The least energy over the width b at height a, in radii: b = 2a/((1+ν)a² + 1 − ν). With a = 1 − e the ratio of strains is
    ν + (1+ν)(ν − ½) e + O(e²): so far it may be off, and a little.
    """
    name = "the strains of a grain have its Poisson's ratio"
    tall, wide = _strains(setup.packing)
    nu = setup.packing.poisson_ratio
    if np.any(tall > -1e-5):
        return Check(name, None, "not squeezed yet")
    ratio, e = -wide / tall, -tall
    allowed = (
        np.abs((1.0 + nu) * (nu - 0.5)) * e + 8.0 * e**2 + (NOISE + setup.solver.tolerance) / e
    )
    return Check(
        name,
        bool(np.all(np.abs(ratio - nu) < allowed)),
        ", ".join(f"{r:.3f} for {v:g}" for r, v in zip(ratio, nu, strict=True)),
    )


def _width(setup: Setup) -> Check:
    """At any compression: the width of least energy, b = 2a/((1+ν)a² + 1 − ν) in radii."""
    name = "at any compression the width follows from the height"
    tall, wide = 1.0 + _strains(setup.packing)
    nu = setup.packing.poisson_ratio
    closed = 2.0 * tall / ((1.0 + nu) * tall**2 + 1.0 - nu)
    worst = float(np.max(np.abs(wide - closed)))
    allowed = NOISE + setup.solver.tolerance
    return Check(name, worst < allowed, f"largest difference {worst:.1e} of a radius")
