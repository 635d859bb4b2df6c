"""The runs of the gallery: every scene by its own script, its packings side by side."""

from __future__ import annotations

from collections.abc import Callable

from sandbox.player.tape import Tape
from sandbox.record.record import in_step
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes import registry

SEED = 1
MOMENTS, GRAINS = 240, 90_000  # that a tape keeps: under 1 MB of page
# Smaller than by default, so that grains can be told apart on a phone and a page is loaded at once.
SMALLER: dict[str, dict[str, object]] = {
    "biaxial_periodic": {"grains": 150},
    "couette": {"grains": 160},
    "avalanches": {"grains": 150},
    "intruder": {"grains": 200, "intruder_radius": 3.5},
    "hopper": {"grains": 160, "width": 18.0, "orifice": 2.5},
    "gravity_hopper": {"grains": 120},
}
ORDER = ("regular", "mixed", "auxetic")
BUILT = 0.3  # of the time that a scene takes

Tell = Callable[[str, float], None]  # which scene, and the share of it that is done


def run(name: str, steps: int | None, tell: Tell) -> Tape:
    """A scene, all but its size at the defaults, by its script, for so many increments at most."""
    scene = registry.get(name)
    packings = [packing for packing in ORDER if packing in scene.packings]
    sessions = [Session(name, packing, SEED, SMALLER.get(name)) for packing in packings]
    for number, session in enumerate(sessions):
        session.build(_part(tell, name, number / len(sessions), 1.0 / len(sessions)))
        session.submit(Protocol(True))
    most = steps or scene.steps(sessions[0].settings)
    tape = Tape(most_moments=MOMENTS, most_grains=GRAINS)
    tape.add([session.frame() for session in sessions])
    increments = 0
    for finished in in_step(sessions):
        if finished:
            increments += 1
            tape.add([session.frame() for session in sessions])
            tell(name, BUILT + (1.0 - BUILT) * increments / most)
            if increments == most:
                break
    return tape


def _part(tell: Tell, name: str, before: float, width: float) -> Tell:
    """What tells of one of several that are built."""
    return lambda _, share: tell(name, BUILT * (before + width * share))
