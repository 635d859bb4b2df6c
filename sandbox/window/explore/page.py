"""Explore as a person uses it: two parameters, ranges, runs a cell; the map fills, a click opens a run, or puts it beside one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pygame

from core.errors import InputError
from sandbox.draw.numbers import short_number
from sandbox.draw.pages.explore_page import ExplorePlaces, Line, MapCell, Shown, draw_explore
from sandbox.draw.painter import Painter
from sandbox.session.commands import Protocol
from sandbox.sweep.request import Axis, Job, Request, check
from sandbox.window.explore.ends import Ends
from sandbox.window.explore.explorer import Explorer
from sandbox.window.explore.side import Side
from sandbox.window.keys import Action
from sandbox.window.solvers.wanted import Wanted
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes import registry
from scenes.parameter import Parameter, Value
from scenes.text import message

FAVOURITES = ("orifice", "auxetic_fraction", "friction", "hand_strength")
MOST_VALUES, MOST_SEEDS = 12, 200
BUTTON, SHOW = "go", "show"
MAP = "map"  # chosen: arrows go from cell to cell
ARROWS = {
    Action.LEFT: (-1, 0),
    Action.RIGHT: (1, 0),
    Action.UP: (0, 1),
    Action.DOWN: (0, -1),
}
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
        self.chosen = BUTTON
        self._said = ""
        self._places = ExplorePlaces()
        self._seen = self.explorer.progress
        self._ends = Ends()
        self._pointed: tuple[Value, ...] | None = None  # the cell that mouse or keys are at
        self._first: Job | None = None  # opened last: another run may be put beside it

    def open(self, scene: str, packing: str, settings: Mapping[str, Value]) -> None:
        """Show it for a scene as it is set; what was asked of that scene before stays."""
        self.stage.mouse.release(self.stage.send)
        self.stage.panes.hold()
        self.stage.notices.forget()
        self.stage.show_explore = True
        self.stage.redraw(True)
        known = registry.get(scene)
        whole = known.settings(settings)
        if (scene, packing) == (self._scene, self._packing) and self._same(whole):
            return  # a run of the map is such a one
        self._forget()
        self._settings, self._packing = whole, packing
        if scene == self._scene:
            return
        self._scene = scene
        self._parameters = [p for p in known.parameters if p.kind != "switch"]
        names = [p.name for p in self._parameters]
        liked = [name for name in FAVOURITES if name in names] + names
        self._sides = [
            Side.around(self._parameters[names.index(name)]) for name in [*dict.fromkeys(liked)][:2]
        ]

    def _same(self, settings: Mapping[str, Value]) -> bool:
        """Is all set as on the map, apart from what the map varies?"""
        varied = {STILL, *(side.parameter.name for side in self._sides)}
        return all(settings[k] == v for k, v in self._settings.items() if k not in varied)

    def close(self) -> None:
        """Back to what was there; runs go on."""
        self.stage.show_explore = False
        self.stage.redraw(True)
        if not self.stage.show_menu:
            self.stage.panes.go_on()

    def tick(self) -> None:
        """Once a picture: is there something new on the map?"""
        news = self.explorer.progress is not self._seen or self._ends.waiting
        self._seen = self.explorer.progress
        self.stage.redraw(news and self.stage.show_explore)

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """A key; True if it was meant for this page."""
        names = [line.name for line in self.lines()]
        if action in (Action.BACK, Action.EXPLORE):
            self.close()
        elif action is Action.NEXT_VIEW:
            self.show_ends_or_shares()
        elif action is Action.COMPARE:
            self.take(self._cell_at(self._pointed), beside=True)
        elif self.chosen == MAP and action in ARROWS:
            self._move(*ARROWS[action])
        elif self.chosen == MAP and action in (Action.ENTER, Action.PAUSE):
            self.take(self._cell_at(self._pointed), beside=False)
        elif action in (Action.UP, Action.DOWN):
            way = 1 if action is Action.DOWN else -1
            here = names.index(self.chosen) if self.chosen in names else 0
            self.chosen = names[(here + way) % len(names)]
        elif action in (Action.LEFT, Action.RIGHT):
            self.change(self.chosen, 1 if action is Action.RIGHT else -1)
        elif action in (Action.ENTER, Action.PAUSE):
            self.press(self.chosen)
        else:
            return False
        return True

    def choose(self, name: str) -> None:
        """Give the keyboard to a line."""
        self.chosen = name
        self.stage.redraw(True)

    @staticmethod
    def is_button(name: str) -> bool:
        """Is that line pressed, and not changed?"""
        return name in (BUTTON, SHOW)

    @property
    def pointed(self) -> MapCell | None:
        """The cell that the keys are at, if they are at one that is known."""
        return self._cell_at(self._pointed) if self.chosen == MAP else None

    def place_of(self, cell: MapCell) -> pygame.Rect | None:
        """Where a cell is in the window [px]."""
        return self._places.cells.get(cell.values)

    def tab(self) -> None:
        """From what is asked to the map, and back."""
        self.chosen = BUTTON if self.chosen == MAP else MAP
        if self.chosen == MAP and self._pointed is None:
            self._pointed = next(iter(self._places.cells), None)

    def hover(self, place: tuple[int, int]) -> None:
        """The mouse is there."""
        cells = self._places.cells.items()
        found = next((values for values, rect in cells if rect.collidepoint(place)), None)
        if found is not None and found != self._pointed:
            self._pointed = found
            self.stage.redraw(True)

    def press(self, name: str) -> None:
        """Enter, or a click, on a line that is a button; on others that of Go."""
        if name == SHOW:
            self.show_ends_or_shares()
        else:
            self.go_or_stop()

    def click(self, place: tuple[int, int], *, beside: bool = False) -> None:
        """The mouse was pressed there; ``beside``: with Shift."""
        for (name, way), rect in self._places.arrows.items():
            if rect.collidepoint(place):
                self.chosen = name
                self.change(name, way)
                return
        for name, rect in self._places.lines.items():
            if rect.collidepoint(place):
                self.chosen = name
                if self.is_button(name):
                    self.press(name)
                return
        for values, rect in self._places.cells.items():
            if rect.collidepoint(place):
                self._pointed = values
                self.take(self._cell_at(values), beside=beside)
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

    def show_ends_or_shares(self) -> None:
        """How runs ended in place of shares, or the other way about; ends that nobody has kept are run for again."""
        self.explorer.pictures = not self.explorer.pictures
        if self.explorer.pictures and self.explorer.progress.unseen:
            request = self.request()
            self.explorer.begin(request, self.folder(request))

    def _cell_at(self, values: tuple[Value, ...] | None) -> MapCell | None:
        """What is known of the cell with those values."""
        cells = self.explorer.progress.cells
        return next((cell for cell in cells if cell.values == values), None)

    def _move(self, across: int, up: int) -> None:
        """From the cell that is pointed at to another."""
        first, second = (list(side.values()) for side in self._sides)
        x, y = self._pointed if self._pointed is not None else (first[0], second[0])
        column, row = first.index(x) + across, second.index(y) + up
        self._pointed = (
            first[min(max(column, 0), len(first) - 1)],
            second[min(max(row, 0), len(second) - 1)],
        )

    def take(self, cell: MapCell | None, *, beside: bool) -> None:
        """Open a run of a cell, or put it ``beside`` the one that was opened, or marked, before."""
        if cell is None:
            return
        job, first = self.request().job(cell.row), self._first
        if not beside:
            self._first = job
            self._open([job])
        elif first is None or first == job:
            self._first = None if first == job else job
        else:
            self._open([first, job])

    def _open(self, jobs: Sequence[Job]) -> None:
        """Those very runs, from their start, in the window."""
        self.stage.start_beside([Wanted(j.scene, j.packing, j.seed, j.settings) for j in jobs])
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

    def change(self, name: str, way: int) -> None:
        """One step of a line to the left or the right; the map is another then."""
        if name == SHOW:
            self.show_ends_or_shares()
        if name in (BUTTON, SHOW):
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
        self._forget()

    def _forget(self) -> None:
        """The map is another now."""
        self.explorer.forget()
        self._ends.forget()
        self._said, self._pointed, self._first = "", None, None

    def _another(self, side: Side, way: int) -> Side:
        """The next parameter that the other axis does not have."""
        taken = {each.parameter.name for each in self._sides if each is not side}
        free = [p for p in self._parameters if p.name not in taken]
        return Side.around(free[(free.index(side.parameter) + way) % len(free)])

    # -- what is shown --

    @property
    def title(self) -> str:
        """Of the scene and the packing that the map is of."""
        return words.EXPLORE_TITLE.format(
            scene=words.title(self._scene, registry.get(self._scene).title),
            packing=words.PACKINGS.get(self._packing, self._packing),
        )

    def draw(self, painter: Painter) -> None:
        """Draw the whole page."""
        progress = self.explorer.progress
        self._ends.begin(painter.theme.name, progress.frames)
        first, second = self._sides
        self._places = draw_explore(
            painter,
            Shown(
                self.title,
                self.lines(),
                self.chosen,
                (_titled(first.parameter), _titled(second.parameter)),
                (first.values(), second.values()),
                progress.cells,
                self._seeds,
                self.status,
                self._ends.picture if self.explorer.pictures else None,
                self._pointed,
                0 if self._first is None else self._first.row,
            ),
        )

    @property
    def status(self) -> str:
        """What went wrong, or about the cell that is pointed at, or how far it is, or what one can do."""
        progress = self.explorer.progress
        if progress.error or self._said:
            return self._said or progress.error
        cell = self._cell_at(self._pointed)
        if self._first is not None and (cell is None or cell.row == self._first.row):
            return words.EXPLORE_FIRST.format(
                where=self._where(self._first.settings), seed=self._first.seed
            )
        if cell is not None:
            return self.about(cell)
        if not progress.cells and not progress.at_work:
            return words.EXPLORE_HINT
        request = self.request()
        return words.EXPLORE_STATUS.format(
            done=progress.done, runs=request.runs, folder=self.folder(request)
        )

    def about(self, cell: MapCell) -> str:
        """Where it is, its share with the interval, and what a click opens."""
        job = self.request().job(cell.row)
        outcome = words.OUTCOMES.get(cell.outcome, cell.outcome)
        low, high = cell.interval
        share = words.EXPLORE_SHARE.format(share=cell.share or 0.0, low=low, high=high)
        return words.EXPLORE_CELL.format(
            where=self._where(job.settings),
            share=outcome if cell.share is None else share,
            count=cell.counted or cell.runs,
            seed=job.seed,
            outcome=outcome,
        )

    def _where(self, settings: Mapping[str, Value]) -> str:
        """The values of both parameters."""
        names = [side.parameter.name for side in self._sides]
        return ", ".join(
            words.EXPLORE_AT.format(name=words.parameter_name(name), value=settings[name])
            for name in names
        )

    def lines(self) -> list[Line]:
        """What can be changed."""
        lines = []
        for number, (side, title) in enumerate(
            zip(self._sides, (words.EXPLORE_ACROSS, words.EXPLORE_UP), strict=True)
        ):
            name = words.parameter_name(side.parameter.name)
            lines += [
                Line(f"{number}name", title, name),
                Line(f"{number}low", words.EXPLORE_FROM, short_number(side.low)),
                Line(f"{number}high", words.EXPLORE_TO, short_number(side.high)),
                Line(f"{number}count", words.EXPLORE_VALUES, str(side.count)),
            ]
        button = words.EXPLORE_STOP if self.explorer.progress.at_work else words.EXPLORE_GO
        shown = words.EXPLORE_ENDS if self.explorer.pictures else words.EXPLORE_SHARES
        return [
            *lines,
            Line("seeds", words.EXPLORE_SEEDS, str(self._seeds)),
            Line(SHOW, words.EXPLORE_SHOW, shown),
            Line(BUTTON, button),
        ]


def _titled(parameter: Parameter) -> str:
    """Name and unit."""
    unit = words.unit(parameter.unit)
    name = words.parameter_name(parameter.name)
    return f"{name} [{unit}]" if unit else name
