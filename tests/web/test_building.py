"""Pages as they are written: what is refused, how large they are, what is on them."""

from __future__ import annotations

import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from sandbox.lessons import tours
from sandbox.web import building
from sandbox.web.laid_out import Blocks, laid_out, packing_in
from sandbox.web.menu import menu
from sandbox.web.packed import GRID, packed
from sandbox.web.pages import SLIDES, STEPS, sliders
from scenes import registry
from tests.web.pages import PAGE, written

pytestmark = pytest.mark.slow


def test_what_a_page_cannot_run_is_refused() -> None:
    scene = registry.get("biaxial_periodic")
    settings = scene.settings({"grains": 100})
    setup = scene.build(settings, "mixed", 1)
    with pytest.raises(InputError, match="a page runs scenes whose cell is open"):
        laid_out(scene, replace(setup, curve=None), settings, "mixed")
    with pytest.raises(InputError, match="there is no page of avalanches: choose hopper, "):
        building.scene_named("avalanches")


def test_the_menu_has_pictures_for_both_themes() -> None:
    text = menu(list(building.SCENES))
    for theme in ("dark", "light"):
        assert text.count(f'class="for-{theme}"') == len(building.SCENES)
    assert not re.search(r'src="(?!data:)', text)
    assert len(text) < building.SINGLE


def test_every_slider_begins_where_the_scene_does() -> None:
    for name, changed in building.SCENES.items():
        scene = registry.get(name)
        settings = scene.settings(dict(changed))
        for slide in sliders(scene, settings):
            value = min(float(settings[slide["name"]]), slide["most"])
            assert slide["least"] <= slide["value"] == value, f"{name}: {slide['name']}"


def test_a_tour_on_a_page_asks_for_nothing_that_cannot_be_done_there() -> None:
    on_a_page = {slide.name for slide in SLIDES}
    for name, settings in building.SCENES.items():
        for k in STEPS.get(name, range(len(tours.steps(name)))):
            asked = {
                key: value
                for key, value in tours.steps(name)[k].settings.items()
                if key not in on_a_page and value != settings.get(key)
            }
            first = k == 0  # which says how the scene is set up on the desk
            assert not asked or first, f"{name}, step {k}: {asked}"


def test_the_page_computes_no_forces() -> None:
    force = r"(?:force|bearing|resisting|reactions?|hand_[xy]|push|residual|pressure|stress)"
    arithmetic = re.compile(
        rf'\b{force}\b["\])]*\s*(?:[-+*/]|\*\*)\s*\w|\w\s*[-+*/]\s*(?:\w+\.)*{force}\b',
        re.IGNORECASE,
    )
    sources = sorted((PAGE / "src").glob("*.ts"))
    assert len(sources) > 4
    for path in sources:
        code = re.sub(
            r"//.*|/\*[\s\S]*?\*/|`[^`]*`|\"[^\"]*\"", '""', path.read_text(encoding="utf-8")
        )
        found = [line for line in code.splitlines() if arithmetic.search(line)]
        assert not found, f"{path.name}: {found}"


@pytest.mark.parametrize("name", building.SCENES)
def test_a_single_page_is_small(
    program: Path, periodic_program: Path, tmp_path: Path, name: str
) -> None:
    (path,) = written(tmp_path, [name], seeds=1, single=True)
    assert path.stat().st_size <= building.SINGLE


def test_a_single_page_has_as_many_seeds_as_it_has_room_for(
    program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def size(seeds: int) -> int:
        (path,) = written(tmp_path, ["grain_row"], seeds=seeds, single=True)
        return path.stat().st_size

    one, eight = size(1), size(8)
    assert one < eight <= building.SINGLE
    monkeypatch.setattr(building, "SINGLE", eight - 1)
    assert one < size(8) < eight
    assert size(40) == size(7)
    monkeypatch.setattr(building, "SINGLE", 0)
    assert size(8) == one


def test_a_seed_that_cannot_be_packed_is_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    packings_of = building.packings_of

    def fails(asked: building.Asked) -> tuple[Blocks, ...]:
        if asked[1] != 2:
            raise InputError("there is no room")
        return packings_of(asked)

    monkeypatch.setattr(building, "packings_of", fails)
    with ThreadPoolExecutor(1) as one:
        built = building.build("grain_row", (1, 2), one)
        assert built.seeds == (2,)
        assert "grain_row is without seed 1: there is no room" in capsys.readouterr().err
        with pytest.raises(InputError, match="no packing of grain_row can be made"):
            building.build("grain_row", (1, 3), one)


def test_packings_of_pages_are_those_of_the_desk_to_half_a_millionth_of_a_radius() -> None:
    scene = registry.get("couette")
    packing = scene.build(scene.settings(dict(building.SCENES["couette"])), "auxetic", 3).packing
    _, _, auxetic, *_ = building.packings_of(("couette", 3))
    moved = np.abs(packing_in(auxetic).state - packing.state)
    assert 0.0 < moved.max() <= 0.5 / GRID <= 0.5e-6
    with pytest.raises(ValueError, match="not on the grid"):
        packed(
            [
                [
                    laid_out(
                        scene,
                        scene.build(scene.settings({}), "auxetic", 3),
                        scene.settings({}),
                        "auxetic",
                    )
                ]
            ]
        )
