"""Kernels are compiled in parts: every scene finds all of its own in them, and no part is compiled twice."""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from core import kernel_cache, warmup
from sandbox.preparation import parts
from scenes import registry

REPOSITORY = Path(__file__).parents[2]
TERMS = ("periodic", "rigid", "friction", "gravity")


def run(*words: str, cache: Path | None = None) -> subprocess.CompletedProcess[str]:
    """This Python in a process of its own, with a folder for compiled kernels instead of the usual one."""
    other = {} if cache is None else {"NUMBA_CACHE_DIR": str(cache)}
    return subprocess.run(
        [sys.executable, *words],
        cwd=REPOSITORY,
        env={**os.environ, **other},
        capture_output=True,
        text=True,
        timeout=600,
    )


@pytest.mark.parametrize("there", list(itertools.product((False, True), repeat=4)))
def test_a_name_says_what_is_compiled(
    there: tuple[bool, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[dict[str, Any]] = []
    monkeypatch.setattr(warmup, "compile_packing", lambda **terms: asked.append(terms))
    monkeypatch.setattr(warmup, "compile_increments", lambda **terms: asked.append(terms))
    terms = dict(zip(TERMS, there, strict=True))
    bounds = {name: terms[name] for name in TERMS[:2]}
    warmup.compile_part(warmup.increments_part(**terms))
    warmup.compile_part(warmup.packing_part(**bounds))
    assert asked == [terms, bounds]


# Every scene as it is and with friction, as it is built, solved and drawn; says which kernels were compiled on the way, or loaded
# from where they had been kept.
WATCHED = """
import gc, json, sys
from itertools import islice
from numba.core.registry import CPUDispatcher
from sandbox.environment import prepare_headless
prepare_headless()
from core import warmup
from sandbox.draw.render import Renderer
from sandbox.preparation import parts
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes import registry

parts.carry_out(parts.of_scenes(registry.names()))
kernels = [k for k in gc.get_objects() if isinstance(k, CPUDispatcher)]
ready = {k: set(k.overloads) for k in kernels}
late = set()
FEW = {"avalanches": 60, "couette": 160, "gravity_hopper": 100, "hopper": 100, "intruder": 100}
for name in registry.names():
    scene = registry.get(name)
    known = {p.name for p in scene.parameters}
    few = {"grains": FEW[name]} if name in FEW else {}
    few |= {"intruder_radius": 2.0} if name == "intruder" else {}
    for more in ({}, {"friction": 0.5} if "friction" in known else None):
        if more is None:
            continue
        session = Session(name, scene.packings[-1], 1, {**few, **more})
        session.build()
        session.submit(Protocol(True))
        list(islice(session.increments(400, lambda *_: None), 2))
        for view in ("kind", "pressure"):
            Renderer((640, 360), view=view).draw(session.frame())
        for kernel in kernels:
            if set(kernel.overloads) - ready[kernel]:
                ready[kernel] = set(kernel.overloads)
                late.add(f"{kernel.py_func.__module__}.{kernel.py_func.__qualname__}: {name}, {more}")
print(json.dumps(sorted(late)))
"""


@pytest.mark.slow
def test_after_all_parts_no_scene_compiles_anything() -> None:
    done = run("-c", WATCHED)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == []


@pytest.mark.slow
def test_what_is_compiled_once_is_there_for_good(tmp_path: Path) -> None:
    """The command, with a folder of its own: the second time there is nothing to do, and one time it says so."""
    first = run("-m", "sandbox", "prepare", "two_ellipses", cache=tmp_path)
    assert first.returncode == 0, first.stderr
    wanted = parts.of_scenes(["two_ellipses"])
    said = [line.split()[-1] for line in first.stdout.splitlines()[:-1]]
    assert said == wanted
    assert first.stdout.splitlines()[-1].startswith(f"compiled {len(wanted)} parts")
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")}
    second = run("-m", "sandbox", "prepare", "two_ellipses", cache=tmp_path)
    assert second.stdout == "everything is there\n"
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")} == kept


def test_where_nothing_can_be_kept_nothing_is_compiled_ahead(tmp_path: Path) -> None:
    """A file where the folder should be: not even root can write there. One line, before any work."""
    (tmp_path / "file").touch()
    done = run("-m", "sandbox", "prepare", cache=tmp_path / "file" / "kernels")
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert str(tmp_path / "file" / "kernels") in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ("list",),
        ("lesson",),
        ("lesson", "poisson", "--out", "{}"),
        ("record", "hopper", "--out", "nowhere/film.mp4"),
        ("--help",),
    ],
    ids=" ".join,
)
def test_what_compiles_nothing_leaves_the_place_of_compiled_code_alone(
    words: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    words = tuple(word.format(tmp_path / "pages") for word in words)
    for cache in (tmp_path / "file" / "kernels", tmp_path / "fresh"):
        done = run("-m", "sandbox", *words, cache=cache)
        assert str(cache) not in done.stderr
    assert not (tmp_path / "fresh").exists()


def test_an_unknown_scene_is_a_mistake() -> None:
    done = run("-m", "sandbox", "prepare", "hoper")
    assert done.returncode == 2
    assert "hopper" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_where_nothing_can_be_kept_no_process_is_started(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from sandbox import beside

    monkeypatch.setattr(kernel_cache, "usable", lambda where: False)
    assert beside.start(["increments-rigid"], 0) is None
    assert beside.start([], 0) is None


def test_every_scene_has_its_parts() -> None:
    """None is left out of the list of all."""
    every = parts.of_scenes(registry.names())
    assert every[0] == "drawing"
    assert len(every) == len(set(every))
    for name in registry.names():
        assert set(parts.of_scene(registry.get(name))) <= set(every)


def test_what_compiles_beside_ends_with_the_process_that_started_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However that ends: with it its end of the pipe is closed."""
    from sandbox import beside

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    process = beside.start(["increments-periodic-rigid-friction"], 0)
    assert process is not None
    assert process.stdin is not None
    process.stdin.close()
    assert process.wait(60.0) == 1


@pytest.mark.parametrize("own", [False, True])
def test_what_others_hold_in_a_process_of_theirs_can_be_freed(own: bool) -> None:
    """The collector leaves alone what is there after the first start, but only where nobody else works."""
    program = f"""
import gc, weakref
class Circle: pass
circle = Circle()
circle.own = circle
gone = weakref.ref(circle)
from core import warmup
from core.own_process import OWN
OWN.set() if {own} else None
warmup.compile_packing(periodic=False, rigid=False)
warmup.compile_packing(periodic=False, rigid=True)
kept = gc.get_freeze_count()
del circle
gc.collect()
print(kept > 0, gone() is None)
"""
    assert run("-c", program).stdout.split() == [str(own), str(not own)]
