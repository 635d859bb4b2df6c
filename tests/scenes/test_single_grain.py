"""One grain between plates, as a person sees it: the numbers by which the model is known, through the whole program.

Haver et al., doi:10.1073/pnas.2317915121, appendix "Single Particle Compression": λ = 0.01 … 100 at μ = 0.1.
"""

from __future__ import annotations

import numpy as np
import pytest

from core import material
from core.errors import InputError
from sandbox.session.commands import Grab, Move, Protocol
from sandbox.session.frame import Frame
from sandbox.session.session import Session

PAPER = (0.01, 0.1, 1.0, 10.0, 100.0)
TINY = 1e-3  # strain at which the response is linear to within about itself


def squeeze(kind: str, compression: float, **settings: object) -> Session:
    """A session whose script has brought the plates together by that share of a diameter, in ten increments."""
    radius = float(settings.get("radius", 1.0))  # type: ignore[arg-type]
    step = 2.0 * radius * compression / 10.0
    values = {"compression": compression, "step": step, **settings}
    session = Session("single_grain", kind, 1, values)
    session.build()
    session.submit(Protocol(True))
    while not session.idle:
        session.advance(20_000)
    assert len(session.history) == 11
    assert not [check for check in session.checks() if check.holds is False]
    return session


def drag(session: Session, height: float) -> None:
    """Pull the held plate to that height, and wait for the grains."""
    session.submit(Move("plate", 0.0, height))
    session.advance(20_000)
    while not session.idle:
        session.advance(20_000)


def paper_grain(ratio: float) -> tuple[str, dict[str, object]]:
    """Packing and settings of the paper's grain with λ = ``ratio``."""
    nu, stiffness = map(float, material.from_paper(ratio, 0.1))
    kind = "auxetic" if nu < 0.0 else "regular"
    return kind, {"poisson_ratio": abs(nu), "contact_stiffness": stiffness}


def half_axes(frame: Frame) -> tuple[np.ndarray, np.ndarray]:
    """Half of the height and of the width of each grain [R]."""
    return frame.p - frame.q1, frame.p + frame.q1


@pytest.mark.parametrize(
    ("ratio", "pressure", "secant"),
    [
        (0.01, 0.0951, -0.981),
        (0.1, 0.0961, -0.829),
        (1.0, 0.1000, -0.050),
        (10.0, 0.1046, 0.862),
        (100.0, 0.1060, 1.083),
    ],
)
def test_compressed_by_a_tenth(ratio: float, pressure: float, secant: float) -> None:
    """F/(2b) [k], and the width's strain over that of the plates. Half a unit of the last digit, 2 % of one for its rounding."""
    kind, settings = paper_grain(ratio)
    session = squeeze(kind, 0.1, **settings)
    _, width = half_axes(session.frame())
    assert session.history[-1].resisting / (2.0 * width[0]) == pytest.approx(pressure, abs=0.52e-4)
    assert (width[0] - 1.0) / 0.1 == pytest.approx(secant, abs=0.52e-3)


@pytest.mark.parametrize("radius", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("ratio", PAPER)
def test_linear_response(ratio: float, radius: float) -> None:
    """Every grain of every size: force/approach → 1 k, strains in the ratio ν = (λ−1)/(λ+1), to the order of the strain."""
    kind, settings = paper_grain(ratio)
    session = squeeze(kind, TINY, radius=radius, **settings)
    last = session.history[-1]
    assert last.stroke == pytest.approx(2.0 * radius * TINY, rel=1e-9)
    assert last.resisting / last.stroke == pytest.approx(1.0, abs=2.0 * TINY)
    height, width = half_axes(session.frame())
    nu = (ratio - 1.0) / (ratio + 1.0)
    assert -(width[0] - radius) / (height[0] - radius) == pytest.approx(nu, abs=1.5 * TINY)


def test_curves_of_all_sizes_fall_on_one() -> None:
    """At equal strain forces go as the radius."""
    curves = [
        squeeze("auxetic", 0.1, radius=radius).history.column("resisting") / radius
        for radius in (0.5, 1.0, 3.0)
    ]
    assert curves[0] == pytest.approx(curves[1], rel=1e-6, abs=1e-8)
    assert curves[2] == pytest.approx(curves[1], rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("kind", ["regular", "auxetic"])
def test_overlap_takes_its_share(kind: str) -> None:
    """2/C of the approach: 0.0400 at C = 50."""
    frame = squeeze(kind, TINY).frame()
    overlap = float(frame.contacts.force.sum()) / 50.0
    assert overlap / (2.0 * TINY) == pytest.approx(0.04, abs=0.04 * 2.0 * TINY)


@pytest.mark.parametrize(
    ("ratio", "digits"),
    [(0.01, 0.505), (0.1, 0.554), (1.0, 1.0), (10.0, 5.125), (100.0, 46.05)],
)
def test_compressed_from_all_sides(ratio: float, digits: float) -> None:
    """Four plates: F/(k δL), the whole contrast in compressibility. All plates feel the same force, on both sides."""
    kind, settings = paper_grain(ratio)
    session = squeeze(kind, TINY, four_plates=True, **settings)
    last = session.history[-1]
    assert last.resisting / last.stroke == pytest.approx(digits, rel=2.0 * TINY)
    assert session.frame().contacts.force == pytest.approx(np.full(4, last.resisting), rel=1e-6)
    height, width = half_axes(session.frame())
    assert width[0] == pytest.approx(height[0], rel=1e-9)


def test_one_of_each_side_by_side() -> None:
    """The mixed packing: both carry the same at first, one grows wide, the other narrow, and they never touch."""
    session = squeeze("mixed", 0.2)
    frame = session.frame()
    assert frame.poisson_ratio.tolist() == [0.8, -0.8]
    _, width = half_axes(frame)
    assert width[0] > 1.15
    assert width[1] < 0.85
    assert bool(frame.contacts.rigid.all())
    assert any("regular" in notice for notice in frame.notices)
    assert any("auxetic" in notice for notice in frame.notices)
    small = squeeze("mixed", TINY).frame().contacts.force
    assert small == pytest.approx(np.full(4, small.mean()), rel=4.0 * TINY)


@pytest.mark.parametrize("kind", ["regular", "auxetic", "mixed"])
def test_a_hand_on_the_top_plate_moves_all_four(kind: str) -> None:
    """And back: the plates let go, and the grains are circles again."""
    session = Session("single_grain", kind, 1, {"four_plates": True, "step": 0.02})
    session.build()
    start = session.frame()
    session.submit(Grab("plate"))
    drag(session, 1.9)
    squeezed = session.frame()
    height, width = half_axes(squeezed)
    assert width == pytest.approx(height, rel=1e-6)
    assert np.all(height < 0.97)
    drag(session, 2.0)
    end = session.frame()
    assert end.p == pytest.approx(start.p, abs=1e-6)
    for before, after in zip(start.bodies, end.bodies, strict=True):
        assert after.polygons[0] == pytest.approx(before.polygons[0], abs=1e-9)


def test_a_step_that_could_pass_a_grain_is_refused_at_once() -> None:
    with pytest.raises(InputError, match=r"step must be at most 0\.05"):
        Session("single_grain", "regular", 1, {"radius": 0.2, "step": 0.06})
