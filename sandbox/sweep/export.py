"""The tables of a sweep as Parquet, of what the CSV files hold."""

from __future__ import annotations

import os
from pathlib import Path

from core.errors import InputError, reason_of
from core.files import atomic_write
from sandbox.extras import require
from sandbox.files import cells
from sandbox.sweep.tables import AVALANCHES, RUNS


def require_pyarrow() -> None:
    """Raise InputError, before any work is done, if Parquet cannot be written."""
    require("--parquet needs", "pyarrow", "pyarrow", "parquet")


def write_parquet(folder: Path) -> None:
    """Beside each table the same with the types that its columns have. Raises InputError if it cannot be written."""
    from pyarrow import array, csv, parquet, types

    for name in (RUNS, AVALANCHES):
        path = (folder / name).with_suffix(".parquet")
        try:
            with atomic_write(path) as file:
                table = csv.read_csv(os.fspath(folder / name))
                for place, field in enumerate(table.schema):
                    if types.is_string(field.type):
                        texts = array(map(cells.original, table.column(place).to_pylist()))
                        table = table.set_column(place, field, texts)
                parquet.write_table(table, file)
        except OSError as error:
            raise InputError(f"cannot write {path}: {reason_of(error)}") from error
