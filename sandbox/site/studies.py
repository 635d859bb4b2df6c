"""The results of the studies as pages: the tables and figures that lie in assets/studies, or beside this module if installed."""

from __future__ import annotations

import base64
import re
from itertools import count
from pathlib import Path
from typing import Any

from sandbox.extras import require
from sandbox.site.markup import document, link, said
from sandbox.words.words import Section

TITLES = Section("site_studies")
OUTSIDE = re.compile(r"[a-z]+:|//")  # how a link begins that leaves the gallery


def require_markdown() -> None:
    """Raise InputError, before any work is done, if the studies cannot be made pages."""
    require("the study pages need", "markdown_it", "markdown-it-py", "site")


def found() -> dict[str, Path]:
    """Which studies there are, by name; nothing where they were left out."""
    here = Path(__file__).parent
    places = (here / "results", here.parents[1] / "assets" / "studies")
    folder = next((place for place in places if place.is_dir()), None)
    if folder is None:
        return {}
    paths = {path.stem: path for path in sorted(folder.rglob("*.md"))}
    return {name: paths[name] for name in TITLES if name in paths}


def file_of(name: str) -> str:
    """The page of a study."""
    return f"study-{name.lower()}.html"


def study(name: str, path: Path, others: dict[str, Path]) -> str:
    """A page of one study, its figures inside. Links to what is not in the gallery become plain text."""
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark").enable("table")
    tokens = parser.parse(path.read_text(encoding="utf-8"))
    for token in tokens:
        for child in token.children or ():
            if child.type == "image":
                _put_inside(child, path.parent)
        if token.children:
            token.children = _linked(token.children, path.parent, others)
    text = parser.renderer.render(tokens, parser.options, {})
    text = _wide_tables(text).replace("&lt;br&gt;", "<br>")
    trail = [link("index.html", said("all_scenes"))]
    return document(
        lambda: TITLES[name], f'<article class="study" lang="en">{text}</article>', trail
    )


def _wide_tables(text: str) -> str:
    """Tables that can be moved sideways by themselves, each with a name; and a corner without words is no header."""
    text = text.replace("<th></th>", "<td></td>").replace("</table>", "</table></div>")
    numbers = count(1)
    region = '<div class="wide" tabindex="0" role="region" aria-label="table {}"><table>'
    return re.sub("<table>", lambda _: region.format(next(numbers)), text)


def _put_inside(image: Any, folder: Path) -> None:
    """Let an image be a part of the page."""
    figure = folder / str(image.attrs["src"])
    data = base64.b64encode(figure.read_bytes()).decode("ascii")
    image.attrs["src"] = f"data:image/png;base64,{data}"


def _linked(tokens: list[Any], folder: Path, others: dict[str, Path]) -> list[Any]:
    """Links to other studies lead to their pages, those to elsewhere stay, and the rest are none any more."""
    kept, open_links = [], []
    names = {path.resolve(): name for name, path in others.items()}
    for token in tokens:
        if token.type == "link_open":
            target = str(token.attrs["href"])
            inside = names.get((folder / target.partition("#")[0]).resolve())
            if inside is not None:
                token.attrs["href"] = file_of(inside)
                token.attrs["data-own"] = ""
            open_links.append(inside is not None or bool(OUTSIDE.match(target)))
            if not open_links[-1]:
                continue
        elif token.type == "link_close" and not open_links.pop():
            continue
        kept.append(token)
    return kept
