"""A single grain between plates: the numbers by which the model is known.

Haver et al., doi:10.1073/pnas.2317915121, appendix "Single Particle Compression": λ = 0.01 … 100 at μ = 0.1. The grain
is relaxed by the program among two or four flat walls; closed forms come from minimising its energy by hand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest

from core import material, observables
from core.packing import Packing
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld

PAPER = (0.01, 0.1, 1.0, 10.0, 100.0)
TINY = 1e-4  # strain at which the response is linear to within about itself


@dataclass(frozen=True)
class Squeezed:
    """The answer of a grain whose plates have come closer by ``approach`` [R]."""

    force: float  # on one plate [k R]
    approach: float  # [R]
    height: float  # semi-axis towards the plates [R]
    width: float  # the other one [R]
    overlap: float  # of both plates together [R]


def squeeze(
    nu: float, stiffness: float, strain: float, plates: int = 2, radius: float = 1.0
) -> Squeezed:
    """Compress a grain of rest radius ``radius`` [R] by ``strain`` of its diameter."""
    gap, long = radius * (1.0 - strain), 3.0 * radius
    sides = [(0.0, -gap), (0.0, gap), (-gap, 0.0), (gap, 0.0)][:plates]
    world = RigidWorld(
        [
            RigidBody(f"plate {k}", position=at, segments=[(-long, 0.0, long, 0.0, 0.0)])
            for k, at in enumerate(sides)
        ]
    )
    for body in world.bodies[2:]:
        body.angle = 0.5 * math.pi
    primitives, owner = world.primitives()
    packing = Packing([0.0], [0.0], radius, nu, stiffness)
    # Rounding of the overlaps alone leaves a residual of 1e-16 / overlap, some 1e-9 for the least strain and hardest grain.
    relaxation = Relaxation(
        packing, primitives, tolerance=1e-8, force_floor=1e-12, max_iterations=20_000
    )
    assert relaxation.run(20_000).reason is StopReason.CONVERGED
    relaxation.write_back()
    contacts = observables.body_contacts(packing, primitives)
    reactions = observables.reactions(contacts, owner, world.placement())
    vertical = [k for k in range(len(contacts.fx)) if abs(contacts.fy[k]) > abs(contacts.fx[k])]
    return Squeezed(
        force=float(reactions[1, 1]),
        approach=2.0 * radius * strain,
        height=float(packing.p[0] - packing.q1[0]),
        width=float(packing.p[0] + packing.q1[0]),
        overlap=float(contacts.overlap[vertical].sum()),
    )


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
    """P = F/(2b) [k] with b the half-width along the plates; Poisson's ratio as strain across over strain of the plates.

    Half a unit of the last digit, and 2 % of one for that digit's own rounding.
    """
    nu, stiffness = map(float, material.from_paper(ratio, 0.1))
    grain = squeeze(nu, stiffness, 0.1)
    assert grain.force / (2.0 * grain.width) == pytest.approx(pressure, abs=0.52e-4)
    assert (grain.width - 1.0) / 0.1 == pytest.approx(secant, abs=0.52e-3)


@pytest.mark.parametrize("ratio", PAPER)
def test_linear_response(ratio: float) -> None:
    """Force/approach → 1 k and the axes' ratio → ν for every grain. The next term is of the order of the strain."""
    nu, stiffness = map(float, material.from_paper(ratio, 0.1))
    grain = squeeze(nu, stiffness, TINY)
    assert grain.force / grain.approach == pytest.approx(1.0, abs=3.0 * TINY)
    assert -(grain.width - 1.0) / (grain.height - 1.0) == pytest.approx(nu, abs=3.0 * TINY)


@pytest.mark.parametrize("nu", [-0.8, 0.0, 0.8])
@pytest.mark.parametrize("radius", [1.0 / 1.4, 3.0])
def test_size_does_not_matter(nu: float, radius: float) -> None:
    """Stiffness is a force over a length, and in two dimensions every size has the same: at equal strain forces go as R0."""
    grain, unit = squeeze(nu, 50.0, 0.1, radius=radius), squeeze(nu, 50.0, 0.1)
    assert grain.force == pytest.approx(radius * unit.force, rel=1e-7)
    assert grain.width == pytest.approx(radius * unit.width, rel=1e-7)


@pytest.mark.parametrize("nu", [-0.8, 0.0, 0.8])
def test_overlap_takes_its_share(nu: float) -> None:
    """2/C of the approach is overlap, the rest deformation: 0.0400 at C = 50."""
    grain = squeeze(nu, 50.0, TINY)
    assert grain.overlap / grain.approach == pytest.approx(0.04, abs=0.04 * 3.0 * TINY)


@pytest.mark.parametrize(
    ("ratio", "digits"),
    [(0.01, 0.505), (0.1, 0.554), (1.0, 1.0), (10.0, 5.125), (100.0, 46.04)],
)
def test_compressed_from_all_sides(ratio: float, digits: float) -> None:
    """Four plates: F/(k δL) = C K/(2(2C + K)) with K = κ(1+ν), which tends to 1/(1−ν) for hard contacts.

    By hand: minimise 4·C/2 (δ − e)² + K e² over the strain e; the force is C (δ − e).
    """
    nu, stiffness = map(float, material.from_paper(ratio, 0.1))
    modulus = float(material.area_modulus(nu, stiffness))
    closed = stiffness * modulus / (2.0 * (2.0 * stiffness + modulus))
    grain = squeeze(nu, stiffness, TINY, plates=4)
    assert grain.force / grain.approach == pytest.approx(closed, rel=3.0 * TINY)
    assert closed == pytest.approx(digits, abs=0.5e-3 if digits < 10.0 else 0.5e-2)


@pytest.mark.parametrize("ratio", PAPER)
def test_hard_contacts(ratio: float) -> None:
    """C → ∞: 1/(1 − ν), the whole contrast in compressibility. The error is of the order K/(2C)."""
    nu = float(material.from_paper(ratio, 0.1)[0])
    stiffness = 1e9
    modulus = float(material.area_modulus(nu, stiffness))
    closed = stiffness * modulus / (2.0 * (2.0 * stiffness + modulus))
    assert closed * (1.0 - nu) == pytest.approx(1.0, abs=modulus / stiffness)


@pytest.mark.parametrize("nu", [-0.8, 0.0, 0.8])
@pytest.mark.parametrize("strain", [0.02, 0.1])
def test_energy_against_a_search(nu: float, strain: float) -> None:
    """The relaxed shape is the least energy of all shapes: by golden sections, over the height of the best width.

    A golden section finds the place of a minimum to about √1e-16.
    """
    stiffness = 50.0
    kappa = float(material.deformation_stiffness(nu, stiffness))

    def energy(height: float, width: float) -> float:
        overlap = max(0.0, height - (1.0 - strain))
        own = (1.0 + nu) * (height * width - 1.0) ** 2 + (1.0 - nu) * (height - width) ** 2
        return stiffness * overlap**2 + 0.25 * kappa * own

    def best_width(height: float) -> float:
        """Where d/dwidth of a quadratic vanishes."""
        return ((1.0 + nu) * height + (1.0 - nu) * height) / ((1.0 + nu) * height**2 + 1.0 - nu)

    low, high = 0.5, 1.2
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(80):
        first, second = high - golden * (high - low), low + golden * (high - low)
        if energy(first, best_width(first)) < energy(second, best_width(second)):
            high = second
        else:
            low = first
    grain = squeeze(nu, stiffness, strain)
    assert grain.height == pytest.approx(low, abs=1e-7)
    assert grain.width == pytest.approx(best_width(low), abs=1e-7)
