"""Two ellipses in your hands: the contact law against the exact contact. Haver et al., doi:10.1073/pnas.2317915121, "Ellipse
Overlap Approximation", with its expansion put right (``core.exact``). Nothing is relaxed here: shapes, places and tilts are
what the hand says, and only the overlap is measured.
"""

from __future__ import annotations

import math

import numpy as np

from core.exact import approximate_distance, contact_distance, parallel_expansion
from core.generate import Progress
from core.packing import Packing
from core.rigid import Point, RigidBody, RigidWorld
from core.settings import Settings
from scenes.checks import Check, Track
from scenes.parameter import Parameter
from scenes.registry import register
from scenes.remarks import Latest, Remarks
from scenes.scene import Curve, Handle, Ingredients, Scene, Setup, Values
from scenes.text import Text

GRAIN = "right grain"
TIPS = ("left tip", "right tip")
TURN = 2.5  # of the scripted drive, each increment [deg]
STEP = 0.1  # longest move of a grain or a tip in one increment; the script asks tips for less [R]
NEAREST = 0.2  # between the centres that a hand can ask for [R]
ROUNDING = 1e-12  # of a contact distance [R]
ALIKE = 1e-6  # a difference of tilts that counts as none [rad]


@register
class TwoEllipses(Scene):
    name = "two_ellipses"
    title = "Two ellipses"
    question = "When do two tilted ellipses begin to touch, and when does the model think so?"
    about = (
        "Drag the right grain, turn both by their tips. "
        "The contact law measures along the line of centres: never late, a little early."
    )
    default_steps = round(180.0 / TURN)
    handle_names = (GRAIN, *TIPS)
    parameters = (
        Parameter("aspect", 1.4, "", 1.0, 3.0, "length over width of both ellipses"),
        Parameter("radius", 1.0, "R", 0.4, 1.0, "mean radius of the right grain; the left has 1 R"),
        Parameter("tilt", 0.0, "deg", -90.0, 90.0, "of both to the line of centres, at the start"),
        Parameter("distance", 1.9, "R", 0.3, 8.0, "between the centres, at the start"),
        Parameter(
            "mirror", False, "", False, True, "tilt and turn the right grain the other way round"
        ),
        Parameter("contact_stiffness", 50.0, "k", 5.0, 1000.0, "force over overlap", live=True),
    )

    def ingredients(self, settings: Values) -> Ingredients:
        del settings
        return Ingredients(rigid=False)

    def build(
        self, settings: Values, packing: str, seed: int, progress: Progress | None = None
    ) -> Setup:
        del seed, progress  # nothing is random, nothing takes long
        # The kind has no part in it but the colour: contact is a matter of outlines.
        nu = {"regular": [0.8, 0.8], "auxetic": [-0.8, -0.8], "mixed": [0.8, -0.8]}[packing]
        distance = float(settings["distance"])
        sizes = np.array([1.0, float(settings["radius"])])
        stretch = math.sqrt(float(settings["aspect"]))
        tilt = math.radians(float(settings["tilt"]))
        tilts = [tilt, -tilt if bool(settings["mirror"]) else tilt]
        grains = Packing([0.0, distance], 0.0, sizes, nu, float(settings["contact_stiffness"]))
        grains.set_axes(sizes * stretch, sizes / stretch, tilts)
        bodies = [RigidBody(GRAIN, "body", position=(distance, 0.0), held=True)]
        for k, name in enumerate(TIPS):
            tip = _on_circle(grains, k, tilts[k])
            bodies.append(RigidBody(name, "body", position=tip, axis=_tangent(tilts[k])))
        longest = float(sizes.max()) * stretch
        left, far, half = -longest - 0.6, max(distance, 2.0) + longest + 0.6, 1.6 * longest
        world = RigidWorld(bodies)

        def reach(now: Packing, handle: str, asked: Point) -> Point:
            """Tips go round their grain; the grain stays in sight, and off the other's centre."""
            if handle in TIPS:
                k = TIPS.index(handle)
                toward = math.atan2(asked[1] - now.y[k], asked[0] - now.x[k])
                return _on_circle(now, k, toward)
            x, y = min(max(asked[0], left), far), min(max(asked[1], -half), half)
            apart = math.hypot(x, y)
            if apart < NEAREST:
                return (
                    (NEAREST, 0.0) if apart == 0.0 else (x * NEAREST / apart, y * NEAREST / apart)
                )
            return x, y

        return Setup(
            packing=grains,
            world=world,
            solver=Settings(step=STEP),
            handles=(
                Handle(GRAIN, "right grain", (-1.0, 0.0), 0.7 * float(sizes[1])),
                *(Handle(name, name, (0.0, 1.0), 0.35) for name in TIPS),
            ),
            bounds=(left, -half, far, half),
            outline=[(left, -half), (far, -half), (far, half), (left, half)],
            curve=Curve(
                "tilt of the left grain [deg]",
                "contact starts early by [% of a diameter]",
                lambda packing, _: math.degrees(tilts_to_line(packing)[0]) % 180.0,
                lambda packing, _: 50.0 * early(packing) / float(np.mean(packing.rest_radius)),
            ),
            follow=_follow,
            relaxes=False,
            reach=reach,
        )

    def drive(self, setup: Setup, settings: Values, increment: int) -> dict[str, Point] | None:
        """Both make half a turn, the same way or as mirror images."""
        if increment >= self.default_steps:
            return None
        turned = math.radians((increment + 1) * TURN)
        ways = (1.0, -1.0 if bool(settings["mirror"]) else 1.0)
        start = math.radians(float(settings["tilt"]))
        return {
            name: _on_circle(setup.packing, k, ways[k] * (start + turned))
            for k, name in enumerate(TIPS)
        }

    def remarks(self, setup: Setup, settings: Values, latest: Latest) -> Remarks:
        """Both overlaps, and for equal, equally tilted ellipses the expansion."""
        del settings, latest
        packing = setup.packing
        distance, angle = line_of_centres(packing)
        model = approximate_distance(packing, 0, 1, angle) - distance
        exact = contact_distance(packing, 0, 1, angle) - distance
        text = Text(
            "model: {model}, exact: {exact}, early by {early:.4f} R",
            model=_gap(model),
            exact=_gap(exact),
            early=model - exact,
        )
        if _parallel(packing) and packing.rest_radius[0] == packing.rest_radius[1]:
            a, b = (float(axes[0]) for axes in packing.semi_axes)
            late, soon = parallel_expansion(b, a / b - 1.0, tilts_to_line(packing)[0])
            formula = "{early} (b ε² sin² 2θ = {expansion:.4f} R)"
            text = Text(formula, early=text, expansion=soon - late)
        return Remarks((text,))

    def checks(self, setup: Setup, track: Track) -> list[Check]:
        return [*super().checks(setup, track), _never_late(track), _mirror(setup), _same(setup)]


