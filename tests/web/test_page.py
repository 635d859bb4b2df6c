"""The page itself, in a browser."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.draw.numbers import ONE_DIGIT, percent
from sandbox.web import building
from sandbox.web.laid_out import state_hash
from sandbox.words import language, words
from tests.web.pages import blocks_of, run_exactly

pytestmark = pytest.mark.slow


def test_the_pages_ask_for_nothing_say_nothing_and_are_open_to_all(tried: dict[str, Any]) -> None:
    assert tried["faults"] == []
    assert set(tried["others"]) == set(building.SCENES)


def test_in_the_page_the_regular_hopper_locks_and_the_auxetic_one_flows(
    tried: dict[str, Any],
) -> None:
    regular, _, auxetic = tried["dragged"]
    assert regular["locked"]
    assert not auxetic["locked"]
    assert auxetic["out"] > 0
    assert auxetic["stroke"] > regular["stroke"]


def test_the_page_says_what_happens(tried: dict[str, Any]) -> None:
    regular = dict(map(tuple, tried["dragged"][0]["events"]))
    assert set(regular) >= {"locked", "arch", "clog"}
    assert re.fullmatch(r"locked at 8 k R: an arch of \d grains holds", regular["locked"])
    assert tried["told"][0].startswith(f"regular {regular['locked']}")
    assert any(line.startswith("regular · increment ") for line in tried["events"])
    for said, (usual, most) in zip(tried["trust"], tried["errors"], strict=True):
        often, bound = (percent(max(error, 1e-6), ONE_DIGIT) for error in (usual, most))
        text = words.HANDLE_FORCE_ERROR.format(usual=often, error=bound)
        within = words.HANDLE_FORCE_WITHIN.format(error=bound)
        assert said in (f"settled · {text}", f"settled · {within}")
    assert tried["slow"] == [["settling", "lamp working"]] * 3
    for line in tried["events"]:
        assert "{" not in line
        assert "NaN" not in line


def test_a_page_in_use_sets_undoes_and_resets(tried: dict[str, Any]) -> None:
    assert tried["softer"][0]["ratios"] == [0.6]
    assert tried["softer"][0]["rows"] > tried["dragged"][0]["rows"]
    assert tried["again"] == tried["first"]
    for name, seen in tried["others"].items():
        played, pulled = ([pane["rows"] for pane in seen[when]] for when in ("played", "pulled"))
        assert min(played) > 4, name
        assert min(more - rows for rows, more in zip(played, pulled, strict=True)) > 4, name
        assert seen["back"] == seen["before"], name
        assert seen["redone"] == seen["far"] != seen["back"], name
        still, later = seen["paused"]
        assert still == [pane["rows"] for pane in seen["pulled"]], name
        assert min(more - rows for rows, more in zip(still, later, strict=True)) > 0, name
        assert any(0.6 in pane["ratios"] for pane in seen["softer"]), name
        assert seen["end"] == seen["start"], name
        if seen["shares"]:
            assert seen["shares"][1] == pytest.approx(0.75, abs=0.05), name


def test_clumsy_hands_leave_a_page_in_order(tried: dict[str, Any]) -> None:
    hands = tried["hands"]
    assert not hands["byOther"]
    assert hands["keptHold"]
    assert hands["after"] < 5
    assert hands["aloud"].startswith("regular: ")
    assert "an event" not in hands["aloud"]
    for rows, drawn in hands["curves"]:
        assert rows == drawn > 1
    assert hands["friction"] == "0.5"
    with language.speaking("de"):
        assert hands["inGerman"].startswith(f"{words.PACKINGS['regular']}: ")
    assert hands["focus"] == "undo"
    assert hands["lamps"][0] == hands["lamps"][1]
    assert min(hands["printed"]) > 100
    assert hands["pulled"] == [True, 0]
    assert hands["scrolled"] == [False]


def test_a_seed_is_chosen_by_hand_by_key_and_by_address(tried: dict[str, Any]) -> None:
    seeds = tried["seeds"]
    assert seeds["offered"] == ["1", "2"]
    assert seeds["named"] == language.table("en")["words"]["panel_seed"]
    assert seeds["begun"] == [
        ["1", 0],
        ["2", 1],
        ["1", 0],
    ]  # as such, by address, and by one that is not there
    unknown = language.table("en")["player"]["unknown_seed"].format(asked="77", seed=1)
    assert seeds["told"] == ["", "", unknown, ""]  # until one is chosen
    assert seeds["chosen"] == [1, 0]  # from the list, and by the key
    assert seeds["start"] == [
        1,
        1,
        1,
    ]  # increments: what is chosen while paused is shown, and stands still


def test_the_page_unfolds_what_was_laid_out(tried: dict[str, Any]) -> None:
    for seed, laid in enumerate(tried["laid"], 1):
        for there, blocks in zip(laid, building.packings_of(("hopper", seed)), strict=False):
            for block, other in zip(blocks_of(there), blocks, strict=True):
                assert block.tobytes() == other.tobytes()


def test_a_page_that_cannot_go_on_says_so(tried: dict[str, Any]) -> None:
    table = language.table("en")
    assert tried["hands"]["never"] == table["player"]["cannot_run"]
    again = table["player"]["silent"].format(reset=table["buttons"]["reset"])
    assert tried["hands"]["silent"] == again


@pytest.mark.parametrize(("kind", "place"), [("regular", 0), ("auxetic", 2)])
def test_the_page_has_the_bits_of_the_desk(
    tried: dict[str, Any], tmp_path: Path, kind: str, place: int
) -> None:
    laid = blocks_of(tried["laid"][0][place])
    np.savez(tmp_path / "laid.npz", ints=laid[0], floats=laid[1])
    said = run_exactly(("hopper", kind), tmp_path, f"from={tmp_path / 'laid.npz'}")["session"]
    start, driven = (blocks_of(some[place]) for some in tried["blocks"])
    assert state_hash(start) == said[0]
    assert state_hash(driven) == said[60]
