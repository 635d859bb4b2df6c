"""An axis of the map as a person asks for it: a parameter, from where to where, in how many values."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scenes.parameter import Parameter, Value

AROUND = 1.0 / 3.0  # of a default, to either side, at first


@dataclass
class Side:
    """An axis as it is asked for."""

    parameter: Parameter
    low: float
    high: float
    count: int = 5

    @classmethod
    def around(cls, parameter: Parameter) -> Side:
        """About the default."""
        default = float(parameter.default)
        if (parameter.low, parameter.high) == (0.0, 1.0):  # a share: all of it
            return cls(parameter, 0.0, 1.0)
        side = cls(parameter, default, default)
        reach = max(AROUND * abs(default), 2.0 * side.step)
        side.low, side.high = side.bounded(default - reach), side.bounded(default + reach)
        return side

    @property
    def step(self) -> float:
        """By which its ends are moved: a round number, about a tenth of the default."""
        size = abs(float(self.parameter.default)) or float(self.parameter.high)
        power = 10.0 ** math.floor(math.log10(size / 10.0))
        step = power * (1 if size / 10.0 < 2.0 * power else 2 if size / 10.0 < 5.0 * power else 5)
        return max(step, 1.0) if self.parameter.kind == "whole number" else step

    def bounded(self, value: float) -> float:
        """On the grid of steps, within what the parameter may be."""
        low, high = float(self.parameter.low), float(self.parameter.high)
        return min(max(float(f"{round(value / self.step) * self.step:.6g}"), low), high)

    def values(self) -> tuple[Value, ...]:
        """All along the axis, each once."""
        between = (self.high - self.low) / max(self.count - 1, 1)
        found = [float(f"{self.low + k * between:.6g}") for k in range(self.count)]
        whole = self.parameter.kind == "whole number"
        return tuple(dict.fromkeys(round(v) if whole else v for v in found))
