"""The command ``prepare``: compiles ahead what scenes need. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
import time

from core.errors import InputError
from sandbox.cli.exit_codes import OK
from scenes.text import counted


def add_options(prepare: argparse.ArgumentParser) -> None:
    """Which scenes."""
    prepare.add_argument("scenes", nargs="*", metavar="SCENE", help="these instead of all")


def prepare(options: argparse.Namespace) -> int:
    """Compile all kernels that scenes may need, and say how long it takes."""
    from sandbox import environment
    from sandbox.preparation import parts
    from scenes import registry

    environment.prepare_headless()
    scenes = [registry.get(name).name for name in options.scenes] or registry.names()
    missing = parts.missing(parts.of_scenes(scenes))
    parts.require_room(missing)
    began = time.perf_counter()
    parts.carry_out(missing, lambda part, seconds: print(f"{seconds:6.1f} s  {part}", flush=True))
    took = time.perf_counter() - began
    what = counted(len(missing), "part")
    print(f"compiled {what} of the kernels in {took:.1f} s" if missing else "everything is there")
    if parts.missing(missing):  # it could be, when this began
        raise InputError("what was compiled was not kept: every start will compile it anew")
    return OK
