"""The sweeps that the study of clogging is made of: which scene, along which axes, over how many seeds.

Under gravity the funnel is not shaken, so that a drain ends with its first clog. Protocols were set up with seeds 1 to 10; those
from ``FIRST`` on judge.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sandbox.sweep.asking import ask
from sandbox.sweep.request import Request

FIRST = 101
GRAVITY, PISTON = "gravity_hopper", "hopper"
STILL = {"shake": 0.0}
# To, Lai and Pak: 200 single-sized discs, a hopper whose sides stand at 34° to the vertical.
SINGLE = {**STILL, "size_ratio": 1.0, "angle": 56.0, "friction": 0.5}
# --quick: smaller hoppers. What they say of the large ones is little; that the study works, all.
QUICK = {"grains": 60, "width": 14.0}
QUICK_SEEDS = 20
USUAL_ORIFICE = 3.0
USUAL_HAND = 8.0


@dataclass(frozen=True)
class Part:
    """One sweep. ``quickly``: the axes with ``--quick``, where they are others."""

    name: str
    title: str
    scene: str
    axes: tuple[str, ...]
    settings: Mapping[str, float]
    packings: str = "mixed"
    seeds: int = 50
    quickly: tuple[str, ...] = ()
    small: Mapping[str, float] = field(default_factory=lambda: QUICK)  # settings with --quick

    def request(self, quick: bool) -> Request:
        """What the sweep is asked."""
        axes = (self.quickly or self.axes) if quick else self.axes
        seeds = min(self.seeds, QUICK_SEEDS) if quick else self.seeds
        varied = {axis.partition("=")[0] for axis in axes}
        small = {k: v for k, v in self.small.items() if k not in varied} if quick else {}
        settings = {**self.settings, **small}
        return ask(self.scene, axes, self.packings, f"{FIRST}:{FIRST + seeds - 1}", settings)


WIDTHS = Part(
    "widths",
    "Single-sized grains, orifice",
    GRAVITY,
    ("orifice=2:4:0.25",),
    SINGLE,
    "regular",
    100,
)
WIDE = Part(
    "wide",
    "The same, wide orifices: nearly all run empty, and take longest",
    GRAVITY,
    ("orifice=4.5,5",),
    SINGLE,
    "regular",
    20,
    ("orifice=5",),
)
SOFT = Part(
    "soft",
    "Single-sized grains, their weight: the heavier, the softer for it",
    GRAVITY,
    ("gravity=0.001,0.004,0.016,0.05",),
    {**SINGLE, "orifice": USUAL_ORIFICE},
    "regular",
    100,
    ("gravity=0.001,0.05",),
)
SHARES = Part(
    "shares",
    "Orifice and share of auxetic grains, under gravity",
    GRAVITY,
    ("orifice=2.5:4:0.5", "auxetic_fraction=0:1:0.25"),
    STILL,
    quickly=("orifice=2.5,3.5", "auxetic_fraction=0,0.5,1"),
)
STRENGTHS = Part(
    "strengths",
    "Orifice and strength of the hand, under the piston",
    PISTON,
    ("orifice=2,2.5,3", "hand_strength=2,4,8"),
    {},
    "regular,mixed,auxetic",
    quickly=("orifice=2,3", "hand_strength=2,8"),
)
# What the answer must not depend on, at a cell of each map: number of grains, how finely the path is cut, tolerance.
_HALF = {**STILL, "orifice": USUAL_ORIFICE, "auxetic_fraction": 0.5}
_PUSHED = {"orifice": 2.5, "hand_strength": USUAL_HAND}
SAME: tuple[tuple[Part, Part], ...] = tuple(
    (part, base)
    for base, parts in (
        (
            SHARES,
            (
                Part(
                    "drained_grains",
                    "N under gravity",
                    GRAVITY,
                    ("grains=100,400",),
                    _HALF,
                    quickly=("grains=40,90",),
                    small={"width": 14.0},
                ),
                Part("drained_fall", "Fall in an increment", GRAVITY, ("fall=0.05,0.2",), _HALF),
                Part("drained_tolerance", "Tolerance", GRAVITY, ("tolerance=0.001",), _HALF),
            ),
        ),
        (
            STRENGTHS,
            (
                Part(
                    "pushed_grains",
                    "N under the piston",
                    PISTON,
                    ("grains=150,600",),
                    _PUSHED,
                    "regular",
                    quickly=("grains=50,90",),
                    small={"width": 14.0},
                ),
                Part(
                    "pushed_step",
                    "Step of the piston",
                    PISTON,
                    ("step=0.025,0.1",),
                    _PUSHED,
                    "regular",
                ),
                Part(
                    "pushed_tolerance",
                    "Tolerance",
                    PISTON,
                    ("tolerance=0.001",),
                    _PUSHED,
                    "regular",
                ),
            ),
        ),
    )
    for part in parts
)
PARTS = (WIDTHS, WIDE, SOFT, SHARES, STRENGTHS, *(part for part, _ in SAME))
