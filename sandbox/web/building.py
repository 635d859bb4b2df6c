"""Which scenes there are as pages, with packings of how many seeds; and the folder, or the single file, that they make."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from core.errors import InputError
from sandbox.ensemble.batch import Batch, Workers, carry_out_all
from sandbox.environment import cores
from sandbox.files.folder import write_text
from sandbox.web.laid_out import Blocks, laid_out
from sandbox.web.menu import FILE, menu, way_back
from sandbox.web.packed import to_grid
from sandbox.web.pages import SHARE, SHARED_PACKING, SHARES, Built, page
from sandbox.web.toolchain import kernels, scripts
from sandbox.words import language
from scenes import registry
from scenes.parameter import Value
from scenes.scene import Setup, Values

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
ALIKE = ("single_grain",)  # nothing in it is random
SINGLE = 400_000  # bytes of one page at most
JOBS = min(cores(), 8)  # processes that pack

Asked = tuple[str, int]  # a scene and a seed


def scene_named(name: str) -> str:
    """``name`` if there is a page of it. Raises InputError otherwise."""
    if registry.get(name).name not in SCENES:
        raise InputError(f"there is no page of {name}: choose {', '.join(SCENES)}")
    return name


def is_periodic(name: str) -> bool:
    """True if the cell of the scene goes round on its page."""
    return registry.get(name).ingredients(_settings(name)).periodic


def build(name: str, seeds: Sequence[int], workers: Workers) -> Built:
    """Pack all grains of a scene, seed by seed. One that cannot be packed is left out, and named.

    Raises InputError if none can be.
    """
    found: dict[int, tuple[Blocks, ...]] = {}
    batch = Batch(
        packings_of,
        [(name, seed) for seed in seeds],
        lambda asked, blocks: found.update({asked[1]: blocks}),
        lambda asked, reason: f"{name} is without seed {asked[1]}: {reason}",
        prepare=partial(packings_of, (name, seeds[0])),
        label=lambda _: f"packing {name}",
        unit="seed",
    )
    carry_out_all(batch, workers, JOBS)
    if not found:
        raise InputError(f"no packing of {name} can be made")
    there = tuple(sorted(found))
    scene, settings = registry.get(name), _settings(name)
    kinds = tuple(kind for kind in ORDER if kind in scene.packings)
    blocks = tuple(found[seed] for seed in there)
    return Built(scene, settings, kinds, there, _shares(settings), _setups(name, there[0]), blocks)


def packings_of(asked: Asked) -> tuple[Blocks, ...]:
    """All packings of a scene and a seed, on the grid, laid out. In the process of a worker."""
    setups = _setups(*asked)
    scene, settings = registry.get(asked[0]), _settings(asked[0])
    kinds = [kind for kind, _ in _asked_for(asked[0])]
    return tuple(
        laid_out(scene, setup, settings, kind) for setup, kind in zip(setups, kinds, strict=True)
    )


def _settings(name: str) -> Values:
    return registry.get(name).settings(dict(SCENES[name]))


def _shares(settings: Values) -> tuple[float, ...]:
    return tuple(share for share in SHARES if settings.get(SHARE, share) != share)


def _asked_for(name: str) -> list[tuple[str, Values]]:
    """Kind and settings of each packing of a seed: those of the scene, and mixed ones with other shares of auxetic grains."""
    scene, settings = registry.get(name), _settings(name)
    kinds = [(kind, settings) for kind in ORDER if kind in scene.packings]
    return kinds + [(SHARED_PACKING, {**settings, SHARE: share}) for share in _shares(settings)]


def _setups(name: str, seed: int) -> tuple[Setup, ...]:
    scene = registry.get(name)
    setups = tuple(scene.build(settings, kind, seed) for kind, settings in _asked_for(name))
    for setup in setups:
        to_grid(setup.packing)
    return setups


def write(
    folder: Path,
    names: Sequence[str],
    workers: Workers,
    tell: Callable[[str], None],
    *,
    seeds: int,
    single: bool = False,
) -> list[Path]:
    """A page for each scene into the folder, and a menu unless it is a ``single`` one; what was written.

    A page has packings of so many ``seeds``, a single one of as many as it has room for. ``tell`` is told what takes long.
    Raises InputError where a page cannot be.
    """
    tell("compiling the kernels")
    programs = {periodic: kernels(periodic=periodic) for periodic in set(map(is_periodic, names))}
    bundled = scripts()
    back = "" if single else way_back(language.present())
    written = []
    for name in names:
        built = build(name, range(1, 2 if name in ALIKE else seeds + 1), workers)

        def made(count: int, built: Built = built) -> str:
            return page(
                built.of_first(count), programs[is_periodic(built.scene.name)], bundled, back
            )

        count = _most_with_room(made, len(built.seeds)) if single else len(built.seeds)
        written.append(_write(folder / f"{name}.html", made(count)))
    if not single:
        written.append(_write(folder / FILE, menu(names)))
    return written


def _most_with_room(made: Callable[[int], str], most: int) -> int:
    """How many seeds a single page may have, at least one."""
    counts = range(1, most + 1)
    return max(bisect_right(counts, SINGLE, key=lambda count: len(made(count).encode())), 1)


def _write(path: Path, text: str) -> Path:
    write_text(path, text)
    return path
