"""The page itself: markup, style, script and recording in one file that asks for nothing."""

from __future__ import annotations

import base64
import html
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.squeezed import AUXETIC_AREA, MOUTH, NOTCH, RING_WALL, TIP, WING
from sandbox.draw import views
from sandbox.draw.event_shapes import SHAPES
from sandbox.draw.raster import made_grains
from sandbox.draw.theme import (
    EVENT,
    HAND,
    THEMES,
    Theme,
    magnitude_colours,
    packing_colour,
    packing_dash,
)
from sandbox.player.pieces import as_json, asset, colours, document, marked, policy
from sandbox.player.recording import recording
from sandbox.player.story import PLAYER, story
from sandbox.player.tape import Tape
from sandbox.words import language, words
from sandbox.words.language import available, in_each, speaking

SCRIPTS = (
    *("manners.js", "unpack.js", "speak.js", "grains.js", "scenery.js", "plot.js"),
    *("legend.js", "panes.js", "inspect.js", "labels.js", "player.js"),
)
SHADES = 64  # of a colour map
# Words of the window that the page says too.
SHARED = (
    *("grain_label", "grain_ratio", "grain_axes", "grain_angle", "grain_rest", "grain_area"),
    *("grain_pressure", "grain_contacts", "grain_total", "grain_unbalanced", "grain_wall"),
    *("grain_other", "grains_out", "hand_limit", "panel_packing"),
)


@dataclass(frozen=True)
class Look:
    """How a page begins; whoever looks at it may choose otherwise."""

    theme: str = "dark"
    view: str = "kind"
    language: str = ""  # the present one, if none is named
    play: bool = True  # by itself, where the computer does not ask for little motion
    auto: bool = False  # theme and language as this computer and the page's address ask for them
    above: str = ""  # markup before the player, and after it
    below: str = ""
    style: str = ""  # for that markup


def page(tape: Tape, look: Look | None = None) -> str:
    """The HTML text of a run, or of several side by side. Raises InputError for an empty tape, or an unknown view or language.

    Belongs to the thread that draws, as it speaks every language for a moment.
    """
    look = look or Look()
    views.view_named(look.view)
    recorded = base64.b64encode(recording(tape)).decode("ascii")  # raises for an empty tape
    first = tape.last[0]
    titles = {
        "title": in_each(lambda: words.title(first.scene, first.title)),
        "question": in_each(lambda: words.question(first.scene)),
    }
    begins = {"view": look.view, "play": look.play, "auto": look.auto}
    script = (
        f'"use strict";\nconst PAGE = {as_json(about(words_of) | titles | {"start": begins})};\n'
        f"const PLURALS = [{', '.join(map(_plural, available()))}];\n"
        + "\n".join(asset(name) for name in SCRIPTS)
    )
    code = look.language or language.present()
    with speaking(code):
        at = available().index(code)
        values = {
            "language": code,
            "theme": look.theme,
            "policy": policy(script),
            "title": html.escape(titles["title"][at]),
            "question": html.escape(titles["question"][at]),
            "style": "\n".join([colours(), asset("player.css"), look.style]),
            "story": marked(lambda: _paragraphs(tape), code),
            "noscript": html.escape(PLAYER["noscript"]),
            "above": look.above,
            "below": look.below,
            "script": script,
            "recording": recorded,
        }
    return document(asset("player.html"), values)


def _paragraphs(tape: Tape) -> str:
    return "".join(f"<p>{html.escape(text)}</p>" for text in story(tape))


def about(said: Callable[[str], dict[str, str]], keys: str = "player_keys") -> dict[str, Any]:
    """What is the same for every run: words, colours, signs. ``said`` has all words of a language, table ``keys`` its keys."""
    return {
        "words": [said(code) for code in available()],
        "keys": [language.table(code)[keys]["keys"] for code in available()],
        "themes": {name: _theme(theme) for name, theme in THEMES.items()},
        "packings": {
            name: {"colour": packing_colour(name), "dash": packing_dash(name)}
            for name in ("regular", "auxetic", "mixed")
        },
        "shapes": SHAPES,
        "made": {
            "closed": AUXETIC_AREA,
            "wall": RING_WALL,
            "tip": TIP,
            "wing": (WING, made_grains.WING_V),
            "notch": (NOTCH, made_grains.NOTCH_CLOSED),
            "hinge": made_grains.HINGE,
            "mouth": MOUTH,
            "tooth": {
                "long": made_grains.TOOTH_LONG,
                "thick": made_grains.TOOTH_THICK,
                "gap": made_grains.POCKET_GAP,
            },
        },
    }


def _plural(code: str) -> str:
    """Which form of a word goes with which number, as a function of the script: gettext's rules read the same there."""
    return f"(n) => +({language.table(code)['plural']})"


def words_of(code: str) -> dict[str, str]:
    """All that the script says in a language."""
    table = language.table(code)
    said: dict[str, str] = {"name": table["name"], "decimal": table["decimal"], **table["player"]}
    said |= {name: table["words"][name] for name in SHARED}
    said |= {f"event_{kind}": text for kind, text in table["events"].items()}
    said |= {f"kind_{kind}": text for kind, text in table["kinds_short"].items()}
    said |= {f"kinds_{kind}": text for kind, text in table["kinds"].items()}
    return said


def _theme(theme: Theme) -> dict[str, Any]:
    """Colours as numbers, and those of magnitudes."""
    share = np.linspace(0.0, 1.0, SHADES)
    ramps = {
        "chains": magnitude_colours(theme, share),
        "fill": views.fill_colours(theme, share),
        "fringes": views.fringe_colours(theme, share),
    }
    shown = ("ground", "panel", "hairline", "text", "soft_text", "wall", "piston", "intruder")
    names = (*shown, "regular", "auxetic")
    return {
        **{name: getattr(theme, name) for name in names},
        "event": EVENT,
        "hand": HAND,
        "dark": theme.name == "dark",
        "ramps": {name: colours.tolist() for name, colours in ramps.items()},
    }
