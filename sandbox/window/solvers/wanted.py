"""A scene as it was asked for, which is known without asking a session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from sandbox.session.commands import Change
from sandbox.session.frame import Frame
from scenes import registry


@dataclass(frozen=True)
class Wanted:
    """Its solvers may not have got there yet."""

    scene: str
    packing: str  # of the pane that was there first
    seed: int
    settings: Mapping[str, object]

    def changed(self, change: Change) -> Wanted:
        """With a change of the seed, of a packing or of a setting. Raises InputError for a setting that cannot be."""
        if change.name == "seed" and isinstance(change.value, int):
            return replace(self, seed=change.value)
        if change.name == "packing":
            return replace(self, packing=str(change.value))
        if change.name == "scene":
            return self
        settings = {**self.settings, change.name: change.value}
        if self.scene in registry.names():
            registry.get(self.scene).settings(settings)
        return replace(self, settings=settings)

    def as_shown(self, frame: Frame) -> Wanted:
        """With the seed and the settings of a picture."""
        return replace(self, seed=frame.seed, settings=frame.settings)

    def changed_as(self, first: Wanted, now: Wanted) -> Wanted:
        """With what has become of another one since it was ``first``."""
        changed = {k: v for k, v in now.settings.items() if first.settings.get(k) != v}
        seed = self.seed if now.seed == first.seed else now.seed
        return replace(self, seed=seed, settings={**self.settings, **changed})
