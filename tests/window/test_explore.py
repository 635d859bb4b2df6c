"""Explore: what is asked, a map that fills while one looks, stopped and gone on with, and a cell that opens its run."""

from __future__ import annotations

import pickle
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.session.commands import Protocol
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.sweep.asking import ask
from sandbox.sweep.outcome import CLOGGED, EMPTIED, Found
from sandbox.sweep.request import Job
from sandbox.window.explore import explorer
from sandbox.window.explore.page import ExplorePage
from sandbox.window.explore.side import Side
from scenes import registry
from tests.draw.frames import intruder_frame
from tests.sweep.conftest import fake
from tests.window.desk import Desk


class Threads(ThreadPoolExecutor):
    """In place of processes."""

    def stop(self) -> None:
        pass


def gently(job: Job) -> tuple[Found, Frame]:
    return fake(job), intruder_frame(columns=4, seed=job.seed)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Desk]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(explorer, "Pool", Threads)
    monkeypatch.setattr(explorer, "carry_out_gently", gently)
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
    for key in (
        pygame.K_UP,
        pygame.K_UP,
        pygame.K_LEFT,
        pygame.K_UP,
        pygame.K_LEFT,
    ):  # runs a cell, values
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


def fill(desk: Desk, seeds: int = 2) -> ExplorePage:
    """A map of four cells."""
    page = desk.app.pages.explore
    page._seeds = seeds
    for side in page._sides:
        side.count = 2
    page.go_or_stop()
    desk.until(lambda: not page.explorer.progress.at_work)
    desk.app.tick()
    return page


def test_the_run_of_another_cell_is_put_beside_the_one_that_was_opened(desk: Desk) -> None:
    page = fill(desk)
    panes = desk.app.stage.panes
    first, second = page.explorer.progress.cells[0], page.explorer.progress.cells[3]
    desk.click(page._places.cells[first.values].center)
    desk.until(lambda: panes.snapshot.phase == "running" and panes.snapshot.frame is not None)
    desk.key(pygame.K_x)
    assert page.explorer.progress.done == 8  # the map is still there
    page.click(page._places.cells[second.values].center, beside=True)
    jobs = [page.request().job(cell.row) for cell in (first, second)]
    assert [(s.packing, s.seed, s.settings) for s in desk.sessions[-2:]] == [
        (job.packing, job.seed, job.settings) for job in jobs
    ]
    assert panes.comparing
    assert not desk.app.stage.show_explore
    desk.until(lambda: all(Protocol(True) in s.commands for s in desk.sessions[-2:]))


def test_two_cells_are_chosen_by_keys(desk: Desk) -> None:
    """Shift and a click marks the first where none was opened; C does so by keys, and again takes it back."""
    page = fill(desk)
    desk.key(pygame.K_TAB)
    desk.key(pygame.K_c)
    desk.key(pygame.K_c)
    assert page._first is None
    desk.key(pygame.K_c)
    desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_UP)
    assert page._pointed == page.explorer.progress.cells[3].values
    desk.key(pygame.K_c)
    panes = desk.app.stage.panes
    assert panes.comparing
    first, last = (page.request().job(page.explorer.progress.cells[k].row) for k in (0, 3))
    assert [s.settings for s in desk.sessions[-2:]] == [first.settings, last.settings]
    desk.key(pygame.K_x)
    desk.key(pygame.K_RETURN)
    assert len(panes.snapshots) == 1
    assert desk.session.settings == last.settings


