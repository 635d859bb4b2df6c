"""A batch of runs: each is told once, what fails and what is known before as well, and an interruption loses nothing."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import wait as wait_for
from typing import Any

import pytest

from core.errors import InputError
from sandbox.ensemble import batch
from sandbox.ensemble.batch import Batch, carry_out_all


def halve(number: int) -> int:
    if number == 5:
        raise InputError("five is odd")
    if number == 7:
        raise ZeroDivisionError("seven")
    return number // 2


class Told(dict[int, Any]):
    """What was told, by run."""

    def done(self, run: int, found: int) -> None:
        self[run] = found

    def failed(self, run: int, reason: str) -> str:
        self[run] = reason
        return f"failed: {reason}"

    def batch(self, *runs: int) -> Batch[int, int]:
        known = lambda run: self.get(8) if run == 9 else None  # noqa: E731
        return Batch(halve, runs, self.done, self.failed, known=known, unit="half")


def test_each_is_told_once(capsys: pytest.CaptureFixture[str]) -> None:
    told = Told()
    with ThreadPoolExecutor(1) as executor:
        carry_out_all(told.batch(8, 5, 9, 7, 2), executor, 1, found_before=3)
    assert told == {8: 4, 5: "five is odd", 9: 4, 7: "ZeroDivisionError: seven", 2: 1}
    assert list(told) == [8, 5, 9, 7, 2]
    said = capsys.readouterr().err
    assert "failed: five is odd" in said
    assert "8/8" in said


def test_an_interruption_keeps_all_that_has_finished(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(futures: Any, return_when: str) -> None:
        wait_for(futures)
        raise KeyboardInterrupt

    monkeypatch.setattr(batch, "wait", interrupted)
    told = Told()
    with ThreadPoolExecutor(2) as executor, pytest.raises(KeyboardInterrupt):
        carry_out_all(told.batch(2, 5, 6), executor, 2)
    assert told == {2: 1, 5: "five is odd"}
