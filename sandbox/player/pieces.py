"""Pieces that every page is put together from: what it may do, its colours, words in all languages."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Callable
from importlib.resources import files
from typing import Any

from sandbox import __version__
from sandbox.draw.theme import EVENT, HAND, THEMES, Theme, mix
from sandbox.words.language import available, speaking


def filled(template: str, values: dict[str, str]) -> str:
    """A template with its ``{{names}}`` replaced, each piece once and what is put in left alone."""
    parts = []
    for part in template.split("{{"):
        name, end, rest = part.partition("}}")
        parts.append(values[name] + rest if end and name in values else part)
    return "".join(parts)


def document(body: str, values: dict[str, str]) -> str:
    """A page: the head that all have, and a template for its body, filled in."""
    return filled(asset("head.html") + body, {"theme": "dark", "version": __version__} | values)


def policy(script: str) -> str:
    """What the page may do: run its own script, and nothing from outside."""
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return (
        f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def asset(name: str, package: str = "sandbox.player") -> str:
    """A file of a package's assets."""
    return (files(package) / "assets" / name).read_text(encoding="utf-8")


def as_json(value: Any) -> str:
    """JSON that says nothing to whoever reads the script it stands in as HTML: no end of it, no beginning of a comment."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")


def spoken(saying: Callable[[], str], shown: str, tag: str = "span") -> str:
    """What ``saying`` says, as text in every language; one of them is shown."""
    return marked(lambda: html.escape(saying()), shown, tag)


def marked(saying: Callable[[], str], shown: str, tag: str = "div") -> str:
    """The same of what is markup already."""
    said = []
    for code in available():
        with speaking(code):
            text = saying()
        hidden = "" if code == shown else " hidden"
        said.append(f'<{tag} data-said lang="{code}"{hidden}>{text}</{tag}>')
    return "".join(said)


def colours() -> str:
    """The colours of both themes for a style."""
    return "\n".join(_variables(theme) for theme in THEMES.values())


def _variables(theme: Theme) -> str:
    """The colours of a theme for the style."""
    dark = theme.name == "dark"
    colours = {
        **{name: getattr(theme, name) for name in ("ground", "panel", "hairline", "text")},
        **{name: getattr(theme, name) for name in ("good", "working", "bad")},
        "soft": theme.soft_text,
        "hand": HAND,
        "edge": mix(theme.panel, theme.text, 0.45),
        "pressed": mix(theme.panel, theme.text, 0.16),
        "event": EVENT if dark else mix(EVENT, 0x000000, 0.35),
        "link": 0x6CC4F5 if dark else 0x00548A,
        "focus": 0xFFD34D if dark else 0x0B57D0,
    }
    declared = " ".join(f"--{name}: #{colour:06x};" for name, colour in colours.items())
    return f'html[data-theme="{theme.name}"] {{ {declared} }}'
