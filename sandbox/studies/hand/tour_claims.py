"""Guided tours played by a scripted hand, and what each of their sentences claims, held against what happened.

A hand that pulls steadily in the direction of the scene's drive does what a step asks for; in every packing of the step at once,
as one hand drives all panes of the window. Whatever a step says about the outcome stands in ``CLAIMS`` as a condition. A
sentence about a tendency is meant of most packings and judged over seeds.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from core import observables
from core.relaxation import FAILED
from sandbox.lessons import tours
from sandbox.lessons.lesson import Condition, Lesson, Step
from sandbox.lessons.moments import Moment, met
from sandbox.session.commands import Change, Command, DrawWall, Grab, Move, Place, Release
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from scenes.couette import plate_stresses
from scenes.grain_row import free_room

SLICE = 400  # force evaluations between two looks at whether to stop
PATIENCE = 900  # increments in which a step must be done
SETTING = 0.25  # what a step's slider is set to
BROKEN = frozenset(map(str, FAILED))


@dataclass
class Pane:
    """One packing of a step: its session, and what was plotted since the step began."""

    session: Session
    since: int = 0
    before: Frame | None = None  # when the step began
    forces: list[float] = field(default_factory=list)  # mean contact force after each increment

    @property
    def frame(self) -> Frame:
        """What is seen at the end of the step."""
        return self.session.frame()

    @property
    def plotted(self) -> np.ndarray:
        """The curve's force since the step began (M,)."""
        return self.session.history.curve[1, self.since :]

    @property
    def locked(self) -> bool:
        """Is its hand locked?"""
        return self.session.run.locked

    @property
    def events(self) -> list[str]:
        """Kinds of the events since the step began."""
        return [e.kind for e in self.session.history.events if e.increment >= self.since]

    @property
    def mean_contact_force(self) -> float:
        """Mean over contacts and the increments of the step [k R]."""
        return float(np.mean(self.forces)) if self.forces else 0.0


Panes = Mapping[str, Pane]
Claim = Callable[[Panes], bool]


def _of(panes: Panes, measure: Callable[[Pane], float]) -> dict[str, float]:
    return {kind: measure(pane) for kind, pane in panes.items()}


def _falling(panes: Panes, measure: Callable[[Pane], float], ratio: float = 1.0) -> bool:
    """Largest for regular, least for auxetic grains, by more than ``ratio`` between those two."""
    found = _of(panes, measure)
    ordered = [found[kind] for kind in ("regular", "mixed", "auxetic") if kind in found]
    return all(a > b for a, b in itertools.pairwise(ordered)) and (
        found["regular"] > ratio * found["auxetic"]
    )


def _only_regular_is_locked(panes: Panes) -> bool:
    return [kind for kind, pane in panes.items() if pane.locked] == ["regular"]


def _others_moved(panes: Panes, handle: str, least: float) -> bool:
    """The packings that are not locked have gone on by at least so far [R] in this step."""
    for kind, pane in panes.items():
        assert pane.before is not None
        then = next(h for h in pane.before.handles if h.name == handle)
        now = next(h for h in pane.frame.handles if h.name == handle)
        if kind != "regular" and math.dist((then.x, then.y), (now.x, now.y)) < least:
            return False
    return True


def _contact_force(pane: Pane) -> float:
    return pane.mean_contact_force


def _grown(pane: Pane) -> dict[str, tuple[float, float]]:
    """Strain of height and width of the grains of a single-grain scene, by kind."""
    packing = pane.session.run.setup.packing
    strains = np.array([packing.p - packing.q1, packing.p + packing.q1]) / packing.rest_radius - 1.0
    return {
        "auxetic" if nu < 0.0 else "regular": (float(tall), float(wide))
        for nu, tall, wide in zip(packing.poisson_ratio, *strains, strict=True)
    }


def _distortion(frame: Frame, auxetic: bool) -> float:
    """Mean of (a − b)/(a + b) over the grains of a kind."""
    of_kind = frame.auxetic == auxetic
    return float(np.mean(np.hypot(frame.q1, frame.q2)[of_kind] / frame.p[of_kind]))


