"""A built scene under way: hands pull, increments follow one another, each leaves a row of history."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace

import numpy as np

from core.errors import InputError
from core.hand import CELL
from core.quasistatic import Increment, Quasistatic
from core.relaxation import FAILED, StopReason
from sandbox.session.checkpoints import Checkpoint, Checkpoints, bare
from sandbox.session.commands import Edit
from sandbox.session.course import Course
from sandbox.session.editing import edited
from sandbox.session.forces import without
from sandbox.session.hands import Hands
from sandbox.session.history import Event, History
from sandbox.session.mark import RunMark
from scenes.accuracy import UNKNOWN
from scenes.checks import Check, Track
from scenes.remarks import Earlier, Holding, Latest, Remarks
from scenes.scene import Scene, Setup, Values
from scenes.text import Text, message

TOO_TIGHT = "that was too tight for the grains: it is taken back"
MOST_RELAXATIONS = 5  # increments after a change, if it takes more than one to relax


class Run:
    """From what was built onwards: row 0 of the history is the start, relaxed at rest. Or onwards from ``kept``, as if it had
    never been left.
    """

    def __init__(
        self,
        scene: Scene,
        settings: Values,
        packing_kind: str,
        seed: int,
        setup: Setup,
        kept: Checkpoint | None = None,
    ) -> None:
        drive = setup.handles[0]
        self.scene, self.settings, self.setup = scene, settings, setup
        self.course = Course(drive.direction, len(setup.packing))
        self.packing_kind, self.seed = packing_kind, seed
        self.engine = Quasistatic(setup)
        self.history = History()
        self.checkpoints = Checkpoints()
        self.course.next_label = int(setup.packing.label.max(initial=-1)) + 1
        self._kept: Checkpoint | None = None  # of the state as it is, unless it was touched since
        self._before_edit: tuple[Checkpoint, Course] | None = None  # to go back if it was too tight
        # What the increment under way has begun with: all but the course, and that.
        self._begun: tuple[Checkpoint, Course] | None = None
        self.last: Increment
        if kept is None:
            self._relax_first()
        else:
            self.restore(kept)

    def _relax_first(self) -> None:
        """Row 0."""
        self.engine.begin({})
        last: Increment | None = None
        while last is None:
            last = self.engine.relax(1_000)
        self.last = last
        self.course.moving = self.setup.drag > 0.0
        self._add_row(last)
        self._remark(None, None, 0)
        self._keep()

    # Changes.

    @property
    def hands(self) -> Hands:
        """What holds its bodies and says where they go."""
        return Hands(self.scene, self.settings, self.setup, self.course)

    def say(self, notice: str) -> None:
        """Plain words for the person at the window, until something else is to be said."""
        self.course.notices = [notice]

    def adjust(self, settings: Values, changed: frozenset[str]) -> None:
        """Live parameters, those in ``changed``, become what ``settings`` say; then one increment relaxes where things stand.

        Raises InputError for a step that is too long, and changes nothing then.
        """
        before = self.present()
        try:
            self.scene.adjust(self.setup, settings, changed)
            self.engine.look_again()
        except InputError:
            self.restore(before)
            raise
        self.course.blocked.clear()
        self.course.stuck = 0
        if self.course.script is not None:
            place = self.scene.place_in_drive(self.course.script, self.settings, settings)
            self.course.script = place
        self.settings = settings
        self.touched()

    def edit(self, command: Edit) -> None:
        """Make something; then one increment relaxes where things stand. Raises InputError where it cannot be done."""
        made = edited(self.setup, self.settings, command, self.course.next_label)
        before = self._before_edit or (self.present(), self.course.copy())
        course, friction = self.course, self.setup.friction
        if friction is not None:
            friction.rearrange(made.source)
            friction.forget_primitives(*made.forgotten)
        course.initial += len(made.packing) - len(self.setup.packing)
        course.next_label = max(course.next_label, int(made.packing.label.max(initial=-1)) + 1)
        course.edited, course.moving = True, self.setup.drag > 0.0
        course.remarks = Remarks()
        course.notices.clear()
        course.blocked.clear()  # what held may be gone
        course.stuck = 0
        self.setup.world.redraw(made.walls)
        self.engine.take_over(made.packing)
        pairs, bodies = self.engine.contacts()
        self.last = replace(
            self.last,
            grain_contacts=pairs,
            body_contacts=bodies,
            reactions=self.engine.reactions,
            unbalanced=np.zeros(len(made.packing)),
            friction=None,
        )
        self.touched()
        self._before_edit = before

    def touched(self) -> None:
        """Something was changed between two increments: one relaxes where things stand, or a few until it is relaxed."""
        self.course.touched = MOST_RELAXATIONS
        self._kept = None

    # Increments.

    @property
    def idle(self) -> bool:
        """True if no body has to move and nothing is being relaxed."""
        return self._still and not self.engine.busy and not self.hands.wanted()

    def advance(self, max_iterations: int) -> bool:
        """At most so many force evaluations. True if they finished an increment."""
        if not self.engine.busy:
            self._begun = self._before_hands(), self.course.copy()
            targets = {} if self.course.touched else self.hands.next_targets()
            if not targets and self._still:
                return False
            box = targets.pop(CELL, None)
            try:
                self.engine.begin(targets, None if box is None else self.hands.cell(box))
            except InputError as error:
                self._give_up(error)
                return False
        increment = self.engine.relax(max_iterations)
        if increment is None:
            return False
        if self._before_edit is not None and self._too_tight(increment):
            return True
        # What a change has done is nothing that the grains did.
        before = None if self.course.touched else self.last
        unfinished = increment.report.reason is StopReason.ITERATION_LIMIT
        self.course.touched = max(self.course.touched - 1, 0) if unfinished else 0
        if increment.friction is None and self.setup.friction is not None:
            # Nothing has moved, or it was taken back: forces are as before.
            last = self.last
            increment = replace(increment, friction=last.friction, beyond_cone=last.beyond_cone)
        self.last = increment
        earlier = None if before is None else Earlier(before, self.setup.packing.label)
        self.course.tell_what_stopped(self.setup, increment)
        left = self._remove_those_gone()
        self.course.follow(self.setup, increment)
        self._add_row(increment)
        if left:
            row, course = self.history[-1], self.course
            course.waited = row.stroke - course.last_exit[0]
            course.last_exit = row.stroke, row.resisting
        self.course.moving = self._goes_on(left)
        self._remark(None if left else before, earlier, left)
        self._keep()
        return True

    def _give_up(self, error: InputError) -> None:
        """An increment that cannot be begun: say why, and wait for the hand to ask for something else."""
        course = self.course
        course.blocked.update(course.targets)
        course.script, course.moving, course.touched = None, False, 0
        self.say(message(error))

    def _too_tight(self, increment: Increment) -> bool:
        """After an edit: if the grains cannot be relaxed, back to before it. True then."""
        before, self._before_edit = self._before_edit, None
        if increment.report.reason not in FAILED:
            return False
        assert before is not None
        self.restore(before[0])
        self.course = before[1].copy()
        self.say(TOO_TIGHT)
        return True

    def _add_row(self, increment: Increment) -> None:
        # Nobody has measured what a person has made.
        known = UNKNOWN if self.course.edited else self.scene.accuracy.estimate(self.packing_kind)
        number, farthest = len(self.history), self.engine.farthest_move()
        row = self.course.read_off(self.setup, increment, number, farthest, known)
        if number and increment.report.reason in FAILED:  # the grains are as they were
            row = replace(row, energy=self.history[-1].energy)
        self.history.append(row)

    @property
    def _still(self) -> bool:
        """True if neither the script, nor the grains by themselves, nor a change want another increment."""
        course = self.course
        return course.script is None and not course.moving and not course.touched

    def _goes_on(self, left: int) -> bool:
        """With drag: whether the grains are still on their way."""
        rest = self.setup.rest
        if math.isinf(rest) or self.failed:
            return False
        return left > 0 or self.engine.farthest_move() > rest

    def _remark(self, before: Increment | None, earlier: Earlier | None, left: int) -> None:
        """Take down what the scene has to say about the newest increment, and what has begun in it."""
        course = self.course
        at_rest = self.setup.drag > 0.0 and not course.moving
        curve = self.history.curve
        latest = Latest(
            before,
            self.last,
            curve,
            left,
            course.last_exit,
            at_rest,
            earlier,
            course.waited,
            course.initial,
        )
        remarks, going_on = self.scene.remarks(self.setup, self.settings, latest), course.remarks
        if self.locked:
            remarks = _locked(remarks, self.scene.what_holds(self.setup, latest), self.strength)
        course.remarks = remarks
        row = self.history[-1]
        for kind, text in remarks.happening.items():
            # A clog or an arch remains the same one until a grain has left.
            same = kind in ("clog", "arch") and course.announced.get(kind) == course.out
            if kind not in going_on.happening and not same:
                course.announced[kind] = course.out
                self.history.announce(Event(kind, row.increment, row.stroke, row.resisting, text))

    def _remove_those_gone(self) -> int:
        """How many grains have left by the outlet in this increment."""
        if self.setup.outlet is None:
            return 0
        gone = self.setup.outlet.gone(self.setup.packing)
        if gone.any():
            self.course.out += int(gone.sum())
            self.engine.remove(gone)
            pairs, bodies = self.engine.contacts()
            unbalanced = self.last.unbalanced[~gone]
            self.last = replace(
                self.last,
                grain_contacts=pairs,
                body_contacts=bodies,
                unbalanced=unbalanced,
                friction=without(self.last.friction, gone),
            )
        return int(gone.sum())

    # States to go back to.

    @property
    def kept(self) -> Checkpoint | None:
        """The checkpoint of the state as it is: None if something was changed since, or is going to be by the script."""
        return None if self.course.script is not None else self._kept

    def present(self) -> Checkpoint:
        """A checkpoint of the state as it is: the same object as long as nothing has changed."""
        if self.kept is None:
            self._kept = self._checkpoint(self.checkpoints.at(self.checkpoints.last))
        assert self._kept is not None
        return self._kept

    @property
    def settled(self) -> Checkpoint:
        """All that the next increment depends on, or that the one under way has begun with."""
        if self.engine.busy:
            assert self._begun is not None
            kept, course = self._begun
        else:
            kept, course = self._before_hands(), self.course
        return replace(kept, course=course.copy())

    def _before_hands(self) -> Checkpoint:
        """The state as it is, except that hands may have come and gone since."""
        return self.present() if self._kept is None else self._kept

    def _keep(self) -> None:
        """Keep the state after an increment."""
        before = self.checkpoints.at(self.checkpoints.last) if len(self.checkpoints) else None
        self._kept = self._checkpoint(before)
        self.checkpoints.add(self._kept)

    def _checkpoint(self, before: Checkpoint | None) -> Checkpoint:
        edit = self._before_edit
        return Checkpoint(
            engine=self.engine.save(None if before is None else before.engine),
            course=self.course.copy(),
            last=bare(self.last),
            history=self.history,
            length=len(self.history),
            settings=self.settings,
            before_edit=None if edit is None else replace(edit[0], course=edit[1]),
        )

    def restore(self, kept: Checkpoint) -> None:
        """Be as at that checkpoint; what is kept of the past and the future of that state stays."""
        self.engine.restore(kept.engine)
        self.course, self.settings = kept.course.copy(), kept.settings
        self.history = kept.history.upto(kept.length)
        pairs, bodies = self.engine.contacts()
        self.last = replace(kept.last, grain_contacts=pairs, body_contacts=bodies)
        self.checkpoints.travel(kept)
        before = kept.before_edit
        self._kept, self._before_edit = kept, None if before is None else (before, before.course)

    def recall(self, increment: int) -> None:
        """Go to the state after that increment, or the nearest kept before it."""
        self.restore(self.checkpoints.at(increment))

    def mark(self) -> RunMark:
        """A place to come back to, between two increments."""
        return RunMark(
            state=self.settled,
            kept=self._kept,
            last=self.last,
            before_edit=self._before_edit,
            history=self.history,
            events=self.history.events,
            checkpoints=self.checkpoints.copy(),
            straight=self.setup.reach is None,
        )

    def go_back(self, mark: RunMark) -> None:
        """Be as at that mark of this run: what came since has never been."""
        self.engine.restore(mark.state.engine)
        self.course, self.settings = mark.state.course.copy(), mark.state.settings
        self.history = mark.history
        self.history.cut(mark.state.length, mark.events)
        self.last = mark.last
        self.checkpoints = mark.checkpoints.copy()
        self._kept, self._before_edit = mark.kept, mark.before_edit

    # What can be seen.

    def state_hash(self) -> str:
        """Hash of every bit of the packing, of where the bodies are, and of what frictional contacts remember."""
        placement = self.setup.world.placement().tobytes()
        digest = hashlib.sha256(self.setup.packing.hash().encode() + placement)
        if self.setup.friction is not None:
            digest.update(self.setup.friction.hash().encode())
        for wall in self.setup.world.drawn:
            digest.update(wall.primitives().tobytes())
        return digest.hexdigest()

    @property
    def locked(self) -> bool:
        """True if all the strength of the hand moves nothing."""
        return self.course.locked

    @property
    def how_locked(self) -> str:
        """Where a locked hand ended, in one line."""
        course, way = self.course, self.way
        words = f"locked at {self.strength:g} k R"
        if way is not None:
            words += (
                f" after {way:.1f} R of stroke" if way >= 0.0 else f", pushed back by {-way:.1f} R"
            )
        if self.setup.outlet is not None:
            words += f": {course.out} of {course.initial} out"
        return words

    @property
    def way(self) -> float | None:
        """How far the body in the hand has come from where it first stood [R]; None for a periodic cell.

        Negative for one on a guide that was pushed back.
        """
        name = self.setup.handles[0].body
        if name == CELL:
            return None
        body = self.setup.world[name]
        if body.axis is None:
            return math.dist(body.position, body.home)
        return float(np.dot(np.subtract(body.position, body.home), body.axis))

    @property
    def hand_force(self) -> float:
        """Of the latest increment, along its pull [k R]; nan where it pulled at nothing."""
        return self.last.hand_force

    @property
    def strength(self) -> float:
        """Of the hand [k R]."""
        return self.setup.solver.hand_strength

    @property
    def failed(self) -> bool:
        """True if the newest increment led to nothing that can be shown."""
        return self.last.report.reason in FAILED

    def checks(self) -> list[Check]:
        """The scene's claims about this run; about what a person has made, only those that hold for any scene."""
        rows = self.history
        track = Track(
            stroke=rows.column("stroke"),
            force=rows.column("resisting"),
            grains_out=rows.column("grains_out"),
            residual=rows.column("residual"),
            converged=rows.column("stop_reason") == str(StopReason.CONVERGED),
            initial_grains=self.course.initial,
        )
        claims = self.scene.general_checks if self.course.edited else self.scene.checks
        return claims(self.setup, track)


def _locked(remarks: Remarks, holding: Holding, strength: float) -> Remarks:
    """What the scene has said, and that all the ``strength`` of the hand [k R] moves nothing, because of what holds."""
    text = Text("locked at {strength:g} k R: {holding}", strength=strength, holding=holding.text)
    grains = remarks.highlight if holding.grains is None else holding.grains
    return Remarks((text,), grains, {**remarks.happening, "locked": text})
