"""The gallery as a folder of pages."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from pathlib import Path

from sandbox.bars import bar_options
from sandbox.files.folder import write_text
from sandbox.player.page import Look, page
from sandbox.player.pieces import spoken
from sandbox.player.tape import Tape
from sandbox.site import studies
from sandbox.site.markup import SHOWN, SITE, document, link, said, title_of
from sandbox.site.runs import run
from sandbox.site.worksheets import FILE as WORKSHEETS
from sandbox.site.worksheets import worksheets
from sandbox.words import words

MOST = 15_000_000  # bytes that all pages may have together
BAR = "{desc:<18.18} {percentage:3.0f}%|{bar}| {elapsed}"


def site(folder: Path, scenes: Sequence[str], steps: int | None = None) -> list[Path]:
    """Run the scenes, write all pages, the index last; what was written. Raises InputError if one cannot be.

    ``steps``: increments of each scene at most; its whole script without.
    """
    from tqdm import tqdm

    tapes: dict[str, Tape] = {}
    written: list[Path] = []
    with tqdm(total=float(len(scenes)), bar_format=BAR, **bar_options()) as bar:
        for number, scene in enumerate(scenes):

            def tell(name: str, share: float, number: int = number) -> None:
                bar.set_description_str(name, refresh=False)
                bar.update(max(0.0, number + min(share, 1.0) - bar.n))

            tapes[scene] = run(scene, steps, tell)
            written.append(_write(folder / f"{scene}.html", _scene(scene, tapes[scene], scenes)))
    for name, text in _other_pages(tapes):
        written.append(_write(folder / name, text))
    return written


def _other_pages(tapes: dict[str, Tape]) -> Iterator[tuple[str, str]]:
    yield WORKSHEETS, worksheets(tapes)
    there = studies.found()
    for name, path in there.items():
        yield studies.file_of(name), studies.study(name, path, there)
    yield "index.html", _index(list(tapes), list(there))


def _scene(scene: str, tape: Tape, scenes: Sequence[str]) -> str:
    """A player with the way back, to the scenes before and after, and to the worksheet."""
    at = list(scenes).index(scene)
    ways = [link("index.html", said("all_scenes"))]
    for key, place in (("previous", at - 1), ("next", at + 1)):
        if 0 <= place < len(scenes):
            other = scenes[place]
            ways.append(link(f"{other}.html", said(key, title=title_of(other))))
    ways.append(link(f"{WORKSHEETS}#{scene}", said("worksheet"), "last"))
    above = f'<nav class="ways">{"".join(ways)}</nav>\n'
    return page(tape, Look(language=SHOWN, auto=True, above=above, style=WAYS))


WAYS = """
body { display: flex; flex-direction: column; min-height: 100vh; min-height: 100dvh; }
.ways { display: flex; flex-wrap: wrap; gap: 2px 22px; padding: 8px 16px; background: var(--ground); font-weight: 600; }
.ways a { color: var(--link); text-underline-offset: 3px; }
.ways .last { margin-left: auto; }
.player { flex: 1 1 0; height: auto; }
@media (min-width: 1001px) and (min-height: 560px) { body { height: 100vh; height: 100dvh; } }
"""


def _index(scenes: Sequence[str], there: Sequence[str]) -> str:
    cards = "".join(_card(scene) for scene in scenes)
    body = (
        f"{said('title', 'h1')}{said('intro', 'p')}"
        f'{said("scenes", "h2")}<ul class="cards">{cards}</ul>'
        f"{said('worksheets', 'h2')}{said('worksheets_intro', 'p')}"
        f"<p>{link(WORKSHEETS, said('all_worksheets'))}</p>"
    )
    if there:
        items = "".join(map(_study_link, there))
        body += (
            f'{said("measured", "h2")}{said("measured_intro", "p")}<ul class="list">{items}</ul>'
        )
    body += f"{said('nothing_asked', 'p')}"
    return document(lambda: SITE["title"], body, [f"<span>{said('title')}</span>"])


def _study_link(name: str) -> str:
    return f"<li>{link(studies.file_of(name), spoken(lambda: studies.TITLES[name], SHOWN))}</li>"


def _card(scene: str) -> str:
    pictures = "".join(_picture(scene, theme) for theme in ("dark", "light"))
    return (
        f'<li class="card">{pictures}<div class="words"><h3>{spoken(title_of(scene), SHOWN)}</h3>'
        f"{spoken(lambda: words.question(scene), SHOWN, 'p')}"
        f'<p class="links">{link(f"{scene}.html", said("play"))}'
        f"{link(f'{WORKSHEETS}#{scene}', said('worksheet'))}</p></div></li>"
    )


def _picture(scene: str, theme: str) -> str:
    """The small picture of the menu."""
    here = Path(__file__).parents[1]
    places = (here / "draw" / "pages" / "thumbnails", here.parent / "assets" / "thumbnails")
    path = next((p / f"{scene}-{theme}.png" for p in places if p.is_dir()), None)
    if path is None or not path.is_file():
        return ""
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<img class="for-{theme}" alt="" src="data:image/png;base64,{data}">'


def _write(path: Path, text: str) -> Path:
    write_text(path, text)
    return path
