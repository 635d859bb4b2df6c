"""The same log under several interpreters, and whether it comes to the same bits.

    python -m tests.same_everywhere PYTHON [PYTHON ...]

Each PYTHON is an interpreter in which the program's libraries are installed; this one is always tried. Prints a line for each:
versions, and the hash of the state that the log leads to. Exit code 1 if they differ. Bits depend on the processor and on LLVM
too, so no hash of them is kept in a file: on one machine they must be alike.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from sandbox.files.log_file import write_log
from sandbox.session.commands import Change, Command, Grab, Move, Protocol, Undo
from sandbox.session.log import Log

REPOSITORY = Path(__file__).parents[1]
# A hand, live changes and a way back; friction and gravity; a periodic cell under shear.
RUNS: dict[str, tuple[dict[str, object], list[tuple[int, Command]]]] = {
    "hopper": (
        {"grains": 60, "width": 12.0},
        [
            (0, Grab("piston")),
            (0, Move("piston", 0.0, -100.0)),
            (25, Change("friction", 0.1)),
            (40, Undo()),
            (40, Protocol(True)),
        ],
    ),
    "gravity_hopper": ({"grains": 60}, []),
    "couette": ({"grains": 160}, [(0, Protocol(True))]),
}
INCREMENTS = 60
TELL = """
import json, sys
from sandbox.files.log_file import read_log
from sandbox.session.replay import replay
import llvmlite, numba, numpy
*_, session = replay(read_log(sys.argv[1]))
versions = {m.__name__: m.__version__ for m in (numpy, numba, llvmlite)}
print(json.dumps([sys.version.split()[0], versions, session.state_hash(), session.refusals[0]]))
"""


def log_of(scene: str) -> Log:
    """A log of that scene, without its end."""
    settings, commands = RUNS[scene]
    return Log(scene, "mixed", 1, settings, tuple(commands), INCREMENTS, "0" * 64)


def led_to(log: Path, python: str = sys.executable) -> list[object]:
    """Version, libraries, hash and number of refused commands of the log replayed by an interpreter."""
    done = subprocess.run(
        [python, "-c", TELL, str(log)],
        cwd=REPOSITORY,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    told: list[object] = json.loads(done.stdout)
    return told


def main() -> int:
    """Every run in every interpreter."""
    parser = argparse.ArgumentParser(description="Replay the same logs in several interpreters.")
    parser.add_argument("pythons", nargs="*", metavar="PYTHON")
    options = parser.parse_args()
    alike = True
    with tempfile.TemporaryDirectory() as folder:
        for scene in RUNS:
            log = Path(folder, f"{scene}.jsonl")
            write_log(log, log_of(scene))
            hashes = set()
            for python in [sys.executable, *options.pythons]:
                version, libraries, digest, refused = led_to(log, python)
                print(
                    f"{scene:<15} Python {version}  {libraries}  {refused} refused  {digest}",
                    flush=True,
                )
                hashes.add(digest)
            alike &= len(hashes) == 1
    print("the same everywhere" if alike else "NOT the same everywhere")
    return 0 if alike else 1


if __name__ == "__main__":
    raise SystemExit(main())
