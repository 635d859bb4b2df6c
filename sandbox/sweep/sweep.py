"""Carrying a sweep out: what its folder does not hold yet, by whatever workers there are, kept as it comes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import CancelledError
from dataclasses import asdict, dataclass
from functools import partial

from core.errors import InputError
from core.warmup import compile_kernels
from sandbox.ensemble.batch import LOST, Batch, Workers, carry_out_all
from sandbox.sweep.outcome import Found, carry_out, failure
from sandbox.sweep.request import Job
from sandbox.sweep.tables import Tables
from sandbox.sweep.workers import workers
from scenes import registry
from scenes.scene import Ingredients

TRIES = 3  # of a run whose process died, which may have been the work of a run beside it
GONE = "the executor has given up on its runs: is it still there? What has finished is kept, the same command goes on from there"


@dataclass(frozen=True)
class Ways:
    """How runs are carried out."""

    executor: str = "local"
    jobs: int = 2


def sweep(tables: Tables, ways: Ways) -> bool:
    """Carry out the runs that are missing; False if Ctrl-C came before the end. The tables are in order then all the same.

    Raises InputError if nobody can carry them out, or not to the end.
    """
    missing = [job for job in tables.request.jobs() if job.row not in tables.runs]
    try:
        if missing:
            with workers(ways.executor, ways.jobs) as (some, at_once):
                for _ in range(TRIES):
                    missing = _carry_out(tables, missing, some, at_once)
            for job in missing:
                tables.add(failure(job, LOST))
    except KeyboardInterrupt:
        return False
    except (CancelledError, OSError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise InputError(GONE) from error
    finally:
        tables.write_all()
    return True


def _carry_out(tables: Tables, jobs: Sequence[Job], some: Workers, at_once: int) -> list[Job]:
    """The jobs, of which those whose process died are returned."""
    lost: list[Job] = []

    def done(_: Job, found: Found) -> None:
        tables.add(found)

    def failed(job: Job, reason: str) -> str | None:
        if reason == LOST:
            lost.append(job)
            return None
        tables.add(failure(job, reason))
        return f"failed: row {job.row}: {reason}"

    batch = Batch(
        carry_out,
        jobs,
        done,
        failed,
        prepare=partial(compile_all, sorts(jobs)),
        label=lambda job: f"{job.scene}, {job.packing}"[:32].ljust(32),
    )
    carry_out_all(batch, some, at_once, len(tables.runs))
    return lost


def sorts(jobs: Iterable[Job]) -> tuple[Ingredients, ...]:
    """All sorts of kernels that the jobs need, each once."""
    return tuple(dict.fromkeys(registry.get(job.scene).ingredients(job.settings) for job in jobs))


def compile_all(terms: Sequence[Ingredients]) -> None:
    """Compile them, or have the cache hold them for those who come later."""
    for each in terms:
        compile_kernels(**asdict(each))
