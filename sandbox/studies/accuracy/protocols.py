"""What is walked: for each scene where its short protocol begins and how long it is, and which settings are swept."""

from __future__ import annotations

from dataclasses import dataclass

from scenes.parameter import Value
from scenes.scene import BY_MACHINE

# Largest distance of the force-bearing grains of two tight walks (root of the mean square) that counts as the same path [R].
APART = 0.03


@dataclass(frozen=True)
class Protocol:
    """Lengths count in the scene's own increments."""

    lead: int  # increments of the scripted drive before the protocol begins
    length: int  # of the protocol
    starts: int  # seeds 1, 2, …: as many beginnings
    beyond: int = (
        0  # length of the walks that are compared as distributions; 0: the path is not chaotic
    )
    least_force: float = 0.0  # [k R] the lead goes on, until the handle feels that much
    settings: tuple[tuple[str, Value], ...] = ()


PROTOCOLS: dict[str, Protocol] = {
    "single_grain": Protocol(lead=10, length=8, starts=1),
    "two_ellipses": Protocol(lead=0, length=72, starts=1),
    "grain_row": Protocol(lead=10, length=8, starts=3),
    "biaxial_press": Protocol(lead=32, length=8, starts=3),
    "biaxial_periodic": Protocol(lead=8, length=4, starts=3, beyond=30),
    "couette": Protocol(lead=20, length=4, starts=3, beyond=30),
    "avalanches": Protocol(lead=40, length=8, starts=4, beyond=60),
    "intruder": Protocol(lead=20, length=4, starts=4, beyond=40, settings=(BY_MACHINE,)),
    "hopper": Protocol(
        lead=100, length=4, starts=3, beyond=30, least_force=0.1, settings=(BY_MACHINE,)
    ),
    "gravity_hopper": Protocol(lead=20, length=4, starts=3, beyond=30),
}


@dataclass(frozen=True)
class Sweeps:
    """Which settings are tried. Increments are shares of the scene's own."""

    reference_step: float
    reference_tolerance: float
    tolerances: tuple[float, ...]
    steps: tuple[float, ...]  # besides the scene's own, with ``step_tolerances``
    step_tolerances: tuple[float, ...]
    peer_tolerances: tuple[float, ...]
    stiffness: tuple[float, ...]
    budgets: tuple[int, ...]
    beyond_tolerances: tuple[float, ...]
    timings: int  # walks of which the middle time counts


FULL = Sweeps(
    reference_step=1 / 16,
    reference_tolerance=1e-10,
    tolerances=(1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8),
    steps=(2.0, 0.5, 0.25),
    step_tolerances=(1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8),
    peer_tolerances=(1e-1, 1e-2, 1e-3, 1e-4, 1e-5),
    stiffness=(12.5, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0),
    budgets=(25, 50, 100, 200, 400, 800, 1600),
    beyond_tolerances=(1e-1, 1e-2, 1e-3, 1e-5),
    timings=3,
)
QUICK = Sweeps(
    reference_step=1 / 8,
    reference_tolerance=1e-10,
    tolerances=(1e-1, 1e-2, 1e-3, 1e-4, 1e-6),
    steps=(0.5,),
    step_tolerances=(1e-2, 1e-3, 1e-6),
    peer_tolerances=(1e-1, 1e-2, 1e-3),
    stiffness=(25.0, 50.0, 100.0, 200.0),
    budgets=(50, 200, 800),
    beyond_tolerances=(1e-1, 1e-2, 1e-3),
    timings=1,
)


def protocol(scene: str, quick: bool) -> Protocol:
    """The protocol of a scene: a plain one where none is written down. Quick: one or two beginnings, half as long."""
    whole = PROTOCOLS.get(scene, Protocol(lead=10, length=4, starts=2))
    if not quick:
        return whole
    return Protocol(
        lead=whole.lead,
        length=max(2, whole.length // 2),
        starts=min(whole.starts, 2) if whole.beyond else 1,
        beyond=min(whole.beyond, 10),
        least_force=whole.least_force,
        settings=whole.settings,
    )
