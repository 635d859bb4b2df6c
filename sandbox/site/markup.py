"""Pages of the gallery that play nothing: one frame for all of them, and words in every language."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence

from sandbox.player.pieces import as_json, asset, colours, policy, spoken
from sandbox.player.pieces import document as whole
from sandbox.words import language, words
from sandbox.words.language import available
from sandbox.words.words import Section

SITE = Section("site")
SHOWN = language.SOURCE  # until the page's script has asked the computer


def said(key: str, tag: str = "span", **saying: Callable[[], str]) -> str:
    """A word of the gallery, with its values, in every language."""
    return spoken(
        lambda: SITE[key].format(**{name: say() for name, say in saying.items()}), SHOWN, tag
    )


def title_of(scene: str) -> Callable[[], str]:
    """What says the title of a scene."""
    return lambda: words.title(scene)


def link(target: str, text: str, kind: str = "") -> str:
    """A link to another page of the gallery; theme and language go along."""
    kept = f' class="{kind}"' if kind else ""
    return f'<a data-own href="{html.escape(target)}"{kept}>{text}</a>'


def document(title: Callable[[], str], body: str, trail: Sequence[str] = ()) -> str:
    """A whole page: the way back, the choice of language and theme, and what it is about."""
    names = [language.table(code)["name"] for code in available()]
    player = [language.table(code)["player"] for code in available()]
    told = {
        "languages": available(),
        "names": names,
        "light": [table["to_light"] for table in player],
        "dark": [table["to_dark"] for table in player],
        "titles": language.in_each(title),
    }
    script = "\n".join(
        [
            f'"use strict";\nconst PAGE = {as_json(told)};',
            asset("manners.js"),
            asset("site.js", "sandbox.site"),
        ]
    )
    values = {
        "language": SHOWN,
        "policy": policy(script),
        "title": html.escape(language.in_each(title)[0]),
        "style": "\n".join([colours(), asset("site.css", "sandbox.site")]),
        "trail": "".join(trail),
        "body": body,
        "script": script,
    }
    return whole(asset("page.html", "sandbox.site"), values)
