"""The first section of the panel: packing, seed, view, and what there is to do."""

from __future__ import annotations

from collections.abc import Sequence

from core.errors import InputError
from sandbox.draw.theme import packing_colour
from sandbox.draw.views import VIEWS
from sandbox.draw.widgets.controls import Button, Choice, Control, Option, Row, Stepper
from sandbox.lessons import tours
from sandbox.window.actions import Actions
from sandbox.window.canvas.brush import Brush
from sandbox.window.guide import Guide
from sandbox.window.keys import Action
from sandbox.window.measure.measuring import Measuring
from sandbox.window.sections import Value
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes import registry
from scenes.parameter import LARGEST_SEED

ACTIONS = {
    "reset": Action.RESET,
    "undo": Action.UNDO,
    "redo": Action.REDO,
    "compare": Action.COMPARE,
    "record": Action.RECORD,
    "export": Action.EXPORT,
    "drive": Action.PROTOCOL,
    "brush": Action.BRUSH,
    "measure": Action.MEASURE,
    "new": Action.NEW_SEED,
    "menu": Action.MENU,
    "help": Action.HELP,
    "tour": Action.TOUR,
    "fold": Action.FOLD,
}


class GeneralSection:
    """What every scene has."""

    name = "general"
    title = ""

    def __init__(
        self, stage: Stage, actions: Actions, brush: Brush, guide: Guide, measuring: Measuring
    ) -> None:
        self.stage, self.actions, self.brush, self.guide = stage, actions, brush, guide
        self.measuring = measuring

    @property
    def there(self) -> bool:
        """Always, while something runs."""
        return self.stage.panes.snapshot.frame is not None

    def controls(self) -> Sequence[Control]:
        """Choices first, then buttons."""
        frame = self.stage.panes.snapshot.frame
        if frame is None:
            return ()
        known = frame.scene in registry.names()
        packings = registry.get(frame.scene).packings if known else (frame.packing,)
        views = tuple(Option(name, words.VIEWS[name]) for name in VIEWS)
        seed = Stepper(
            "general/seed",
            words.PANEL_SEED,
            self.stage.panes.seed,
            0,
            LARGEST_SEED,
            words.PANEL_SEED_HELP,
        )
        controls: list[Control] = [
            Row(
                (
                    self._button("menu"),
                    self._tour(),
                    self._button("help"),
                    self._button("fold", sign="›"),
                ),
                (1.4, 1.2, 1.4, 0.8),
            )
        ]
        if len(packings) > 1 and not self.stage.panes.comparing:
            controls.append(
                Choice(
                    "general/packing",
                    words.PANEL_PACKING,
                    tuple(Option(p, words.PACKINGS.get(p, p), packing_colour(p)) for p in packings),
                    self.stage.panes.packing,
                    words.PANEL_PACKING_HELP,
                )
            )
        controls += [
            Choice("general/view", words.PANEL_VIEW, views, self.stage.renderer.view.name),
            Row((seed, self._button("new")), (3.0, 1.4)),
            Row(
                (
                    self._button("reset"),
                    self._button("undo", enabled=frame.can_undo),
                    self._button("redo", enabled=frame.can_redo),
                )
            ),
            Row(
                (
                    self._button("drive", on=frame.protocol),
                    self._button("compare", on=self.stage.panes.comparing),
                    self._button("brush", on=self.brush.on),
                )
            ),
            Row(
                (
                    self._button("record", on=self.stage.recorder.recording),
                    self._button("export"),
                    self._button("measure", on=self.measuring.on),
                )
            ),
        ]
        return controls

    def _tour(self) -> Button:
        """Begins one, puts it aside and goes on with it, as with a lesson."""
        lesson = self.guide.lesson
        if lesson is None and (aside := self.guide.shelf.latest) is not None:
            lesson = aside.lesson
        name = "tour" if lesson is None or tours.is_tour(lesson) else "lesson"
        title, about = words.BUTTONS[name], words.BUTTONS_HELP[name]
        return Button("general/tour", title, self.guide.on, help=about)

    def _button(
        self, name: str, *, on: bool | None = None, enabled: bool = True, sign: str = ""
    ) -> Button:
        about = words.BUTTONS_HELP[name]
        title = words.BUTTONS.get(name, words.first_sentence(about))
        return Button(f"general/{name}", sign or title, on, enabled, about, title)

    def use(self, name: str, value: Value, done: bool) -> None:
        """Do it."""
        del done
        what = name.partition("/")[2]
        if what == "packing":
            self.actions.change_packing(str(value))
        elif what == "view":
            self.actions.change_view(str(value))
        elif what == "seed":
            try:
                self.actions.change_seed(int(str(value).strip()))
            except (ValueError, InputError):
                self.stage.toast(words.SEED_WRONG)
        else:
            self.actions.act(ACTIONS[what])
