"""Which scenes there are as pages, with packings of which seeds; and the folder, or the single file, that they make."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from core.errors import InputError
from sandbox.files.folder import write_text
from sandbox.web.menu import FILE, menu, way_back
from sandbox.web.pages import SHARE, SHARED_PACKING, SHARES, Built, page
from sandbox.web.toolchain import kernels, scripts
from sandbox.words import language
from scenes import registry
from scenes.parameter import Value

# What a page is about, and what of it is set otherwise than on the desk: as many grains as a small computer can keep moving.
SCENES: dict[str, Mapping[str, Value]] = {
    "hopper": {"grains": 160, "width": 18.0},
    "biaxial_press": {"grains": 160},
    "gravity_hopper": {"grains": 160, "width": 18.0},
    "intruder": {"grains": 250, "intruder_radius": 4.0},
    "grain_row": {},
    "single_grain": {},
    "couette": {"grains": 160},
}
ORDER = ("regular", "mixed", "auxetic")
SEEDS = (1, 2, 3)
ALIKE = ("single_grain",)  # nothing in it is random
SINGLE = 400_000  # bytes of one page at most

Tell = Callable[[str, float], None]


def scene_named(name: str) -> str:
    """``name`` if there is a page of it. Raises InputError otherwise."""
    if registry.get(name).name not in SCENES:
        raise InputError(f"there is no page of {name}: choose {', '.join(SCENES)}")
    return name


def is_periodic(name: str) -> bool:
    """True if the cell of the scene goes round on its page."""
    scene = registry.get(name)
    return scene.ingredients(scene.settings(dict(SCENES[name]))).periodic


def build(name: str, seeds: Sequence[int], tell: Tell = lambda _text, _share: None) -> Built:
    """Pack all grains of a scene. ``tell`` is told what is being done, and the share of it that is done."""
    scene = registry.get(name)
    settings = scene.settings(dict(SCENES[name]))
    kinds = tuple(kind for kind in ORDER if kind in scene.packings)
    shares = tuple(share for share in SHARES if settings.get(SHARE, share) != share)
    setups = []
    for done, seed in enumerate(seeds):
        tell(f"packing {name}", done / len(seeds))
        asked = [(settings, kind) for kind in kinds]
        asked += [({**settings, SHARE: share}, SHARED_PACKING) for share in shares]
        setups.append(tuple(scene.build(values, kind, seed) for values, kind in asked))
    return Built(scene, settings, kinds, tuple(seeds), shares, tuple(setups))


def write(folder: Path, names: Sequence[str], tell: Tell, *, single: bool = False) -> list[Path]:
    """A page for each scene into the folder, and a menu unless it is a ``single`` one; what was written.

    Raises InputError where one cannot be.
    """
    tell("compiling the kernels", 0.0)
    programs = {periodic: kernels(periodic=periodic) for periodic in set(map(is_periodic, names))}
    bundled = scripts()
    shown = language.present()
    written = []
    for name in names:
        built = build(name, SEEDS[:1] if name in ALIKE else SEEDS[:2] if single else SEEDS, tell)
        text = page(built, programs[is_periodic(name)], bundled, "" if single else way_back(shown))
        written.append(_write(folder / f"{name}.html", text))
    if not single:
        written.append(_write(folder / FILE, menu(names)))
    return written


def _write(path: Path, text: str) -> Path:
    write_text(path, text)
    return path
