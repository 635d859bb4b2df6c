"""A pipe with a name that nobody reads keeps nobody waiting; one that is read gets all."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.files import pipes
from sandbox.files.growing_log import GrowingLog
from sandbox.files.table import GrowingTable, write_csv
from sandbox.record.video import VideoWriter
from tests.files.test_growing_log import until
from tests.files.test_table import Growing, Rows

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")


@pytest.fixture
def pipe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(pipes, "PATIENCE", 0.0)
    path = tmp_path / "pipe.png"
    os.mkfifo(path)
    return path


def test_without_a_reader_it_is_told_at_once_and_at_the_end(pipe: Path) -> None:
    with pytest.raises(InputError, match=r"--out .*nobody reads this pipe"):
        arguments.output_file("--out", str(pipe), [".png"])
    log = GrowingLog(pipe)
    log.keep(until(3))
    with pytest.raises(InputError, match="nobody reads this pipe"):
        log.close()
    with pytest.raises(InputError, match="nobody reads this pipe"):
        GrowingTable(pipe, lambda: [("mixed", Growing())]).finish()
    writer = VideoWriter(pipe, (64, 48), 30)
    writer.frames = 1
    with pytest.raises(InputError, match="nobody reads this pipe"):
        writer.close()


def test_a_reader_waits_until_it_has_all(pipe: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipes, "PATIENCE", 60.0)
    got: list[str] = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_text()), daemon=True)
    reader.start()
    arguments.output_file("--data", str(pipe), [".png"])
    for _ in range(2):
        with pipes.with_reader(pipe):
            write_csv(pipe, Rows((1, 2.0, "")))
    pipes.let_go()
    reader.join(60)
    assert [len(text.splitlines()) for text in got] == [4]
