"""The sections of the panel that come from the scene's own parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from core.errors import InputError
from sandbox.draw.widgets.controls import Control, Slider, Switch
from sandbox.draw.widgets.scale import shown, typed
from sandbox.session.commands import Change
from sandbox.session.frame import Frame
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes import registry
from scenes.parameter import Parameter, Value
from scenes.text import message

SOLVER = ("step", "tolerance", "max_iterations")
HAND = ("hand_strength",)
GRAINS = (
    "poisson_ratio",
    "regular_poisson_ratio",
    "auxetic_poisson_ratio",
    "auxetic_fraction",
    "friction",
    "contact_stiffness",
    "stiffness_ratio",
    "softness",
    "size_ratio",
    "small_fraction",
    "size_width",
)
PATIENCE = 1.0  # with a change that the solver does not take: then the panel shows what is set [s]


def section_of(parameter: Parameter) -> str:
    """In which section a parameter stands."""
    for section, names in (("solver", SOLVER), ("hand", HAND), ("grains", GRAINS)):
        if parameter.name in names:
            return section
    return "geometry"


@dataclass
class _Wish:
    """A value that was asked for, until the solver has taken it."""

    value: Value
    sent: float | None = None  # when [s]


class Wishes(Silent):
    """What is set and what is on its way to the solver: at most one change of a parameter a picture."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._wishes: dict[str, _Wish] = {}
        self._scene = ""
        self._refusals = 0

    @property
    def frame(self) -> Frame | None:
        """What is shown now."""
        return self.stage.panes.snapshot.frame

    def parameters(self) -> Sequence[Parameter]:
        """Those of the scene that is shown, in the order in which they matter."""
        frame = self.frame
        if frame is None or frame.scene not in registry.names():
            return ()
        own = registry.get(frame.scene).parameters
        first = {name: rank for rank, name in enumerate(GRAINS)}
        return sorted(own, key=lambda parameter: first.get(parameter.name, len(first)))

    def value(self, parameter: Parameter) -> Value:
        """What the panel shows: what was asked for last, else what is set."""
        wish = self._wishes.get(parameter.name)
        if wish is not None:
            return wish.value
        frame = self.frame
        return parameter.default if frame is None else self._set(frame, parameter)

    def ask(self, parameter: Parameter, value: Value | str, done: bool) -> None:
        """Ask for a value. What needs a new scene waits until it is ``done``."""
        try:
            if isinstance(value, str):
                said = value.strip().lower() == words.TOPS.get(parameter.name, "").lower()
                wanted = parameter.parse(parameter.top if parameter.top and said else typed(value))
            else:
                whole = parameter.kind == "whole number"
                wanted = parameter.check(round(value) if whole else value)
        except InputError as error:
            self.stage.toast(words.say(message(error)))
            return
        if (parameter.live or done) and wanted != self.value(parameter):
            self._wishes[parameter.name] = _Wish(wanted)
            if not parameter.live:
                self.stage.forget_picture()

    def tick(self, now: float) -> bool:
        """Send what is new, and forget what has come true or was refused."""
        frame = self.frame
        if frame is None:
            return False
        if frame.scene != self._scene:
            self._scene = frame.scene
            self._wishes.clear()
        if frame.refusals != self._refusals:
            if frame.refusals > self._refusals:
                self.stage.toast(words.say(frame.refusal))
                self._wishes = {n: wish for n, wish in self._wishes.items() if wish.sent is None}
            self._refusals = frame.refusals
        building = self.stage.panes.snapshot.phase == "building"
        by_name = {parameter.name: parameter for parameter in self.parameters()}
        changed = False
        for name, wish in list(self._wishes.items()):
            if wish.sent is None:
                wish.sent = now
                self.stage.send(Change(name, wish.value))
            elif name not in by_name or self._set(frame, by_name[name]) == wish.value:
                del self._wishes[name]
                changed = True
            elif building or frame.busy:
                wish.sent = now
            elif now - wish.sent > PATIENCE:
                del self._wishes[name]
                changed = True
        return changed

    def _set(self, frame: Frame, parameter: Parameter) -> Value:
        return frame.settings.get(parameter.name, parameter.default)


class ParameterSection:
    """Some of the parameters as sliders and switches."""

    def __init__(self, name: str, wishes: Wishes) -> None:
        self.name = name
        self.wishes = wishes

    @property
    def title(self) -> str:
        """On the heading."""
        return words.SECTIONS[self.name]

    @property
    def there(self) -> bool:
        """Has the scene such parameters?"""
        return bool(self._own())

    def _own(self) -> list[Parameter]:
        return [p for p in self.wishes.parameters() if section_of(p) == self.name]

    def controls(self) -> Sequence[Control]:
        """One for each parameter."""
        return [self._control(parameter) for parameter in self._own()]

    def use(self, name: str, value: Value | str, done: bool) -> None:
        """Ask the scene for it."""
        for parameter in self.wishes.parameters():
            if f"{self.name}/{parameter.name}" == name:
                self.wishes.ask(parameter, value, done)

    def _control(self, parameter: Parameter) -> Control:
        frame = self.wishes.frame
        scene = "" if frame is None else frame.scene
        value = self.wishes.value(parameter)
        title = words.parameter_name(parameter.name)
        about = words.parameter_help(scene, parameter.name, parameter.help)
        about = about[:1].upper() + about[1:] + "."
        mark = "" if parameter.live else words.REBUILDS
        if not parameter.live:
            about += " " + words.REBUILDS_HELP
        name = f"{self.name}/{parameter.name}"
        if isinstance(parameter.default, bool):
            return Switch(name, title, bool(value), parameter.default, mark, about)
        unit = words.unit(parameter.unit)
        numbers = words.RANGE_HELP.format(
            low=shown(parameter.low),
            high=shown(parameter.high),
            unit=f" {unit}" if unit else "",
            default=shown(parameter.default),
        )
        return Slider(
            name,
            title,
            float(value),
            float(parameter.low),
            float(parameter.high),
            float(parameter.default),
            unit,
            whole=isinstance(parameter.default, int),
            at_once=parameter.live,
            mark=mark,
            help=f"{numbers} {about}",
            top=words.TOPS[parameter.name] if parameter.top else "",
        )
