"""What a scene is: parameters, a way to build it, handles to drag, a scripted drive, and checks that must hold.

The same scene serves the window, films, tests and studies. It is a list of ingredients: what it does not name, does not exist.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.errors import InputError, nearest
from core.friction import Friction
from core.generate import KINDS, Progress, inside
from core.hand import CELL
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment
from core.rigid import Point, RigidBody
from core.settings import LONGEST_STEP, MACHINE, Settings
from core.system import System
from scenes.accuracy import Accuracy, accuracy_of
from scenes.bearing import bearing
from scenes.grains import KINDS_OF_GRAINS, STIFFNESSES, check_material, material, recipe
from scenes.parameter import Parameter, Value
from scenes.text import Text, counted

Values = Mapping[str, Value]
Bounds = tuple[float, float, float, float]  # x0, y0, x1, y1 [R]


@dataclass(frozen=True)
class Handle:
    """A body that a person can drag. ``direction`` is where the scripted drive takes it; ``radius`` how near to grab it [R]."""

    body: str
    label: str
    direction: Point
    radius: float


AT_REST = 0.01  # of the fall of a free grain: where there is drag, grains that move less have come to rest


@dataclass(frozen=True)
class Outlet:
    """Grains whose centre has come below ``y`` [R] have left; ``opening`` [R] is the width of the orifice.

    In an avalanche a dozen grains come out in one increment. Nobody takes them away before it has ended: some push others
    around a lip and up again under the funnel's side, where nothing would ever move them on. Those have left as well.
    """

    y: float
    opening: float
    # Closed: the space under the funnel, from its outer faces and its lips down to ``y`` [R]. Only the orifice leads there, since
    # an increment in which a grain crosses a wall's face is taken back (core.passage).
    below: tuple[Point, ...] = ()
    beside: float = math.inf  # who lies in it further from the middle than this has left [R]

    def gone(self, packing: Packing) -> NDArray[np.bool_]:
        """True for the grains that have left, (N,)."""
        aside = self._below(packing, np.abs(packing.x) > self.beside)
        gone: NDArray[np.bool_] = aside | (packing.y < self.y)
        return gone

    def has_come_out(self, packing: Packing) -> NDArray[np.bool_]:
        """True for the grains that are in the space under the funnel, (N,)."""
        return self._below(packing, np.ones(len(packing), dtype=np.bool_))

    def _below(self, packing: Packing, asked: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """True for those of the grains that are asked for (N,) that are in that space: mostly none of them is low enough."""
        top = max((y for _, y in self.below), default=-math.inf)
        low: NDArray[np.bool_] = asked & (packing.y < top)
        found = np.flatnonzero(low)
        if len(found):
            low[found] = inside(list(self.below), packing.x[found], packing.y[found])
        return low


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
class Earlier:
    """The increment before the newest one, and the labels (N,) of the grains as they were numbered then."""

    increment: Increment
    label: NDArray[np.int64]


@dataclass(frozen=True)
class Latest:
    """The newest increment, for what a scene has to say about it."""

    before: (
        Increment | None
    )  # the one before it; None if grains have left since, and numbers differ
    now: Increment
    curve: NDArray[np.float64]  # (2, M) what is plotted so far
    left: int  # grains that left in this increment
    last_exit: tuple[float, float]  # stroke and force when a grain last left
    at_rest: bool = False  # with drag: the grains have come to rest
    earlier: Earlier | None = None  # the one before it, also where grains have left since
    waited: float = 0.0  # stroke between the exits of the latest grain and of the one before it
    at_start: int = 0  # grains then


Happening = Literal["locked", "clog", "arch", "avalanche"]


@dataclass(frozen=True)
class Remarks:
    """What a scene says about an increment, in plain words, and the grains that it points at, (N,) or None.

    ``happening``: what goes on now, in plain words; it is announced when it begins.
    """

    notices: tuple[str, ...] = ()
    highlight: NDArray[np.bool_] | None = None
    happening: Mapping[Happening, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Holding:
    """What holds a locked hand, in plain words, and the grains that do, (N,) or None."""

    text: str
    grains: NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class Track:
    """What the checks of a scene look at: the curve so far. Arrays (M,), one entry an increment."""

    stroke: np.ndarray  # [R]
    force: np.ndarray  # that resists the drive [k R]
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


@dataclass(frozen=True)
class Ingredients:
    """Which terms a scene has: what is False has no arrays, no compiled code and no cost."""

    rigid: bool = True
    periodic: bool = False
    friction: bool = False
    gravity: bool = False


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
        return math.ceil(increment * step(before) / step(after) - 1e-9)

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
        kept = _grains_kept(setup, self.region(setup), track)
        return [kept, _nothing_inside(setup), _converged(track)]

    def region(self, setup: Setup) -> list[Point]:
        """The outline [R] as the bodies stand now: it ends at the face of one that presses, behind which no grain belongs."""
        return setup.outline


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


FRICTION = "Coulomb friction coefficient, between grains and with walls; 0 leaves the term out"
# Increment and tolerance, for play and record alike, come from the work-precision plots of `study accuracy`, see
# assets/studies/accuracy. At 1e-2 the force that a hand feels is off by as much as the model is (2 % with C = 50 against hard
# contacts, up to 2.1 % by the contact law) in the press, the shear cell, the shrinking box and both hoppers; with friction the
# increment is to blame for that, and no tolerance helps. Ten times tighter costs 1.7 to 3.3 times the time. Where
# that is not enough, or more is cheap, the scene says so (intruder, avalanches). The intruder's path bifurcates within a few
# increments whatever the tolerance: beyond that single forces mean little, and means over seeds are what can be compared.
# Nothing relaxes to more than a few digits in a picture: --set tolerance=1e-6 for a
# measurement.
SOLVER = (
    Parameter(
        "step",
        0.05,
        "R",
        0.002,
        0.15,
        "longest move of a body in one increment; never more than a quarter of the smallest radius",
        live=True,
    ),
    Parameter(
        "tolerance",
        1e-2,
        "",
        1e-8,
        0.3,
        "largest residual force over mean contact force at the end of an increment",
        live=True,
    ),
    Parameter(
        "max_iterations",
        20_000,
        "",
        10,
        1_000_000,
        "force evaluations after which an increment ends unconverged, and says so",
        live=True,
    ),
)


def solver_parameters(**defaults: float) -> tuple[Parameter, ...]:
    """``SOLVER``, some of it with defaults of a scene's own."""
    return tuple(replace(p, default=defaults.get(p.name, p.default)) for p in SOLVER)


