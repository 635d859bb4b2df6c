"""Explore as a person uses it: two parameters, their ranges, how many runs a cell; the map fills, a click opens a run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from core.errors import InputError
from sandbox.draw.pages.explore_page import ExplorePlaces, Line, Shown, draw_explore
from sandbox.draw.painter import Painter
from sandbox.session.commands import Protocol
from sandbox.sweep.request import Axis, Job, Request, check
from sandbox.window.explore.explorer import Explorer
from sandbox.window.explore.side import Side
from sandbox.window.keys import Action
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes import registry
from scenes.parameter import Parameter, Value
from scenes.text import message

FAVOURITES = ("orifice", "auxetic_fraction", "friction", "hand_strength")
MOST_VALUES, MOST_SEEDS = 12, 200
BUTTON = "go"
STILL = "shake"  # of a scene that is shaken now and then: here it ends with its first clog


class ExplorePage:
    """Keys and mouse, and what is asked. What runs in the window is held as long as the page is shown."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.explorer = Explorer()
        self._scene, self._packing = "", ""
        self._settings: dict[str, Value] = {}
        self._parameters: list[Parameter] = []
        self._sides: list[Side] = []
        self._seeds = 10
        self._chosen = BUTTON
        self._said = ""
        self._places = ExplorePlaces()
        self._seen = self.explorer.progress

    def open(self, scene: str, packing: str, settings: Mapping[str, Value]) -> None:
        """Show it for a scene as it is set; what was asked of that scene before stays."""
        self.stage.mouse.release(self.stage.send)
        self.stage.panes.hold()
        self.stage.show_explore = True
        self.stage.redraw(True)
        known = registry.get(scene)
        if (scene, packing, dict(settings)) == (self._scene, self._packing, self._settings):
            return
        self.explorer.forget()
        self._said = ""
        self._settings, self._packing = dict(settings), packing
        if scene == self._scene:
            return
        self._scene = scene
        self._parameters = [p for p in known.parameters if p.kind != "switch"]
        names = [p.name for p in self._parameters]
        liked = [name for name in FAVOURITES if name in names] + names
        self._sides = [
            Side.around(self._parameters[names.index(name)]) for name in [*dict.fromkeys(liked)][:2]
        ]

    def close(self) -> None:
        """Back to what was there; runs go on."""
        self.stage.show_explore = False
        self.stage.redraw(True)
        if not self.stage.show_menu:
            self.stage.panes.go_on()

    def tick(self) -> None:
        """Once a picture: is there something new on the map?"""
        if self.explorer.progress is not self._seen:
            self._seen = self.explorer.progress
            self.stage.redraw(self.stage.show_explore)

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """A key; True if it was meant for this page."""
        names = [line.name for line in self._lines()]
        if action in (Action.BACK, Action.EXPLORE):
            self.close()
        elif action in (Action.UP, Action.DOWN):
            way = 1 if action is Action.DOWN else -1
            self._chosen = names[(names.index(self._chosen) + way) % len(names)]
        elif action in (Action.LEFT, Action.RIGHT):
            self._change(self._chosen, 1 if action is Action.RIGHT else -1)
        elif action in (Action.ENTER, Action.PAUSE):
            self.go_or_stop()
        else:
            return False
        return True

    def click(self, place: tuple[int, int]) -> None:
        """The mouse was pressed there."""
        for (name, way), rect in self._places.arrows.items():
            if rect.collidepoint(place):
                self._chosen = name
                self._change(name, way)
                return
        for name, rect in self._places.lines.items():
            if rect.collidepoint(place):
                self._chosen = name
                if name == BUTTON:
                    self.go_or_stop()
                return
        for cell in self.explorer.progress.cells:
            there = self._places.cells.get(cell.values)
            if there is not None and there.collidepoint(place):
                self._open_run(self.request().job(cell.row))
                return

    def go_or_stop(self) -> None:
        """Begin, or go on where it was stopped; or stop."""
        if self.explorer.progress.at_work:
            self.explorer.stop()
            return
        request = self.request()
        self._said = ""
        try:
            check(request)
            self.explorer.begin(request, self.folder(request))
        except InputError as error:
            self._said = words.say(message(error))

    def _open_run(self, job: Job) -> None:
        """That very run, from its start, in the window."""
        self.stage.panes.packing = job.packing
        self.stage.start(job.scene, job.settings, seed=job.seed)
        self.stage.send(Protocol(True))  # waits for the scene to be built

    def request(self) -> Request:
        """What is asked now."""
        names = {side.parameter.name for side in self._sides}
        settings = {k: v for k, v in self._settings.items() if k not in names}
        if STILL in settings:
            settings[STILL] = 0.0
        axes = tuple(Axis(side.parameter.name, side.values()) for side in self._sides)
        return Request(
            self._scene, axes, (self._packing,), (1, self._seeds), tuple(settings.items())
        )

    def folder(self, request: Request) -> Path:
        """Where its tables go: the same for the same request, so that it goes on; more seeds may be asked for."""
        return Path(f"sandbox-explore-{self._scene}-{request.key()[:6]}")

    def _change(self, name: str, way: int) -> None:
        """One step of a line to the left or the right; the map is another then."""
        if name == BUTTON:
            return
        if name == "seeds":
            self._seeds = min(
                max(self._seeds + way * (1 if self._seeds + way < 10 else 5), 1), MOST_SEEDS
            )
            self.explorer.stop()
            return
        side, what = self._sides[int(name[0])], name[1:]
        if what == "name":
            self._sides[int(name[0])] = self._another(side, way)
        elif what == "low":
            side.low = min(side.bounded(side.low + way * side.step), side.high)
        elif what == "high":
            side.high = max(side.bounded(side.high + way * side.step), side.low)
        else:
            side.count = min(max(side.count + way, 1), MOST_VALUES)
        self.explorer.forget()
        self._said = ""

    def _another(self, side: Side, way: int) -> Side:
        """The next parameter that the other axis does not have."""
        taken = {each.parameter.name for each in self._sides if each is not side}
        free = [p for p in self._parameters if p.name not in taken]
        return Side.around(free[(free.index(side.parameter) + way) % len(free)])

    # -- what is shown --

    def draw(self, painter: Painter) -> None:
        """Draw the whole page."""
        progress, request = self.explorer.progress, self.request()
        if progress.error or self._said:
            status = self._said or progress.error
        elif not progress.cells and not progress.at_work:
            status = words.EXPLORE_HINT
        else:
            status = words.EXPLORE_STATUS.format(
                done=progress.done, runs=request.runs, folder=self.folder(request)
            )
        title = words.EXPLORE_TITLE.format(
            scene=words.title(self._scene, registry.get(self._scene).title),
            packing=words.PACKINGS.get(self._packing, self._packing),
        )
        first, second = self._sides
        self._places = draw_explore(
            painter,
            Shown(
                title,
                self._lines(),
                self._chosen,
                (_titled(first.parameter), _titled(second.parameter)),
                (first.values(), second.values()),
                progress.cells,
                self._seeds,
                status,
            ),
        )

    def _lines(self) -> list[Line]:
        lines = []
        for number, (side, title) in enumerate(
            zip(self._sides, (words.EXPLORE_ACROSS, words.EXPLORE_UP), strict=True)
        ):
            name = words.parameter_name(side.parameter.name)
            lines += [
                Line(f"{number}name", title, name),
                Line(f"{number}low", words.EXPLORE_FROM, f"{side.low:.4g}"),
                Line(f"{number}high", words.EXPLORE_TO, f"{side.high:.4g}"),
                Line(f"{number}count", words.EXPLORE_VALUES, str(side.count)),
            ]
        button = words.EXPLORE_STOP if self.explorer.progress.at_work else words.EXPLORE_GO
        return [*lines, Line("seeds", words.EXPLORE_SEEDS, str(self._seeds)), Line(BUTTON, button)]


def _titled(parameter: Parameter) -> str:
    """Name and unit."""
    unit = words.unit(parameter.unit)
    name = words.parameter_name(parameter.name)
    return f"{name} [{unit}]" if unit else name
