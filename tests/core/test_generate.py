"""Random packings: seeded, inside, with the numbers that were asked for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import generate, observables
from core.errors import InputError
from core.generate import Recipe, pack
from core.packing import PeriodicBox
from core.rigid import Point, RigidBody, RigidWorld, wall

SQUARE: list[Point] = [(0.0, 0.0), (14.0, 0.0), (14.0, 12.0), (0.0, 12.0)]
# A hopper, seen from inside: a funnel above a neck and a bin below, ten corners, four of them concave.
HOPPER: list[Point] = [
    (-7.0, 0.0), (7.0, 0.0), (7.0, 4.0), (2.0, 4.0), (2.0, 6.0),
    (7.0, 11.0), (7.0, 20.0), (-7.0, 20.0), (-7.0, 11.0), (-2.0, 6.0), (-2.0, 4.0), (-7.0, 4.0),
]  # fmt: skip


def walled(outline: list[Point], *others: RigidBody) -> RigidWorld:
    return RigidWorld([wall("walls", outline, 0.8, closed=True), *others])


def test_same_seed_same_bits() -> None:
    def make(seed: int) -> str:
        return pack(Recipe(), seed=seed, count=60, packing_fraction=0.9).hash()

    assert make(3) == make(3)
    assert make(3) != make(4)


@given(
    st.integers(0, 500),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
    st.sampled_from(generate.KINDS),
    st.integers(0, 9),
)
def test_numbers_are_exact(count: int, small: float, auxetic: float, kind: str, seed: int) -> None:
    """Sizes and kinds as asked, to one grain; also kinds among each size."""
    recipe = Recipe(kind=kind, small_fraction=small, auxetic_fraction=auxetic, size_ratio=1.4)
    radius, nu = recipe.grains(count, np.random.default_rng(seed))
    share = {"regular": 0.0, "auxetic": 1.0, "mixed": auxetic}[kind]
    assert abs(np.sum(radius < 1.0) - small * count) <= 0.5 + 1e-9
    assert abs(np.sum(nu < 0.0) - share * count) <= 1.0
    for size in (radius == 1.0, radius < 1.0):
        assert abs(np.sum(nu[size] < 0.0) - share * np.sum(size)) <= 1.0
    assert set(radius) <= {1.0, 1.0 / 1.4}
    assert set(nu) <= {-0.8, 0.8}


def test_mean_area_is_that_of_the_grains() -> None:
    recipe = Recipe(small_fraction=0.25, size_ratio=2.0)
    radius, _ = recipe.grains(400, np.random.default_rng(1))
    assert np.pi * np.mean(radius**2) == pytest.approx(recipe.mean_area())


@given(st.integers(1, 300), st.floats(0.0, 1.0), st.floats(1.0, 5.0), st.floats(0.0, 0.9))
def test_radii_are_spread_evenly(count: int, small: float, ratio: float, width: float) -> None:
    """Each size from 1 − width to 1 of it, without a random number: the area is that of the even spread."""
    recipe = Recipe(small_fraction=small, size_ratio=ratio, size_width=width)
    radius, nu = recipe.grains(count, np.random.default_rng(1))
    plain, same_nu = replace(recipe, size_width=0.0).grains(count, np.random.default_rng(1))
    assert np.array_equal(nu, same_nu)
    share = radius / plain
    assert np.all((share > 1.0 - width - 1e-12) & (share <= 1.0))
    assert np.all(radius >= recipe.smallest * (1.0 - 1e-12))
    for size in np.unique(plain):
        found = np.sort(share[plain == size])
        gap = width / len(found)
        assert np.diff(found) == pytest.approx(np.full(len(found) - 1, gap), abs=1e-9)
        assert found[-1] == pytest.approx(1.0 - 0.5 * gap)
    few = round(count * small) if ratio > 1.0 else 0
    kinds = [few, count - few]
    numbers = Recipe(small_fraction=kinds[0] / count, size_ratio=ratio, size_width=width)
    fewest = min((k for k in kinds if k), default=1)
    assert np.pi * np.mean(radius**2) == pytest.approx(
        numbers.mean_area(), rel=width**2 / (1.0 - width) / fewest**2 + 1e-12
    )


@pytest.mark.parametrize("kind", generate.KINDS)
@pytest.mark.parametrize("outline", [SQUARE, HOPPER], ids=["square", "hopper"])
def test_every_grain_is_inside(kind: str, outline: list[Point]) -> None:
    """Centres in the outline, and no grain deep in a wall: for a packing fraction of 0.9 the overlap share of the strain."""
    world = walled(outline)
    shares: list[float] = []
    packing = pack(
        Recipe(kind=kind),
        seed=5,
        outline=outline,
        world=world,
        packing_fraction=0.9,
        progress=shares.append,
    )
    assert np.all(generate.inside(outline, packing.x, packing.y))
    contacts = observables.body_contacts(packing, world.primitives()[0])
    assert len(contacts.overlap) > 10
    assert contacts.overlap.max() < 0.05
    area = generate.open_area(outline, world)
    assert packing.rest_area / area == pytest.approx(0.9, abs=0.6 * np.pi / area)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_room_is_left_for_bodies() -> None:
    intruder = RigidBody("intruder", "intruder", position=(4.0, 6.0), discs=[(0.0, 0.0, 2.5)])
    plate = RigidBody(
        "plate",
        "body",
        position=(10.0, 6.0),
        polygons=[(((0.0, 0.0), (2.0, 0.0), (0.0, 3.0)), 0.2)],
    )
    world = walled(SQUARE, intruder, plate)
    triangle = 3.0 + 0.2 * (5.0 + math.sqrt(13.0)) + math.pi * 0.2**2
    area = 14.0 * 12.0 - math.pi * 2.5**2 - triangle
    assert generate.open_area(SQUARE, world) == pytest.approx(area)
    packing = pack(Recipe(), seed=2, outline=SQUARE, world=world, packing_fraction=0.85)
    assert np.all(generate.inside(SQUARE, packing.x, packing.y))
    assert np.min(np.hypot(packing.x - 4.0, packing.y - 6.0)) > 2.5
    corners = [(float(x), float(y)) for x, y in plate.to_world([(0, 0), (2, 0), (0, 3)])]
    assert not np.any(generate.inside(corners, packing.x, packing.y))


@pytest.mark.parametrize("target", [0.002, 0.05])
@pytest.mark.parametrize("kind", generate.KINDS)
def test_target_pressure_in_a_box(kind: str, target: float) -> None:
    """The box gives way, grains keep their radii."""
    packing = pack(Recipe(kind=kind), seed=4, count=60, target_pressure=target)
    assert packing.box is not None
    contacts = observables.grain_contacts(packing)
    measured = observables.pressure(observables.stress(contacts, packing.box.area))
    assert measured == pytest.approx(target, rel=0.01)
    assert set(packing.rest_radius) == {1.0, 1.0 / 1.4}


def test_target_pressure_between_walls() -> None:
    """Walls stay, all grains grow or shrink alike. The force on the walls says the same: P = Σ F·n / perimeter, to within
    some grains' share of it, since the pressure inside fluctuates from grain to grain."""
    world = walled(SQUARE)
    packing = pack(Recipe(), seed=4, outline=SQUARE, world=world, target_pressure=0.05)
    primitives, _ = world.primitives()
    contacts = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, primitives)
    area = generate.open_area(SQUARE, world)
    stress = observables.stress(contacts, area, bodies, packing)
    assert observables.pressure(stress) == pytest.approx(0.05, rel=0.01)
    assert np.unique(packing.rest_radius).size == 2
    assert packing.rest_radius.max() / packing.rest_radius.min() == pytest.approx(1.4)
    wall_pressure = bodies.normal_force.sum() / 52.0
    assert wall_pressure == pytest.approx(0.05, rel=0.1)