def _lost(frame: Frame, auxetic: bool) -> float:
    """Mean share of the area lost, over the grains of a kind."""
    of_kind = frame.auxetic == auxetic
    now = frame.p**2 - frame.q1**2 - frame.q2**2
    return float(np.mean((1.0 - now / frame.rest_radius**2)[of_kind]))


def _squeezes(frame: Frame) -> tuple[float, float]:
    """Sum of the contact forces on the regular and on the auxetic grain [k R]."""
    total = np.bincount(frame.contacts.i, frame.contacts.force, frame.grains)
    return float(total[~frame.auxetic].sum()), float(total[frame.auxetic].sum())


def _coordination(pane: Pane) -> float:
    packing = pane.session.run.engine.packing
    return observables.coordination(packing, observables.grain_contacts(packing))[0]


def _backbone(pane: Pane) -> float:
    packing = pane.session.run.engine.packing
    return observables.coordination(packing, observables.grain_contacts(packing))[1]


def _stress_ratio(pane: Pane) -> float:
    """Mean shear stress over mean pressure of a sheared packing, over this step's last half."""
    normal = np.array(pane.forces)
    half = len(normal) // 2
    return float(np.mean(pane.plotted[-half:]) / np.mean(normal[-half:]))


def _normal_stress(pane: Pane) -> float:
    run = pane.session.run
    box = run.setup.packing.box
    latest = run.engine.latest
    assert box is not None
    assert latest is not None
    return plate_stresses(run.setup.world, box.width, latest)[1]


