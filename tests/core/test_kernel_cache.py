"""The folders of compiled kernels: one for each state of their sources, and none for ever."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from core import kernel_cache

REPOSITORY = Path(__file__).parents[2]
MONTHS = 100 * 86_400.0  # [s]


def test_other_sources_get_another_hash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The hash follows every source file of every folder, their names, and the compiler's version."""
    core, other = tmp_path / "core", tmp_path / "other"
    for folder in (core, other):
        folder.mkdir()
        (folder / "kernels.py").write_text("a = 1")

    def both() -> str:
        return kernel_cache.source_hash(core, other)

    hashes = {both(), kernel_cache.source_hash(core)}
    assert both() in hashes
    (core / "kernels.py").write_text("a = 2")
    hashes.add(both())
    (other / "kernels.py").write_text("a = 3")
    hashes.add(both())
    (other / "kernels.py").rename(other / "kernel.py")
    hashes.add(both())
    (other / "more.py").write_text("")
    hashes.add(both())
    monkeypatch.setattr("numba.__version__", "0.0")
    hashes.add(both())
    assert len(hashes) == 7


def test_each_package_has_a_place_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels of core go by the sources of core alone, those of another package by its own too."""
    core, raster = kernel_cache.CORE, REPOSITORY / "sandbox" / "draw" / "raster"
    assert kernel_cache.place(core) != kernel_cache.place(raster)
    asked: list[tuple[Path, ...]] = []

    def record(*folders: Path) -> str:
        asked.append(folders)
        return "0"

    monkeypatch.setattr(kernel_cache, "source_hash", record)
    for folder in (core, raster):
        kernel_cache.place.__wrapped__(folder)
    assert asked == [(core,), (core, raster)]


def test_kernels_are_kept_where_they_belong(tmp_path: Path) -> None:
    """A fresh process: Numba's folder is another for core than for drawing, and is put back afterwards."""
    program = (
        "import numba\n"
        "before = numba.config.CACHE_DIR\n"
        "from core.sweeps import kick\n"
        "from sandbox.draw.raster import draw_ring\n"
        "assert numba.config.CACHE_DIR == before\n"
        "print(kick._cache.cache_path, draw_ring._cache.cache_path, sep=chr(10))\n"
    )

    def places(**variables: str) -> list[str]:
        environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
        done = subprocess.run(
            [sys.executable, "-c", program],
            cwd=REPOSITORY,
            env={**environment, **variables},
            capture_output=True,
            text=True,
            check=True,
            timeout=300,
        )
        return done.stdout.split()

    core, raster = places()
    assert str(kernel_cache.place(kernel_cache.CORE)) in core
    assert str(kernel_cache.place(REPOSITORY / "sandbox" / "draw" / "raster")) in raster
    assert all(str(tmp_path) in path for path in places(NUMBA_CACHE_DIR=str(tmp_path)))


def folder(caches: Path, name: str, age: float) -> Path:
    """A folder with a kernel in it, used ``age`` [s] ago."""
    made = caches / name / "core"
    made.mkdir(parents=True)
    (made / "kernel.nbc").write_bytes(b"code")
    used = time.time() - age
    os.utime(made.parent, (used, used))
    return made.parent


def test_old_folders_go_and_others_stay(tmp_path: Path) -> None:
    old = folder(tmp_path, "kernels-1", MONTHS)
    half_removed = folder(tmp_path, "kernels-2.4711", MONTHS)  # by a process that was stopped
    fresh = folder(tmp_path, "kernels-3", 86_400.0)
    foreign = folder(tmp_path, "scenes", MONTHS)
    kernel_cache.prune(tmp_path)
    assert not old.exists()
    assert not half_removed.exists()
    assert (fresh / "core" / "kernel.nbc").exists()
    assert (foreign / "core" / "kernel.nbc").exists()
    assert len(list(tmp_path.iterdir())) == 2
    kernel_cache.prune(tmp_path / "nowhere")


