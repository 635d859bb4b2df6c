"""The page from which one goes to the scenes."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence

from sandbox.draw.pages.thumbnail import path_of
from sandbox.draw.theme import THEMES
from sandbox.player.pieces import asset, colours, document, marked, policy, spoken
from sandbox.web.toolchain import PAGE
from sandbox.words import language, words
from sandbox.words.language import available

FILE = "index.html"
_SCRIPT = """
"use strict";
{manners}
const languages = {languages};
settle(languages[languageAsked(true, languages, "{shown}")], themeAsked(true, "dark"));
document.documentElement.dataset.ready = "0";
"""


def menu(names: Sequence[str]) -> str:
    """The HTML text, with a way to the page of each scene."""
    shown = language.present()
    script = _SCRIPT.format(manners=asset("manners.js"), languages=list(available()), shown=shown)
    values = {
        "language": shown,
        "policy": policy(script),
        "title": html.escape(words.SPLASH_TITLE),
        "heading": spoken(lambda: words.SPLASH_TITLE, shown),
        "about": spoken(lambda: words.SPLASH_ABOUT, shown),
        "style": "\n".join(
            [colours(), asset("player.css"), (PAGE / "page.css").read_text(encoding="utf-8")]
        ),
        "scenes": "".join(_card(name, shown) for name in names),
        "script": script,
    }
    return document((PAGE / "menu.html").read_text(encoding="utf-8"), values)


def _card(name: str, shown: str) -> str:
    def told() -> str:
        title, question = html.escape(words.title(name)), html.escape(words.question(name))
        return f"<strong>{title}</strong><p>{question}</p>"

    pictures = "".join(_picture(name, theme) for theme in THEMES)
    return f'<a href="{name}.html" data-own>{pictures}{marked(told, shown)}</a>'


def _picture(name: str, theme: str) -> str:
    """The small picture of the desk's menu, seen in that theme."""
    data = base64.b64encode(path_of(name, theme).read_bytes()).decode("ascii")
    return f'<img class="for-{theme}" alt="" width="96" height="96" src="data:image/png;base64,{data}">'


def way_back(shown: str) -> str:
    """From the page of a scene to the menu."""
    return f'<a href="{FILE}" data-own>{spoken(lambda: words.BUTTONS["menu"], shown)}</a>'