def line_of_centres(packing: Packing) -> tuple[float, float]:
    """Distance [R] and direction [rad] from the left grain to the right one."""
    dx, dy = float(packing.x[1] - packing.x[0]), float(packing.y[1] - packing.y[0])
    return math.hypot(dx, dy), math.atan2(dy, dx)


def early(packing: Packing) -> float:
    """How much further apart the model sees the first touch than the outlines do [R]."""
    _, angle = line_of_centres(packing)
    return approximate_distance(packing, 0, 1, angle) - contact_distance(packing, 0, 1, angle)


def tilts_to_line(packing: Packing) -> tuple[float, float]:
    """Tilts of both longer axes to the line of centres, in [0, π) [rad]; a hair below π is 0."""
    _, angle = line_of_centres(packing)
    left, right = ((float(tilt) - angle) % math.pi for tilt in packing.angle)
    return left if left < math.pi - ALIKE else 0.0, right if right < math.pi - ALIKE else 0.0


def _tangent(angle: float) -> Point:
    return (-math.sin(angle), math.cos(angle))


def _on_circle(packing: Packing, k: int, angle: float) -> Point:
    """Where the tip of grain k is at that tilt [R]."""
    reach = float(packing.semi_axes[0][k])
    return (
        float(packing.x[k]) + reach * math.cos(angle),
        float(packing.y[k]) + reach * math.sin(angle),
    )


def _follow(packing: Packing, world: RigidWorld) -> None:
    """Grains where the hand has put them, tilted as the tips say; tips back on their circles, free to slide along them."""
    a, b = packing.semi_axes
    tilts = []
    for k, name in enumerate(TIPS):
        x, y = world[name].position
        tilts.append(math.atan2(y - packing.y[k], x - packing.x[k]))
    packing.state[:2, 1] = world[GRAIN].position
    if packing.x[1] == packing.x[0] and packing.y[1] == packing.y[0]:
        packing.state[0, 1] += 1e-3  # on its way through the other: there is no line of centres
    packing.set_axes(a, b, tilts)
    for k, name in enumerate(TIPS):
        tip = world[name]
        tip.position = tip.home = _on_circle(packing, k, tilts[k])
        tip.axis = _tangent(tilts[k])


def _gap(overlap: float) -> Text:
    if overlap > 0.0:
        return Text("overlap {size:.4f} R", size=overlap)
    return Text("gap {size:.4f} R", size=-overlap)


def _parallel(packing: Packing) -> bool:
    left, right = tilts_to_line(packing)
    return abs(math.sin(left - right)) < ALIKE


def _never_late(track: Track) -> Check:
    least, most = float(np.min(track.force)), float(np.max(track.force))
    return Check(
        "in the model contact never starts late",
        least >= -100.0 * ROUNDING,
        f"early by {max(least, 0.0):.3f} to {most:.3f} % of a diameter",
    )


def _mirror(setup: Setup) -> Check:
    """Exact for mirror images in the line of centres; a difference of tilts counts in full."""
    name = "mirror images touch where the model says"
    left, right = tilts_to_line(setup.packing)
    alike = setup.packing.rest_radius[0] == setup.packing.rest_radius[1]
    if not alike or abs(math.sin(left + right)) > ALIKE:
        return Check(name, None, "they are not mirror images now")
    off = early(setup.packing)
    return Check(name, off < ROUNDING + ALIKE, f"early by {off:.1e} R")


def _same(setup: Setup) -> Check:
    """Equal ellipses, equally tilted: early by b ε² sin² 2θ. What is left out is of the order ε³, with a factor below 3."""
    name = "equal tilts: early by b ε² sin² 2θ, to second order"
    packing = setup.packing
    alike = packing.rest_radius[0] == packing.rest_radius[1]
    if not alike or not _parallel(packing):
        return Check(name, None, "they are not equally tilted now")
    a, b = (float(axes[0]) for axes in packing.semi_axes)
    stretch = a / b - 1.0
    if stretch > 0.5:
        return Check(name, None, "too long for an expansion")
    exact, model = parallel_expansion(b, stretch, tilts_to_line(packing)[0])
    off = early(packing)
    return Check(
        name,
        abs(off - (model - exact)) < 3.0 * b * stretch**3 + ALIKE,
        f"early by {off:.4f} R, expansion {model - exact:.4f} R",
    )