def test_box_of_ones_own() -> None:
    box = PeriodicBox(16.0, 11.0, 3.0)
    packing = pack(Recipe(), seed=1, box=box, packing_fraction=0.86)
    assert packing.box == box
    assert packing.rest_area / box.area == pytest.approx(0.86, abs=0.6 * np.pi / box.area)


def test_a_number_of_grains_makes_its_box() -> None:
    packing = pack(Recipe(kind="auxetic"), seed=1, count=50, packing_fraction=0.8)
    assert packing.box is not None
    assert packing.rest_area / packing.box.area == pytest.approx(0.8, rel=1e-12)
    assert packing.auxetic.all()


def test_no_grains() -> None:
    assert len(pack(Recipe(), seed=1, outline=SQUARE, world=walled(SQUARE), count=0)) == 0


@given(
    st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=3, max_size=9),
    st.lists(st.tuples(st.floats(-4.0, 4.0), st.floats(-4.0, 4.0)), max_size=5),
)
def test_inside_is_an_odd_number_of_sides_to_the_right(
    corners: list[tuple[int, int]], points: list[Point]
) -> None:
    def odd(x: float, y: float) -> bool:
        crossed = 0
        for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
            if (y0 > y) != (y1 > y):
                crossed += x < x0 + (y - y0) * (x1 - x0) / (y1 - y0)
        return crossed % 2 == 1

    x, y = np.array(points).reshape(-1, 2).T
    outline = [(float(a), float(b)) for a, b in corners]
    assert generate.inside(outline, x, y).tolist() == [odd(*point) for point in points]