def step(settings: Values) -> float:
    """How far a body moves in one increment at most [R]: as asked, but no further than the smallest grain allows."""
    asked = float(settings["step"])
    if "size_ratio" not in settings:
        return asked
    return min(asked, LONGEST_STEP * recipe(settings, "mixed").smallest)


def solver(settings: Values) -> Settings:
    """How carefully ``settings`` ask to relax."""
    return Settings(
        step=step(settings),
        tolerance=float(settings["tolerance"]),
        max_iterations=int(settings["max_iterations"]),
        hand_strength=hand_strength(settings),
    )


def friction(settings: Values, grains: int) -> Friction | None:
    """That of so many grains as ``settings`` call for; None without any."""
    return Friction.of(float(settings["friction"]), grains)


def hand_strength(settings: Values) -> float:
    """The strength of the hand that ``settings`` ask for [k R]; without bound for a testing machine."""
    strength = float(settings[HAND_STRENGTH])
    return MACHINE if strength >= STRONGEST else strength


def below_height(outline: Sequence[Point], y: float) -> list[Point]:
    """The outline with what is higher than ``y`` [R] brought down to it: for a body with a level face."""
    return [(x, min(corner, y)) for x, corner in outline]


def _grains_kept(setup: Setup, region: list[Point], track: Track) -> Check:
    packing = setup.packing
    out = int(track.grains_out[-1]) if len(track.grains_out) else 0
    counted = len(packing) + out == track.initial_grains
    astray = ~inside(region, *packing.folded())
    if setup.outlet is not None:  # on their way out, or out and counted after the next increment
        astray &= ~(setup.outlet.has_come_out(packing) | setup.outlet.gone(packing))
    stray = int(astray.sum())
    return Check(
        "no grain is lost and none has passed a wall",
        counted and stray == 0,
        f"{out} left by the outlet, {stray} astray",
    )


def _nothing_inside(setup: Setup) -> Check:
    packing = setup.packing
    worst = 0.0
    primitives, _ = setup.world.primitives()
    contacts = observables.body_contacts(packing, primitives)
    if len(contacts.grain):
        worst = float(np.max(contacts.overlap / packing.rest_radius[contacts.grain]))
    return Check(
        "no grain sinks into a body by half its radius",
        worst < 0.5,
        f"deepest overlap {worst:.3f} of a radius",
    )


def _converged(track: Track) -> Check:
    if not len(track.converged):
        return Check("at least nine of ten increments converge", None, "nothing has moved yet")
    share = float(np.mean(track.converged))
    return Check(
        "at least nine of ten increments converge",
        share >= 0.9,
        f"{share:.1%} of {counted(len(track.converged), 'increment')}",
    )


def mean(values: Sequence[float] | np.ndarray) -> float:
    """Mean, and 0 of nothing."""
    return float(np.mean(values)) if len(values) else 0.0
