"""Stress drops in simple shear: Fig. 5 of Haver et al., doi:10.1073/pnas.2317915121."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.avalanches import force_changes, participation, stress_drops, weights
from core.generate import Progress, pack
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment
from core.rigid import Point, RigidWorld
from scenes.checks import Check, Track
from scenes.drives import depth_after
from scenes.grains import MATERIAL, PAPER, SIZES, recipe
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.relaxing import solver_parameters, step
from scenes.remarks import Latest, Remarks
from scenes.scene import STRONGEST, Curve, Handle, Ingredients, Scene, Setup, Values, hand, solver
from scenes.text import Text, counted

LEAST_DROP = 0.005  # of the pressure at the start: smaller falls of the stress are no avalanche
ANNOUNCED = 0.02  # of the pressure at the start: smaller ones are told, and not announced
GRAB = 4.0  # radius of the handle [R]


@register
class Avalanches(Scene):
    """Simple shear of a cell that is periodic both ways (Lees and Edwards): the image above slides over the one below.

    Without plates there is no grain unlike the others, so that shares of grains mean the same everywhere; and it is half the
    work of the shear cell. All kinds of packings are compressed to the same pressure, then sheared at fixed volume. The lower
    the pressure, the more alike they are: grains that are hardly squeezed are discs, whatever their Poisson's ratio.
    """

    name = "avalanches"
    title = "Avalanches"
    question = "When the grains give way, how many of them take part?"
    about = (
        "Every kind of packing under the same pressure, sheared from image to image. "
        "At each drop of the stress, the grains whose forces have changed most light up."
    )
    default_steps = 336
    handle_names = ("box",)
    parameters = (
        Parameter("grains", 400, "", 60, 4000, "number of grains, exactly"),
        Parameter("pressure", 0.06, "k", 0.002, 0.2, "pressure at the start, within 1 %"),
        Parameter("strain", 0.5, "", 0.01, 20.0, "shear strain of the scripted drive", live=True),
        hand(STRONGEST),
        *SIZES,
        *MATERIAL,
        *PAPER,
        # The shear stress is a small difference of large contact forces: at 1e-2 it is off by some per cent, and avalanches
        # come at the wrong strains. At 1e-3 one packing of four still took another way at once; 1e-4 costs 1.7 times as
        # much, less than a picture (`study accuracy`).
        *solver_parameters(tolerance=1e-4),
    )

    def ingredients(self, settings: Values) -> Ingredients:
        del settings
        return Ingredients(rigid=False, periodic=True)

    def steps(self, settings: Values) -> int:
        # The cell is not built yet; under little pressure its packing fraction is near that of jamming, 0.84.
        side = math.sqrt(float(settings["grains"]) * recipe(settings, "mixed").mean_area() / 0.84)
        return max(1, round(float(settings["strain"]) * side / step(settings)))

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        packed = pack(
            recipe(settings, packing),
            seed=seed,
            count=int(settings["grains"]),
            packing_fraction=0.86,
            target_pressure=float(settings["pressure"]),
            tolerance=min(1e-3, float(settings["tolerance"])),
            progress=progress,
        )
        assert packed.box is not None
        side = packed.box.width

        def box(point: Point) -> PeriodicBox:
            return PeriodicBox(side, side, point[0] - 0.5 * side)

        def handle(now: PeriodicBox) -> Point:
            return 0.5 * side + now.shift, side

        def reach(now: Packing, _: str, target: Point) -> Point:
            # The image above goes round: a hand means the place that is nearest to the handle.
            assert now.box is not None
            turns = round((handle(now.box)[0] - target[0]) / side)
            return target[0] + turns * side, target[1]

        return Setup(
            packing=packed,
            world=RigidWorld(),
            solver=solver(settings),
            handles=(Handle("box", "image above", (1.0, 0.0), GRAB),),
            bounds=(-1.0, -1.0, side + 1.0, side + 1.0),
            outline=[(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)],
            box_target=box,
            box_handle=handle,
            reach=reach,
            curve=Curve("shear strain", "shear stress [k]", shear_strain, shear_stress),
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        side = setup.outline[1][0]
        shift = depth_after(increment, setup.solver.step, float(settings["strain"]) * side)
        return None if shift is None else {"box": (0.5 * side + shift, side)}

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        if latest.before is None or latest.curve.shape[1] < 2:
            return Remarks()
        (before, now), (high, low) = latest.curve[:, -2:]
        fall = (high - low) * np.sign(now - before)
        if fall <= LEAST_DROP * float(settings["pressure"]):
            return Remarks()
        weight = taking_part(setup.packing, latest.before, latest.now)
        share = participation(weight)
        text = Text(
            "avalanche: the shear stress fell by {fall:.2g} k, as if {count:.0f} of {total} {total:grain|grains} took part",
            fall=float(fall),
            count=share * len(weight),
            total=len(weight),
        )
        large = fall > ANNOUNCED * float(settings["pressure"])
        return Remarks((text,), weight > weight.mean(), {"avalanche": text} if large else {})

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _falls_are_sudden(track)]


def shear_strain(packing: Packing, _: Increment) -> float:
    """Shift of the image above over the height of the cell."""
    assert packing.box is not None
    return packing.box.shift / packing.box.height


def shear_stress(packing: Packing, increment: Increment) -> float:
    """τ = −(σ_xy + σ_yx)/2 [k]: positive where the grains resist a shift towards +x."""
    assert packing.box is not None
    tensor = observables.stress(increment.grain_contacts, packing.box.area)
    return -0.5 * float(tensor[0, 1] + tensor[1, 0])


def taking_part(packing: Packing, before: Increment, now: Increment) -> NDArray[np.float64]:
    """How much each grain takes part in what happened between two increments, (N,) [k² R²]."""
    label = packing.label
    return weights(force_changes(before.grain_contacts, now.grain_contacts, label, label), label)


def _falls_are_sudden(track: Track) -> Check:
    name = "the stress builds up step by step and falls at once"
    if np.any(np.diff(track.stroke) < 0.0):
        return Check(name, None, "for a drive that goes one way")
    places, drops = stress_drops(track.force, 0.0)
    if len(track.force) < 100 or len(places) < 5:
        falls, increments = counted(len(places), "fall"), counted(len(track.force), "increment")
        return Check(name, None, f"{falls} in {increments}: too few")
    rise = float(np.diff(track.force).max())
    return Check(
        name,
        float(drops.max()) > rise,
        f"largest fall {drops.max():.2g} k, largest rise {rise:.2g} k",
    )
