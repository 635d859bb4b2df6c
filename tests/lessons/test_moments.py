"""What reads as the number that a lesson asks for is that number, whatever is behind its last digit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.draw.widgets.scale import shown
from sandbox.lessons.lesson import Condition
from sandbox.lessons.moments import FIGURES, PLACE_DECIMALS, Moment, met
from sandbox.session.frame import Frame
from tests.draw.frames import intruder_frame

FRAME = intruder_frame(6)
WANTED = st.floats(0.01, 999.0).map(lambda value: float(f"{value:.3g}"))
OFF = st.floats(-1.0, 1.0)  # of the last digit that is shown


def moment(frame: Frame) -> Moment:
    return Moment.of([frame], "kind")


def last_digit(value: float) -> float:
    return float(10.0 ** (np.floor(np.log10(value)) + 1 - FIGURES))


@given(WANTED, OFF)
def test_a_value_that_reads_so_is_so(wanted: float, off: float) -> None:
    value = wanted + off * last_digit(wanted)
    set_so = moment(replace(FRAME, settings={"friction": value}))
    felt = moment(replace(FRAME, curve_force=np.array([0.0, value])))
    before = moment(FRAME)
    if shown(value) == shown(wanted):
        assert met(Condition(setting="friction", below=wanted), before, set_so)
        assert met(Condition(force=wanted), before, felt)


@given(WANTED)
def test_what_reads_otherwise_is_not(wanted: float) -> None:
    digit = last_digit(wanted)
    before = moment(FRAME)
    above = moment(replace(FRAME, settings={"friction": wanted + digit}))
    weaker = moment(replace(FRAME, curve_force=np.array([0.0, wanted - digit])))
    assert shown(wanted + digit) != shown(wanted) != shown(wanted - digit)
    assert not met(Condition(setting="friction", below=wanted), before, above)
    assert not met(Condition(force=wanted), before, weaker)


@settings(max_examples=300)
@given(st.floats(-50.0, 50.0), st.floats(0.05, 5.0).map(lambda by: round(by, 2)))
@pytest.mark.parametrize("way", ["", "up"])
def test_a_place_given_in_the_digits_that_are_told_is_far_enough(
    way: str, start: float, by: float
) -> None:
    """As a screen reader gives it: what it was told of the start, and so much more."""
    handle = FRAME.handles[0]
    given_place = round(start, PLACE_DECIMALS) + by
    then, there, short = (
        moment(replace(FRAME, handles=(replace(handle, y=y),)))
        for y in (start, given_place, start + by - 3.0 * 10.0**-PLACE_DECIMALS)
    )
    condition = Condition(moved=handle.name, by=by, way=way)
    assert met(condition, then, there)
    assert not met(condition, then, short)
