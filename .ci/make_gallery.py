"""Make the pictures of the README again, by the commands that stand beside them: python .ci/make_gallery.py [NAME ...]

They are those of the program as it is: after a change of the physics, run this, and look at them.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
CELL = re.compile(
    r"!\[[^]]*\]\((assets/gallery/(\w+)\.png)\) `([^`]+)`"
)  # a picture and its command
TOP = re.compile(r"`record ([^`]+) --out FILE\.gif`")


def commands() -> dict[str, tuple[str, list[str]]]:
    """By name of the picture: where it is, and what ``record`` is told."""
    text = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    found = {name: (path, shlex.split(words)) for path, name, words in CELL.findall(text)}
    (words,) = TOP.findall(text)
    return {"side_by_side": ("assets/gallery/side_by_side.gif", shlex.split(words)), **found}


def main(names: list[str]) -> None:
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}
    all_of_them = commands()
    for name in names or all_of_them:
        path, words = all_of_them[name]
        subprocess.run(
            [sys.executable, "-m", "sandbox", "record", *words, "--out", path],
            cwd=REPOSITORY,
            env=environment,
            check=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
