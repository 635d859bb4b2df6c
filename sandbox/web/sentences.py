"""The words for what ``increment.remarks`` says as numbers: the desk's own texts, and what stands in one of another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sandbox.web.increment import remarks
from sandbox.web.increment.memory import COLUMNS, COUNTS, SAID, SENTENCES
from sandbox.web.laid_out import REMARKS, Blocks, part
from sandbox.words import language, words

EVENTS = ("locked", "clog", "arch", "avalanche")  # by the kernels' numbers


@dataclass(frozen=True)
class Sentence:
    """A text of the tables, under the name ``key`` in ``[texts]``; ``inner``: the names of texts that stand in it."""

    key: str
    values: tuple[str, ...] = ()  # what the numbers that come with it are called
    inner: Mapping[str, str] = field(default_factory=dict)

    def text(self, handle: str) -> str:
        """In the present language, with room for its numbers; ``handle`` is what the hand holds."""
        text = str(language.find("texts", self.key))
        for name, key in self.inner.items():
            text = text.replace(f"{{{name}}}", str(language.find("texts", key)))
        return text.replace("{label}", words.say(handle))


_STRAINS = ("tall", "wide")
_RATIO = (*_STRAINS, "ratio", "nu")
# In the order of ``increment.remarks``.
ALL = (
    Sentence("hand_limit", ("limit",)),
    Sentence("end_of_travel"),
    Sentence("stopped_by_wall"),
    Sentence("squeezed_flat"),
    Sentence("blew_up"),
    Sentence("pressed_in"),
    Sentence("avalanche_force", ("fall",)),
    Sentence("arch_holds", ("grains",)),
    Sentence("clogged", ("diameters",)),
    Sentence("clogged_arch", ("diameters", "grains"), {"clogged": "clogged"}),
    Sentence("empty"),
    Sentence("flowing"),
    Sentence("avalanche_flow", ("count",)),
    Sentence("at_rest", ("count",)),
    Sentence("never_started", ("arch", "count")),
    Sentence("clogged_gravity", ("arch", "count")),
    Sentence("locked", ("strength", "grains"), {"holding": "locked_arch"}),
    Sentence("locked", ("strength", "grains"), {"holding": "locked_grains"}),
    Sentence("locked", ("strength",), {"holding": "locked_all"}),
    Sentence("sideways", ("share",)),
    Sentence("sideways_room", ("share", "room"), {"sideways": "sideways"}),
    Sentence("grain_strains", _STRAINS, {"kind": "regular"}),
    Sentence("grain_ratio", _RATIO, {"strains": "grain_strains", "kind": "regular"}),
    Sentence("grain_strains", _STRAINS, {"kind": "auxetic"}),
    Sentence("grain_ratio", _RATIO, {"strains": "grain_strains", "kind": "auxetic"}),
    Sentence("plate_stresses", ("normal", "ratio")),
    Sentence("no_hold"),
    Sentence("avalanche_stress", ("fall",)),
)


_OF_ANY = (*range(remarks.FORCE_FELL), *range(remarks.LOCKED_BY_ARCH, remarks.SIDEWAYS))
_OF_SCENES = {
    remarks.HOPPER: range(remarks.FORCE_FELL, remarks.EMPTY),
    remarks.GRAVITY: range(remarks.EMPTY, remarks.LOCKED_BY_ARCH),
    remarks.DISC: (remarks.FORCE_FELL,),
    remarks.ROW_OF_GRAINS: (remarks.SIDEWAYS, remarks.SIDEWAYS_AND_ROOM),
    remarks.SINGLE: range(remarks.STRAINS, remarks.STRESSES),
    remarks.SHEAR: range(remarks.STRESSES, len(ALL)),
}


def said_in(scene: str) -> frozenset[int]:
    """Which sentences there can be about a run of that scene."""
    return frozenset((*_OF_ANY, *_OF_SCENES.get(REMARKS.get(scene, remarks.NOBODY), ())))


def told(blocks: Blocks, handle: str) -> tuple[list[str], list[tuple[str, str]]]:
    """What is said about the latest increment in the present language; and the events that begin in it, with their texts."""
    count = int(part(blocks, "counts", len(COUNTS))[COUNTS.said])
    shown, events = [], []
    for row in part(blocks, "said", SENTENCES * COLUMNS).reshape(SENTENCES, COLUMNS)[:count]:
        sentence = ALL[int(row[SAID.sentence])]
        values = [float(value) for value in row[SAID.values :]]
        whole = {
            name: int(v) if v.is_integer() else v
            for name, v in zip(sentence.values, values, strict=False)
        }
        text = language.Word(sentence.text(handle)).format(**whole)
        if row[SAID.shown]:
            shown.append(text)
        if row[SAID.event] >= 0:
            events.append((EVENTS[int(row[SAID.event])], text))
    return shown, events
