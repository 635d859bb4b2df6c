"""Any words on the command line: they are carried out, or answered with one clear line and exit code 2. Nothing is written."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from sandbox.cli import main as cli
from scenes import registry

COMMANDS = ("list", "play", "record", "replay", "bench", "study")
OPTIONS = (
    "--out",
    "--data",
    "--packing",
    "--seed",
    "--set",
    "--steps",
    "--size",
    "--fps",
    "--view",
    "--theme",
    "--language",
    "--log",
    "--scale",
    "--compare",
    "--every",
    "--json",
    "--markdown",
    "--quick",
    "--jobs",
    "--only",
    "--scene",
    "--peers",
    "--no-such",
    "-x",
    "--",
    "--out=",
    "--set=",
)
VALUES = (
    "",
    " ",
    "0",
    "-1",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "1_000",
    "٣",
    "9" * 5000,
    "0x10",
    "true",
    "grains=60",
    "grains=",
    "=60",
    "grains=nan",
    "grains=" + "9" * 5000,
    "step=0",
    "friction=-1",
    "packing=mixed",
    "mixed",
    "regular,mixed",
    "regular,,mixed",
    "regular,regular,regular,regular",
    "1280x720",
    "0x0",
    "999999x999999",
    "641x361",
    "film.mp4",
    "film.avi",
    "run.csv",
    "run.jsonl",
    "no/such/folder/film.mp4",
    ".",
    "..",
    "/",
    "a" * 300 + ".mp4",
    "a" * 300 + ".csv",
    "a" * 300 + ".jsonl",
    "a" * 300 + ".toml",
    "x\0y.mp4",
    "x\0y.jsonl",
    "x\0y.toml",
    "x\ny.mp4",
    "x\ny",
    "\udcff.mp4",
    "\udcff.jsonl",
    "%s%n",
    "$(touch hit)",
    "dark",
    "chains",
    "de",
    "paper",
    "stability",
    "accuracy",
    "missing.toml",
    "empty.toml",
    "empty.jsonl",
    "folder.toml",
)
WORDS = st.one_of(
    st.sampled_from(COMMANDS),
    st.sampled_from(OPTIONS),
    st.sampled_from(VALUES),
    st.sampled_from(registry.names()),
    st.text(max_size=12),
)


class Reached(Exception):
    """The words made sense: here the work would begin."""


def begin(*_: object, **__: object) -> None:
    raise Reached


@pytest.fixture(scope="module")
def nothing_is_done(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Run in an empty folder, with everything that takes long replaced."""
    from sandbox import environment
    from sandbox.files import folder as output_folder
    from sandbox.record import record
    from sandbox.studies.accuracy import study as accuracy
    from sandbox.studies.bench import bench
    from sandbox.studies.stability import study as stability
    from sandbox.window import app

    folder = tmp_path_factory.mktemp("words")
    for name in ("empty.toml", "empty.jsonl"):
        (folder / name).write_text("")
    (folder / "folder.toml").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(environment, "require_display", lambda: None)
        for module, name in (
            (app, "run"),
            (record, "record"),
            (record, "repeat"),
            (bench, "run"),
            (output_folder, "prepare_folder"),
            (stability, "study"),
            (accuracy, "study"),
        ):
            patch.setattr(module, name, begin)
        yield folder


@settings(
    max_examples=1000,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(st.lists(WORDS, max_size=7))
@example(["record", "hopper", "--out", "a" * 300 + ".mp4"])
@example(["record", "hopper", "--data", "a" * 300 + ".csv"])
@example(["record", "hopper", "--out", "x\0y.mp4"])
@example(["play", "hopper", "--log", "a" * 300 + ".jsonl"])
@example(["play", "a" * 300 + ".toml"])
@example(["play", "x\0y.toml"])
@example(["replay", "a" * 300 + ".jsonl"])
@example(["replay", "x\0y.jsonl"])
@example(["replay", "."])
@example(["record", "hopper", "--out", "x\ny.mp4", "--steps", "9" * 5000])
@example(["record", "hopper", "--data", "run.csv", "--set", "grains=" + "9" * 5000])
@example(["bench", "--json", "a" * 300 + ".json"])
@example(["study", "paper", "--out", "a" * 300])
@example(["x\ny"])
@example(["record", "x\ny", "--data", "run.csv"])
@example(["--", "\r\n"])
def test_any_words(
    nothing_is_done: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    before = sorted(path.name for path in nothing_is_done.iterdir())
    code: object = None
    with contextlib.suppress(Reached):
        try:
            code = cli.main(words)
        except SystemExit as leave:  # --help and --version
            code = leave.code
    said = capsys.readouterr()
    assert sorted(path.name for path in nothing_is_done.iterdir()) == before
    assert "Traceback" not in said.err
    if code == 2:
        assert said.err.startswith("error: ")
        assert said.err.endswith("\n")
        assert len(said.err.splitlines()) == 1, said.err
        assert said.out == ""
    else:
        assert code in (None, 0)
