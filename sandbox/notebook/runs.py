"""Runs a scene's own script in a few lines of Python, and keeps what a notebook wants to show."""

from __future__ import annotations

import html
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from sandbox.environment import prepare_headless
from sandbox.interrupts import deferred
from sandbox.session.commands import Protocol
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from scenes.checks import Check
from scenes.parameter import shown
from scenes.text import counted

if TYPE_CHECKING:
    from sandbox.draw.render import Renderer

SLICE = 400  # relaxation steps between two looks at Ctrl-C
HEIGHT = 820  # of the player in a cell [px]

Image = NDArray[np.uint8]


def run(
    scene: str,
    packing: str = "mixed",
    seed: int = 1,
    *,
    steps: int | None = None,
    every: int = 1,
    progress: bool = False,
    **settings: object,
) -> Result:
    """Run a scene by its own script for ``steps`` increments, or to the end, and keep every ``every``-th state.

    ``settings`` are the scene's parameters, ``progress`` draws a bar. Ctrl-C, or the stop of a notebook, ends the run early with
    what there is. Raises InputError for what does not exist or cannot be.
    """
    from tqdm import tqdm

    _check_count("steps", 0 if steps is None else steps, 0)
    _check_count("every", every, 1)
    session = Session(scene, packing, seed, settings)
    session.build()
    session.submit(Protocol(True))
    wanted = session.scene.steps(session.settings) if steps is None else steps
    frames, work = [session.frame()], session.slices(SLICE)
    try:
        with tqdm(total=wanted, desc=scene, unit="increment", disable=not progress) as bar:
            while session.finished < wanted:
                with deferred():
                    finished = next(work, None)
                    if finished:
                        bar.update()
                        if session.finished % every == 0:
                            frames.append(session.frame())
                if finished is None:
                    break
    except KeyboardInterrupt:
        pass  # between two slices of work: all that is there is whole
    if frames[-1].increment != session.history[-1].increment and not session.busy:
        frames.append(session.frame())
    return Result(session, frames)


def _check_count(name: str, number: object, low: int) -> None:
    if not (isinstance(number, (int, np.integer)) and number >= low):
        raise InputError(f"{name} must be a whole number from {low}, not {shown(number)}")


class Columns(dict[str, NDArray[Any]]):
    """The table of a run: its columns (M,) by quantity and unit."""

    def to_pandas(self) -> Any:
        """The same as a DataFrame of pandas, which must be installed."""
        import pandas as pd

        return pd.DataFrame(self)


class Result:
    """What came of a run; at the end of a cell it shows itself as a player."""

    def __init__(self, session: Session, frames: list[Frame]) -> None:
        self.session = session  # goes on where the run ended
        self.frames = frames  # the states that were kept, as plain data: see ``Frame``
        table = session.table
        columns = zip(*table.rows(), strict=True)
        self.table = Columns(zip(table.header(), map(np.array, columns), strict=True))

    @property
    def checks(self) -> list[Check]:
        """The scene's claims about the run, and whether they hold."""
        return self.session.checks()

    def picture(
        self,
        number: int = -1,
        size: tuple[int, int] = (960, 540),
        view: str = "kind",
        theme: str = "light",
    ) -> Image:
        """The state of that number, the last one by default, as RGB (h, w, 3)."""
        return _image(_renderer(size, view, theme), self.frames[number])

    def pictures(
        self, size: tuple[int, int] = (960, 540), view: str = "kind", theme: str = "light"
    ) -> Iterator[Image]:
        """All states that were kept, one after another: those of a film."""
        renderer = _renderer(size, view, theme)
        return (_image(renderer, frame) for frame in self.frames)

    def page(self, view: str = "kind", theme: str = "light") -> str:
        """The player as one HTML page that asks for nothing: as ``record --out FILE.html`` writes it."""
        prepare_headless()
        from sandbox.player.page import Look, page
        from sandbox.player.tape import Tape

        tape = Tape()
        for frame in self.frames:
            tape.add([frame])
        return page(tape, Look(theme=theme, view=view, play=False))

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self.page())}" title="{html.escape(self.frames[0].title)}" '
            f'style="width:100%;height:{HEIGHT}px;border:0"></iframe>'
        )

    def __repr__(self) -> str:
        frame = self.frames[-1]
        return f"<{frame.scene}, {frame.packing}: {counted(len(self.session.history) - 1, 'increment')}>"


def _renderer(size: tuple[int, int], view: str, theme: str) -> Renderer:
    prepare_headless()
    from sandbox.draw.render import Renderer

    return Renderer(size, max(0.5, min(size[0] / 1280, size[1] / 720)), theme, view)


def _image(renderer: Renderer, frame: Frame) -> Image:
    return np.array(renderer.image([frame]))
