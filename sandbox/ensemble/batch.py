"""Many runs carried out at once: what is finished is kept as it comes, what fails is told, and a bar says how long it takes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from core.errors import InputError
from sandbox.bars import bar_options
from sandbox.interrupts import deferred

LOST = "the process that ran it ended without a word"

Asked = TypeVar("Asked")
Found = TypeVar("Found")


class Workers(Protocol):
    """Who carries runs out: a ``pool.Pool``, or any ``concurrent.futures.Executor``."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """Have ``function`` called with ``arguments``."""


@dataclass(frozen=True)
class Batch(Generic[Asked, Found]):
    """Runs, and who is told what they came to.

    ``done`` and ``failed`` are called in the calling thread, one at a time, and no Ctrl-C comes between: there results are kept.
    A line that they return is shown above the bar.
    """

    # One run. Where workers are processes it is pickled, as the run is and what it came to.
    carry_out: Callable[[Asked], Found]
    runs: Sequence[Asked]
    done: Callable[[Asked, Found], str | None]
    failed: Callable[[Asked, str], str | None]  # with the reason
    # What a run comes to if that follows from others that have been told of when its turn comes, or None.
    known: Callable[[Asked], Found | None] = lambda _: None
    prepare: Callable[[], object] | None = None  # called by a worker before the rest begins
    label: Callable[[Asked], str] = lambda _: "runs"  # of the run that was told last
    unit: str = "run"
    silent: bool = False  # no bar: it is shown elsewhere how far it is


def carry_out_all(
    batch: Batch[Asked, Found], workers: Workers, at_once: int, found_before: int = 0
) -> None:
    """Carry out all runs of a batch, ``at_once`` at a time, in their order, and show progress with the time left.

    A run that raises fails, and so do all under way where a process dies: ``pool.Pool`` goes on with new ones, other executors
    raise BrokenExecutor at the next run. ``found_before`` runs more count as finished in the bar.

    Raises KeyboardInterrupt, after all that has finished was told. To stop what is under way is up to who owns the workers.
    """
    from tqdm import tqdm

    if not batch.runs:
        return
    under_way: dict[Future[Found], Asked] = {}
    total = found_before + len(batch.runs)
    look = {**bar_options(), "unit": batch.unit, "disable": batch.silent}
    with tqdm(total=total, initial=found_before, **look) as bar:

        def tell(run: Asked, line: str | None) -> None:
            bar.set_description_str(batch.label(run), refresh=False)
            bar.update()
            if line is not None:
                bar.write(line, file=sys.stderr)

        def begin(run: Asked) -> None:
            found = batch.known(run)
            if found is None:
                under_way[workers.submit(batch.carry_out, run)] = run
            else:
                with deferred():
                    tell(run, batch.done(run, found))

        def settle(finished: Iterable[Future[Found]]) -> None:
            for future in finished:
                with deferred():
                    run, error = under_way.pop(future), future.exception()
                    if error is None:
                        tell(run, batch.done(run, future.result()))
                    else:
                        tell(run, batch.failed(run, _reason(error)))

        if batch.prepare is not None:
            bar.set_description_str("compiling")
            # What fails here fails again, and is told then.
            workers.submit(batch.prepare).exception()
        bar.set_description_str(batch.label(batch.runs[0]))
        try:
            for run in batch.runs:
                begin(run)
                while len(under_way) >= at_once:
                    settle(wait(under_way, return_when=FIRST_COMPLETED).done)
            while under_way:
                settle(wait(under_way, return_when=FIRST_COMPLETED).done)
        except KeyboardInterrupt:
            settle([future for future in under_way if future.done() and not future.cancelled()])
            raise


def _reason(error: BaseException) -> str:
    """Why a run failed, in one line."""
    if isinstance(error, BrokenExecutor):
        return LOST
    return str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
