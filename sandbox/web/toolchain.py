"""What pages are built with: kernels compiled to WebAssembly, and scripts bundled by esbuild. Both are kept in the user's cache.

The compiler comes from PyPI with the extra ``web``, the bundler from npm as the lock file says; to run the program takes neither.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from platformdirs import user_cache_path

from core.errors import InputError
from core.kernel_cache import CORE, source_hash
from sandbox.extras import require

HERE = Path(__file__).parent
PAGE = HERE / "page"
ROOT = HERE.parents[1]
SCRIPTS = ("page.ts", "worker.ts")


def require_tools() -> None:
    """Raise InputError where anything is missing that pages are made with, and that is not made already."""
    _require_linker()
    if not (_cache() / _bundle_name(_page_files())).exists():
        _npm()


def _require_linker() -> None:
    require("pages need", "ziglang", "the linker of Zig", "web")


def kernels(*, periodic: bool = False) -> bytes:
    """All that a page calls, as WebAssembly: the same kernels as on the desk, without fast math; for open or ``periodic`` cells.

    Raises InputError where the compiler is not installed, or fails.
    """
    _require_linker()
    sources = source_hash(CORE, ROOT / "scenes", HERE / "increment", HERE / "wasm")
    runtime = hashlib.sha256((HERE / "wasm" / "runtime.c").read_bytes()).hexdigest()[:8]
    kind = ("periodic",) if periodic else ()
    name = "-".join(("kernels", *kind, sources, runtime))
    return _kept(f"{name}.wasm", lambda out: _compile(out, *kind)).read_bytes()


def _compile(out: Path, *kind: str) -> None:
    paths = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    _run(
        [sys.executable, "-m", "sandbox.web.wasm", str(out), *kind],
        ROOT,
        "the kernels cannot be compiled",
        PYTHONPATH=paths,
    )


def scripts() -> dict[str, str]:
    """The scripts of the page, bundled, by the names in ``SCRIPTS``. Raises InputError where Node.js is missing, or fails."""
    files = _page_files()
    folder = _kept(_bundle_name(files), lambda out: _bundle(files, out))
    return {name: (folder / name).read_text(encoding="utf-8") for name in SCRIPTS}


def _page_files() -> list[Path]:
    return sorted(path for path in PAGE.rglob("*") if path.is_file() and _own(path))


def _bundle_name(files: list[Path]) -> str:
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.relative_to(PAGE).as_posix().encode())
        digest.update(path.read_bytes())
    return f"page-{digest.hexdigest()[:16]}"


def _own(path: Path) -> bool:
    return "node_modules" not in path.parts and path.suffix in (".ts", ".json")


def _npm() -> str:
    """The program. Raises InputError where it is missing, or what runs it."""
    npm, node = shutil.which("npm"), shutil.which("node")
    if npm is None or node is None:
        missing = "npm" if npm is None else "Node.js"
        raise InputError(
            f"pages need {missing}, which is not installed: install Node.js 20 or newer"
        )
    return npm


def _bundle(files: list[Path], out: Path) -> None:
    npm = _npm()
    work = out.with_suffix(".work")
    shutil.rmtree(work, ignore_errors=True)
    for path in files:
        copy = work / path.relative_to(PAGE)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, copy)
    trouble = "the page's scripts cannot be bundled"
    _run([npm, "ci", "--no-audit", "--no-fund"], work, trouble)
    _run([npm, "run", "--silent", "check"], work, trouble)
    out.mkdir()
    options = ["--bundle", "--format=iife", "--target=es2022", "--minify", "--legal-comments=none"]
    for name in SCRIPTS:
        outfile = f"--outfile={out / name}"
        command = [npm, "exec", "--", "esbuild", f"src/{name}", *options, outfile]
        _run(command, work, trouble)
    shutil.rmtree(work)


def _cache() -> Path:
    return user_cache_path("auxetic-sandbox") / "web"


def _kept(name: str, make: Callable[[Path], None]) -> Path:
    """What ``make`` makes, from the cache if it is there."""
    folder = _cache()
    there = folder / name
    if not there.exists():
        folder.mkdir(parents=True, exist_ok=True)
        new = folder / f"{name}.new-{os.getpid()}"
        make(new)
        new.replace(there)
    return there


def _run(command: list[str], folder: Path, trouble: str, **environment: str) -> None:
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines()
        raise InputError(f"{trouble}: {said[-1] if said else 'no reason given'}")