def test_the_ends_of_runs_are_shown_and_run_for_again(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = fill(desk)
    progress = page.explorer.progress
    assert not progress.unseen
    shares = desk.app.stage.renderer.surface.copy()
    desk.key(pygame.K_v)
    desk.until(lambda: not page._ends.waiting)
    assert pygame.image.tobytes(shares, "RGB") != pygame.image.tobytes(
        desk.app.stage.renderer.surface, "RGB"
    )
    desk.click(page._places.lines["show"].center)
    assert not page.explorer.pictures
    # A folder that was filled by others knows how runs came out, and not how they looked.
    page._forget()
    again: list[int] = []

    def counted(job: Job) -> tuple[Found, Frame]:
        again.append(job.row)
        return gently(job)

    monkeypatch.setattr(explorer, "carry_out_gently", counted)
    fill(desk)
    assert page.explorer.progress.unseen
    assert again == []
    desk.key(pygame.K_v)
    desk.until(lambda: not page.explorer.progress.at_work)
    rows = [cell.row for cell in page.explorer.progress.cells]
    assert sorted(again) == rows == sorted(page.explorer.progress.frames)
    # What is seen at once comes before what is new.
    page._forget()
    again.clear()
    fill(desk, seeds=3)
    assert sorted(again[:4]) == rows
    assert sorted(again[4:]) == [9, 10, 11, 12]


def test_the_end_that_is_kept_is_that_of_the_run_that_opens() -> None:
    ends = explorer.Ends({})
    frames = {row: intruder_frame(columns=2, seed=row) for row in (1, 3, 5, 7)}
    for row, outcome in ((5, CLOGGED), (3, EMPTIED), (1, CLOGGED), (7, CLOGGED)):
        ends.keep(row, (0, 0, outcome), frames[row])
    assert ends.frames == {1: frames[1], 3: frames[3]}


def test_a_click_opens_the_same_bits() -> None:
    """What a process of low priority carried out, and what it shows, are those of a run from its start."""
    small = {"grains": 24, "width": 10.0, "shake": 0.0, "fall": 0.3}
    job = ask("gravity_hopper", ["orifice=1.5"], "regular", "1", small).job(1)
    found, frame = explorer.carry_out_gently(job)
    session = Session(job.scene, job.packing, job.seed, job.settings)
    session.build()
    session.submit(Protocol(True))
    for _ in islice(session.increments(7), int(found.run["increments"])):
        pass
    assert session.run.state_hash() == found.run["state"]
    assert np.array_equal(session.frame().x, pickle.loads(pickle.dumps(frame)).x)
    below, above = frame.bounds[1], frame.bounds[3]
    assert session.frame().bounds[1] < below < frame.y.min()
    assert frame.y.max() < above <= session.frame().bounds[3]


def test_it_stops_and_goes_on_where_it_was(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    gate, page = threading.Semaphore(4), desk.app.pages.explore

    def slow(job: Job) -> tuple[Found, Frame]:
        gate.acquire()
        return gently(job)

    monkeypatch.setattr(explorer, "carry_out_gently", slow)
    page._seeds = 2
    desk.key(pygame.K_RETURN)
    desk.until(lambda: page.explorer.progress.done >= 1)
    desk.key(pygame.K_RETURN)
    gate.release(1000)
    desk.until(lambda: not page.explorer.progress.at_work)
    stopped = page.explorer.progress.done
    assert 1 <= stopped < page.request().runs
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


def test_the_terminal_hears_nothing_of_it(desk: Desk, capfd: pytest.CaptureFixture[str]) -> None:
    page = fill(desk)
    assert page.explorer.progress.done
    page.show_ends_or_shares()
    desk.until(lambda: not page.explorer.progress.at_work)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("run", [False, True], ids=["menu", "run"])
@pytest.mark.parametrize("over", ["", "help"])
def test_m_leads_from_every_page_to_the_menu(desk: Desk, run: bool, over: str) -> None:
    if run:
        desk.key(pygame.K_ESCAPE)
        desk.start("gravity_hopper")
        desk.key(pygame.K_x)
    assert desk.app.stage.show_explore
    if over:
        desk.key(pygame.K_h)
    desk.key(pygame.K_m)
    stage = desk.app.stage
    assert (stage.show_menu, stage.show_help, stage.show_explore) == (True, False, False)
    assert desk.paused() == run
    if run:
        desk.key(pygame.K_m)
        assert desk.page() == "run"
        assert not desk.paused()
