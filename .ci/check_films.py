"""Record a short film of every scene without a screen, all packings side by side, and check that it shows what it should.

    python check_films.py FOLDER [SCENE ...]

Run it with the Python in which the program is installed, or where it lies.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import imageio.v2
import numpy as np

STEPS = 24
SIZE = (960, 360)  # a pane of each packing is as high as it is wide


def run(*words: str) -> str:
    """Standard output of ``python -m sandbox``."""
    done = subprocess.run(
        [sys.executable, "-m", "sandbox", *words], capture_output=True, text=True, timeout=600
    )
    if done.returncode:
        raise RuntimeError(
            f"python -m sandbox {' '.join(words)} ended with code {done.returncode}: "
            f"{done.stdout}{done.stderr}"
        )
    return done.stdout


def check(scene: dict[str, Any], folder: Path) -> str:
    """Record a scene; what was said and measured. Raises AssertionError."""
    name, packings = scene["name"], scene["packings"]
    # A hand of limited strength gives way to a testing machine.
    limited = any(parameter["name"] == "hand_strength" for parameter in scene["parameters"])
    film, table = folder / f"{name}.mp4", folder / f"{name}.csv"
    said = run(
        *("record", name, "--compare", ",".join(packings), "--steps", str(STEPS)),
        *("--size", "x".join(map(str, SIZE)), "--out", str(film), "--data", str(table)),
        *(("--set", "hand_strength=machine") if limited else ()),
    )
    frames = [np.asarray(f, np.int16) for f in imageio.v2.mimread(film, memtest=False)]
    assert len(frames) == STEPS, f"{len(frames)} frames instead of {STEPS}"
    assert frames[0].shape == (SIZE[1], SIZE[0], 3), f"frames of shape {frames[0].shape}"
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    measured = [
        check_pane([f[:, k * width : (k + 1) * width] for f in frames])
        + check_rows([row for row in rows if row["packing"] == packing])
        for width in [SIZE[0] // len(packings)]
        for k, packing in enumerate(packings)
    ]
    return f"{said}{name}: {STEPS} frames; " + "; ".join(
        f"{packing}: {words}" for packing, words in zip(packings, measured, strict=True)
    )


def check_pane(frames: list[np.ndarray[Any, Any]]) -> str:
    """One packing's part of all frames."""
    contrast = min(float(frame.std()) for frame in frames)
    assert contrast > 10.0, f"a frame is blank: its grey levels vary by {contrast:.1f} only"
    # The canvas alone: the plot below it changes whether grains move or not.
    canvas = slice(0, SIZE[1] // 2)
    moved = float((np.abs(frames[-1] - frames[0])[canvas].max(axis=2) > 48).mean())
    assert moved > 0.005, f"nothing moved: {moved:.2%} of the pixels changed"
    return f"contrast {contrast:.0f}, {moved:.1%} of the canvas moved"


def check_rows(rows: list[dict[str, str]]) -> str:
    """One packing's rows of the table."""
    assert len(rows) == STEPS + 1, f"{len(rows)} rows instead of {STEPS} and one of the start"
    way = list(rows[0])[2]  # behind the packing and the increment, in the scene's own words
    moved = itertools.pairwise(float(row[way]) for row in rows)
    assert all(b > a for a, b in moved), f"the hand did not always move: {way}"
    words = {"packing", "stop reason"}
    numbers = [float(row[name]) for row in rows for name in row if name not in words]
    assert np.isfinite(numbers).all(), "a number of the table is not finite"
    assert len({row["energy [k R^2]"] for row in rows}) > 1, "the energy never changed"
    return ""


def main() -> None:
    """Check the scenes that are named, or every one that the program lists; one on each processor at a time."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("scene", nargs="*")
    options = parser.parse_args()
    scenes = json.loads(run("list", "--json"))["scenes"]
    chosen = [scene for scene in scenes if scene["name"] in (options.scene or [scene["name"]])]
    assert len(chosen) >= max(len(options.scene), 1), "there is no such scene"
    with ThreadPoolExecutor(os.cpu_count()) as processors:
        for measured in processors.map(partial(check, folder=options.folder), chosen):
            print(measured, flush=True)


if __name__ == "__main__":
    main()
