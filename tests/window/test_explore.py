"""Explore: what is asked, a map that fills while one looks, stopped and gone on with, and a cell that opens its run."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pygame
import pytest

pytest.importorskip("scipy")

from sandbox.session.commands import Protocol
from sandbox.sweep.outcome import Found
from sandbox.sweep.request import Job
from sandbox.window.explore import explorer
from sandbox.window.explore.side import Side
from scenes import registry
from tests.sweep.conftest import fake
from tests.window.desk import Desk


class Threads(ThreadPoolExecutor):
    """In place of processes."""

    def stop(self) -> None:
        pass


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Desk]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(explorer, "Pool", Threads)
    monkeypatch.setattr(explorer, "carry_out_gently", fake)
    place = Desk((1000, 700))
    place.app.pages.open_menu()
    place.until(lambda: not place.app._splash)
    place.app.pages.menu.choose("gravity_hopper")
    place.key(pygame.K_x)
    yield place
    place.app.close()


def test_a_map_fills_and_a_cell_opens_its_run(desk: Desk, tmp_path: Path) -> None:
    page = desk.app.pages.explore
    page._seeds = 3
    for key in (pygame.K_UP, pygame.K_LEFT, pygame.K_UP, pygame.K_LEFT):  # runs a cell, values
        desk.key(key)
    request = page.request()
    assert [axis.name for axis in request.axes] == ["orifice", "auxetic_fraction"]
    assert [len(axis.values) for axis in request.axes] == [5, 4]
    assert request.seeds == (1, 2)
    assert dict(request.settings).get("shake", 0.0) == 0.0
    desk.key(pygame.K_RETURN)
    desk.until(lambda: not page.explorer.progress.at_work)
    desk.app.tick()
    progress = page.explorer.progress
    assert (progress.done, progress.error) == (40, "")
    assert {cell.share for cell in progress.cells} == {0.0, 1.0}
    (folder,) = tmp_path.glob("sandbox-explore-*")
    assert (folder / "runs.csv").read_text().count("\n") == 41
    cell = progress.cells[7]
    desk.click(page._places.cells[cell.values].center)
    panes = desk.app.stage.panes
    assert not desk.app.stage.show_explore
    assert (panes.scene, panes.seed) == ("gravity_hopper", 1)
    assert desk.session.settings == request.job(cell.row).settings
    desk.until(lambda: Protocol(True) in desk.session.commands)


def test_it_stops_and_goes_on_where_it_was(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    gate, page = threading.Semaphore(4), desk.app.pages.explore

    def slow(job: Job) -> Found:
        gate.acquire()
        return fake(job)

    monkeypatch.setattr(explorer, "carry_out_gently", slow)
    page._seeds = 2
    desk.key(pygame.K_RETURN)
    desk.until(lambda: page.explorer.progress.done >= 1)
    desk.key(pygame.K_RETURN)
    gate.release(1000)
    desk.until(lambda: not page.explorer.progress.at_work)
    stopped = page.explorer.progress.done
    assert 4 <= stopped < page.request().runs
    desk.key(pygame.K_RETURN)
    desk.until(lambda: not page.explorer.progress.at_work)
    assert page.explorer.progress.done == page.request().runs
    desk.key(pygame.K_ESCAPE)
    assert desk.page() == "menu"


def test_what_cannot_be_is_said(desk: Desk) -> None:
    page = desk.app.pages.explore
    page._sides[0].high = 99.0
    desk.key(pygame.K_RETURN)
    assert "must lie between" in page._said
    assert not page.explorer.progress.at_work


@pytest.mark.parametrize("name", registry.names())
def test_every_parameter_has_a_range_that_may_be(name: str) -> None:
    for parameter in registry.get(name).parameters:
        if parameter.kind != "switch":
            values = Side.around(parameter).values()
            assert len(values) > 1
            assert [parameter.check(value) for value in values] == list(values)