def test_inside_concave() -> None:
    x = np.array([0.0, 0.0, 5.0, -5.0, 5.0, 1.9, 8.0])
    y = np.array([1.0, 5.0, 5.0, 5.0, 15.0, 5.0, 5.0])
    expected = [True, True, False, False, True, True, False]
    assert generate.inside(HOPPER, x, y).tolist() == expected
    assert generate.inside(HOPPER[::-1], x, y).tolist() == expected


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"count": 10, "seed": -1}, "seed"),
        ({"count": 10, "packing_fraction": 0.0}, "packing fraction"),
        ({"count": 10, "packing_fraction": math.nan}, "packing fraction"),
        ({"count": 10, "packing_fraction": 2.0}, "packing fraction"),
        ({}, "outline"),
        ({"box": PeriodicBox(20.0)}, "outline"),
        ({"count": 40, "target_pressure": 0.0}, "pressure"),
        ({"count": 40, "target_pressure": -1.0}, "pressure"),
        ({"count": 40, "target_pressure": math.nan}, "pressure"),
        ({"count": -4}, "number of grains"),
        ({"count": 4}, "box is too small"),
        ({"count": 0}, "without grains"),
        ({"count": 0, "outline": SQUARE, "target_pressure": 0.1}, "no pressure"),
        (
            {"box": PeriodicBox(5.0, 5.0), "packing_fraction": 0.01, "target_pressure": 0.1},
            "no pressure",
        ),
    ],
)
def test_impossible_requests(request_: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        pack(Recipe(), **{"seed": 1, **request_})  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "recipe",
    [
        {"kind": "soft"},
        {"auxetic_fraction": 1.1},
        {"small_fraction": -0.1},
        {"size_ratio": 0.5},
        {"size_ratio": math.nan},
        {"size_ratio": math.inf},
        {"auxetic_fraction": math.nan},
        {"regular_poisson_ratio": 1.0},
        {"contact_stiffness": 2.0},
        {"size_width": 1.0},
        {"size_width": -0.1},
    ],
)
def test_impossible_recipes(recipe: dict[str, object]) -> None:
    with pytest.raises(InputError):
        pack(Recipe(**recipe), seed=1, count=40)  # type: ignore[arg-type]


def test_bodies_that_fill_the_container() -> None:
    world = walled(
        SQUARE, RigidBody("big", "intruder", position=(7.0, 6.0), discs=[(0.0, 0.0, 9.0)])
    )
    with pytest.raises(InputError, match="no room"):
        pack(Recipe(), seed=1, outline=SQUARE, world=world)


def test_too_many_grains() -> None:
    with pytest.raises(InputError, match="do not fit"):
        pack(Recipe(), seed=1, outline=SQUARE, world=walled(SQUARE), count=800)


@pytest.mark.parametrize("box", [None, PeriodicBox(22.0)], ids=["periodic", "walled"])
def test_few_large_grains_among_many_small_ones(box: PeriodicBox | None) -> None:
    """In the area of one large grain there is room for forty small ones and more, also where hardly any lie."""
    recipe = Recipe(size_ratio=20.0, small_fraction=0.995)
    outline: list[Point] | None = None
    if box is not None:
        outline = [(0.0, 0.0), (22.0, 0.0), (22.0, 22.0), (0.0, 22.0)]
    packing = pack(recipe, seed=1, count=2000, packing_fraction=0.1, outline=outline, box=box)
    assert len(packing) == 2000
    assert np.sum(packing.rest_radius == 1.0) == 10
    assert len(observables.grain_contacts(packing).i) == 0


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 1000),
    st.floats(1.0, 40.0),
    st.floats(0.0, 1.0),
    st.floats(0.02, generate.PLACED_FRACTION),
    st.sampled_from([1.0, 0.3]),
    st.integers(0, 99),
)
def test_any_mixture_is_placed(
    count: int, ratio: float, small: float, fraction: float, flat: float, seed: int
) -> None:
    """No disc touches another, around the edges of the cell neither; all pairs are looked at here."""
    recipe = Recipe(size_ratio=ratio, small_fraction=small)
    random = np.random.default_rng(seed)
    radius, _ = recipe.grains(count, random)
    area = max(float(np.pi * np.sum(radius**2)) / fraction, (4.0 / flat) ** 2)
    box = PeriodicBox(math.sqrt(area * flat), math.sqrt(area / flat))
    x, y = generate._place(radius, None, RigidWorld(), box, random)
    dx, dy = x[:, np.newaxis] - x, y[:, np.newaxis] - y
    dx -= box.width * np.rint(dx / box.width)
    dy -= box.height * np.rint(dy / box.height)
    gap = np.hypot(dx, dy) - radius[:, np.newaxis] - radius
    assert np.all(gap[~np.eye(count, dtype=bool)] >= 0.0)
