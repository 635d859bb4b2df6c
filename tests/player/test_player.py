"""A page holds what was shown, asks for nothing, speaks every language, and works in a browser."""

from __future__ import annotations

import base64
import json
import re
import signal
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.cli import main as cli
from sandbox.draw.views import VIEWS
from sandbox.player import coding
from sandbox.player.coding import Writer, read, unpacked
from sandbox.player.kept import QUANTITIES
from sandbox.player.page import SCRIPTS, Look, page
from sandbox.player.pieces import as_json, asset
from sandbox.player.story import PLAYER, story
from sandbox.player.tape import Tape
from sandbox.record.record import in_step
from sandbox.session.commands import Protocol
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.session.session import Session
from sandbox.words import language
from tests.draw.frames import empty_frame, hopper_frame, periodic_frame
from tests.player.browser import PROGRAM, Browser
from tests.player.markup import Markup, asks_for

NEAR = 0.002  # [R]
EVENT = Event("locked", 2, 0.1, 0.2, "locked at 0.6 k R: 3 grains hold")


@pytest.fixture(scope="module")
def moments() -> list[list[Frame]]:
    """Two small packings side by side, at the start and after each of five increments."""
    settings = {"grains": 50, "intruder_radius": 2.0}
    sessions = [Session("intruder", kind, 3, settings) for kind in ("regular", "auxetic")]
    for session in sessions:
        session.build()
        session.submit(Protocol(True))
    shown = [[session.frame() for session in sessions]]
    for finished in in_step(sessions):
        if finished:
            events = (EVENT,) if len(shown) > 1 else ()
            shown.append([replace(session.frame(), events=events) for session in sessions])
        if len(shown) == 6:
            break
    return shown


def taped(moments: Sequence[Sequence[Frame]], **options: int) -> Tape:
    tape = Tape(**options)
    for frames in moments:
        tape.add(frames)
    return tape


def recorded(text: str) -> tuple[dict[str, Any], bytes]:
    found = re.search(r'id="recording">([^<]+)<', text)
    assert found
    return unpacked(base64.b64decode(found[1]))


def test_every_view_with_a_measure_has_it_on_the_page() -> None:
    """A page measures by itself; without a measure it would stay blank."""
    table = re.search(r"const MEASURES = \{\n(.*?)\n\};", asset("unpack.js"), re.DOTALL)
    assert table
    measured = set(re.findall(r"^ +(\w+)(?::|,$)", table[1], re.MULTILINE))
    expected = {view.name for view in VIEWS.values() if view.measure}
    where = "MEASURES of sandbox/player/assets/unpack.js"
    assert not expected - measured, f"add {sorted(expected - measured)} to {where}"
    assert not measured - expected, f"no view has what is in {where}: {sorted(measured - expected)}"


def test_runs_of_one_packing_are_told_apart(moments: list[list[Frame]]) -> None:
    """By what is set otherwise in them: in the story and above their pictures, and their curves by dashes."""
    one = moments[0][0]
    other = replace(one, settings={**one.settings, "friction": 0.5})
    tape = taped([[one, other]])
    head, _ = recorded(page(tape))
    titles = [pane["title"][0] for pane in head["panes"]]
    assert titles == [f"friction {value:g}" for value in (one.settings["friction"], 0.5)]
    assert head["panes"][0]["dash"] != head["panes"][1]["dash"]
    assert " and ".join(titles) in story(tape)[0]


def test_what_is_read_back_is_what_was_shown(moments: list[list[Frame]]) -> None:
    head, blocks = recorded(page(taped(moments)))
    assert head["increments"] == [0, 1, 2, 3, 4, 5]
    for number, pane in enumerate(head["panes"]):
        grains = {name: read(blocks, pane["grains"][name]) for name in QUANTITIES}
        force, i, j = (read(blocks, pane["contacts"][name]) for name in ("force", "i", "j"))
        top = head["tops"]["chains"]
        for t, frames in enumerate(moments):
            frame = frames[number]
            at = np.searchsorted(pane["grains"]["labels"], frame.label)
            for name in ("x", "y", "p", "q1", "q2"):
                assert np.abs(grains[name][t, at] - getattr(frame, name)).max() < NEAR, name
            assert np.abs(grains["nu"][t, at] - frame.poisson_ratio).max() < 1e-3
            contacts = frame.contacts
            bears = contacts.force > 0
            assert np.count_nonzero(force[t]) == np.count_nonzero(bears)
            assert np.count_nonzero((force[t] > 0) & (j[:, 0] < 0)) == np.count_nonzero(
                bears & contacts.rigid
            )
            assert force[t].sum() == pytest.approx(contacts.force.sum(), rel=0.02, abs=top / 100)
            assert set(i[force[t] > 0, 0].astype(int)) <= set(at.tolist())
        curve = read(blocks, pane["force"])[:, 0]
        last = moments[-1][number].curve_force
        assert np.abs(curve - last).max() <= np.ptp(last) / 4000


