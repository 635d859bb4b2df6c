"""Ways to look at the grains: by kind, as they are made, or coloured by a quantity on a scale.

Each quantity is a function of a Frame alone, (N,) numbers, one a grain.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.errors import InputError
from sandbox.draw.theme import Theme, magnitude_colours
from sandbox.session.frame import Frame
from sandbox.words import words

Colours = NDArray[np.uint32]
Colouring = Callable[[Theme, Floats], Colours]

# Parts of cividis on grains, from no value to the top: the mark in ground colour shows on all of it.
FILL_RAMPS = {"dark": (0.2, 1.0), "light": (0.8, 0.0)}
FRINGE_RAMPS = {"dark": (0.2, 1.0), "light": (0.0, 0.8)}  # from no light to full light
FRINGES = 2.0  # dark bands from no stress to the top of the scale, the first excepted


def pressure(frame: Frame) -> Floats:
    """Mean pressure in each grain, p = Σ f h / 2A over its contacts [k]."""
    return frame.pressure


def shape(frame: Frame) -> Floats:
    """(a − b)/(a + b) of the semi-axes a ≥ b; 0 for a circle."""
    with np.errstate(all="ignore"):
        values: Floats = np.hypot(frame.q1, frame.q2) / frame.p
    return values


def area_lost(frame: Frame) -> Floats:
    """What part of its area at rest each grain has lost [%]; 0 where it has grown."""
    with np.errstate(all="ignore"):
        area = frame.p * frame.p - frame.q1 * frame.q1 - frame.q2 * frame.q2
        values: Floats = np.maximum(100.0 * (1.0 - area / frame.rest_radius**2), 0.0)
    return values


def motion(frame: Frame) -> Floats:
    """How far each grain moved in the latest increment against the mean of all [R].

    In a periodic cell also against the cell's own stretch and shear: the non-affine part.
    """
    own = frame.motion
    finite = np.isfinite(own).all(axis=0)
    mean = own[:, finite].mean(axis=1) if finite.any() else np.zeros(2)
    with np.errstate(all="ignore"):
        values: Floats = np.hypot(*(own - mean[:, None]))
    return values


def stress_difference(frame: Frame) -> Floats:
    """Difference of the principal stresses in each grain [k]: what polarised light shows."""
    return frame.stress_difference


def fill_colours(theme: Theme, share: Floats) -> Colours:
    """Magnitudes on more of cividis than lines can use: a rim sets grains off from the ground."""
    return magnitude_colours(theme, share, FILL_RAMPS[theme.name])


def fringe_colours(theme: Theme, share: Floats) -> Colours:
    """Brightness as sin² of the stress, dark at none: as between crossed polarisers."""
    bounded = np.clip(np.nan_to_num(share, nan=0.0), 0.0, 1.0)
    light = np.sin(np.pi * FRINGES * bounded) ** 2
    return magnitude_colours(theme, light, FRINGE_RAMPS[theme.name])


@dataclass(frozen=True, slots=True)
class View:
    """One way to look at the grains. Without a measure they have the colours of their kinds."""

    name: str
    measure: Callable[[Frame], Floats] | None = None
    unit: str = ""
    least: float = 1.0  # the top of the scale is never below this
    colouring: Colouring = fill_colours
    made: bool = False  # drawn as they are made
    chains: bool = False  # are force chains shown at first?
    only_chains: bool = False

    @property
    def title(self) -> str:
        """What the legend says."""
        return words.VIEWS[self.name]

    def colours(self, theme: Theme, values: Floats, top: float) -> Colours:
        """Colours of values (N,) on a scale from 0 to ``top``; grey for what is no number."""
        with np.errstate(all="ignore"):
            colours = self.colouring(theme, values / top)
        return np.where(np.isfinite(values), colours, np.uint32(theme.hairline))


_ALL = (
    View("kind", chains=True),
    View("skin", made=True),
    View("pressure", pressure, words.STRESS_UNIT, 0.005),
    View("shape", shape, "", 0.01),
    View("area", area_lost, words.PERCENT, 1.0),
    View("motion", motion, words.LENGTH_UNIT, 1e-4),
    View("chains", chains=True, only_chains=True),
    View("fringes", stress_difference, words.STRESS_UNIT, 0.005, colouring=fringe_colours),
)
VIEWS = {view.name: view for view in _ALL}
KIND = VIEWS["kind"]


def view_named(name: str) -> View:
    """The view of that name."""
    try:
        return VIEWS[name]
    except KeyError:
        raise InputError(f"unknown view {name!r}: choose {', '.join(VIEWS)}") from None


def view_after(view: View) -> View:
    """The next one; after the last the first."""
    names = list(VIEWS)
    return VIEWS[names[(names.index(view.name) + 1) % len(names)]]
