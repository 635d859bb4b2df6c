"""The page of a scene as one self-contained file: kernels, packings, words and scripts. It asks for nothing."""

from __future__ import annotations

import base64
import html
import zlib
from dataclasses import dataclass, replace
from typing import Any

from sandbox.draw.lamp import ROUGH
from sandbox.draw.theme import packing_dash
from sandbox.draw.views import VIEWS
from sandbox.lessons import tours
from sandbox.player.page import about
from sandbox.player.pieces import as_json, asset, colours, document, marked, policy, spoken
from sandbox.player.recording import view_of
from sandbox.web.increment import course, curve
from sandbox.web.increment.memory import COLUMNS, COUNTS, FIRST_INT, PART, ROW, SAID, SIZES
from sandbox.web.increment.systems import PLACES
from sandbox.web.laid_out import CURVES, Blocks
from sandbox.web.packed import packed
from sandbox.web.sentences import ALL, EVENTS, Sentence, said_in
from sandbox.web.toolchain import PAGE
from sandbox.words import language, words
from sandbox.words.language import available, in_each, speaking
from scenes.scene import HAND_STRENGTH, STRONGEST, Scene, Setup, Values

DRAWING = (
    *("manners.js", "unpack.js", "speak.js", "grains.js", "scenery.js", "plot.js"),
    "legend.js",
)
# The window's words that the page says too.
SPOKEN = (
    *("settled", "force_error", "handle_force_error", "handle_force_within", "within", "no_forces"),
    *("unknown_forces", "settling", "grains_out", "hand_limit", "panel_seed", "squeezed", "paused"),
)
# And of the page that plays a run.
SHARED = (
    *("view", "choices", "stage", "chains", "to_light", "to_dark", "increment", "events", "keys"),
    *("letters", "noscript", "cannot_run", "silent", "unknown_seed", "play", "pause"),
)
# Steps of a tour that can be done on the page, where others ask for what cannot be changed there.
STEPS = {"gravity_hopper": (0, 2), "intruder": (0, 1, 2), "single_grain": (0, 1, 2)}
REASONS = (
    *("converged", "budget", "not finite", "collapsed", "budget"),
    *("iteration limit", "sunk"),
)  # by the kernels' numbers
LEVELS = {"converged": 0, "budget": 1, "iteration limit": 1}  # of the lamp; all others 2


@dataclass(frozen=True)
class Slide:
    """A slider: a parameter, how far it goes, and the entry of the kernels that sets it."""

    name: str
    least: float
    most: float
    step: float
    command: tuple[str | int, ...]  # with its values: numbers, or the names of parameters

    def called(self, settings: Values) -> tuple[str, list[float]]:
        """The entry and its values."""
        entry, *given = self.command
        return str(entry), [float(settings[v]) if isinstance(v, str) else v for v in given]


SLIDES = (
    Slide(HAND_STRENGTH, 1.0, 41.0, 0.5, ("set_strength", HAND_STRENGTH)),
    Slide("friction", 0.0, 1.5, 0.05, ("set_friction", "friction")),
    Slide("gravity", 0.001, 0.05, 0.001, ("set_weight", "gravity", "fall")),
    Slide("fall", 0.01, 0.3, 0.01, ("set_weight", "gravity", "fall")),
    Slide("poisson_ratio", 0.0, 0.95, 0.05, ("set_ratios", "poisson_ratio")),
    Slide("regular_poisson_ratio", 0.0, 0.95, 0.05, ("set_ratio", 0, "regular_poisson_ratio")),
    Slide("auxetic_poisson_ratio", -0.95, -0.05, 0.05, ("set_ratio", 1, "auxetic_poisson_ratio")),
)
# Of a hand that locks at less.
WEAK = Slide(HAND_STRENGTH, 0.05, 2.05, 0.05, ("set_strength", HAND_STRENGTH))
SHARE, SHARES = "auxetic_fraction", (0.25, 0.5, 0.75)  # of a mixed packing
SHARED_PACKING = "mixed"


@dataclass(frozen=True)
class Built:
    """A scene with packings of several seeds, as they are before the first increment: those of one, and all laid out.

    After those of ``packings`` come the mixed ones with the other ``shares`` of auxetic grains.
    """

    scene: Scene
    settings: Values
    packings: tuple[str, ...]
    seeds: tuple[int, ...]
    shares: tuple[float, ...]
    setups: tuple[Setup, ...]  # handles and labels are the same in all, bodies in all of a packing
    blocks: tuple[tuple[Blocks, ...], ...]  # by seed and packing

    def of_first(self, count: int) -> Built:
        """The same with no more than so many seeds."""
        return replace(self, seeds=self.seeds[:count], blocks=self.blocks[:count])


