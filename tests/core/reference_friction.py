"""Slow, plain twins of friction and gravity, from equations (10) and (11) of MODEL.md."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from core.arrays import Floats
from core.packing import Packing
from core.reference import (
    Contact,
    Vector,
    ellipses,
    grain_contact,
    near_pairs,
    nearest_image,
    rigid_contact,
)


class Tangential(NamedTuple):
    """A frictional contact, frozen for one increment (10)."""

    i: int
    j: int  # -1: a rigid body
    labels: tuple[int, int]  # by which it is remembered, see ``friction.Friction.remembered``
    t: Vector  # unit vector along which the surfaces slip: the normal that leaves grain i, turned left
    at: Vector  # where the surfaces meet [R]
    lever_i: float  # from the centre of i to there along the normal [R]
    lever_j: float  # the same of j; 0 for a body
    stiffness: float  # k_t [k]
    cap: float  # μ f_n [k R]
    slip: float  # ξ that it remembers, within ± cap/k_t [R]
    carried: float  # motion of the body's surface along t in this increment [R]


def frozen_friction(
    packing: Packing,
    coefficient: float,
    memory: dict[tuple[int, int], float],
    primitives: Floats | None = None,
    motion: Floats | None = None,
) -> list[Tangential]:
    """Every frictional contact at the start of an increment in which the primitives move by ``motion`` (M, 2) [R]."""
    grains = ellipses(packing)
    label = packing.label

    def tangential(i: int, j: int, labels: tuple[int, int], contact: Contact) -> Tangential:
        stiffness = 0.5 * contact.normal_force / contact.overlap
        cap = coefficient * contact.normal_force
        n, lever = contact.n, contact.slopes.h
        if j >= 0:
            lever -= 0.5 * contact.overlap  # half way between the two outlines
        r = math.hypot(
            *nearest_image(packing.box, grains[i].x - grains[j].x, grains[i].y - grains[j].y)
        )
        return Tangential(
            i=i,
            j=j,
            labels=labels,
            t=(n[1], -n[0]),
            at=(grains[i].x - lever * n[0], grains[i].y - lever * n[1]),
            lever_i=lever,
            lever_j=r - lever if j >= 0 else 0.0,
            stiffness=stiffness,
            cap=cap,
            slip=min(max(memory.get(labels, 0.0), -cap / stiffness), cap / stiffness),
            carried=0.0,
        )

    found = []
    for i, j in sorted(near_pairs(packing, 0.0)):
        contact = grain_contact(packing, grains, i, j)
        if contact is not None:
            labels = (int(min(label[i], label[j])), int(max(label[i], label[j])))
            found.append(tangential(i, j, labels, contact))
    for m, row in enumerate(() if primitives is None else primitives):
        for i, grain in enumerate(grains):
            contact = rigid_contact(float(packing.contact_stiffness[i]), grain, row)
            if contact is not None:
                one = tangential(i, -1, (int(label[i]), -1 - m), contact)
                shift = (0.0, 0.0) if motion is None else motion[m]
                found.append(one._replace(carried=float(shift[0] * one.t[0] + shift[1] * one.t[1])))
    return found


def friction_energy_and_forces(
    frozen: list[Tangential], displacement: Floats, turned: Floats
) -> tuple[float, Floats]:
    """Energy [k R²] (10) and forces on x, y [k R] and spin [k R²], (3, N), of friction.

    ``displacement`` (2, N) [R] and ``turned`` (N,) [rad] count from the start of the increment.
    """
    energy, forces = 0.0, np.zeros((3, displacement.shape[1]))
    for contact in frozen:
        i, j, t = contact.i, contact.j, contact.t
        u = contact.slip + t[0] * displacement[0, i] + t[1] * displacement[1, i]
        u += contact.lever_i * turned[i] - contact.carried
        if j >= 0:
            u -= t[0] * displacement[0, j] + t[1] * displacement[1, j]
            u += contact.lever_j * turned[j]
        if contact.stiffness * abs(u) <= contact.cap:
            pull = contact.stiffness * u
            energy += 0.5 * contact.stiffness * u**2
        else:
            pull = math.copysign(contact.cap, u)
            energy += contact.cap * (abs(u) - 0.5 * contact.cap / contact.stiffness)
        forces[:, i] -= pull * t[0], pull * t[1], pull * contact.lever_i
        if j >= 0:
            forces[:, j] -= -pull * t[0], -pull * t[1], pull * contact.lever_j
    return energy, forces


def weight(packing: Packing, gravity: Vector) -> tuple[float, Floats]:
    """Potential energy [k R²] and forces on x, y (2, N) [k R] of gravity [k/R]: a grain weighs g R0² (11)."""
    energy, forces = 0.0, np.zeros((2, len(packing)))
    for i in range(len(packing)):
        area = float(packing.rest_radius[i]) ** 2
        forces[:, i] = area * gravity[0], area * gravity[1]
        energy -= forces[0, i] * packing.x[i] + forces[1, i] * packing.y[i]
    return energy, forces