def test_the_story_ends_with_all_that_was_said(moments: list[list[Frame]]) -> None:
    said = ("regular: wider", "auxetic: narrower")
    told = story(taped([[replace(moments[0][0], notices=said)]]))
    assert told[1].endswith("At the end: regular: wider. Auxetic: narrower.")


def test_numbers_of_any_size_and_gaps_come_back() -> None:
    rng = np.random.default_rng(1)
    values = rng.normal(0.0, [[0.01, 1.0, 300.0, 1e5]], (40, 4))
    values[3:6, 1] = np.nan
    values[0, 2] = np.inf
    writer = Writer()
    blocks = [writer.block(values, 0.01), writer.block(-values, 0.5)]
    head, data = unpacked(writer.packed({"text": "ν “x”"}))
    assert head == {"text": "ν “x”"}
    whole = coding.carried(values)
    assert (whole[3:6, 1] == values[2, 1]).all()
    assert whole[0, 2] == 0.0
    for sign, block in zip((1, -1), blocks, strict=True):
        assert np.abs(read(data, block) - sign * whole).max() <= 0.5 * block[4] + 1e-9


def test_grains_come_and_go_and_time_goes_back() -> None:
    frame = hopper_frame()
    fewer = replace(
        frame,
        **{
            name: getattr(frame, name)[3:]
            for name in ("x", "y", "p", "q1", "q2", "rest_radius", "poisson_ratio", "label")
        },
        **{name: getattr(frame, name)[3:] for name in ("pressure", "stress_difference", "spin")},
        motion=frame.motion[:, 3:],
        increment=frame.increment + 1,
    )
    tape = taped([[frame], [fewer]])
    head, blocks = recorded(page(tape))
    there = read(blocks, head["panes"][0]["grains"]["there"])
    assert there.sum(axis=1).tolist() == [frame.grains, frame.grains - 3]
    tape.add([replace(frame, x=frame.x + 1.0)])  # the first increment once more
    assert [kept[0].increment for kept in tape.moments] == [frame.increment]
    assert tape.moments[0][0].grains[0, 0] == pytest.approx(frame.x[0] + 1.0)


@pytest.mark.parametrize("increments", [1, 7, 8, 9, 37])
def test_beyond_its_budget_a_tape_is_thinned_and_keeps_the_ends(increments: int) -> None:
    tape = taped([[empty_frame(increment=k)] for k in range(increments + 1)], most_moments=8)
    kept = [moment[0].increment for moment in tape.moments]
    assert len(kept) <= 9
    assert kept[0] == 0
    assert kept[-1] == increments
    assert set(np.diff(kept[:-1])) <= {tape.every}
    assert (tape.every > 1) == (increments > 7)


LOST = hopper_frame()  # its numbers went bad


@pytest.mark.parametrize(
    "frame", [empty_frame(), periodic_frame(), replace(LOST, x=LOST.x * np.nan)]
)
def test_odd_frames_make_a_page(frame: Frame) -> None:
    head, blocks = recorded(page(taped([[frame]])))
    there = read(blocks, head["panes"][0]["grains"]["there"])
    assert there.sum() == np.isfinite(frame.x).sum()
    assert (head["panes"][0]["box"] is not None) == (frame.box is not None)


# -- the page as text --


@pytest.fixture(scope="module")
def text(moments: list[list[Frame]]) -> str:
    return page(taped(moments), Look(theme="light", language="de"))


def test_no_text_can_be_taken_for_markup_in_a_script() -> None:
    bad = "</script><!--<script>"
    assert "<" not in as_json({bad: [bad]})
    assert json.loads(as_json({bad: [bad]})) == {bad: [bad]}


def test_nothing_is_asked_for(text: str) -> None:
    assert asks_for(text) == []
    assert not Markup(text).all("a", "img")


def test_every_word_of_the_page_is_there_in_every_language(text: str) -> None:
    asked = set()
    for name in SCRIPTS:
        asked |= set(re.findall(r'\bword\("([a-z_]+)"[,)]', asset(name)))
    asked |= {f"event_{kind}" for kind in ("locked", "clog", "arch", "avalanche")}
    found = re.search(r"const PAGE = (\{.+\});", text)
    assert found
    tables = json.loads(found[1])["words"]
    assert len(tables) == len(language.available())
    for table in tables:
        assert asked <= set(table)
    assert asked - set(tables[0]) == set()
    stories = [a for _, a in Markup(text).found if "data-said" in a]
    assert [(a["lang"], "hidden" in a) for a in stories] == [
        (code, code != "de") for code in language.available()
    ]
    assert "Locked" not in text
    assert "Schritt 2: Verkeilt" in text or "Schritt 2: " in text
    head, _ = recorded(text)
    for said in (head["texts"], [view["title"] for view in head["views"]]):
        assert all(len(each) == len(tables) and all(each) for each in said)


