"""λ and μ of the paper in place of Poisson's ratios and contact stiffness, and where the strain of the shrinking box begins."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core import observables
from core.errors import InputError
from core.generate import Recipe, pack
from core.material import from_paper, to_paper
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import Change, Place, Retype
from sandbox.session.replay import replay
from sandbox.session.session import Session
from scenes import registry
from scenes.biaxial_periodic import ONSET
from scenes.grains import MATERIAL, PAPER, material, recipe
from tests.cli.test_commands import sandbox
from tests.scenes.test_sizes import BULK, few

PAPERS = {0.01: 1022.1, 0.1: 123.0, 1.0: 42.0, 10.0: 123.0, 100.0: 1022.1}  # C at μ = 0.1


def settings(**given: object) -> dict[str, object]:
    return dict(registry.get("biaxial_periodic").settings(given))


@pytest.mark.parametrize("ratio", PAPERS)
@pytest.mark.parametrize("kind", ["regular", "auxetic"])
def test_the_grains_of_the_paper(ratio: float, kind: str) -> None:
    """Regular grains have the larger of λ and 1/λ, auxetic ones the smaller."""
    nu, stiffness = material(settings(stiffness_ratio=ratio, softness=0.1), kind)  # type: ignore[arg-type]
    assert stiffness == pytest.approx(PAPERS[ratio], rel=1e-6)
    found, softness = to_paper(nu, stiffness)
    assert softness == pytest.approx(0.1)
    larger = max(ratio, 1.0 / ratio)
    assert found == pytest.approx(larger if kind == "regular" else 1.0 / larger)
    assert np.signbit(nu) == (kind == "auxetic")


@given(st.floats(0.0, 0.99), st.floats(0.01, 0.99), st.floats(0.2, 1.0))
def test_softness_alone(regular: float, auxetic: float, softness: float) -> None:
    """Poisson's ratios stay; each kind has the contact stiffness that its own asks for."""
    given_ = settings(
        regular_poisson_ratio=regular, auxetic_poisson_ratio=-auxetic, softness=softness
    )
    made = recipe(given_, "mixed")  # type: ignore[arg-type]
    assert (made.regular_poisson_ratio, made.auxetic_poisson_ratio) == (regular, -auxetic)
    for nu, stiffness in (
        (regular, made.contact_stiffness),
        (-auxetic, made.auxetic_contact_stiffness),
    ):
        assert stiffness is not None
        assert to_paper(nu, stiffness)[1] == pytest.approx(softness)


def test_stiffness_ratio_alone() -> None:
    """The contact stiffness stays."""
    given_ = settings(stiffness_ratio=0.25, contact_stiffness=70.0)
    assert material(given_, "auxetic") == pytest.approx((-0.6, 70.0))  # type: ignore[arg-type]
    assert material(given_, "regular") == pytest.approx((0.6, 70.0))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"stiffness_ratio": 9.0, "regular_poisson_ratio": 0.5}, "stiffness_ratio or Poisson"),
        ({"stiffness_ratio": 9.0, "auxetic_poisson_ratio": -0.5}, "stiffness_ratio or Poisson"),
        ({"softness": 0.1, "contact_stiffness": 60.0}, "softness or contact_stiffness"),
        ({"stiffness_ratio": 0.001}, "between 0.01 and 100"),
        ({"stiffness_ratio": 100.0, "softness": 0.01}, "stiffer than 2000 k"),
        ({"softness": 2.3e-308}, "stiffer than 2000 k"),  # beyond what a number can hold
    ],
)
def test_one_line_where_they_do_not_go_together(wrong: dict[str, object], says: str) -> None:
    for name in BULK:
        with pytest.raises(InputError, match=says):
            registry.get(name).settings(wrong)


def test_all_scenes_that_pack_have_them() -> None:
    for name in BULK:
        own = {p.name: p for p in registry.get(name).parameters}
        assert all(own[p.name] is p for p in (*MATERIAL, *PAPER))
        plain = recipe(registry.get(name).settings(), "mixed")
        assert plain == Recipe(auxetic_contact_stiffness=50.0)


