"""Record a short film of every scene without a screen, and check that it shows what it should.

    python check_films.py FOLDER --packing mixed

Run it with the Python in which the program is installed.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import json
import subprocess
import sys
from pathlib import Path

import imageio.v2
import numpy as np

STEPS = 24
SIZE = (640, 360)


def run(*words: str) -> str:
    """Standard output of ``python -m sandbox``."""
    done = subprocess.run(
        [sys.executable, "-m", "sandbox", *words], stdout=subprocess.PIPE, text=True, timeout=600
    )
    if done.returncode:
        sys.exit(f"python -m sandbox {' '.join(words)} ended with code {done.returncode}")
    return done.stdout


def check(scene: str, packing: str, folder: Path, limited: bool) -> str:
    """Record a scene; what was measured, or an AssertionError. A hand that is ``limited`` gives way to a testing machine."""
    machine = ("--set", "hand_strength=machine") if limited else ()
    film, table = folder / f"{scene}-{packing}.mp4", folder / f"{scene}-{packing}.csv"
    size = "x".join(map(str, SIZE))
    print(
        run(
            *("record", scene, "--packing", packing, "--steps", str(STEPS), "--size", size),
            *("--out", str(film), "--data", str(table)),
            *machine,
        ),
        end="",
    )
    frames = [np.asarray(f, np.int16) for f in imageio.v2.mimread(film, memtest=False)]
    assert len(frames) == STEPS, f"{len(frames)} frames instead of {STEPS}"
    assert frames[0].shape == (SIZE[1], SIZE[0], 3), f"frames of shape {frames[0].shape}"
    contrast = min(float(frame.std()) for frame in frames)
    assert contrast > 10.0, f"a frame is blank: its grey levels vary by {contrast:.1f} only"
    # The canvas alone: the plot below it changes whether grains move or not.
    canvas = slice(0, SIZE[1] // 2)
    moved = float((np.abs(frames[-1] - frames[0])[canvas].max(axis=2) > 48).mean())
    assert moved > 0.005, f"nothing moved: {moved:.2%} of the pixels changed"

    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == STEPS + 1, f"{len(rows)} rows instead of {STEPS} and one of the start"
    stroke = [float(list(row.values())[1]) for row in rows]  # whatever the scene calls it
    assert all(b > a for a, b in itertools.pairwise(stroke)), "the hand did not always move"
    numbers = [float(row[name]) for row in rows for name in row if name != "stop reason"]
    assert np.isfinite(numbers).all(), "a number of the table is not finite"
    assert len({row["energy [k R^2]"] for row in rows}) > 1, "the energy never changed"
    return f"{STEPS} frames, contrast {contrast:.0f}, {moved:.1%} of the canvas moved"


def main() -> None:
    """Check every scene that the program lists."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--packing", default="mixed")
    options = parser.parse_args()
    scenes = json.loads(run("list", "--json"))["scenes"]
    assert scenes, "there is no scene"
    for scene in scenes:
        if options.packing in scene["packings"]:
            limited = any(p["name"] == "hand_strength" for p in scene["parameters"])
            measured = check(scene["name"], options.packing, options.folder, limited)
            print(f"{scene['name']}, {options.packing}: {measured}", flush=True)


if __name__ == "__main__":
    main()
