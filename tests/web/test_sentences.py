"""What pages say and show is what the desk does."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.session.course import BLEW_UP, PRESSED_IN, SQUEEZED_FLAT
from sandbox.web import building
from sandbox.web.increment import course, relaxation, remarks
from sandbox.web.increment.memory import COUNTS, Kept
from sandbox.web.increment.observe import observe
from sandbox.web.laid_out import laid_out, part
from sandbox.web.sentences import ALL, said_in, told
from sandbox.words import language
from scenes import registry
from tests.web.pages import RUNS, Run

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("run", RUNS)
def test_kernels_say_and_show_what_the_desk_does(exact: dict[Run, Any], run: Run) -> None:
    said = exact[run]
    for desk, kernels in said["said"]:
        assert kernels == desk
    assert max(said["apart"]) < 1e-12


def test_the_runs_have_much_to_say(exact: dict[Run, Any]) -> None:
    said = {run: " ".join(desk for desk, _ in exact[run]["said"]) for run in RUNS}
    for kind in ("locked", "arch", "clog"):
        assert f"('{kind}', " in said["hopper", "regular"], kind
    assert "('avalanche', " in said["intruder", "regular"]
    assert "all the hand has" in said["intruder", "regular"]
    assert "flowing" in said["gravity_hopper", "mixed"]
    assert "end of travel" in said["gravity_hopper", "mixed"]
    assert "sideways: " in said["grain_row", "mixed"]
    assert "Poisson's ratio" in said["single_grain", "mixed"]
    assert "shear stress over pressure" in said["couette", "mixed"]


def test_every_sentence_has_its_words_and_its_scene() -> None:
    assert len(ALL) == remarks.STRESS_FELL + 1
    for code in language.available():
        with language.speaking(code):
            for sentence in ALL:
                text = sentence.text("piston")
                values = dict.fromkeys(sentence.values, 3)
                assert "{" not in language.Word(text).format(**values), (code, text)
    everything = frozenset().union(*(said_in(name) for name in building.SCENES))
    assert everything == frozenset(range(len(ALL)))


def test_what_is_taken_back_is_said_as_on_the_desk() -> None:
    scene = registry.get("single_grain")
    settings = scene.settings({})
    setup = scene.build(settings, "regular", 1)
    blocks = laid_out(scene, setup, settings, "regular")
    kept = Kept(*blocks)
    course.advance(kept)
    for reason, text in (
        (relaxation.COLLAPSED, SQUEEZED_FLAT),
        (relaxation.NOT_FINITE, BLEW_UP),
        (relaxation.SUNK, PRESSED_IN),
    ):
        part(blocks, "counts", len(COUNTS))[COUNTS.reason] = reason
        observe(kept)
        assert told(blocks, "plate") == ([text], [])