def test_use_keeps_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_cache, "user_cache_path", lambda name: tmp_path)
    name = kernel_cache.PREFIX + kernel_cache.source_hash(kernel_cache.CORE)
    old = folder(tmp_path, name, MONTHS)
    assert kernel_cache.place.__wrapped__(kernel_cache.CORE) == old
    kernel_cache.prune()
    assert old.exists()


def test_two_processes_prune_at_once(tmp_path: Path) -> None:
    """None of them fails, and nothing old is left."""
    for k in range(60):
        folder(tmp_path, f"kernels-{k}", MONTHS if k % 3 else 0.0)
    program = "import sys, pathlib; from core.kernel_cache import prune; sys.stdin.readline(); prune(pathlib.Path(sys.argv[1]))"
    both = [
        subprocess.Popen(
            [sys.executable, "-c", program, str(tmp_path)],
            cwd=REPOSITORY,
            stdin=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    for process in both:
        assert process.stdin is not None
        process.stdin.write("now\n")
        process.stdin.flush()
    for process in both:
        process.communicate(timeout=120)
    assert [process.returncode for process in both] == [0, 0]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        f"kernels-{k}" for k in range(0, 60, 3)
    )


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege there")
def test_what_cannot_be_removed_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = folder(tmp_path, "kernels-1", MONTHS)
    link = tmp_path / "kernels-2"
    link.symlink_to(old)

    def refuse(self: Path, target: Path) -> Path:
        raise PermissionError(13, "no", str(target))

    monkeypatch.setattr(Path, "rename", refuse)
    kernel_cache.prune(tmp_path)
    assert old.exists()
    assert link.is_symlink()


KERNEL = """
import numpy as np
from core.jit import kernel

@kernel
def double(x):
    return 2.0 * x

print(double(21.0))
"""


def run_kernel(tmp_path: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """A fresh process that compiles one kernel, or takes it from where it is kept."""
    (tmp_path / "one.py").write_text(KERNEL)
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    return subprocess.run(
        [sys.executable, str(tmp_path / "one.py")],
        env={**environment, "PYTHONPATH": str(REPOSITORY), **variables},
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_where_nothing_can_be_kept_kernels_run_all_the_same(tmp_path: Path) -> None:
    """A file where the folder should be: not even root can write there. It is said in one line, once."""
    (tmp_path / "cache").write_text("a file")
    for variables in (
        {"XDG_CACHE_HOME": str(tmp_path / "cache")},
        {"NUMBA_CACHE_DIR": str(tmp_path / "cache" / "numba")},
    ):
        done = run_kernel(tmp_path, **variables)
        assert done.returncode == 0, done.stderr
        assert done.stdout == "42.0\n"
        assert len(done.stderr.splitlines()) == 1, done.stderr
        assert "every start compiles it anew" in done.stderr
    assert not list(tmp_path.rglob("*.nbi"))  # nor beside the source


def test_it_is_said_once_for_all_folders_of_sources(tmp_path: Path) -> None:
    """Physics and drawing are kept side by side: what stands in the way of one does so for the other."""
    (tmp_path / "cache").write_text("a file")
    program = (
        "from core import kernel_cache as k\n"
        "from sandbox.draw import raster\n"
        "import pathlib\n"
        "folders = k.CORE, pathlib.Path(raster.__file__).parent\n"
        "print([k.usable(k.place(folder)) for folder in folders])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=REPOSITORY,
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache" / "numba")},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.stdout == "[False, False]\n"
    assert len(done.stderr.splitlines()) == 1, done.stderr


MOVED = b"cno_such_module\nThing\n."  # the pickle of a class that is gone
DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda whole: b"",
    "half": lambda whole: whole[: len(whole) // 2],
    "moved": lambda whole: MOVED,
}


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the kernel has been compiled and kept."""
    folder = tmp_path_factory.mktemp("compiled")
    assert run_kernel(folder, NUMBA_CACHE_DIR=str(folder / "kept")).stdout == "42.0\n"
    return folder


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES.keys())
def test_what_cannot_be_read_is_missing(
    compiled: Path, suffix: str, damage: Callable[[bytes], bytes]
) -> None:
    """It is compiled anew, and kept again."""
    (path,) = (compiled / "kept").rglob(f"*{suffix}")
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    done = run_kernel(compiled, NUMBA_CACHE_DIR=str(compiled / "kept"))
    assert (done.returncode, done.stdout, done.stderr) == (0, "42.0\n", "")
    assert len(path.read_bytes()) > 0.9 * len(whole)


def test_what_can_neither_be_read_nor_written_is_left_alone(compiled: Path) -> None:
    """Where the kernel is kept there are folders of that name."""
    for path in (compiled / "kept").rglob("*.nb?"):
        path.unlink()
        path.mkdir()
    done = run_kernel(compiled, NUMBA_CACHE_DIR=str(compiled / "kept"))
    assert (done.returncode, done.stdout, done.stderr) == (0, "42.0\n", "")


AT_ONCE = """
import sys, time
import numpy as np
from numba.core.caching import IndexDataCacheFile
from core.jit import kernel

load = IndexDataCacheFile._load_index

def slowly(self):  # between reading the index and writing it
    found = load(self)
    time.sleep(0.5)
    return found

IndexDataCacheFile._load_index = slowly

@kernel
def double(x):
    return x + x

kind = getattr(np, sys.argv[1])
print(double(kind(21)), sum(double.stats.cache_hits.values()))
"""


def test_two_processes_keep_two_sorts_of_one_kernel(tmp_path: Path) -> None:
    """Each in a file of its own: with Numba alone both would take the first free name, and one would be lost."""
    (tmp_path / "both.py").write_text(AT_ONCE)
    environment = {
        **os.environ,
        "PYTHONPATH": str(REPOSITORY),
        "NUMBA_CACHE_DIR": str(tmp_path / "kept"),
    }

    def both() -> list[str]:
        started = [
            subprocess.Popen(
                [sys.executable, str(tmp_path / "both.py"), kind],
                env=environment,
                stdout=subprocess.PIPE,
                text=True,
            )
            for kind in ("float64", "int64")
        ]
        return [process.communicate(timeout=300)[0].strip() for process in started]

    assert both() == ["42.0 0", "42 0"]
    assert len(list((tmp_path / "kept").rglob("*.nbc"))) == 2
    assert both() == ["42.0 1", "42 1"]


def test_what_came_with_the_program_is_taken(tmp_path: Path) -> None:
    """With the very name that the sources and the processor give; and no other."""
    assert run_kernel(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "shipped")).stdout == "42.0\n"
    (kept,) = (tmp_path / "shipped").iterdir()
    program = (
        "import pathlib, sys; from core import kernel_cache; kernel_cache.SHIPPED = pathlib.Path(sys.argv[1]);"
        "sys.path.insert(0, sys.argv[2]); from one import double; print(sum(double.stats.cache_hits.values()))"
    )

    def hits(own: str) -> str:
        done = subprocess.run(
            [sys.executable, "-c", program, str(kept.parent), str(tmp_path)],
            env={
                **os.environ,
                "PYTHONPATH": str(REPOSITORY),
                "NUMBA_CACHE_DIR": str(tmp_path / own),
            },
            capture_output=True,
            text=True,
            timeout=300,
            check=True,
        )
        return done.stdout.split()[-1]

    assert hits("a") == "1"
    kept.rename(kept.with_name(kernel_cache.PREFIX + "0" * 16))
    assert hits("b") == "0"


def test_a_function_need_not_know_the_whole_path_of_its_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a program that was packed for machines without Python: the module knows it."""
    module = ModuleType("packed")
    module.__file__ = str(tmp_path / "packed.py")
    monkeypatch.setitem(sys.modules, "packed", module)
    source = "from core.jit import kernel\n@kernel\ndef double(x):\n    return 2.0 * x\n"
    exec(compile(source, "packed.py", "exec"), module.__dict__)
    assert module.double._cache.cache_path == str(kernel_cache.place(tmp_path.resolve()))
