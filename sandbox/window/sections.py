"""What the panel is put together from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from sandbox.draw.widgets.controls import Control
from sandbox.window.actions import Actions
from sandbox.window.stage import Stage
from sandbox.words import words

Value = float | int | bool | str


class Section(Protocol):
    """A part of the panel. Names of its controls begin with its own name and a slash."""

    @property
    def name(self) -> str:
        """Tells it from all others."""

    @property
    def title(self) -> str:
        """On its heading; empty: it has none and cannot be folded."""

    @property
    def there(self) -> bool:
        """Is there anything in it at the moment?"""

    def controls(self) -> Sequence[Control]:
        """What there is; asked for only while the section is open."""

    def use(self, name: str, value: Value, done: bool) -> None:
        """A control got a value: True for a button, typed text as it is. Not ``done``: the drag goes on."""


class StageSection:
    """What the sections about the window itself share: a heading by their name, and that they are always there."""

    name: str

    def __init__(self, stage: Stage, actions: Actions) -> None:
        self.stage, self.actions = stage, actions

    @property
    def title(self) -> str:
        """On the heading."""
        return words.SECTIONS[self.name]

    @property
    def there(self) -> bool:
        """Always, where a section does not say otherwise."""
        return True
