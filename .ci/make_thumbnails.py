"""Make the pictures of the scene menu again: python .ci/make_thumbnails.py [NAME ...]

Writes assets/thumbnails/NAME-dark.png and NAME-light.png for every scene (or the named ones), and for the hopper with the other
packings. Few grains, so that each can be seen. Needs Pillow, which imageio brings along.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
FOLDER = REPOSITORY / "assets" / "thumbnails"
LARGEST = 15_000  # bytes
COLOURS = (96, 64, 48, 32, 24)  # as many as fit into that

# Settings, and increments of the scripted drive, that show what a scene is about.
HOPPER = {"grains": 90, "width": 15.0, "orifice": 2.0}
SCENES: dict[str, tuple[dict[str, object], int]] = {
    "single_grain": ({}, 60),
    "two_ellipses": ({"aspect": 1.6, "tilt": 30.0}, 6),
    "grain_row": ({"grains": 5}, 40),
    "biaxial_press": ({"grains": 60}, 40),
    "biaxial_periodic": ({"grains": 50}, 12),
    "couette": ({"grains": 160}, 60),
    "avalanches": ({"grains": 60}, 40),
    "intruder": ({"grains": 110, "intruder_radius": 3.5}, 100),
    "hopper": (HOPPER, 140),
    "gravity_hopper": ({"grains": 90, "width": 15.0, "orifice": 2.2}, 150),
    "workshop": ({"grains": 60, "width": 24.0, "height": 20.0}, 120),
}
PACKINGS = {"hopper-regular": "regular", "hopper-auxetic": "auxetic"}  # all others are mixed
WHOLE = 18.0  # side of a cell that is shown as a whole [R]
SMALLEST = 12.0  # side of what is shown of a larger one [R]


def main(names: list[str]) -> None:
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    sys.path.insert(0, str(REPOSITORY))
    FOLDER.mkdir(exist_ok=True)
    for name in names or [*SCENES, *PACKINGS]:
        scene = name.partition("-")[0]
        shown = frame(scene, PACKINGS.get(name, "mixed"), *SCENES[scene])
        for theme in ("dark", "light"):
            write(shown, theme, FOLDER / f"{name}-{theme}.png")


def frame(scene: str, packing: str, settings: dict[str, object], steps: int):
    """The scene after so many increments of its own drive."""
    from sandbox.session.commands import Protocol
    from sandbox.session.session import Session

    session = Session(scene, packing, 1, settings)
    session.build()
    session.submit(Protocol(True))
    while steps and not session.idle:
        steps -= session.advance(1000)
    return cropped(session.frame())


def cropped(frame):
    """The same, without the empty part of its scene; of a long cell one part."""
    from dataclasses import replace

    xmin, ymin, xmax, ymax = frame.bounds
    if frame.box is None:  # walls that rise high above the grains
        ymin = max(ymin, float((frame.y - frame.p).min()) - 2.0)
        ymax = min(ymax, float((frame.y + frame.p).max()) + 4.0)
    elif ymax - ymin > WHOLE:
        ymin, xmax = ymax - SMALLEST, xmin + SMALLEST
    return replace(frame, bounds=(xmin, ymin, xmax, ymax))


def write(frame, theme: str, path: Path) -> None:
    """With as many colours as the size allows."""
    import pygame
    from PIL import Image

    from sandbox.draw.pages.thumbnail import drawn

    surface = drawn(frame, theme)
    picture = Image.frombytes("RGB", surface.get_size(), pygame.image.tobytes(surface, "RGB"))
    for colours in COLOURS:
        picture.quantize(colours, dither=Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size <= LARGEST:
            break
    print(f"{path.relative_to(REPOSITORY)}: {path.stat().st_size} bytes, {colours} colours")


if __name__ == "__main__":
    main(sys.argv[1:])
