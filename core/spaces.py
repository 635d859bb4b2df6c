"""Rigid bodies in pymunk: what a hand drags, and how deep one body sinks into others. The only module that knows pymunk.

In a Space walls are static, a piston is kinematic, and an intruder is a dynamic body that hangs on a PivotJoint from a kinematic
hand: the hand's pull is limited in speed and force, and walls stop the intruder, not the hand.

A Space carries hidden state (cached impulses, contact arbiters), so each increment gets a new one, built from the bodies'
positions alone. What follows then depends on nothing but those: a replay, an undo and a restored file move as the first run did.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import pymunk

Point = tuple[float, float]
SUBSTEPS = 4
HELD_MASS = 50.0  # [k · increment²] of a body in a hand, on a joint that gives way at walls: both only settle how it meets them
JOINT_FORCE = 40.0  # [k R]


class Body(Protocol):
    """What is asked of a rigid body: see ``rigid.RigidBody``."""

    position: Point
    angle: float
    discs: list[tuple[float, float, float]]
    segments: list[tuple[float, float, float, float, float]]
    polygons: list[tuple[tuple[Point, ...], float]]

    @property
    def movable(self) -> bool:
        """Does anything move it?"""


def pulled(body: Body, others: Sequence[Body], wanted: Point, step: float) -> Point:
    """Where a held body comes to [R] that is to go by ``wanted`` and at most ``step`` [R], with the others in its way."""
    space = pymunk.Space()
    space.iterations = 30
    space.collision_slop = 1e-4
    held = pymunk.Body(HELD_MASS, math.inf)
    held.position, held.angle = body.position, body.angle
    held.velocity = wanted
    held.velocity_func = lambda b, _gravity, _damping, _dt: _limit_speed(b, step)
    space.add(held, *_shapes(body, held))
    for other in others:
        fixed = pymunk.Body(
            body_type=pymunk.Body.KINEMATIC if other.movable else pymunk.Body.STATIC
        )
        fixed.position, fixed.angle = other.position, other.angle
        space.add(fixed, *_shapes(other, fixed))
    hand = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    hand.position = body.position
    hand.velocity = wanted
    joint = pymunk.PivotJoint(hand, held, (0.0, 0.0), (0.0, 0.0))
    joint.max_force = JOINT_FORCE
    joint.collide_bodies = False
    space.add(hand, joint)
    for _ in range(SUBSTEPS):
        space.step(1.0 / SUBSTEPS)
    return held.position.x, held.position.y


def depth(body: Body, position: Point, others: Sequence[Body]) -> float:
    """How deep ``body``, put at ``position``, would sink into one of the others [R]; 0 if it touches none."""
    space = pymunk.Space()
    for other in others:
        fixed = pymunk.Body(body_type=pymunk.Body.STATIC)
        fixed.position, fixed.angle = other.position, other.angle
        space.add(fixed, *_shapes(other, fixed))
    there = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    there.position, there.angle = position, body.angle
    found = [info for shape in _shapes(body, there) for info in space.shape_query(shape)]
    # Only points where they overlap are given; the sign of how far says which of the two shapes was asked about.
    return max(
        (abs(point.distance) for info in found for point in info.contact_point_set.points),
        default=0.0,
    )


def _limit_speed(body: pymunk.Body, step: float) -> None:
    """Velocity of a held body: never faster than one step an increment."""
    velocity = body.velocity
    if velocity.length > step:
        body.velocity = velocity * (step / velocity.length)


def _shapes(body: Body, holder: pymunk.Body) -> list[pymunk.Shape]:
    shapes: list[pymunk.Shape] = [pymunk.Circle(holder, r, (x, y)) for x, y, r in body.discs]
    shapes += [pymunk.Segment(holder, (x0, y0), (x1, y1), r) for x0, y0, x1, y1, r in body.segments]
    shapes += [pymunk.Poly(holder, list(corners), radius=r) for corners, r in body.polygons]
    return shapes
