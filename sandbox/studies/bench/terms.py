"""What each scene is made of: which kernels are compiled for it and how long that takes, how much memory a grain has, and which
terms are absent. Each scene in a process of its own, with nothing compiled before."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from sandbox.studies.bench.report import Row, Section
from scenes import registry

REPOSITORY = Path(__file__).parents[3]
PATIENCE = 600.0  # [s]
MORE = 200  # grains, to tell what one of them takes
# What a term adds to every evaluation of the forces.
TERMS = {
    "friction": "core.slip.prepare_friction",
    "bodies": "core.rigid_contacts.add_rigid_forces",
    "gravity": "core.fire.add_weight",
    "threads": "core.threads.all_forces",
}

CHILD = """
import json, sys, time, tracemalloc
from itertools import islice
from numba.core import event
from core.errors import InputError
from sandbox import beside
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes import registry

class Watch(event.Listener):
    def __init__(self):
        self.began, self.open, self.found = [], 0, []
        self.seconds = 0.0
    def on_start(self, happened):
        function = happened.data["dispatcher"].py_func
        self.found.append([function.__module__, function.__qualname__])
        self.began.append(time.process_time())
    def on_end(self, happened):
        took = time.process_time() - self.began.pop()
        if not self.began:  # what is compiled for a caller is in the caller's time
            self.seconds += took

beside.start = lambda *_, **__: None  # all is compiled here, where it is watched
watch = Watch()
event.register("numba:compile", watch)
name, more = sys.argv[1], int(sys.argv[2])
scene = registry.get(name)

def held(settings):  # bytes of a run after its first increment
    tracemalloc.start()
    session = Session(name, scene.packings[0], 1, settings)
    session.build()
    session.submit(Protocol(True))
    list(islice(session.increments(400, lambda *_: None), 1))
    found = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    return found, len(session.run.setup.packing)

session = Session(name, scene.packings[0], 1)
session.build()
session.submit(Protocol(True))
list(islice(session.increments(400, lambda *_: None), 1))
modules = sorted(m for m in sys.modules if m.partition(".")[0] in ("core", "scenes", "pymunk"))
a_grain = None
grains = scene.settings().get("grains")
if grains:
    try:
        few, n = held({"grains": grains})
        many, m = held({"grains": grains + more})
        a_grain = (many - few) / (m - n)
    except InputError:  # it has no room for so many
        pass
terms = scene.ingredients(scene.settings())
print(json.dumps({
    "periodic": terms.periodic, "rigid": terms.rigid, "friction": terms.friction, "gravity": terms.gravity,
    "kernels": watch.found, "seconds": watch.seconds, "modules": modules, "bytes_a_grain": a_grain,
}))
"""


def look(scene: str, cache: str) -> dict[str, Any]:
    """One scene as it is by default, with compiled kernels kept in the folder ``cache``."""
    paths = [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]
    done = subprocess.run(
        [sys.executable, "-c", CHILD, scene, str(MORE)],
        env={
            **os.environ,
            "NUMBA_CACHE_DIR": cache,
            "PYTHONPATH": os.pathsep.join(filter(None, paths)),
        },
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=True,
    )
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return {"scene": scene, **found}


def absent(found: dict[str, Any]) -> list[str]:
    """The optional terms of which nothing was compiled, and what was not imported."""
    compiled = {".".join(kernel) for kernel in found["kernels"]}
    gone = [term for term, kernel in TERMS.items() if kernel not in compiled]
    if not found["periodic"]:
        gone.append("periodic box")
    if not any(module.partition(".")[0] == "pymunk" for module in found["modules"]):
        gone.append("pymunk")
    return gone


def section(*, whole: bool) -> Section:
    """All scenes; without ``whole`` none, since each is compiled anew."""
    title = "What each scene is made of, compiled for it alone"
    if not whole:
        return Section(
            "terms", title, (Row("all scenes", "not measured (--quick)"),), {"scenes": []}
        )
    found = []
    for scene in registry.names():
        with tempfile.TemporaryDirectory() as cache:
            found.append(look(scene, cache))
    return Section("terms", title, tuple(map(row_of, found)), {"scenes": found})


def row_of(found: dict[str, Any]) -> Row:
    """What is shown of it."""
    a_grain = found["bytes_a_grain"]
    memory = "" if a_grain is None else f", {a_grain / 1e3:.1f} kB a grain"
    own = sum(module.startswith(("core", "scenes")) for module in found["modules"])
    measured = (
        f"{len(found['kernels'])} functions in {found['seconds']:.1f} s{memory}, {own} modules; without "
        f"{', '.join(absent(found))}"
    )
    return Row(str(found["scene"]), measured)
