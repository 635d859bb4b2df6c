"""What stands in a page, and what it would ask the network for."""

from __future__ import annotations

import re
from html.parser import HTMLParser

ASKING = (":" + "//", "url(", "@import", "fetch(", "XMLHttpRequest", "WebSocket", "import(")


class Markup(HTMLParser):
    """Elements of a page in their order: names and attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    def all(self, *tags: str) -> list[dict[str, str | None]]:
        """The attributes of all elements of these names."""
        return [attributes for tag, attributes in self.found if tag in tags]


def asks_for(text: str) -> list[str]:
    """All in a page that could ask for something from outside; links that a person may follow do not count."""
    markup = Markup(text)
    policy = [str(meta.get("content")) for meta in markup.all("meta") if "http-equiv" in meta]
    found = (
        []
        if len(policy) == 1 and policy[0].startswith("default-src 'none'; script-src 'sha256-")
        else policy
    )
    found += [str(a) for a in markup.all("link", "iframe", "object", "embed", "base", "form")]
    for tag, attributes in markup.found:
        for name in {"src", "href", "data", "action", "srcset"} & set(attributes):
            value = str(attributes[name])
            if not (value.startswith("data:image/png;base64,") or (tag == "a" and name == "href")):
                found.append(f"{tag} {name}={value[:60]}")
    for part in re.findall(r"<style>(.*?)</style>|<script>(.*?)</script>", text, re.DOTALL):
        found += [sign for sign in ASKING if any(sign in each for each in part)]
    return found
