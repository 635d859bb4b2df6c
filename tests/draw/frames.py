"""Synthetic frames: no physics, but shapes, numbers and sizes like those of a real run."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.session.frame import BodyShape, Contacts, Frame, HandleState

Floats = NDArray[np.float64]


def curve(points: int, seed: int = 3) -> tuple[Floats, Floats]:
    """A force that rises and drops in avalanches, against stroke."""
    rng = np.random.default_rng(seed)
    stroke = np.linspace(0.0, 20.0, points)
    force = 0.8 * (1.0 - np.exp(-stroke)) + 0.25 * np.sin(stroke * 3.1) * rng.random(points)
    return stroke, np.maximum(force, 0.0)


def intruder_frame(
    columns: int = 24, packing: str = "mixed", seed: int = 1, points: int = 400, **changes: Any
) -> Frame:
    """A closed box of grains, squeezed in front of an intruder that is being pulled right."""
    rng = np.random.default_rng(seed)
    rows = columns
    pitch = 1.78
    column, row = np.meshgrid(np.arange(columns), np.arange(rows))
    x = (column + 0.5 * (row % 2)).ravel() * pitch + 1.0
    y = row.ravel() * pitch * 0.9 + 1.0
    width, height = columns * pitch + 1.0, rows * pitch * 0.9 + 0.4
    x = x + rng.normal(0.0, 0.06, x.size)
    y = y + rng.normal(0.0, 0.06, y.size)
    centre = np.array([0.45 * width, 0.5 * height])
    radius = min(5.7, 0.2 * width)
    away = np.hypot(x - centre[0], y - centre[1])
    keep = away > radius + 0.7
    x, y, away = x[keep], y[keep], away[keep]
    count = x.size
    rest = np.where(rng.random(count) < 0.5, 1.0, 0.86)
    share = {"regular": 0.0, "auxetic": 1.0}.get(packing, 0.5)
    nu = np.where(rng.random(count) < share, -0.8, 0.8)
    angle = np.arctan2(y - centre[1], x - centre[0])
    squeeze = np.exp(-(away - radius) / 5.0) * (0.4 + 0.6 * np.cos(angle).clip(0.0))
    p = rest * np.where(nu < 0, 1.0 - 0.22 * squeeze, 1.0 + 0.01 * squeeze)
    q = rest * np.where(nu < 0, 0.02, 0.16) * squeeze
    q1, q2 = -q * np.cos(2 * angle), -q * np.sin(2 * angle)

    dx, dy = x[:, None] - x[None, :], y[:, None] - y[None, :]
    near = np.argwhere(np.triu(np.hypot(dx, dy) < 1.95, 1))
    i, j = near[:, 0], near[:, 1]
    force = 0.9 * np.maximum(squeeze[i], squeeze[j]) * rng.exponential(0.5, i.size)
    touching = np.flatnonzero(away < radius + 1.6)
    reach = radius / away[touching]
    contacts = Contacts(
        np.concatenate((x[i], x[touching])),
        np.concatenate((y[i], y[touching])),
        np.concatenate((x[j], centre[0] + (x[touching] - centre[0]) * reach)),
        np.concatenate((y[j], centre[1] + (y[touching] - centre[1]) * reach)),
        np.concatenate((force, 0.7 * squeeze[touching])),
        np.concatenate((np.zeros(i.size, bool), np.ones(touching.size, bool))),
    )
    t = 0.6
    corners = [(-t, -t), (width + t, -t), (width + t, height + t), (-t, height + t)]
    sides = [(*a, *b, t) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    bodies = (
        BodyShape("box", "wall", segments=np.array(sides)),
        BodyShape("intruder", "intruder", discs=np.array([[*centre, radius]])),
    )
    handle = HandleState(
        "intruder",
        "intruder",
        float(centre[0]),
        float(centre[1]),
        (float(centre[0]) + 6.0, float(centre[1]) + 2.0),
        0.83,
        0.12,
        radius,
    )
    stroke, resist = curve(points)
    frame = Frame(
        scene="intruder",
        title="Intruder dragged through grains",
        packing=packing,
        seed=seed,
        increment=points,
        x=x,
        y=y,
        p=p,
        q1=q1,
        q2=q2,
        rest_radius=rest,
        poisson_ratio=nu,
        label=np.arange(count),
        pressure=0.2 * squeeze,
        stress_difference=0.3 * squeeze * (1.0 + 0.5 * np.sin(3.0 * angle)),
        motion=0.05 * squeeze * np.array([np.cos(angle), np.sin(2.0 * angle)]),
        contacts=contacts,
        bodies=bodies,
        handles=(handle,),
        bounds=(-2 * t, -2 * t, width + 2 * t, height + 2 * t),
        stroke=float(stroke[-1]) if points else 0.0,
        grains_out=0,
        energy=1.2,
        residual=0.0082,
        tolerance=0.01,
        iterations=512,
        stop_reason="converged",
        busy=False,
        protocol=False,
        notices=(),
        curve_stroke=stroke,
        curve_force=resist,
        curve_label="force on the intruder [k R]",
    )
    return replace(frame, **changes)


def hopper_frame(packing: str = "mixed", seed: int = 2, **changes: Any) -> Frame:
    """A channel that narrows to an orifice, a piston on top."""
    frame = intruder_frame(14, packing, seed)
    left, right, top = 0.0, 26.0, 34.0
    walls = np.array(
        [
            (left, 11.0, left, top, 0.5),
            (right, 11.0, right, top, 0.5),
            (left, 11.0, 9.6, 1.0, 0.5),
            (right, 11.0, 16.4, 1.0, 0.5),
        ]
    )
    plate = np.array([[0.6, 28.0], [25.4, 28.0], [25.4, 29.6], [0.6, 29.6]])
    bodies = (
        BodyShape("funnel", "wall", segments=walls),
        BodyShape("piston", "piston", polygons=(plate,)),
    )
    handle = HandleState("piston", "piston", 13.0, 28.8, None, 0.0, -8.02, 3.0, (0.0, 1.0))
    spin = np.random.default_rng(seed).normal(0.0, 1.5, frame.grains)
    return replace(
        frame,
        **{
            "scene": "hopper",
            "title": "Hopper with a piston",
            "bodies": bodies,
            "handles": (handle,),
            "bounds": (-1.0, -4.0, 27.0, 35.0),
            "y": frame.y + 6.0,
            "x": frame.x + 0.4,
            "spin": spin,
            "contacts": Contacts.none(),
            "grains_out": 37,
            "curve_label": "force on the piston [k R]",
            **changes,
        },
    )


def empty_frame(**changes: Any) -> Frame:
    """No grain, no body, no curve: what an empty scene would show."""
    none = np.empty(0)
    return replace(
        intruder_frame(6),
        **{
            "x": none,
            "y": none,
            "p": none,
            "q1": none,
            "q2": none,
            "rest_radius": none,
            "poisson_ratio": none,
            "label": np.empty(0, dtype=np.int64),
            "pressure": none,
            "stress_difference": none,
            "motion": np.empty((2, 0)),
            "contacts": Contacts.none(),
            "bodies": (),
            "handles": (),
            "curve_stroke": none,
            "curve_force": none,
            "increment": 0,
            "residual": float("nan"),
            **changes,
        },
    )


def periodic_frame(shift: float = 3.0, **changes: Any) -> Frame:
    """A sheared periodic cell of grains that reach over all its sides, some of them pointed at."""
    frame = intruder_frame(12)
    width, height = 20.0, 16.0
    x, y = frame.x % width, frame.y % height
    i = np.arange(frame.grains - 1)
    contacts = Contacts(
        x[i],
        y[i],
        x[i] + 1.6,
        y[i] + 0.5,
        0.1 + 0.01 * (i % 7).astype(np.float64),
        np.zeros(i.size, dtype=bool),
    )
    return replace(
        frame,
        **{
            "title": "Simple shear",
            "x": x,
            "y": y,
            "contacts": contacts,
            "bodies": (),
            "handles": (),
            "bounds": (-1.0, -1.0, width + 1.0, height + 1.0),
            "box": (width, height, shift),
            "highlight": np.arange(frame.grains) % 9 == 0,
            "curve_label": "shear stress over pressure",
            "stroke_label": "shear strain",
            **changes,
        },
    )
