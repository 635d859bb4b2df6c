"""Who carries the runs of a sweep out: processes of this machine, or the executor of a Dask cluster."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager

from core.errors import InputError
from sandbox.ensemble.batch import Workers
from sandbox.ensemble.pool import Pool
from sandbox.extras import require

LOCAL, DASK = "local", "dask://"
SILENT = "no scheduler answers there; start one: dask scheduler"
PATIENCE = 10.0  # [s] with a scheduler that is to answer
QUEUED = 3  # runs that a cluster is given for each of its threads, so that none waits for the next


def check(executor: str) -> str:
    """``executor`` if it is one that there can be. Raises InputError."""
    if executor.startswith(DASK):
        require(f"--executor {executor} needs", "distributed", "Dask", "cluster")
        _knock(executor)
    elif executor != LOCAL:
        raise InputError(f"--executor {executor}: use local or dask://HOST:PORT")
    return executor


@contextmanager
def workers(executor: str, jobs: int) -> Iterator[tuple[Workers, int]]:
    """Somebody to carry out runs, and how many to ask for at once. Raises InputError if nobody answers, or all are gone.

    At the end of the block, by Ctrl-C as well, what has not begun is called off.
    """
    if executor.startswith(DASK):
        with _dask(executor.removeprefix(DASK)) as found:
            yield found
    else:
        with Pool(jobs) as pool:
            yield pool, jobs


@contextmanager
def _dask(address: str) -> Iterator[tuple[Workers, int]]:
    import logging

    from distributed import Client

    for name in ("distributed", "distributed.client"):  # what went wrong is said in one line
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(f"tcp://{address}", timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(f"--executor {DASK}{address}: {SILENT}") from error
    try:
        threads = sum(client.nthreads().values())
        if not threads:
            raise InputError(
                f"--executor {DASK}{address}: the scheduler has no workers; start some: dask worker {address}"
            )
        executor = client.get_executor(pure=False, retries=2)
        try:
            yield executor, QUEUED * threads
        finally:
            executor.shutdown(wait=False)
    finally:
        client.close(timeout=PATIENCE)


def _knock(executor: str) -> None:
    """Raise InputError, at once and before anything heavy is imported, if nothing listens where the scheduler should be."""
    host, _, port = executor.removeprefix(DASK).rpartition(":")
    if not (host and port.isdecimal() and int(port) < 2**16):
        raise InputError(
            f"--executor {executor}: write dask://HOST:PORT, such as dask://127.0.0.1:8786"
        )
    try:
        socket.create_connection((host, int(port)), PATIENCE).close()
    except OSError as error:
        raise InputError(f"--executor {executor}: {SILENT}") from error
