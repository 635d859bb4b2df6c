"""What all tests share: compiled kernels, which are there before tests begin side by side."""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

import pytest

from sandbox.preparation import parts
from scenes import registry


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config: pytest.Config, specs: Sequence[object]) -> None:
    """Else every process would compile the same."""
    if len(specs) < 2:
        return
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is not None:
        reporter.write_line("kernels are compiled first, which takes a minute or two")
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(len(specs), context) as pool:
        for done in [
            pool.submit(parts.carry_out, [part]) for part in parts.of_scenes(registry.names())
        ]:
            done.result()
