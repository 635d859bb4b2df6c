"""Words of the command line to checked values."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import InputError
from sandbox.cli import arguments, listing, study
from sandbox.cli import main as cli


@given(st.integers(320, 7680), st.integers(240, 4320))
def test_every_size_in_range_is_read(width: int, height: int) -> None:
    assert arguments.size(f"{width}x{height}") == (width, height)


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("1280", "WIDTHxHEIGHT"),
        ("", "WIDTHxHEIGHT"),
        ("-1280x720", "WIDTHxHEIGHT"),
        ("1280.5x720", "WIDTHxHEIGHT"),
        ("0x0", "320x240 to 7680x4320"),
        ("8000x720", "320x240 to 7680x4320"),
        ("99999999x2", "WIDTHxHEIGHT"),
    ],
)
def test_a_wrong_size_is_explained(text: str, advice: str) -> None:
    with pytest.raises(InputError, match=advice):
        arguments.size(text)


def test_a_film_alone_needs_even_sizes() -> None:
    for suffix in (".gif", ".png"):
        arguments.check_size((641, 361), suffix)
    arguments.check_size((640, 360), ".mp4")
    for size in ((641, 360), (640, 361), (641, 361)):
        with pytest.raises(InputError, match=r"a film needs even numbers, not .*: use"):
            arguments.check_size(size, ".mp4")


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "0.5", "121", "fast", ""])
def test_a_wrong_number_is_explained(text: str) -> None:
    with pytest.raises(InputError):
        arguments.number(1.0, 120.0)(text)


@pytest.mark.parametrize("text", ["0", "-3", "1.5", "1e3", "many", "10000000"])
def test_a_wrong_count_is_explained(text: str) -> None:
    with pytest.raises(InputError):
        arguments.whole_number(1, arguments.MOST_STEPS)(text)


def test_a_gif_cannot_be_faster_than_browsers_play_it() -> None:
    arguments.check_fps(50.0, ".gif")
    arguments.check_fps(120.0, ".mp4")
    with pytest.raises(InputError, match=r"\.gif: use 50"):
        arguments.check_fps(60.0, ".gif")


def test_output_files_are_tried_before_any_work(tmp_path: Path) -> None:
    def check(text: str) -> Path:
        return arguments.output_file("--out", text, [".mp4", ".gif"])

    good = tmp_path / "Film.MP4"
    assert check(str(good)) == good
    assert not list(tmp_path.iterdir())
    (tmp_path / "folder.mp4").mkdir()
    (tmp_path / "file").touch()
    for text, advice in [
        (tmp_path / "film.avi", "must end in .mp4 or .gif"),
        (tmp_path / "film", "must end in"),
        (tmp_path / "nowhere" / "film.mp4", "make it first"),
        (tmp_path / "file" / "film.mp4", "make it first"),
        (tmp_path / "folder.mp4", "this is a folder"),
    ]:
        with pytest.raises(InputError, match=advice):
            check(str(text))


@pytest.mark.parametrize("suffix", [".mp4", ".gif", ".png", ".csv"])
def test_a_name_is_taken_if_and_only_if_it_can_be_written(tmp_path: Path, suffix: str) -> None:
    """As long as the system takes, in bytes; one more is told at once."""
    for letter in ("x", "ν"):
        count = (255 - len(suffix)) // len(letter.encode())
        name = letter * count + suffix
        arguments.output_file("--out", str(tmp_path / name), [suffix])
        with pytest.raises(InputError, match="too long"):
            arguments.output_file("--out", str(tmp_path / (letter + name)), [suffix])
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege there")
def test_links_that_lead_nowhere_are_told(tmp_path: Path) -> None:
    (tmp_path / "a.csv").symlink_to(tmp_path / "b.csv")
    (tmp_path / "b.csv").symlink_to(tmp_path / "a.csv")
    (tmp_path / "far.csv").symlink_to(tmp_path / "gone" / "far.csv")
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    for name in ("a.csv", "b.csv", "circle/run.csv"):
        with pytest.raises(InputError, match="too many levels of symbolic links"):
            arguments.output_file("--data", str(tmp_path / name), [".csv"])
    with pytest.raises(InputError, match="there is no folder"):
        arguments.output_file("--data", str(tmp_path / "far.csv"), [".csv"])


@pytest.mark.skipif(
    sys.platform == "win32" or os.geteuid() == 0, reason="nothing is forbidden to this user"
)
def test_protected_places_are_noticed(tmp_path: Path) -> None:
    film = tmp_path / "film.mp4"
    film.touch(0o400)
    with pytest.raises(InputError, match="write-protected"):
        arguments.output_file("--out", str(film), [".mp4"])
    folder = tmp_path / "locked"
    folder.mkdir(0o500)
    with pytest.raises(InputError, match="permission denied"):
        arguments.output_file("--out", str(folder / "film.mp4"), [".mp4"])


def test_two_options_cannot_name_one_file(tmp_path: Path) -> None:
    table = tmp_path / "run.csv"
    link = tmp_path / "film.mp4"
    link.symlink_to(table)
    arguments.check_different({"--out": tmp_path / "other.mp4", "--data": table})
    arguments.check_different({"--out": None, "--data": None})
    with pytest.raises(InputError, match="--out and --data name the same file"):
        arguments.check_different({"--out": link, "--data": table})


def test_assignments_are_names_and_values() -> None:
    assert arguments.assignments(["radius = -2e0", "kind=a=b"]) == {"radius": "-2e0", "kind": "a=b"}
    assert arguments.assignments([]) == {}


@pytest.mark.parametrize(
    ("texts", "advice"),
    [
        (["radius"], "--set radius: write NAME=VALUE"),
        (["radius="], "NAME=VALUE"),
        (["=3"], "NAME=VALUE"),
        ([""], "NAME=VALUE"),
        (["radius=3", "radius=4"], "set twice"),
    ],
)
def test_wrong_assignments_are_explained(texts: list[str], advice: str) -> None:
    with pytest.raises(InputError, match=advice):
        arguments.assignments(texts)


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        (["recrod", "hopper"], r"unknown command 'recrod' \(did you mean record\?\)"),
        (["xyzzy"], "unknown command 'xyzzy': use list, play, record, replay"),
        (["--versoin"], r"unknown option --versoin \(did you mean --version\?\)"),
        (["record"], "required: SCENE; see python -m sandbox record --help"),
        (["record", "hopper", "--output", "x"], r"--output \(did you mean --out\?\)"),
        (["record", "hopper", "--out"], "--out: expected one argument"),
        (["record", "hopper", "again"], "unexpected argument 'again'"),
        (["record", "hopper", "--size", "319x361"], "--size: 319x361 is out of range"),
        (["record", "hopper", "--fps", "0"], "--fps: 0 is out of range: use 1 to 120"),
        (["record", "hopper", "--steps", "0"], "--steps: 0 is out of range"),
        (["record", "hopper", "--seed", "-1"], "--seed: -1 is out of range"),
        (["play", "--theme", "drak"], r"--theme: .*did you mean dark\?"),
        (
            ["play", "--view", "presure"],
            r"--view: .*did you mean pressure\?.*chains or fringes; see",
        ),
        (["record", "hopper", "--view", "x"], "--view: unknown value 'x': use kind, skin, "),
        (["play", "--scale", "9"], "--scale: 9 is out of range: use 0.5 to 4"),
        (["list", "--jsno"], r"did you mean --json\?"),
        (["replay"], "LOG.jsonl"),
    ],
)
def test_usage_mistakes_are_one_line_with_advice(words: list[str], advice: str) -> None:
    with pytest.raises(InputError, match=advice) as caught:
        cli.parse(words)
    assert "\n" not in str(caught.value)


def test_no_command_is_play() -> None:
    options = cli.parse([])
    assert options.command == "play"
    assert options.scene is None


def test_a_full_disk_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(options: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device", "run.jsonl")

    monkeypatch.setattr(listing, "list_scenes", fail)
    assert cli.main(["list"]) == 2
    assert capsys.readouterr().err == (
        "error: no room left on the disk for run.jsonl: free some and try again\n"
    )


def test_a_study_that_is_stopped_at_its_end_says_what_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Ctrl-C while tables are written and figures drawn, after all runs; and before there is anything."""
    folder = tmp_path / "results"

    def stop(options: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setitem(study.STUDIES, "hand", stop)
    words = ["study", "hand", "--out", str(folder)]
    assert cli.main(words) == 130
    assert capsys.readouterr().err == "stopped: nothing was written\n"
    folder.mkdir()
    assert cli.main(words) == 130
    said = capsys.readouterr().err
    assert said.startswith(f"stopped; what was finished is in {folder}")
    assert "nothing" not in said