def test_who_hears_the_page_finds_the_way(text: str) -> None:
    markup = Markup(text)
    ids = [a["id"] for _, a in markup.found if "id" in a]
    assert len(ids) == len(set(ids))
    assert markup.all("html")[0]["lang"] == "de"
    assert len(markup.all("h1")) == len(markup.all("main")) == len(markup.all("title")) == 1
    named = set(re.findall(r'\$\("([a-z-]+)"\)', "".join(map(asset, SCRIPTS))))
    assert named <= set(ids)
    for attribute in ("for", "aria-labelledby", "aria-describedby", "aria-controls"):
        assert {a[attribute] for _, a in markup.found if attribute in a} <= set(ids)
    for canvas in markup.all("canvas"):
        assert canvas["role"] == "img"
    assert [a["role"] for _, a in markup.found if a.get("id") == "live"] == ["status"]
    assert all(button["type"] == "button" for button in markup.all("button"))


# -- the page in a browser --


@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium here")
@pytest.mark.end_to_end
def test_in_a_browser(moments: list[list[Frame]], text: str, tmp_path: Path) -> None:
    path = tmp_path / "run.html"
    path.write_text(text, encoding="utf-8")
    with Browser(tmp_path / "profile") as browser:
        browser.ask(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-reduced-motion", "value": "reduce"}],
        )
        browser.open(path)
        assert browser.run("sandboxPlayer.state.moment") == 0  # little motion: it waits
        assert not browser.run("sandboxPlayer.state.playing")
        browser.run("document.getElementById('time').focus()")
        before = browser.run("sandboxPlayer.run.panes[0].canvas.toDataURL()")
        browser.run(
            "const time = document.getElementById('time'); time.value = 4;"
            "time.dispatchEvent(new Event('input', {bubbles: true}))"
        )
        assert browser.run("sandboxPlayer.state.moment") == 4
        assert browser.run("sandboxPlayer.run.panes[0].canvas.toDataURL()") != before
        for number, frame in enumerate(moments[4]):
            for name in ("x", "y", "p", "q1", "q2"):
                shown = browser.run(
                    f"(pane => Array.from(pane.{name}.subarray(4 * pane.count, 5 * pane.count)))"
                    f"(sandboxPlayer.run.panes[{number}])"
                )
                assert np.abs(np.array(shown) - getattr(frame, name)).max() < NEAR
            force = browser.run(
                f"(pane => Array.from(pane.bearing.subarray(4 * pane.pairs, 5 * pane.pairs)))"
                f"(sandboxPlayer.run.panes[{number}])"
            )
            assert sum(force) == pytest.approx(frame.contacts.force.sum(), rel=0.02)
        press = (
            "([key, code]) => document.body.dispatchEvent("
            "new KeyboardEvent('keydown', {key, code, bubbles: true}))"
        )
        keys = [[key, ""] for key in ("v", "f", "t", "i", "i", "Home", "N", "n")]
        keys += [["д", "KeyL"]] * (len(language.available()) - language.available().index("de"))
        browser.run(f"{json.dumps(keys)}.forEach({press})")
        assert browser.run("document.documentElement.lang") == "en"
        assert browser.run("document.documentElement.dataset.theme") == "dark"
        assert browser.run("sandboxPlayer.state.moment") == EVENT.increment
        assert browser.run("document.querySelector('#grain h2').textContent").startswith("grain ")
        for at, code in enumerate(language.available()):
            with language.speaking(code):
                told = {"packing": "A", "view": "B", "force": "C", "notice": "D"}
                for count in (1, 2, 5, 11, 21):
                    values = {"count": count, **told}
                    said = browser.run(f"language = {at}; word('picture', {json.dumps(values)})")
                    assert said == PLAYER["picture"].format(**values)
        assert browser.messages == []


def test_record_writes_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run.html"
    assert cli.main(["record", "grain_row", "--steps", "6", "--every", "2", "--out", str(out)]) == 0
    assert "4 pictures" in capsys.readouterr().out
    head, _ = recorded(out.read_text(encoding="utf-8"))
    assert head["increments"] == [0, 2, 4, 6]
    assert cli.main(["record", "grain_row", "--out", str(tmp_path / "run.htm"), "--view", "x"]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["run.html"]


def test_ctrl_c_leaves_a_whole_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add = Tape.add

    def press(tape: Tape, frames: Sequence[Frame]) -> None:
        add(tape, frames)
        if tape.increments == 3:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Tape, "add", press)
    out = tmp_path / "run.html"
    assert cli.main(["record", "grain_row", "--out", str(out)]) == 130
    head, _ = recorded(out.read_text(encoding="utf-8"))
    assert head["increments"] == [0, 1, 2, 3]
    assert [path.name for path in tmp_path.iterdir()] == ["run.html"]
