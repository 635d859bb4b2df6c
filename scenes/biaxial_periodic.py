"""A square periodic box that shrinks: Fig. 2d and "Coordination" of Haver et al., doi:10.1073/pnas.2317915121."""

from __future__ import annotations

import math

from core import observables
from core.generate import Progress, pack
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment
from core.rigid import Point, RigidWorld
from scenes.checks import Check, Track
from scenes.grains import MATERIAL, PAPER, SIZES, recipe
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.relaxing import SOLVER, step
from scenes.remarks import Latest, Remarks
from scenes.scene import STRONGEST, Curve, Handle, Ingredients, Scene, Setup, Values, hand, solver
from scenes.text import Text

# The pressure [k] that counts as the onset of rigidity, whatever C: how far a grain is squeezed by it is set by k.
ONSET = 5e-4
MOST_STRAIN = 0.5  # volumetric strain at which a hand is stopped
GRAB = 4.0  # radius of the handle [R]
ISOSTATIC = 4.0  # contacts a grain that frictionless discs need in order not to move


@register
class BiaxialPeriodic(Scene):
    """Starts where the packing has just become rigid; volumetric strain ε_v = L²/L0² − 1 counts from there."""

    name = "biaxial_periodic"
    title = "Shrinking box"
    question = "How hard does a packing push back when it is squeezed from all sides?"
    about = (
        "A box without walls: what leaves on one side comes in on the other. "
        "Drag its corner to shrink it; auxetic grains give way, regular ones push back."
    )
    default_steps = 39
    handle_names = ("box",)
    parameters = (
        Parameter("grains", 500, "", 50, 5000, "number of grains, exactly"),
        Parameter(
            "strain",
            0.1,
            "",
            0.005,
            0.4,
            "volumetric strain −ε_v of the scripted squeeze",
            live=True,
        ),
        hand(STRONGEST),
        *SIZES,
        *MATERIAL,
        *PAPER,
        *SOLVER,
    )

    def ingredients(self, settings: Values) -> Ingredients:
        del settings
        return Ingredients(rigid=False, periodic=True)

    def steps(self, settings: Values) -> int:
        # The box at the onset is not built yet; frictionless discs jam at 0.84, and a step too many does no harm.
        side = math.sqrt(float(settings["grains"]) * recipe(settings, "mixed").mean_area() / 0.84)
        shrink = side * (1.0 - math.sqrt(1.0 - float(settings["strain"])))
        return max(1, math.ceil(shrink / step(settings)))

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        packed = pack(
            recipe(settings, packing),
            seed=seed,
            count=int(settings["grains"]),
            packing_fraction=0.84,
            target_pressure=ONSET,
            tolerance=min(1e-3, float(settings["tolerance"])),
            progress=progress,
        )
        assert packed.box is not None
        side = packed.box.width
        least = side * math.sqrt(1.0 - MOST_STRAIN)

        def box(point: Point) -> PeriodicBox:
            wanted = min(max(0.5 * (point[0] + point[1]), least), side)
            return PeriodicBox(wanted, wanted)

        return Setup(
            packing=packed,
            world=RigidWorld(),
            solver=solver(settings),
            handles=(Handle("box", "corner of the box", (-math.sqrt(0.5), -math.sqrt(0.5)), GRAB),),
            bounds=(-1.0, -1.0, side + 1.0, side + 1.0),
            outline=[(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)],
            box_target=box,
            curve=Curve(
                "volumetric strain −ε_v",
                "pressure [k]",
                lambda now, _: -volumetric_strain(now, side),
                pressure,
            ),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        full = setup.outline[1][0]
        end = full * math.sqrt(1.0 - float(settings["strain"]))
        side = full - (increment + 1) * setup.solver.step
        if side <= end - setup.solver.step + 1e-9:
            return None
        side = max(side, end)
        return {"box": (side, side)}

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        del settings
        everyone, backbone = observables.coordination(setup.packing, latest.now.grain_contacts)
        text = "{backbone:.2f} contacts a grain, {everyone:.2f} with rattlers"
        return Remarks((Text(text, backbone=backbone, everyone=everyone),))

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _never_floppy(setup, track), _stiffens(track)]


def volumetric_strain(packing: Packing, side: float) -> float:
    """ε_v = L²/L0² − 1 with L0 = ``side`` [R]; negative where the box has shrunk."""
    assert packing.box is not None
    return packing.box.area / side**2 - 1.0


def pressure(packing: Packing, increment: Increment) -> float:
    """Pressure in the periodic cell [k]."""
    assert packing.box is not None
    return observables.pressure(observables.stress(increment.grain_contacts, packing.box.area))


def _never_floppy(setup: Setup, track: Track) -> Check:
    name = f"a rigid packing has at least {ISOSTATIC:g} contacts a grain, rattlers left out"
    contacts = observables.grain_contacts(setup.packing)
    _, backbone = observables.coordination(setup.packing, contacts)
    pressure_now = float(track.force[-1])
    measured = f"Z = {backbone:.2f} at pressure {pressure_now:.3g} k"
    if pressure_now < ONSET:
        return Check(name, None, f"{measured}: it is not rigid")
    # A finite packing needs 2/N fewer, and a tolerance leaves some contacts open.
    return Check(name, backbone > ISOSTATIC - 0.1, measured)


def _stiffens(track: Track) -> Check:
    name = "the pressure rises when the box shrinks"
    if len(track.stroke) < 10 or float(track.stroke.max()) < 0.01:
        return Check(name, None, "the box has hardly shrunk yet")
    smallest, largest = int(track.stroke.argmin()), int(track.stroke.argmax())
    low, high = float(track.force[smallest]), float(track.force[largest])
    return Check(name, high > low, f"from {low:.3g} to {high:.3g} k")
