"""How runs side by side are told apart: a name, a colour and a dash for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sandbox.draw.theme import packing_colour, packing_dash
from sandbox.session.frame import Frame
from sandbox.words import words

DASHES = (
    "regular",
    "auxetic",
    "mixed",
)  # of packings, given in turn to runs that have the same one


@dataclass(frozen=True, slots=True)
class Mark:
    """Of a run: what it is called, and how its curve is drawn."""

    name: str
    colour: int
    dash: tuple[float, ...]


def marks(frames: Sequence[Frame]) -> list[Mark]:
    """Of each frame: its packing, and where several have the same, what is set otherwise in them, and the seed."""
    kinds = [frame.packing for frame in frames]
    if len(set(kinds)) == len(kinds):
        return [Mark(_packing(kind), packing_colour(kind), packing_dash(kind)) for kind in kinds]
    found = []
    for place, frame in enumerate(frames):
        parts = [_packing(frame.packing)] if len(set(kinds)) > 1 else []
        parts += [
            words.EXPLORE_AT.format(name=words.parameter_name(name), value=value)
            for name, value in frame.settings.items()
            if any(other.settings.get(name) != value for other in frames)
        ]
        if any(other.seed != frame.seed for other in frames):
            parts.append(words.SEED.format(seed=frame.seed))
        name = " · ".join(parts) or _packing(frame.packing)
        dash = packing_dash(DASHES[place % len(DASHES)])
        found.append(Mark(name, packing_colour(frame.packing), dash))
    return found


def _packing(packing: str) -> str:
    return words.PACKINGS.get(packing, packing)
