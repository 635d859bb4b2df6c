"""Where a run stands, apart from its grains: what the hand wants, how far the script is, what has been counted and said."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from core.hand import CELL
from core.quasistatic import Increment
from core.relaxation import FAILED, StopReason
from core.rigid import Point
from sandbox.session.history import Row
from scenes.accuracy import Estimate, left_over
from scenes.remarks import Remarks
from scenes.scene import STRONGEST, Setup
from scenes.text import Text

LOCKED_AFTER = 3  # increments in a row that all the strength of the hand could not make
STUCK = 1e-3  # of a step: a body that moves less than that is stopped
PRESSED_IN = (
    "a grain was pressed into a wall: back to the state before this step. Draw back, or reset"
)
SQUEEZED_FLAT = "a grain was squeezed flat: back to the state before this step. Draw back, or reset"
BLEW_UP = "the numbers blew up: back to the state before this step. Draw back, or reset"
_WHAT_FAILED = {
    StopReason.COLLAPSED: SQUEEZED_FLAT,
    StopReason.NOT_FINITE: BLEW_UP,
    StopReason.SUNK: PRESSED_IN,
}


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
        own = vars(self).copy()
        for name in ("targets", "held", "blocked", "notices", "announced"):
            own[name] = own[name].copy()
        return Course(**own)

    def still(self) -> None:
        """Nothing is held, nothing is wanted, and the script is off."""
        self.targets.clear()
        self.held.clear()
        self.blocked.clear()
        self.script = None

    @property
    def locked(self) -> bool:
        """True if all the strength of the hand moves nothing."""
        return self.stuck >= LOCKED_AFTER

    def follow(self, setup: Setup, increment: Increment) -> None:
        """Stroke and direction of the drive: along its axis for a body that slides, as the hand pulls for one that is dragged."""
        drive = setup.handles[0].body
        if drive == CELL:
            return
        body = setup.world[drive]
        if body.axis is not None:
            self.stroke = float(np.dot(np.array(body.position) - body.home, body.axis))
            return
        if increment.report.reason in FAILED:  # it is back where it was
            return
        self.stroke += math.hypot(*increment.moved.get(drive, (0.0, 0.0)))
        pull = increment.pulled.get(drive, (0.0, 0.0))
        if pull != (0.0, 0.0):
            self.direction = pull

    def read_off(
        self, setup: Setup, increment: Increment, number: int, farthest: float, estimate: Estimate
    ) -> Row:
        """The row of the history for an increment, the ``number``-th, in which no grain has moved further than ``farthest`` [R].

        ``estimate`` is that of the scene and its packing: how far off the force on the handle is.
        """
        fx = fy = 0.0
        drive = setup.handles[0].body
        if drive != CELL:
            fx, fy = map(float, increment.reactions[setup.world.index(drive), :2])
        resisting = -(fx * self.direction[0] + fy * self.direction[1]) + 0.0
        curve = setup.curve
        if curve is not None:
            self.stroke = number if curve.stroke is None else curve.stroke(setup.packing, increment)
            force = curve.force
            resisting = self.out if force is None else force(setup.packing, increment)
        report = increment.report
        usual = most = math.nan
        if report.reason not in FAILED:
            scale, unbalanced = (
                report.mean_contact_force,
                float(np.linalg.norm(increment.unbalanced)),
            )
            left = left_over(unbalanced, report.residual, scale)
            usual, most = estimate.errors(scale, left, max(farthest / setup.solver.step, 1.0))
        solids = tuple(setup.world.index(body.name) for body in setup.solids)
        drawn = increment.reactions[len(setup.world.bodies) - len(setup.world.drawn) :, :2].sum(0)
        return Row(
            increment=number,
            stroke=self.stroke,
            fx=fx,
            fy=fy,
            grains_out=self.out,
            energy=report.energy,
            residual=report.residual,
            iterations=report.iterations,
            stop_reason=str(report.reason),
            resisting=float(resisting),
            usual_error=usual,
            force_error=most,
            hand_strength=min(setup.solver.hand_strength, STRONGEST),
            beyond_cone=increment.beyond_cone,
            on_solids=tuple(increment.reactions[solids, :2].ravel().tolist()),
            on_drawn_x=float(drawn[0]),
            on_drawn_y=float(drawn[1]),
        )

    def tell_what_stopped(self, setup: Setup, increment: Increment) -> None:
        """Notices of what held the hand back; what is stuck tries again only when the hand moves.

        A hand that is not strong enough tries ``LOCKED_AFTER`` times, as friction may yield meanwhile; so does the script.
        """
        self.notices.clear()
        step, limit = setup.solver.step, setup.solver.hand_strength
        stuck = {name: math.hypot(*way) < STUCK * step for name, way in increment.moved.items()}
        limited = "force limit" in increment.stopped.values()
        if increment.moved or CELL in increment.stopped:
            # A body that cannot even give way, at a wall or at the end of its travel, is stuck as well.
            still = all(stuck.values()) and (bool(stuck) or increment.share == 0.0)
            self.stuck = self.stuck + 1 if limited and still else 0
        if limited and self.script is not None:
            self.script = None if self.locked else self.script - 1
        labels = {handle.body: handle.label for handle in setup.handles}
        for name, why in increment.stopped.items():
            label = labels[name]
            if why == "force limit":
                if self.locked:
                    self.blocked.add(name)
                else:
                    text = "all the hand has: {limit:g} k R on the {label}"
                    self.notices.append(Text(text, limit=limit, label=label))
                continue
            if stuck[name]:
                self.blocked.add(name)
            if why == "end of travel":
                self.notices.append(Text("{label}: end of travel", label=label))
            elif stuck[name]:
                self.notices.append(Text("{label}: stopped by the wall", label=label))
        reason = increment.report.reason
        if reason in FAILED:
            self.blocked.update(increment.moved, {CELL})
            self.script = None
            self.notices.append(_WHAT_FAILED[reason])
