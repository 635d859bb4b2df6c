"""Whether to believe what is shown: a colour and a few words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sandbox.draw.numbers import ONE_DIGIT, percent
from sandbox.draw.theme import Theme
from sandbox.session.frame import CONVERGED, Frame
from sandbox.words import words

ROUGH = 0.5  # an error of the force on the handle that one in ten exceeds, above which settled is not yet green


@dataclass(frozen=True, slots=True)
class Lamp:
    """One look at the state of the computation."""

    colour: int
    state: str
    error: str  # how far the forces can be trusted; empty where that means nothing
    within: str = ""  # the same in the fewest words

    @property
    def words(self) -> str:
        """Both parts."""
        return f"{self.state} · {self.error}" if self.error else self.state

    @property
    def short(self) -> str:
        """Both parts where there is little room."""
        return f"{self.state} · {self.within}" if self.within else self.state


def lamp(frame: Frame, theme: Theme) -> Lamp:
    """Green: settled to the tolerance; amber: on the way; red: don't believe the picture."""
    if frame.stop_reason in words.BROKEN:
        return Lamp(theme.bad, words.STOPPED[frame.stop_reason], "")
    within = ""
    estimated = 0.0 <= frame.force_error <= 1.0
    if not math.isfinite(frame.residual):
        error = words.NO_FORCES
    elif frame.residual > 1.0:
        error = words.UNKNOWN_FORCES
    elif estimated:
        bound = percent(max(frame.force_error, 1e-6), ONE_DIGIT)
        usual = percent(max(frame.usual_error, 1e-6), ONE_DIGIT)
        said = words.HANDLE_FORCE_WITHIN if usual == bound else words.HANDLE_FORCE_ERROR
        error = said.format(usual=usual, error=bound)
        within = words.WITHIN.format(error=bound)
    else:
        bound = percent(max(frame.residual, 1e-6))
        error, within = words.FORCE_ERROR.format(error=bound), words.WITHIN.format(error=bound)
    if frame.busy:
        return Lamp(theme.working, words.SETTLING, error, within)
    if frame.stop_reason == CONVERGED:
        rough = estimated and frame.force_error > ROUGH
        return Lamp(theme.working if rough else theme.good, words.SETTLED, error, within)
    reason = words.STOPPED.get(frame.stop_reason, frame.stop_reason)
    near = frame.residual <= 10.0 * frame.tolerance
    return Lamp(theme.working if near else theme.bad, reason, error, within)


def worst(frames: Sequence[Frame], theme: Theme) -> Frame:
    """The frame that is to be believed least."""
    order = [theme.good, theme.working, theme.bad]

    def doubt(frame: Frame) -> tuple[int, float, float]:
        error, residual = (
            value if math.isfinite(value) else 0.0 for value in (frame.force_error, frame.residual)
        )
        return order.index(lamp(frame, theme).colour), error, residual

    return max(frames, key=doubt)
