"""Where a run stands, apart from its grains: what the hand wants, how far the script is, what has been counted and said."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

from core.rigid import Point
from scenes.scene import Remarks


@dataclass
class Course:
    """Changes while the run goes on; ``copy`` is what a checkpoint keeps."""

    direction: Point  # of the drive, a unit vector
    initial: int  # grains at the start
    targets: dict[str, Point] = field(default_factory=dict)  # where the hand or the script wants it
    held: set[str] = field(default_factory=set)
    blocked: set[str] = field(default_factory=set)  # stopped: they try again when the hand moves
    stuck: int = 0  # increments in a row in which all the hand's strength moved nothing
    script: int | None = None  # increments of the scripted drive so far
    stroke: float = 0.0  # [R], or what the scene plots instead
    out: int = 0  # grains that have left
    last_exit: tuple[float, float] = (0.0, 0.0)  # stroke and force when a grain last left
    waited: float = 0.0  # stroke between that and the exit before
    moving: bool = False  # the grains go on by themselves
    touched: int = (
        0  # something was changed: relax where things stand, in so many increments at most
    )
    edited: bool = False  # grains or walls are no longer those that the scene came with
    next_label: int = 0  # of a grain that is placed: larger than any that there was
    notices: list[str] = field(default_factory=list)
    announced: dict[str, int] = field(default_factory=dict)  # grains out at the latest of a kind
    remarks: Remarks = field(default_factory=Remarks)

    def copy(self) -> Course:
        """An independent copy."""
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        for name in ("targets", "held", "blocked", "notices", "announced"):
            own[name] = own[name].copy()
        return Course(**own)

    def still(self) -> None:
        """Nothing is held, nothing is wanted, and the script is off."""
        self.targets.clear()
        self.held.clear()
        self.blocked.clear()
        self.script = None
