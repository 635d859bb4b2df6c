"""The curves of earlier runs in the panel: renamed, hidden, forgotten."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.draw.theme import packing_colour
from sandbox.draw.widgets.controls import Button, Control, Row, TextField
from sandbox.window.sections import StageSection, Value
from sandbox.words import words


class CurvesSection(StageSection):
    """A row for every curve that is kept of this scene; the section is there while there is one."""

    name = "curves"

    @property
    def there(self) -> bool:
        """While there is a curve."""
        return bool(self.stage.panes.curves.of(self.stage.panes.scene))

    def controls(self) -> Sequence[Control]:
        """Name, eye, and a cross."""
        rows = [
            Row(
                (
                    TextField(
                        f"curves/name/{kept.key}",
                        "",
                        kept.name,
                        packing_colour(kept.packing),
                        f"{kept.name}. {words.CURVE_NAME_HELP}",
                    ),
                    Button(
                        f"curves/show/{kept.key}",
                        "◉" if kept.visible else "○",
                        help=words.CURVE_SHOW_HELP,
                        spoken=f"{kept.name}: {words.CURVE_SHOW_HELP}",
                    ),
                    Button(
                        f"curves/delete/{kept.key}",
                        "×",
                        help=words.CURVE_DELETE_HELP,
                        spoken=f"{kept.name}: {words.CURVE_DELETE_HELP}",
                    ),
                ),
                (5.0, 1.0, 1.0),
            )
            for kept in self.stage.panes.curves.of(self.stage.panes.scene)
        ]
        return [*rows, Button("curves/clear", words.CURVES_CLEAR, help=words.CURVES_CLEAR_HELP)]

    def use(self, name: str, value: Value, done: bool) -> None:
        """Do it to that curve."""
        del done
        curves = self.stage.panes.curves
        _, what, *key = name.split("/")
        match what:
            case "name":
                curves.rename(int(key[0]), str(value))
            case "show":
                curves.toggle(int(key[0]))
            case "delete":
                curves.delete(int(key[0]))
            case "clear":
                curves.clear(self.stage.panes.scene)