def page(built: Built, kernels: bytes, scripts: dict[str, str], menu: str = "") -> str:
    """The HTML text. ``menu`` is markup before the choices. Raises InputError for a scene that a page cannot run."""
    about_packings, packings = packed(built.blocks)
    script = (
        f'"use strict";\nconst PAGE = {as_json(about(_words, "page_keys"))};\n'
        f"const PLURALS = [{', '.join(map(_plural, available()))}];\n"
        f"const LIVE = {as_json(_live(built, about_packings))};\n"
        f"const WORKER = {as_json(scripts['worker.ts'])};\n"
        + "\n".join(asset(name) for name in DRAWING)
        + "\n"
        + scripts["page.ts"]
    )
    code = language.present()
    with speaking(code):
        values = {
            "language": code,
            "policy": _policy(script),
            "title": html.escape(words.title(built.scene.name)),
            "question": html.escape(words.question(built.scene.name)),
            "style": "\n".join(
                [colours(), asset("player.css"), (PAGE / "page.css").read_text(encoding="utf-8")]
            ),
            "menu": menu,
            "dragged": _dragged(built, code),
            "story": _tour(built.scene, code),
            "noscript": html.escape(_words(code)["noscript"]),
            "kernels": _packed(kernels),
            "packings": _packed(packings),
            "script": script,
        }
    return document((PAGE / "page.html").read_text(encoding="utf-8"), values)


def _tour(scene: Scene, shown: str) -> str:
    """What the scene's tour says, to be read; why is told to who asks."""
    steps = tours.steps(scene.name)
    if not steps:
        return ""
    steps = tuple(steps[k] for k in STEPS.get(scene.name, range(len(steps))))

    def told() -> str:
        return "".join(
            f'<li><p>{html.escape(str(step.say))}</p><p class="do">{html.escape(str(step.do))}</p>'
            f"<details><summary>{html.escape(words.TOUR_WHY)}</summary><p>{html.escape(str(step.why))}</p></details></li>"
            for step in steps
        )

    title = spoken(lambda: words.TOUR, shown)
    return f'<section class="card"><h2>{title}</h2>{marked(told, shown, "ol")}</section>'


def _dragged(built: Built, shown: str) -> str:
    """What is otherwise than on the desk, where a disc is dragged."""
    if not any(body.held for body in built.setups[0].world.bodies):
        return ""
    return f'<p class="soft">{spoken(lambda: words.DISC_STRAIGHT, shown)}</p>'


def _policy(script: str) -> str:
    """As of a page that plays a run, and it may compile kernels and have workers of its own making."""
    return (
        policy(script).replace("script-src ", "script-src 'wasm-unsafe-eval' ")
        + "; worker-src blob:"
    )


def _packed(content: bytes) -> str:
    return base64.b64encode(zlib.compress(content, 9)).decode("ascii")


def _live(built: Built, packings: dict[str, Any]) -> dict[str, Any]:
    """What the script knows of the scene: see ``live.ts``."""
    scene, setup = built.scene, built.setups[0]
    handle = setup.handles[0]
    body = setup.world[handle.body]
    stroke = float(built.settings.get("stroke", 1.0))
    strength = float(built.settings.get(HAND_STRENGTH, 1.0))
    own = setup.curve is not None  # then nobody knows yet how far it goes
    counts = CURVES.get(scene.name) == curve.GRAINS_OUT
    said = said_in(scene.name)
    return {
        "scene": scene.name,
        "languages": available(),
        "layout": {
            "part": PART._asdict(),
            "sizes": SIZES._asdict(),
            "counts": COUNTS._asdict(),
            "row": ROW._asdict(),
            "firstInt": getattr(PART, FIRST_INT),
            "columns": PLACES,
            "said": SAID._asdict(),
            "sentence": COLUMNS,
        },
        "labels": {
            "force": in_each(lambda: words.say(setup.force_label)),
            "stroke": in_each(lambda: words.say(setup.stroke_label)),
        },
        "title": in_each(lambda: words.title(scene.name)),
        "question": in_each(lambda: words.question(scene.name)),
        "about": in_each(lambda: words.about(scene.name)),
        "views": [view_of(view, {}) for view in VIEWS.values()],
        "packings": [
            _packing(name, setup) for name, setup in zip(built.packings, built.setups, strict=False)
        ],
        "seeds": built.seeds,
        "counts": counts,
        "plotsHand": not own,
        "axes": [60.0, 5.0]
        if counts
        else [1.0, 0.01]
        if own or strength >= STRONGEST
        else [stroke, 1.2 * strength],
        "handle": {
            "body": setup.world.index(handle.body),
            "label": in_each(lambda: words.say(handle.label)),
            "axis": body.axis,
        },
        "sliders": sliders(scene, built.settings),
        "share": _share(built),
        "commands": {
            "grab": course.GRAB,
            "move": course.MOVE,
            "release": course.RELEASE,
            "scriptOn": course.SCRIPT_ON,
            "scriptOff": course.SCRIPT_OFF,
        },
        "tolerance": setup.solver.tolerance,
        "rough": ROUGH,
        "reasons": [_reason(reason) for reason in REASONS],
        "sentences": [
            _sentence(sentence, handle.label) if number in said else None
            for number, sentence in enumerate(ALL)
        ],
        "events": EVENTS,
        "machine": STRONGEST,
        "lockedAfter": course.LOCKED_AFTER,
        "packed": packings,
        "start": {"theme": "dark", "auto": True},
    }