MIXED, REGULAR, AUXETIC = "mixed", "regular", "auxetic"
# What is said at each step, and the condition that makes it true; a step that is missing says nothing about an outcome.
CLAIMS: Mapping[tuple[str, str], Mapping[str, Claim]] = {
    ("single_grain", "squeeze"): {
        "the blue grain has bulged, the pink one has grown narrower": lambda p: (
            _grown(p[MIXED])[REGULAR][1] > 0.0 > _grown(p[MIXED])[AUXETIC][1]
        ),
    },
    ("single_grain", "shape"): {
        "the blue one changes its shape, the pink one stays round": lambda p: (
            _distortion(p[MIXED].frame, False) > 3.0 * _distortion(p[MIXED].frame, True)
        ),
        "a regular grain keeps its area, an auxetic one gives it up": lambda p: (
            _lost(p[MIXED].frame, True) > 3.0 * _lost(p[MIXED].frame, False)
        ),
    },
    ("single_grain", "four"): {
        "from all sides the blue grain is more than seven times stiffer": lambda p: (
            _squeezes(p[MIXED].frame)[0] > 7.0 * _squeezes(p[MIXED].frame)[1]
        ),
    },
    ("two_ellipses", "touch"): {
        "the first touch comes early, never late": lambda p: bool(
            np.all(p[MIXED].plotted >= -1e-9)
        ),
    },
    ("two_ellipses", "mirror"): {
        "mirror images touch exactly where the model says": lambda p: bool(
            np.all(np.abs(p[MIXED].plotted) < 1e-6)
        ),
    },
    ("grain_row", "regular"): {
        "a sideways force from the first moment on": lambda p: bool(p[REGULAR].plotted[1] > 0.0),
    },
    ("grain_row", "auxetic"): {
        "nothing pushes sideways": lambda p: bool(np.all(p[AUXETIC].plotted == 0.0)),
        "gaps open": lambda p: free_room(p[AUXETIC].session.run.setup) > 0.0,
    },
    ("grain_row", "together"): {
        "a few grains that shrink spare the others": lambda p: _falling(
            p, lambda pane: float(pane.plotted[-1]) + (pane is p[MIXED]) * 1e-12
        ),
    },
    ("biaxial_press", "press"): {
        "the regular packing pushes back hardest, the auxetic one least": lambda p: _falling(
            p, lambda pane: float(pane.plotted[-1])
        ),
    },
    ("biaxial_press", "chains"): {
        "far smaller forces in the auxetic packing": lambda p: _falling(p, _contact_force, 2.0),
    },
    ("biaxial_press", "area"): {
        "auxetic grains lose more area and stay round, regular ones lose their shape": lambda p: (
            _lost(p[AUXETIC].frame, True) > 1.1 * _lost(p[REGULAR].frame, False)
            and _distortion(p[REGULAR].frame, False) > 5.0 * _distortion(p[AUXETIC].frame, True)
        ),
    },
    ("biaxial_periodic", "contacts"): {
        "close to four contacts a grain": lambda p: 3.8 < _backbone(p[MIXED]) < 4.3,
    },
    ("biaxial_periodic", "shrink"): {
        "the pressure rises fastest in the regular packing": lambda p: _falling(
            p, lambda pane: float(pane.plotted[-1])
        ),
    },
    ("biaxial_periodic", "area"): {
        "auxetic grains touch fewer neighbours": lambda p: (
            _coordination(p[AUXETIC]) < _coordination(p[REGULAR])
        ),
    },
    ("couette", "yield"): {
        "the stress rises, then goes up and down": lambda p: (
            len(observables.force_drops(p[MIXED].plotted)) > 3
            and float(p[MIXED].plotted[-1]) < 3.0 * float(np.mean(p[MIXED].plotted[20:]))
        ),
    },
    ("couette", "compare"): {
        "the regular packing resists more": lambda p: _falling(
            p, lambda pane: float(np.mean(pane.plotted[20:]))
        ),
        "its grains press harder": lambda p: _falling(p, _normal_stress),
    },
    ("couette", "ratio"): {
        "shear stress over pressure is much the same": lambda p: (
            max(_of(p, _stress_ratio).values()) < 2.0 * min(_of(p, _stress_ratio).values())
        ),
    },
    ("avalanches", "drop"): {
        "an avalanche is marked": lambda p: "avalanche" in p[MIXED].events,
    },
    ("avalanches", "chains"): {
        "the next one, too": lambda p: "avalanche" in p[MIXED].events,
    },
    ("intruder", "drag"): {
        "locked among the regular grains, and there alone": _only_regular_is_locked,
    },
    ("intruder", "through"): {
        "auxetic and mixed grains let it through": lambda p: (
            _only_regular_is_locked(p) and _others_moved(p, "intruder", 2.0)
        ),
    },
    ("intruder", "chains"): {
        "strong chains before the locked disc, weaker ones elsewhere": lambda p: (
            p[REGULAR].mean_contact_force
            > max(p[MIXED].mean_contact_force, p[AUXETIC].mean_contact_force)
        ),
    },
    ("hopper", "push"): {
        "the regular packing is locked, and no other": _only_regular_is_locked,
    },
    ("hopper", "flow"): {
        "the locked one stays locked": lambda p: p[REGULAR].locked,
        "the other two go on": lambda p: not (p[MIXED].locked or p[AUXETIC].locked),
        "they never ask for all that the hand has": lambda p: all(
            float(np.max(p[kind].plotted)) < p[kind].session.run.strength
            for kind in (MIXED, AUXETIC)
        ),
    },
    ("hopper", "chains"): {
        "thick chains in the locked hopper, thinner ones elsewhere": lambda p: (
            p[REGULAR].mean_contact_force
            > 1.2 * max(p[MIXED].mean_contact_force, p[AUXETIC].mean_contact_force)
        ),
    },
    ("hopper", "machine"): {
        "the machine gives more than the hand had": lambda p: bool(p[REGULAR].plotted.max() > 8.0),
    },
    ("gravity_hopper", "flow"): {
        "grains leave by themselves": lambda p: p[MIXED].frame.grains_out >= 3,
    },
    ("gravity_hopper", "clog"): {
        "an arch carries what is above": lambda p: (
            not {"clog", "arch"}.isdisjoint(p[MIXED].events)
            and p[MIXED].frame.highlight is not None
        ),
    },
}
TENDENCIES = frozenset({("couette", "ratio")})  # said of most packings, not of each


