"""Claims about a run: what they look at, what they come to, and those that hold in every scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core import observables
from core.arrays import Floats
from core.generate import inside
from core.packing import Packing
from core.rigid import Point, RigidWorld
from core.system import System
from scenes.outlet import Outlet
from scenes.text import counted


@dataclass(frozen=True)
class Track:
    """What the checks of a scene look at: the curve so far. Arrays (M,), one entry an increment."""

    stroke: np.ndarray  # [R], or what the scene plots
    force: np.ndarray  # that resists the drive [k R], or what the scene plots
    grains_out: np.ndarray
    residual: np.ndarray
    converged: np.ndarray
    initial_grains: int


@dataclass(frozen=True)
class Check:
    """A claim about a run. ``holds`` is None where the run was too short to tell."""

    name: str
    holds: bool | None
    measured: str


def on_bodies(system: System) -> tuple[observables.RigidContacts, Floats]:
    """Contacts of grains and bodies as they stand, and what they do to each body, (B, 3) [k R, k R²], without friction."""
    primitives, owner = system.world.primitives()
    contacts = observables.body_contacts(system.packing, primitives)
    return contacts, observables.reactions(contacts, owner, system.world.placement())


def below_height(outline: Sequence[Point], y: float) -> list[Point]:
    """The outline with what is higher than ``y`` [R] brought down to it: for a body with a level face."""
    return [(x, min(corner, y)) for x, corner in outline]


def grains_kept(
    packing: Packing, outlet: Outlet | None, region: list[Point], track: Track
) -> Check:
    """All that there were are within ``region`` [R], or have left."""
    out = int(track.grains_out[-1]) if len(track.grains_out) else 0
    complete = len(packing) + out == track.initial_grains
    astray = ~inside(region, *packing.folded())
    if outlet is not None:  # on their way out, or out and counted after the next increment
        astray &= ~(outlet.has_come_out(packing) | outlet.gone(packing))
    stray = int(astray.sum())
    return Check(
        "no grain is lost and none has passed a wall",
        complete and stray == 0,
        f"{stray} astray" if outlet is None else f"{out} left by the outlet, {stray} astray",
    )


def nothing_inside(packing: Packing, world: RigidWorld) -> Check:
    """No body is where grains are."""
    worst = 0.0
    primitives, _ = world.primitives()
    contacts = observables.body_contacts(packing, primitives)
    if len(contacts.grain):
        worst = float(np.max(contacts.overlap / packing.rest_radius[contacts.grain]))
    return Check(
        "no grain sinks into a body by half its radius",
        worst < 0.5,
        f"deepest overlap {worst:.3f} of a radius",
    )


def converged(track: Track) -> Check:
    """What is shown is in balance."""
    if not len(track.converged):
        return Check("at least nine of ten increments converge", None, "nothing has moved yet")
    share = float(np.mean(track.converged))
    return Check(
        "at least nine of ten increments converge",
        share >= 0.9,
        f"{share:.1%} of {counted(len(track.converged), 'increment')}",
    )