@pytest.mark.parametrize("name", BULK)
def test_packed_and_changed_alike(name: str) -> None:
    """What is packed with λ and μ, and what is given them where it stands, is of one material; set back, it is as before."""
    packed = Session(name, "mixed", 2, few(name, stiffness_ratio=4.0, softness=0.3))
    packed.build()
    changed = Session(name, "mixed", 2, few(name))
    changed.build()
    before = changed.run.setup.packing.copy()
    for by in (Change("softness", 0.3), Change("stiffness_ratio", 4.0)):
        changed.submit(by)
        changed.settle()
    for session in (packed, changed):
        packing = session.run.setup.packing
        for nu, stiffness in zip(packing.poisson_ratio, packing.contact_stiffness, strict=True):
            lam = 4.0 if nu > 0.0 else 0.25
            assert (nu, stiffness) == pytest.approx(
                [float(value) for value in from_paper(lam, 0.3)]
            )
    assert np.array_equal(
        np.signbit(changed.run.setup.packing.poisson_ratio), np.signbit(before.poisson_ratio)
    )
    for by in (Change("softness", 0.0), Change("stiffness_ratio", 0.0)):
        changed.submit(by)
        changed.settle()
    now = changed.run.setup.packing
    assert np.array_equal(now.poisson_ratio, before.poisson_ratio)
    assert np.array_equal(now.contact_stiffness, before.contact_stiffness)


def test_what_is_made_has_the_material_of_its_kind(tmp_path: Path) -> None:
    given_ = few("workshop", grains=6, softness=0.2, auxetic_poisson_ratio=-0.3)
    session = Session("workshop", "regular", 1, given_)
    session.build()
    session.submit(Place(20.0, 3.0, "auxetic"))
    session.settle()
    session.submit(Retype(15.0, 10.0, 9.0, "auxetic"))
    session.settle()
    write_scene(tmp_path / "it.toml", session.made())
    other = read_scene(tmp_path / "it.toml").of_kind("mixed").grains
    for packing in (session.run.setup.packing, other):
        assert len(set(packing.contact_stiffness)) == 2
        softness = to_paper(packing.poisson_ratio, packing.contact_stiffness)[1]
        assert softness == pytest.approx(np.full(len(packing), 0.2))
    assert list(replay(session.log()))[-1].state_hash() == session.state_hash()


def test_a_refused_change_changes_nothing() -> None:
    session = Session("workshop", "mixed", 1, few("workshop", softness=0.3))
    session.build()
    start = session.state_hash()
    session.submit(Change("contact_stiffness", 80.0))
    session.settle()
    assert "softness or contact_stiffness" in session.frame().notices[0]
    assert session.state_hash() == start


@pytest.mark.end_to_end
def test_on_the_command_line(tmp_path: Path) -> None:
    words = ("record", "biaxial_press", "--steps", "2", "--data", "it.csv", "--packing", "auxetic")
    both = ("--set", "stiffness_ratio=0.01", "--set", "softness=0.1")
    done = sandbox(tmp_path, *words, *both, "--set", "grains=20")
    assert done.returncode == 0, done.stderr
    wrong = sandbox(tmp_path, *words, *both, "--set", "contact_stiffness=60")
    assert wrong.returncode == 2
    assert wrong.stderr.count("\n") == 1
    assert "softness or contact_stiffness" in wrong.stderr


@pytest.mark.parametrize("softness", [0.0, 0.1])
def test_the_strain_begins_at_one_pressure(softness: float) -> None:
    """Whatever C."""
    given_ = settings(grains=60, softness=softness, stiffness_ratio=10.0 if softness else 0.0)
    setup = registry.get("biaxial_periodic").build(given_, "auxetic", 1)  # type: ignore[arg-type]
    assert setup.packing.box is not None
    contacts = observables.grain_contacts(setup.packing)
    pressure = observables.pressure(observables.stress(contacts, setup.packing.box.area))
    assert pressure == pytest.approx(ONSET, rel=0.011)


@pytest.mark.parametrize("stiffness", [50.0, 1022.1])
@pytest.mark.parametrize("kind", ["regular", "auxetic"])
def test_that_pressure_is_near_the_onset(kind: str, stiffness: float) -> None:
    """To first order the strain from the onset is that from half to all of a pressure: of 5e-4 k less than 0.5 %, at any C.

    At 1e-5 C, from where the strain was counted once, it would be 5 % for auxetic grains at C = 1022.
    """
    made = Recipe(kind=kind, contact_stiffness=stiffness)
    areas = []
    for pressure in (0.5 * ONSET, ONSET):
        packing = pack(made, seed=11, count=60, packing_fraction=0.84, target_pressure=pressure)
        assert packing.box is not None
        areas.append(packing.box.area)
    assert 0.0 < 2.0 * (1.0 - areas[1] / areas[0]) < 0.005
