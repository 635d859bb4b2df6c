"""What all tests share: compiled kernels, which are there before tests begin side by side."""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import asdict, astuple

import pytest

from core import warmup as solving
from core.errors import InputError
from sandbox.draw import warmup as drawing
from scenes import registry
from scenes.scene import Ingredients


def sorts_of_kernels() -> list[Ingredients]:
    """Those of all scenes, with and without friction; first those that share the least, which are compiled at the same time."""
    found: dict[Ingredients, None] = {}
    for scene in map(registry.get, registry.names()):
        for values in ({}, {"friction": 0.0}, {"friction": 0.5}):
            with suppress(InputError):  # it has no such parameter
                found[scene.ingredients(scene.settings(values))] = None
    return sorted(found, key=lambda terms: (terms.friction, terms.gravity, *astuple(terms)))


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
        done = [pool.submit(solving.compile_kernels, **asdict(sort)) for sort in sorts_of_kernels()]
        done.append(pool.submit(drawing.compile_kernels))
        for one in done:
            one.result()
