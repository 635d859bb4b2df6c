"""A scheduler and a worker of Dask give the same rows, and one that goes is one line."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("scipy")
pytest.importorskip("distributed")

from core.errors import InputError
from sandbox.sweep import sweep, workers
from sandbox.sweep.asking import ask
from sandbox.sweep.sweep import Ways
from sandbox.sweep.tables import RUNS, Tables
from tests.sweep.conftest import fake

pytestmark = pytest.mark.filterwarnings("ignore")  # those of Dask are not ours


def test_the_rows_are_those_of_one_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep, "carry_out", fake)
    monkeypatch.setattr(sweep, "compile_all", len)
    request = ask("gravity_hopper", ["orifice=1.5,3.5"], "regular", "3", {})
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=1,
        threads_per_worker=2,
        processes=False,
        protocol="tcp://",
        host="127.0.0.1",
        dashboard_address=None,
    ) as cluster:
        where = str(cluster.scheduler_address).replace("tcp://", workers.DASK)
        workers.check(where)
        tables = Tables(tmp_path, request)
        assert sweep.sweep(tables, Ways(where))
        tables.close()
    alone = Tables(tmp_path / "alone", request)
    for job in request.jobs():
        alone.add(fake(job))
    alone.close()
    assert (tmp_path / RUNS).read_bytes() == (tmp_path / "alone" / RUNS).read_bytes()
    with pytest.raises(InputError, match="no scheduler answers"):
        workers.check(where)