def _reason(reason: str) -> dict[str, Any]:
    return {"text": in_each(lambda: words.STOPPED[reason]), "level": LEVELS.get(reason, 2)}


def _sentence(sentence: Sentence, handle: str) -> dict[str, Any]:
    return {"text": in_each(lambda: sentence.text(handle)), "values": sentence.values}


def _packing(name: str, setup: Setup) -> dict[str, Any]:
    return {
        "name": name,
        "title": in_each(lambda: words.PACKINGS.get(name, name)),
        "dash": packing_dash(name),
        "bounds": setup.bounds,
        "width": None if setup.packing.box is None else setup.packing.box.width,
        "radius": setup.handles[0].radius,
        "bodies": [
            {
                "role": body.role,
                "discs": [v for row in body.discs for v in row],
                "segments": [v for row in body.segments for v in row],
                "polygons": [[v for at in corners for v in at] for corners, _ in body.polygons],
            }
            for body in setup.world.bodies
        ],
    }


def sliders(scene: Scene, settings: Values) -> list[dict[str, Any]]:
    """Those of the scene, as ``live.ts`` knows them."""
    return [_slider(scene, settings, slide) for slide in SLIDES if slide.name in settings]


def _share(built: Built) -> dict[str, Any] | None:
    """The share of auxetic grains, as ``live.ts`` knows it."""
    if not built.shares:
        return None
    begun, here = float(built.settings[SHARE]), built.packings.index(SHARED_PACKING)
    values = sorted((begun, *built.shares))
    others = len(built.packings)
    return {
        "name": SHARE,
        "title": in_each(lambda: f"{words.parameter_name(SHARE)} · {words.REBUILDS}"),
        "values": values,
        "at": values.index(begun),
        "packing": here,
        "places": [here if v == begun else others + built.shares.index(v) for v in values],
    }


def _slider(scene: Scene, settings: Values, slide: Slide) -> dict[str, Any]:
    if slide.name == HAND_STRENGTH and float(settings[slide.name]) < slide.least:
        slide = WEAK
    parameter = next(p for p in scene.parameters if p.name == slide.name)
    top = in_each(lambda: words.TOPS[slide.name]) if slide.name in words.TOPS else None
    return {
        "name": slide.name,
        "title": in_each(lambda: words.parameter_name(slide.name)),
        "unit": parameter.unit,
        "least": slide.least,
        "most": slide.most,
        "step": slide.step,
        "value": min(float(settings[slide.name]), slide.most),
        "top": top,
        "command": slide.command,
    }


def _words(code: str) -> dict[str, str]:
    """All that the script says in a language."""
    table = language.table(code)
    said = {"name": table["name"], "decimal": table["decimal"]}
    said |= {name: table["player"][name] for name in SHARED}
    said |= {name: table["words"][name] for name in SPOKEN}
    said |= {name: table["buttons"][name] for name in ("reset", "undo", "redo", "drive")}
    said |= {f"event_{kind}": table["events"][kind] for kind in EVENTS}
    said |= {f"kinds_{kind}": text for kind, text in table["kinds"].items()}
    return said


def _plural(code: str) -> str:
    return f"(n) => +({language.table(code)['plural']})"
