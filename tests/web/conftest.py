"""What is compiled, run and tried in a browser once, for all tests of pages that can run.

What needs the extra ``web``, Node.js or Chromium is skipped where that is missing, and says so.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from sandbox.web import building
from tests.web.pages import HERE, PAGE, RUNS, Run, compiled, run_exactly, written

CHROMIUM = next(
    (
        found
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (found := shutil.which(name))
    ),
    None,
)
SEEDS = 2  # of the pages that are tried


@pytest.fixture(scope="session")
def exact(tmp_path_factory: pytest.TempPathFactory) -> dict[Run, dict[str, Any]]:
    """That of all runs."""
    return {run: run_exactly(run, tmp_path_factory.mktemp("exact")) for run in RUNS}


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Those for open cells."""
    return compiled(tmp_path_factory.mktemp("kernels"))


@pytest.fixture(scope="session")
def periodic_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """And for periodic ones."""
    return compiled(tmp_path_factory.mktemp("periodic"), periodic=True)


@pytest.fixture(scope="session")
def tried(program: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the pages do in a browser."""
    if CHROMIUM is None or shutil.which("npm") is None:
        pytest.skip("without Chromium or npm: no page can be tried")
    pages, folder = tmp_path_factory.mktemp("pages"), tmp_path_factory.mktemp("node")
    written(pages, list(building.SCENES), seeds=SEEDS)
    for name in ("package.json", "package-lock.json"):
        shutil.copyfile(PAGE / name, folder / name)
    subprocess.run(
        ["npm", "ci", "--no-audit", "--no-fund"], cwd=folder, check=True, capture_output=True
    )
    done = subprocess.run(
        ["node", str(HERE / "try_page.mjs"), str(pages), str(folder)],
        env={**os.environ, "CHROMIUM": CHROMIUM},
        capture_output=True,
        text=True,
        check=True,
        timeout=1800,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found
