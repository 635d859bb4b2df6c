"""From a running session to a frame: an immutable copy of what can be seen."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.observables import grain_stress
from core.packing import Packing, PeriodicBox
from core.rigid import Point, RigidBody
from core.rigid_contacts import DISC
from sandbox.session.forces import contact_forces
from sandbox.session.frame import Ahead, BodyShape, Contacts, Frame, HandleState
from sandbox.session.history import History
from sandbox.session.run import Run
from scenes.scene import Handle


def take(run: Run, can_undo: bool, can_redo: bool, refusals: tuple[int, str]) -> Frame:
    """A snapshot that shares nothing with the run; what its session knows besides: how many commands were refused, and why."""
    packing, box, curve = run.setup.packing, run.setup.packing.box, run.setup.curve
    under_way = run.engine.progress()
    last = run.last.report
    highlight = run.course.remarks.highlight
    state = packing.state.copy()
    state[:2] = packing.folded()
    usual, most = _errors(run.history)
    primitives, _ = run.setup.world.primitives()
    stress = grain_stress(packing, run.last.grain_contacts, run.last.body_contacts, primitives)
    return Frame(
        scene=run.scene.name,
        title=run.scene.title,
        packing=run.packing_kind,
        seed=run.seed,
        increment=len(run.history) - 1,
        x=state[0],
        y=state[1],
        p=state[2],
        q1=state[3],
        q2=state[4],
        rest_radius=packing.rest_radius.copy(),
        poisson_ratio=packing.poisson_ratio.copy(),
        label=packing.label.copy(),
        pressure=stress[0],
        stress_difference=2.0 * np.hypot(stress[1], stress[2]),
        motion=run.engine.own_motion(),
        contacts=_contact_lines(run, packing, primitives, state[0], state[1]),
        bodies=tuple(_shape(body, box) for body in run.setup.world.bodies),
        handles=tuple(_handle_state(run, handle) for handle in run.setup.handles),
        bounds=run.setup.bounds,
        focus=run.setup.focus,
        stroke=run.course.stroke,
        grains_out=run.course.out,
        energy=last.energy,
        residual=last.residual,
        tolerance=run.setup.solver.tolerance,
        iterations=(last if under_way is None else under_way).iterations,
        stop_reason=str(last.reason),
        busy=under_way is not None,
        protocol=run.course.script is not None,
        notices=(*run.course.notices, *run.course.remarks.notices),
        curve_stroke=run.history.curve[0],
        curve_force=run.history.curve[1],
        spin=None if run.setup.friction is None else run.setup.friction.spin.copy(),
        curve_label=run.setup.force_label,
        stroke_label=run.setup.stroke_label,
        hand_limit=run.strength if curve is None and math.isfinite(run.strength) else None,
        box=None if box is None else (box.width, box.height, box.shift),
        highlight=None if highlight is None else highlight.copy(),
        residual_force=run.last.unbalanced.copy(),
        usual_error=usual,
        force_error=most,
        beyond_cone=run.last.beyond_cone,
        settings=dict(run.settings),
        first_kept=run.checkpoints.first,
        last_kept=run.checkpoints.last,
        can_undo=can_undo,
        can_redo=can_redo,
        refusals=refusals[0],
        refusal=refusals[1],
        events=run.history.events,
        ahead=_ahead(run),
    )


def _errors(history: History) -> tuple[float, float]:
    """The newest estimates over the mean magnitude of the force so far; nan where there was none."""
    scale, row = history.mean_magnitude, history[-1]
    if scale == 0.0:
        return math.nan, math.nan
    return row.usual_error / scale, row.force_error / scale


def _ahead(run: Run) -> Ahead | None:
    """What is kept of later increments."""
    future = run.checkpoints.future(len(run.history))
    if future is None:
        return None
    so_far, last = len(run.history), run.checkpoints.last
    stroke, force = future.curve[:, so_far : last + 1]
    later = tuple(e for e in future.events if so_far <= e.increment <= last)
    return Ahead(stroke, force, later)


def _contact_lines(
    run: Run,
    packing: Packing,
    primitives: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
) -> Contacts:
    """Lines from where the grains are drawn, ``x`` and ``y`` (N,); a line that leaves the periodic cell goes on outside."""
    pairs, bodies = run.last.grain_contacts, run.last.body_contacts
    whole = contact_forces(run.last, run.setup.world)
    grain_x, grain_y = x[bodies.grain], y[bodies.grain]
    body_x = bodies.x + grain_x - packing.x[bodies.grain]
    body_y = bodies.y + grain_y - packing.y[bodies.grain]
    # On a disc the force acts at its centre; the line ends where grain and disc touch.
    disc = primitives[bodies.primitive, 0] == DISC
    length = np.hypot(grain_x - body_x, grain_y - body_y)
    share = np.where(disc, primitives[bodies.primitive, 7] / np.maximum(length, 1e-12), 0.0)
    return Contacts(
        x0=np.concatenate([x[pairs.i], grain_x]),
        y0=np.concatenate([y[pairs.i], grain_y]),
        x1=np.concatenate([x[pairs.i] + pairs.dx, body_x + share * (grain_x - body_x)]),
        y1=np.concatenate([y[pairs.i] + pairs.dy, body_y + share * (grain_y - body_y)]),
        force=np.concatenate([pairs.normal_force, bodies.normal_force]),
        rigid=np.repeat([False, True], [len(pairs.i), len(bodies.grain)]),
        i=np.concatenate([pairs.i, bodies.grain]),
        j=np.concatenate([pairs.j, np.full(len(bodies.grain), -1)]),
        fx=whole.fx,
        fy=whole.fy,
    )


def _handle_state(run: Run, handle: Handle) -> HandleState:
    box = run.setup.packing.box
    target = run.course.targets.get(handle.body)
    if handle.body == "box" and box is not None:
        at = run.setup.box_handle
        place = (box.width, box.height) if at is None else at(box)
        x, target = _nearest_image(place[0], target, box) if at is not None else (place[0], target)
        return HandleState(
            name=handle.body,
            label=handle.label,
            x=x,
            y=place[1],
            target=target,
            fx=0.0,
            fy=0.0,
            radius=handle.radius,
            axis=handle.direction,  # whatever else a hand wants of it, it goes along that line
        )
    body = run.setup.world[handle.body]
    push = run.last.reactions[run.setup.world.index(handle.body), :2]
    # The hand's force along its pull, as it is plotted; what goes across is borne by the guide.
    along = run.course.direction if body.axis is None else body.axis
    fx, fy = -float(np.dot(push, along)) * np.array(along)
    x, target = _nearest_image(body.position[0], target, box)
    return HandleState(
        name=handle.body,
        label=handle.label,
        x=x,
        y=body.position[1],
        target=target,
        fx=float(fx),
        fy=float(fy),
        radius=handle.radius,
        axis=body.axis,
    )


def _nearest_image(
    x: float, target: Point | None, box: PeriodicBox | None
) -> tuple[float, Point | None]:
    """What has gone round a periodic cell is shown where its image is, and so is the place where it is wanted."""
    if box is None or not np.isfinite(box.width):
        return x, target
    shown = x % box.width
    return shown, None if target is None else (target[0] + shown - x, target[1])


def _shape(body: RigidBody, box: PeriodicBox | None) -> BodyShape:
    """A body's shapes in the world, for drawing; discs folded into the periodic cell."""
    discs = np.array([(*body.to_world([(x, y)])[0], radius) for x, y, radius in body.discs])
    discs = discs.reshape(-1, 3)
    if box is not None and np.isfinite(box.width):
        discs[:, 0] %= box.width
    rows = np.array(body.segments, dtype=np.float64).reshape(-1, 5)
    ends = body.to_world(rows[:, :4].reshape(-1, 2)).reshape(-1, 4)
    return BodyShape(
        name=body.name,
        role=body.role,
        discs=discs,
        segments=np.column_stack([ends, rows[:, 4:]]),
        polygons=tuple(body.to_world(corners) for corners, _ in body.polygons),
    )