def play(scene: str, seed: int, check: Callable[[], None] = lambda: None) -> list[dict[str, Any]]:
    """Every step of a scene's tour: whether it could be done, in how many increments, which claims hold, what broke."""
    found = tours.tour(scene)
    return [] if found is None else play_lesson(found, seed, CLAIMS, check)


def play_lesson(
    lesson: Lesson,
    seed: int,
    claims_of: Mapping[tuple[str, str], Mapping[str, Claim]],
    check: Callable[[], None] = lambda: None,
) -> list[dict[str, Any]]:
    """The same for any lesson, with claims by its name and the key of a step."""
    panes: dict[str, Pane] = {}
    told = []
    for index, step in enumerate(lesson.steps):
        if step.packings:
            scene = lesson.scene_of(index)
            sessions = [Session(scene, kind, seed, dict(step.settings)) for kind in step.packings]
            for session in sessions:
                session.build()
            panes = {session.packing: Pane(session) for session in sessions}
        for pane in panes.values():
            pane.since, pane.before = len(pane.session.history) - 1, pane.session.frame()
            pane.forces.clear()
        increments = _do(step, panes, check)
        claims = claims_of.get((lesson.name, step.key), {})
        reasons = {
            str(reason)
            for pane in panes.values()
            for reason in pane.session.history.column("stop_reason")[pane.since :]
        }
        told.append(
            {
                "step": step.key,
                "done": increments is not None,
                "increments": increments,
                "claims": {words: bool(claim(panes)) for words, claim in claims.items()},
                "broken": sorted(reasons & BROKEN),
            }
        )
    return told


def _do(step: Step, panes: Panes, check: Callable[[], None]) -> int | None:
    """Do what a step asks for; the increments it took, None if they were too many."""
    until = step.until
    if until is None:
        return 0
    view = until.view or step.view or "kind"
    first = next(iter(panes.values())).session
    then = Moment.of([pane.session.frame() for pane in panes.values()], view)
    for command in _asked(until, first):
        for pane in panes.values():
            pane.session.submit(command)
    handles = {handle.body: handle for handle in first.run.setup.handles}
    handle = handles[until.moved or next(iter(handles))]
    at = next(each for each in first.frame().handles if each.name == handle.body)
    way, pace = handle.direction, first.run.setup.solver.step
    by_itself = first.run.setup.drag > 0.0 and not until.moved
    done = 0
    for count in range(1, PATIENCE + 1):
        check()
        if not (by_itself or until.setting or until.grains or until.walls or until.view):
            _pull(panes, handle.body, (at.x + count * pace * way[0], at.y + count * pace * way[1]))
        for pane in panes.values():
            _one_increment(pane, check)
        now = Moment.of([pane.session.frame() for pane in panes.values()], view)
        if met(until, then, now):
            done = count
            break
    for pane in panes.values():
        pane.session.submit(Release(handle.body))
        pane.session.settle()
    return done or None


def _pull(panes: Panes, handle: str, target: tuple[float, float]) -> None:
    """One hand for all, a little further on."""
    for pane in panes.values():
        pane.session.submit(Grab(handle))
        pane.session.submit(Move(handle, *target))


def _one_increment(pane: Pane, check: Callable[[], None]) -> None:
    session = pane.session
    if not any(session.slices(SLICE, check)):
        return
    latest = session.run.engine.latest
    assert latest is not None
    if session.scene.name == "couette":
        pane.forces.append(_normal_stress(pane))
    else:
        pane.forces.append(latest.report.mean_contact_force)


def _asked(until: Condition, session: Session) -> Sequence[Command]:
    """Commands that do what is asked for, apart from pulling."""
    _, ymin, xmax, ymax = session.frame().bounds
    if until.setting:
        return [Change(until.setting, SETTING)]
    if until.grains:
        shares = (0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85)
        return [Place(xmax - 4.0, ymin + share * (ymax - ymin), "auxetic") for share in shares]
    if until.walls:
        return [DrawWall(((xmax - 8.0, ymin + 3.0), (xmax - 8.0, ymin + 5.0)))]
    return []
