"""How well one colour is seen on another."""

from __future__ import annotations

from sandbox.draw.theme import channels


def contrast(first: int, second: int) -> float:
    """Contrast ratio of two colours, 1 to 21, after WCAG 2.1."""

    def luminance(colour: int) -> float:
        linear = []
        for channel in channels(colour):
            value = channel / 255.0
            linear.append(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4)
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    bright, dim = sorted((luminance(first), luminance(second)), reverse=True)
    return (bright + 0.05) / (dim + 0.05)
