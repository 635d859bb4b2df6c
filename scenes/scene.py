"""What a scene is: parameters, a way to build it, handles to drag, a scripted drive, and checks that must hold.

The same scene serves the window, films, tests and studies. It is a list of ingredients: what it does not name, does not exist.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, nearest
from core.generate import KINDS, Progress
from core.hand import CELL
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment
from core.rigid import Point, RigidBody
from core.settings import MACHINE, Settings
from core.system import System
from scenes.accuracy import Accuracy, accuracy_of
from scenes.bearing import bearing
from scenes.checks import Check, Track, converged, grains_kept, nothing_inside
from scenes.grains import KINDS_OF_GRAINS, STIFFNESSES, check_material, material
from scenes.outlet import Outlet
from scenes.parameter import Parameter, Value
from scenes.relaxing import SOLVER, step
from scenes.remarks import Holding, Latest, Remarks
from scenes.text import Text

Values = Mapping[str, Value]
Bounds = tuple[float, float, float, float]  # x0, y0, x1, y1 [R]
AT_REST = 0.01  # of the fall of a free grain: where there is drag, grains that move less have come to rest


@dataclass(frozen=True)
class Handle:
    """A body that a person can drag. ``direction`` is where the scripted drive takes it; ``radius`` how near to grab it [R]."""

    body: str
    label: str
    direction: Point
    radius: float


@dataclass(frozen=True)
class Curve:
    """What a scene plots instead of force against stroke, from the packing and the latest increment."""

    stroke_label: str  # with its unit
    force_label: str  # with its unit
    stroke: Callable[[Packing, Increment], float] | None  # None: the number of increments
    force: Callable[[Packing, Increment], float] | None  # None: the number of grains that have left


@dataclass(kw_only=True)
class Setup(System):
    """A scene that is built: the system that an engine works on, and what a person can do with it."""

    handles: tuple[Handle, ...]
    bounds: Bounds  # what a camera should show [R]
    outline: list[Point]  # the region that grains must not leave, the outlet apart [R]
    outlet: Outlet | None = None
    focus: tuple[
        Bounds, ...
    ] = ()  # where it happens, besides at the handles: nothing that is said covers it [R]
    box_target: Callable[[Point], PeriodicBox] | None = None  # of the handle "box": where it goes
    box_handle: Callable[[PeriodicBox], Point] | None = (
        None  # where that handle is; None: the corner
    )
    curve: Curve | None = None  # what is plotted, if not the force on the first handle
    reach: Callable[[Packing, str, Point], Point] | None = None  # where a handle can go, of a wish

    @property
    def rest(self) -> float:
        """A grain that moves less than this in an increment [R] has come to rest; infinite where none goes on by itself."""
        if self.gravity is None or self.drag == 0.0:
            return math.inf
        return AT_REST * math.hypot(*self.gravity) / self.drag

    @property
    def stroke_label(self) -> str:
        """What is plotted along: quantity and unit."""
        return "stroke [R]" if self.curve is None else self.curve.stroke_label

    @property
    def force_label(self) -> str:
        """What is plotted against it: quantity and unit."""
        return self.felt_label if self.curve is None else self.curve.force_label

    @property
    def felt_label(self) -> str:
        """What a hand feels, with its unit: the force on the first handle, or what is plotted where that is a periodic cell."""
        handle = self.handles[0]
        if handle.body == CELL and self.curve is not None:
            return self.curve.force_label
        return Text("force on the {label} [k R]", label=handle.label)

    @property
    def solids(self) -> tuple[RigidBody, ...]:
        """The bodies that grains can touch; those that a person has drawn apart."""
        return tuple(b for b in self.world.bodies if not b.drawn and len(b.primitives()))


@dataclass(frozen=True)
class Ingredients:
    """Which terms a scene has: what is False has no arrays, no compiled code and no cost."""

    rigid: bool = True
    periodic: bool = False
    friction: bool = False
    gravity: bool = False


HAND_STRENGTH = "hand_strength"
STRONGEST = 1000.0  # [k R] stands for a testing machine
BY_MACHINE = (HAND_STRENGTH, STRONGEST)  # what a protocol sets that is driven wherever it wants


def hand(default: float) -> Parameter:
    """The strength of the hand, ``default`` [k R] or ``STRONGEST``."""
    return Parameter(
        HAND_STRENGTH,
        default,
        "k R",
        0.01,
        STRONGEST,
        "strongest push or pull of the hand; 1000, or the word machine, is a testing machine that goes wherever it is driven",
        live=True,
        top="machine",
    )


def solver(settings: Values) -> Settings:
    """How carefully ``settings`` ask to relax."""
    return Settings(
        step=step(settings),
        tolerance=float(settings["tolerance"]),
        max_iterations=int(settings["max_iterations"]),
        hand_strength=hand_strength(settings),
    )


def hand_strength(settings: Values) -> float:
    """The strength of the hand that ``settings`` ask for [k R]; without bound for a testing machine."""
    strength = float(settings[HAND_STRENGTH])
    return MACHINE if strength >= STRONGEST else strength


class Scene(ABC):
    """One scene. Subclasses set the class attributes and write ``build`` and ``drive``."""

    name: ClassVar[str]
    title: ClassVar[str]
    question: ClassVar[str]
    about: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    default_steps: ClassVar[int]
    handle_names: ClassVar[tuple[str, ...]]  # of the bodies that a person can drag, whatever is set
    packings: ClassVar[tuple[str, ...]] = KINDS

    @property
    def accuracy(self) -> Accuracy:
        """What `study accuracy` found about the scene at its defaults."""
        return accuracy_of(self.name)

    def settings(self, overrides: Mapping[str, object] | None = None) -> dict[str, Value]:
        """All parameters, defaults unless overridden (by values or by typed text). Raises InputError for a bad name or value."""
        settings: dict[str, Value] = {p.name: p.default for p in self.parameters}
        by_name = {p.name: p for p in self.parameters}
        for name, value in (overrides or {}).items():
            if name not in by_name:
                close = nearest(name, by_name)
                hint = f"did you mean {close}?" if close else f"there are: {', '.join(by_name)}"
                raise InputError(f"scene {self.name} has no parameter {name!r}; {hint}")
            settings[name] = (
                by_name[name].parse(value) if isinstance(value, str) else by_name[name].check(value)
            )
        check_material(settings)
        self.validate(settings)
        return settings

    def validate(self, settings: Values) -> None:
        """Quick: raise InputError if the settings, each allowed, do not go together. Subclasses add what they know."""
        del settings

    def steps(self, settings: Values) -> int:
        """Length of the scripted drive in increments."""
        del settings
        return self.default_steps

    @property
    def live(self) -> frozenset[str]:
        """Names of the parameters that act on the grains where they stand; a change of any other builds the packing anew."""
        return frozenset(p.name for p in self.parameters if p.live)

    def built_from(self, settings: Values) -> Values:
        """Those that the packing is built from."""
        return {name: value for name, value in settings.items() if name not in self.live}

    def check_packing(self, packing: str) -> str:
        """``packing`` if the scene knows it. Raises InputError otherwise."""
        if packing not in self.packings:
            raise InputError(f"unknown packing {packing!r}: choose {', '.join(self.packings)}")
        return packing

    def ingredients(self, settings: Values) -> Ingredients:
        """The terms that ``settings`` call for, so that they can be compiled before anything is built."""
        return Ingredients(friction=float(settings.get("friction", 0.0)) > 0.0)

    @abstractmethod
    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        """Set the scene up. ``progress`` is told the share done. Raises InputError if the parameters do not go together."""

    @abstractmethod
    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        """The scripted drive: where each body is to go in increment 0, 1, … of the drive; None at its end. {}: wait."""

    def adjust(self, setup: Setup, settings: Values, changed: frozenset[str]) -> None:
        """Let what is built have ``settings``, of which the live parameters in ``changed`` are new.

        Arrays of the packing are replaced, never written into.
        """
        packing = setup.packing
        stiffness_changed = not changed.isdisjoint(STIFFNESSES)
        for kind in KINDS_OF_GRAINS:
            ratio_changed = not changed.isdisjoint((f"{kind}_poisson_ratio", "stiffness_ratio"))
            if not (ratio_changed or stiffness_changed):
                continue
            nu, stiffness = material(settings, kind)
            of_kind = np.signbit(packing.poisson_ratio) == (kind == "auxetic")
            if ratio_changed:
                packing.poisson_ratio = np.where(of_kind, nu, packing.poisson_ratio)
            if stiffness_changed or float(settings.get("softness", 0.0)) > 0.0:
                packing.contact_stiffness = np.where(of_kind, stiffness, packing.contact_stiffness)
        if "friction" in changed:
            setup.rub(float(settings["friction"]))
        if not changed.isdisjoint(p.name for p in SOLVER):
            setup.solver = replace(
                setup.solver,
                step=step(settings),
                tolerance=float(settings["tolerance"]),
                max_iterations=int(settings["max_iterations"]),
            )
        if HAND_STRENGTH in changed:
            setup.solver = replace(setup.solver, hand_strength=hand_strength(settings))

    def place_in_drive(self, increment: int, before: Values, after: Values) -> int:
        """Where the scripted drive goes on when live parameters change; unless a subclass knows better, it goes by steps."""
        if "step" not in before:
            return increment
        return math.floor(increment * step(before) / step(after) + 1e-9)

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        """What is to be said about an increment. Nothing, unless a subclass knows better."""
        del setup, settings, latest
        return Remarks()

    def arch(self, setup: Setup, now: Increment) -> NDArray[np.bool_] | None:
        """The grains (N,) of an arch that holds back what is above it, or None: no scene has any unless it knows better."""
        del setup, now
        return None

    def what_holds(self, setup: Setup, latest: Latest) -> Holding:
        """What a hand cannot overcome that pushes with all its strength and moves nothing: the grains that bear its force."""
        grains = bearing(setup.packing, latest.now, setup.world, setup.handles[0].body)
        if grains is None:
            return Holding("the grains hold")
        return Holding(
            Text("{grains} {grains:grain holds|grains hold}", grains=int(grains.sum())), grains
        )

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        """Claims that must hold; subclasses add their own to those for any scene."""
        return self.general_checks(setup, track)

    def general_checks(self, setup: Setup, track: Track) -> list[Check]:
        """Claims that must hold for any run of any scene, whatever a person has put into it."""
        kept = grains_kept(setup.packing, setup.outlet, self.region(setup), track)
        return [kept, nothing_inside(setup.packing, setup.world), converged(track)]

    def region(self, setup: Setup) -> list[Point]:
        """The outline [R] as the bodies stand now: it ends at the face of one that presses, behind which no grain belongs."""
        return setup.outline
