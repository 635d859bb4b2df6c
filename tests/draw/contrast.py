"""How well one colour is seen on another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.theme import channels

# What eyes see of linear red, green and blue that lack one sort of cones: Machado, Oliveira and Fernandes 2009,
# doi:10.1109/TVCG.2009.113, at full severity.
EYES = {
    "all colours": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}


def linear(colour: int) -> NDArray[np.float64]:
    """Red, green and blue in proportion to light, 0 to 1."""
    value = np.array(channels(colour)) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def contrast(first: int, second: int, eyes: str = "all colours") -> float:
    """Contrast ratio of two colours, 1 to 21, after WCAG 2.1, as such eyes see them."""
    return contrast_of_light(linear(first), linear(second), eyes)


def contrast_of_light(
    first: NDArray[np.float64], second: NDArray[np.float64], eyes: str = "all colours"
) -> float:
    """The same of linear red, green and blue."""
    weights = np.array([0.2126, 0.7152, 0.0722])
    seen = [np.clip(EYES[eyes] @ light, 0.0, 1.0) @ weights for light in (first, second)]
    return float((max(seen) + 0.05) / (min(seen) + 0.05))
