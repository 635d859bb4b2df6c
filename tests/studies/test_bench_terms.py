"""What a scene does not need is not there: no compiled kernel, no import, no array."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from sandbox.studies.bench import terms
from scenes import registry

ROOT = Path(__file__).parents[2]
ABSENT = {
    "biaxial_periodic": ["friction", "bodies", "gravity", "threads", "pymunk"],
    "gravity_hopper": ["threads", "periodic box", "pymunk"],
}


@pytest.mark.slow
@pytest.mark.parametrize("scene", ABSENT)
def test_absent_terms_cost_nothing(scene: str, tmp_path: Path) -> None:
    found = terms.look(scene, str(tmp_path))
    assert terms.absent(found) == ABSENT[scene]
    kernels = {tuple(kernel) for kernel in found["kernels"]}
    assert (("core.fire", "add_weight") in kernels) == found["gravity"]
    assert (("core.slip", "prepare_friction") in kernels) == found["friction"]
    assert (("core.observables", "_measure_rigid") in kernels) == found["rigid"]
    assert (("core.rigid_contacts", "add_rigid_forces") in kernels) == found["rigid"]
    # State, velocity, force, inertia and where it was when the lists were made: 5 numbers of 8 bytes each, and more.
    assert 200.0 < found["bytes_a_grain"] < 4000.0
    row = terms.row_of(found)
    assert row.what == scene
    assert f"{len(found['kernels'])} functions" in row.measured
    assert len(found["kernels"]) == published()[scene]


def published() -> dict[str, int]:
    """How many functions the README says are compiled for each scene."""
    counts: dict[str, int] = {}
    for line in (ROOT / "README.md").read_text(encoding="utf-8").splitlines():
        row = re.match(r"\| (`\w+`(?:, `\w+`)*) \| (\d+) \| ", line)
        if row:
            counts |= dict.fromkeys(re.findall(r"`(\w+)`", row[1]), int(row[2]))
    return counts


def test_the_readme_has_the_table_of_the_published_run() -> None:
    sections = json.loads((ROOT / "assets/studies/bench/bench.json").read_text(encoding="utf-8"))
    found: list[dict[str, Any]] = sections["sections"]["terms"]["scenes"]
    assert {each["scene"] for each in found} == set(registry.names())
    assert published() == {each["scene"]: len(each["kernels"]) for each in found}


def test_friction_has_arrays_only_where_there_is_friction() -> None:
    from core.relaxation import Relaxation
    from tests.core import examples

    relaxation = Relaxation(examples.random_grains(20, 8.0, 1))
    assert relaxation.friction_terms is None
    assert relaxation._rigid is None
    assert relaxation._weight is None
    assert relaxation._minimizer.state.shape[0] == 5
