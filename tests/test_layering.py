"""Who may import whom: sandbox -> scenes -> core, and the physics knows no window."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[1]
LAYERS = ("core", "scenes", "sandbox")
# What a layer may import of the layers.
ALLOWED = {"core": {"core"}, "scenes": {"core", "scenes"}, "sandbox": set(LAYERS)}
OUT_OF_CORE = {"pygame", "imageio", "imageio_ffmpeg", "matplotlib", "tqdm", "PIL"}
MODULES = [path for layer in LAYERS for path in sorted((REPOSITORY / layer).rglob("*.py"))]


def imports(path: Path) -> Iterator[tuple[int, str]]:
    """Every imported module in a file, wherever the import stands: (line, dotted name)."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: relative import"
            yield node.lineno, node.module or ""


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_imports_run_one_way(path: Path) -> None:
    layer = path.relative_to(REPOSITORY).parts[0]
    for line, name in imports(path):
        package = name.partition(".")[0]
        where = f"{path}:{line} imports {name}"
        assert package not in set(LAYERS) - ALLOWED[layer], where
        assert package != "tests", where
        if layer != "sandbox":
            assert package not in OUT_OF_CORE, where
        if package == "pymunk":
            assert path == REPOSITORY / "core" / "spaces.py", where


def test_all_packages_were_looked_at() -> None:
    assert {path.relative_to(REPOSITORY).parts[0] for path in MODULES} == set(LAYERS)


def name_of(path: Path) -> str:
    """Dotted name of the module in a file."""
    return ".".join(path.relative_to(REPOSITORY).with_suffix("").parts).removesuffix(".__init__")


NAMES = {name_of(path) for path in MODULES}


def own_imports(path: Path) -> dict[str, int]:
    """The project's modules that a file imports anywhere, late ones and those for types alone too, with a line of each."""
    found: dict[str, int] = {}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name if name in NAMES else str(node.module) for name in whole]
        else:
            continue
        found.update({name: node.lineno for name in names if name in NAMES})
    return found


IMPORTS = {name_of(path): own_imports(path) for path in MODULES}


def circle_through(start: str) -> list[str]:
    """The shortest way of imports from a module back to itself, or nothing."""
    ways = [[start]]
    seen: set[str] = set()
    for way in ways:
        for name in IMPORTS[way[-1]]:
            if name == start:
                return [*way, start]
            if name not in seen:
                seen.add(name)
                ways.append([*way, name])
    return []


# Each room, and those below it that it may import. A room within another is told from it where it may import less.
STUDY = "studies.common ensemble files session draw scenes core"
ROOMS = {
    "cli": "window sweep studies.accuracy studies.stability studies.paper studies.bench studies.hand studies.classics "
    "preparation studies.clogging studies.common ensemble site web record player files lessons session words scenes core",
    "window": "preparation window.solvers sweep ensemble record player files draw lessons session words scenes core",
    "sweep": "ensemble files record draw session scenes core",
    "window.solvers": "files session words scenes core",
    "preparation": "draw scenes core",
    "notebook": "player draw session scenes core",
    "record": "files player draw session scenes core",
    "web": "web.increment web.wasm ensemble player files draw lessons words scenes core",
    "web.wasm": "web.increment core",
    "web.increment": "scenes core",
    "site": "record files player session words scenes core",
    "player": "draw draw.raster session words scenes core",
    "studies.accuracy": STUDY,
    "studies.stability": STUDY,
    "studies.paper": f"studies.hand {STUDY}",
    "studies.classics": STUDY,
    "studies.clogging": f"sweep studies.classics {STUDY}",
    "studies.bench": f"sweep {STUDY}",
    "studies.hand": f"lessons {STUDY}",
    "studies.common": "ensemble files core",
    "ensemble": "core",
    "lessons": "files words session scenes core",
    "files": "session scenes core",
    "draw": "draw.raster session words scenes core",
    "draw.raster": "core",
    "session": "scenes core",
    "words": "scenes core",
}
HALL = {
    "sandbox",
    "sandbox.bars",
    "sandbox.beside",
    "sandbox.environment",
    "sandbox.extras",
    "sandbox.interrupts",
}  # in no room: for all in sandbox


def room_of(name: str) -> str:
    """The innermost room that a module is in; the first part of its name if it is in none."""
    inside = name.removeprefix("sandbox.")
    rooms = [room for room in ROOMS if f"{inside}.".startswith(f"{room}.")]
    return max(rooms, key=len, default=name.partition(".")[0])


@pytest.mark.parametrize("name", sorted(name for name in NAMES if name.startswith("sandbox.")))
def test_imports_run_downhill(name: str) -> None:
    own = room_of(name)
    if own == "sandbox":  # no room, and none is needed
        allowed = {"core", "cli"} if name == "sandbox.__main__" else {"core"}
    else:
        allowed = {own, *ROOMS[own].split()}
    for other, line in IMPORTS[name].items():
        assert other in HALL or room_of(other) in allowed, f"{name}:{line} imports {other}"


@pytest.mark.parametrize("name", sorted(NAMES))
def test_no_circle_of_imports(name: str) -> None:
    way = circle_through(name)
    assert not way, " imports ".join(way)


def loaded_after(code: str) -> set[str]:
    """Top-level packages that a fresh Python holds after ``code``."""
    done = subprocess.run(
        [sys.executable, "-c", f"import json, sys\n{code}\nprint(json.dumps(list(sys.modules)))"],
        cwd=REPOSITORY,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    return {name.partition(".")[0] for name in json.loads(done.stdout.splitlines()[-1])}


@pytest.mark.parametrize("layer", ["core", "scenes"])
def test_physics_loads_no_window_and_no_video(layer: str) -> None:
    modules = [
        ".".join(path.relative_to(REPOSITORY).with_suffix("").parts).removesuffix(".__init__")
        for path in MODULES
        if path.relative_to(REPOSITORY).parts[0] == layer
    ]
    loaded = loaded_after("\n".join(f"import {module}" for module in modules))
    assert not loaded & OUT_OF_CORE
    assert "sandbox" not in loaded


def test_command_line_starts_light() -> None:
    heavy = {
        "numba",
        "numpy",
        "pygame",
        "pymunk",
        "imageio",
        "imageio_ffmpeg",
        "matplotlib",
        "tqdm",
    }
    assert not loaded_after("import sandbox.cli.main") & heavy
