"""Scene files that are none: one line that names the file and says why, and nothing is run."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from core.packing import Packing
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.beginning import SceneFile
from sandbox.session.session import Session
from tests.files.scene_files import (
    Arrays,
    assert_refused,
    change,
    drive,
    parts,
    put,
    rewrite,
    spoil,
)
from tests.session.edited import built


def at(*path: str | int) -> Callable[[Any], Any]:
    """What is at the end of that path."""

    def found(data: Any) -> Any:
        for step in path:
            data = data[step]
        return data

    return found


@pytest.mark.parametrize(
    ("part", "old", "new", "why"),
    [
        ("scene", '"auxetic-sandbox scene"', '"another"', "not a scene file"),
        ("scene", '"version": 2', '"version": 3', "update the program"),
        ("scene", '"version": 2', '"version": true', "version"),
        ("scene", '"scene": "workshop"', '"scene": "workshob"', "did you mean"),
        ("scene", '"scene": "workshop"', '"scene": ["workshop"]', "scene"),
        ("scene", '"scene": "workshop"', '"scene": "hopper"', None),
        ("scene", '"packing": "mixed"', '"packing": "wooden"', "choose"),
        ("scene", '"packing": "mixed"', '"packing": 3', "packing"),
        ("scene", '"seed": 1', '"seed": -1', "seed"),
        ("scene", '"seed": 1', '"seed": 9223372036854775808', "seed"),
        ("scene", '"seed": 1', '"seed": true', "seed"),
        ("scene", '"seed": 1', '"seed": 1.5', "seed"),
        ("scene", '"seed": 1', '"seed": 1, "seed": 1', "twice"),
        ("scene", '"seed": 1', '"seed": 1, "speed": 3', "unknown key 'speed'"),
        ("scene", '"seed": 1,', "", "seed is missing"),
        ("scene", '"friction": 0.4', '"friction": -1.0', "friction"),
        ("scene", '"friction": 0.4', '"friction": 0.4, "friction": 0.5', "twice"),
        ("state", '"friction": 0.4', '"friction": -1.0', "friction"),
        ("state", '"friction": 0.4', '"friction": NaN', "no number"),
        ("state", '"friction": 0.4', '"friction": 1e400', "friction"),
        ("state", '"friction": 0.4', f'"friction": 1{"0" * 400}', "friction"),
        ("state", '"friction": 0.4', '"friction": "0.4"', "friction"),
        ("state", '"friction": 0.4', '"frictoin": 0.4', "did you mean friction"),
        ("state", '"friction": 0.4', '"friction": [0.4]', "friction"),
        ("state", '"contact_stiffness": 50.0', '"contact_stiffness": 1e300', "finite number"),
        ("state", '"contact_stiffness": 50.0', '"contact_stiffness": 5000.0', "between"),
        ("state", '"settings"', '"setings"', "settings"),
        ("state", '"name": "intruder"', '"name": "walls"', "name of its own"),
        ("state", '"name": "intruder"', '"name": "extruder"', "intruder"),
        ("state", '"name": "intruder"', '"name": 3', "name"),
        ("state", '"angle": 0.0', '"angle": 1.0', "cannot be where"),
    ],
)
def test_texts_that_are_none(copy: Path, part: str, old: str, new: str, why: str | None) -> None:
    spoil(copy, part, old, new)
    assert_refused(copy, why)


@pytest.mark.parametrize(
    ("where", "value", "why"),
    [
        (("bodies", 0, "position"), [1.0, 0.0], "cannot be where"),
        (("bodies", 1, "position"), [3.0, 1e4], "cannot be where"),
        (("bodies", 1, "position"), [3.0], "position"),
        (("bodies", 1, "position"), [3.0, "nan"], "position"),
        (("bodies", 1, "home"), [3.0, 1.0], "cannot be where"),
        (("bodies", 1, "axis"), [1.0, 0.0], "cannot be where"),
        (("bodies", 1, "speed"), 3, "unknown"),
        (("bodies", 1), None, "bodies"),
        (("walls", 1), [], "points"),
        (("walls", 1), [[25.0]], "walls"),
        (("walls", 1), [[25.0, "inf"]], "walls"),
        (("walls", 1), [[25.0, 1e300]], "far away"),
        (("walls", 1), [[2.0, 5.0], [2.0, 5.0]], "twice"),
        (("walls", 1), [[3.0, 9.0], [3.0, 11.0], [2.5, 8.0]], "goes through"),
        (("walls",), [[[25.0, 5.0]]] * 101, "more drawn walls"),
        (("going_on", "course", "script"), -1, "counted"),
        (("going_on", "course", "touched"), 10**9, "counted"),
        (("going_on", "course", "next_label"), 0, "counted"),
        (("going_on", "course", "next_label"), 2.0, "next_label"),
        (("going_on", "course", "out"), 10**6, "counted"),
        (("going_on", "course", "held"), ["extruder"], "called"),
        (("going_on", "course", "targets"), {"intruder": [1e300, 0.0]}, "further away"),
        (("going_on", "course", "targets"), {"extruder": [1.0, 0.0]}, "called"),
        (("going_on", "course", "notices"), ["x" * 200_000], "notices"),
        (("going_on", "course", "colour"), 3, "unknown"),
        (("going_on", "report", "reason"), "budget", "has not ended"),
        (("going_on", "report", "reason"), "boredom", "reason"),
        (("going_on", "report", "iterations"), True, "iterations"),
        (("going_on", "events"), [3], "events"),
        (("going_on", "hand_force"), "much", "hand_force"),
        (("going_on", "share"), "nan", "share"),
        (("going_on",), 3, "going_on"),
        (("speed",), 3, "unknown"),
    ],
)
def test_states_that_no_command_leads_to(
    copy: Path, where: tuple[str | int, ...], value: Any, why: str
) -> None:
    change(copy, "state", lambda data: at(*where[:-1])(data).__setitem__(where[-1], value))
    assert_refused(copy, why)


@pytest.mark.parametrize(
    ("template", "values"),
    [
        ("{x.__class__}", {"x": "a"}),
        ("{x[0]}", {"x": "a"}),
        ("{x!r}", {"x": "a"}),
        ("{x:>99999999999}", {"x": "a"}),
        ("{x:{y}}", {"x": "a", "y": "b"}),
        ("{y}", {"x": "a"}),
        ("{x:.2f}", {"x": "a"}),
        ("{x:grain|grains}", {"x": "a"}),
        ("{x:grain|{y}}", {"x": 1, "y": "b"}),
        ("{", {}),
        ("{x}", {"x": [1]}),
    ],
)
def test_templates_that_ask_for_more_than_their_values(
    copy: Path, template: str, values: dict[str, Any]
) -> None:
    text = {"text": "a", "template": template, "values": values}
    event = {"kind": "arch", "increment": 0, "stroke": 0.0, "force": 0.0, "text": text}
    change(copy, "state", lambda data: data["going_on"].update(events=[event]))
    assert_refused(copy, "events.0.text")
    values = {"x": 1.0, "y": "b", "n": 2}
    good = {"text": "a", "template": "{x:+.2f} of {y} {n:grain|grains}", "values": values}
    change(copy, "state", lambda data: data["going_on"].update(events=[{**event, "text": good}]))
    (kept,) = Session.from_file(read_scene(copy))._first.file.state.going_on.events  # type: ignore[union-attr]
    assert kept.text == "+1.00 of b grains"


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"\xff\xfe",
        b"PK\x03\x04",
        b"PK\x03\x04" + bytes(100),
        b"x = ",
        b"x = 1\nx = 2",
        b"x = " + b"[" * 100_000,
        b"x = 1" + b"0" * 10_000,
        b"[" + b"a." * 50_000 + b"a]",
    ],
    ids=["nothing", "bytes", "head", "zip", "half", "twice", "brackets", "digits", "dots"],
)
def test_files_that_are_none(copy: Path, text: bytes) -> None:
    copy.write_bytes(text)
    assert_refused(copy)


@pytest.mark.parametrize(
    "text", [b"", b"\xff", b"[" * 100_000, b"3", b'{"a": 1' + b"0" * 10_000 + b"}"]
)
@pytest.mark.parametrize("part", ["scene", "state"])
def test_texts_that_are_no_json(copy: Path, part: str, text: bytes) -> None:
    put(copy, {**parts(copy), f"{part}.json": text})
    assert_refused(copy)


def test_parts_that_nobody_knows(copy: Path) -> None:
    content = parts(copy)
    for name in ("../../evil.json", "more.json", "code.py", "state.more.npy", "before_edit.x.npy"):
        put(copy, {**content, name: content["state.json"]})
        if name.endswith(".npy"):
            put(copy, {**content, name: content["state.grains.label.npy"]})
        assert_refused(copy, "nobody knows")
    with zipfile.ZipFile(copy, "w") as archive:
        for name, part in content.items():
            archive.writestr(name, part)
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("scene.json", content["scene.json"])
    assert_refused(copy, "twice")
    with zipfile.ZipFile(copy, "w", zipfile.ZIP_BZIP2) as archive:
        for name, part in content.items():
            archive.writestr(name, part)
    assert_refused(copy, "packed in a way")


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_scene(tmp_path / "nothing.scene")
    with pytest.raises(InputError, match="no file"):
        read_scene(tmp_path)
    with pytest.raises(InputError):
        read_scene(tmp_path / "with\0zero.scene")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_a_pipe_is_not_waited_for(copy: Path) -> None:
    copy.unlink()
    os.mkfifo(copy)
    assert_refused(copy, "no file")


def test_files_that_are_too_large(copy: Path) -> None:
    content = parts(copy)
    put(copy, {**content, "state.json": b" " * ((1 << 25) + 1)})
    assert_refused(copy, "longer than any text")
    with copy.open("r+b") as file:
        file.truncate((1 << 28) + 1)
    assert_refused(copy, "larger than")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda a: a.pop("grains.state"), "not a readable packing"),
        (lambda a: a.update({"grains.state": a["grains.state"][:4]}), None),
        (lambda a: a["grains.state"].__setitem__((0, 0), np.nan), "finite"),
        (lambda a: a["grains.state"].__setitem__((0, 0), 500.0), "outside"),
        (lambda a: a["grains.state"].__setitem__((0, 0), -4.0), "outside"),
        (lambda a: a["grains.state"].__setitem__((0, 0), 1e8), "outside"),
        (lambda a: a["grains.state"].__setitem__((2, 0), 0.0), "flatter"),
        (lambda a: a["grains.state"].__setitem__((3, 0), 5.0), "flatter"),
        (lambda a: a["grains.state"].__setitem__((2, 0), 1e6), "longer"),
        (lambda a: a["grains.rest_radius"].__setitem__(0, 1e-3), "rest radii"),
        (lambda a: a["grains.rest_radius"].__setitem__(0, 1e3), "rest radii"),
        (lambda a: a["grains.rest_radius"].__setitem__(0, 0.1), "increment must be"),
        (lambda a: a["grains.poisson_ratio"].__setitem__(0, 1.0), "Poisson"),
        (lambda a: a["grains.poisson_ratio"].__setitem__(0, 0.999), "Poisson"),
        (lambda a: a["grains.contact_stiffness"].__setitem__(0, 1.0), "stiffness"),
        (lambda a: a["grains.contact_stiffness"].__setitem__(0, 1e300), "stiffness"),
        (lambda a: a["grains.label"].__setitem__(0, a["grains.label"][1]), "labels"),
        (lambda a: a.update({"grains.label": a["grains.label"].astype(float)}), "whole numbers"),
        (lambda a: a.update({"grains.box": np.array([30.0, 20.0, 0.0])}), "periodic cell"),
        (lambda a: a.pop("contact_keys"), "memory"),
        (lambda a: a.update(spin=a["spin"][1:]), "memory"),
        (lambda a: a.update(spin=np.full_like(a["spin"], np.inf)), "finite"),
        (lambda a: a.update(contact_keys=a["contact_keys"].astype(float)), "contact_keys"),
        (lambda a: a.update(contact_keys=np.array(3)), "memory"),
        (lambda a: a.update(contact_keys=np.arange(10_000)), "out of order"),
        (lambda a: a.update(contact_keys=np.array([2, 1])), "out of order"),
        (lambda a: a.update(spin=np.array([print], dtype=object)), "plain numbers"),
        (lambda a: a.pop("going_on.reactions"), "reactions"),
        (lambda a: a["going_on.reactions"].fill(np.nan), "reactions"),
        (lambda a: a.update({"going_on.displacement": np.zeros((5, 1))}), "displacement"),
        (lambda a: a.pop("going_on.history.increment"), "increment"),
        (lambda a: a["going_on.history.increment"].__setitem__(0, 3), "numbered"),
        (lambda a: a["going_on.history.stroke"].__setitem__(0, np.inf), "finite"),
        (lambda a: a.update({"going_on.history.fx": np.zeros(1)}), "one length"),
        (lambda a: a.update({"going_on.history.colour": np.zeros(1)}), "unknown column"),
        (lambda a: a["going_on.history.stop_reason"].fill("boredom"), "nobody knows"),
    ],
)
def test_grains_that_are_none(
    copy: Path, change: Callable[[Arrays], object], why: str | None
) -> None:
    rewrite(copy, change)
    assert_refused(copy, why)


def test_grains_in_one_heap(copy: Path) -> None:
    many = Packing(np.full(200, 10.0), np.full(200, 3.0))
    rewrite(copy, lambda a: a.update({f"grains.{n}": v for n, v in many.arrays().items()}))
    assert_refused(copy, "on top of one another")


def test_grains_that_would_fill_the_memory(copy: Path) -> None:
    content = parts(copy)
    put(copy, {**content, "state.spin.npy": bytes(200_000_000), "more.npy": bytes(200_000_000)})
    assert_refused(copy, "unpack to more")


def test_too_many_grains(copy: Path) -> None:
    many = np.arange(110_000.0)
    grains = Packing(many % 400, many // 400, 0.1).arrays()
    rewrite(copy, lambda a: a.update({f"grains.{n}": v for n, v in grains.items()}))
    assert_refused(copy, "more than a scene holds")


def test_the_cell_must_be_that_of_the_scene(tmp_path: Path) -> None:
    session = built("avalanches", grains=60)
    path = tmp_path / "it.scene"
    for box in (np.array([100.0, 100.0, 0.0]), np.array([12.0, np.inf, 0.0]), np.zeros(0)):
        write_scene(path, session.made())
        rewrite(path, partial(dict.update, **{"grains.box": box}))
        assert_refused(path, "periodic cell")


def test_walls_through_grains_are_no_danger(copy: Path) -> None:
    change(copy, "state", lambda data: data["walls"].__setitem__(1, [[9.0, 1.0], [30.0, 19.0]]))
    session = Session.from_file(read_scene(copy))
    session.build()
    drive(session, 2)
    session.run.setup.packing.validate()


def test_reading_gives_what_is_needed_and_runs_nothing(copy: Path) -> None:
    assert isinstance(read_scene(copy), SceneFile)
