"""Compile, or load from where they are kept, the kernels that a scene will need, and say how far that is.

Left alone, the kernels would compile inside the first relaxation: the same wait, without a word about it. They come in parts,
which several processes can compile side by side: whoever finds a part compiled loads it in no time.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import numpy as np

from core import generate, kernel_cache, observables, rigid_contacts
from core.friction import Friction
from core.own_process import OWN
from core.packing import Packing, PeriodicBox
from core.passage import pass_faces
from core.relaxation import Relaxation

Tell = Callable[[float], None]
DONE = "done-"  # a file of that name says that a part has been compiled


def _silent(share: float) -> None:
    """Nobody asks how far it is."""


def compile_packing(*, periodic: bool, rigid: bool, progress: Tell = _silent) -> None:
    """What packs grains, and looks at what is packed. ``progress`` is told the share done."""
    scene = _Tiny(periodic, rigid)
    steps: tuple[tuple[float, Callable[[], object]], ...] = (
        (0.1, scene.place),
        (0.7, scene.relax),
        (1.0, scene.contacts),
    )
    with compiling(kernel_cache.CORE, packing_part(periodic=periodic, rigid=rigid)):
        for done, step in steps:
            step()
            progress(done)
    kernel_cache.prune()


def compile_increments(*, periodic: bool, rigid: bool, friction: bool, gravity: bool) -> None:
    """What relaxes an increment with these terms."""
    part = increments_part(periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)
    scene = _Tiny(periodic, rigid)
    with compiling(kernel_cache.CORE, part):
        scene.relax(friction=friction, gravity=gravity)
        scene.push()


def compile_kernels(*, periodic: bool, rigid: bool, friction: bool, gravity: bool) -> None:
    """All that a scene with these terms needs of the solver."""
    compile_packing(periodic=periodic, rigid=rigid)
    compile_increments(periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)


def packing_part(*, periodic: bool, rigid: bool) -> str:
    """Name of what ``compile_packing`` compiles."""
    return _name("packing", periodic=periodic, rigid=rigid)


def increments_part(*, periodic: bool, rigid: bool, friction: bool, gravity: bool) -> str:
    """Name of what ``compile_increments`` compiles."""
    return _name("increments", periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)


def compile_part(name: str) -> None:
    """What one of these names stands for."""
    kind, *there = name.split("-")
    periodic, rigid, friction, gravity = (
        term in there for term in ("periodic", "rigid", "friction", "gravity")
    )
    if kind == "packing":
        compile_packing(periodic=periodic, rigid=rigid)
    else:
        compile_increments(periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)


def _name(kind: str, **terms: bool) -> str:
    return "-".join([kind, *(name for name, there in terms.items() if there)])


def compiled(folder: Path, part: str) -> bool:
    """Has a part of the kernels in a folder of sources been compiled and kept?"""
    kept = kernel_cache.place(folder)
    return any((at / (DONE + part)).exists() for at in (kept, kernel_cache.SHIPPED / kept.name))


@contextmanager
def compiling(folder: Path, part: str) -> Iterator[None]:
    """Compile a part inside, and note that it is done. The collector of garbage rests: a compiler makes much that stays."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if OWN.is_set():
            _set_aside()
        if collects:
            gc.enable()
    if not compiled(folder, part):
        with suppress(OSError):  # nothing can be kept there: nothing is
            (kernel_cache.place(folder) / (DONE + part)).touch()


@cache
def _set_aside() -> None:
    """Modules, compiler, what is compiled: from now on the collector does not look through them each time. Once a process: what
    is there at that moment stays.
    """
    gc.freeze()


class _Tiny:
    """Three grains on a wall: enough to call every kernel."""

    def __init__(self, periodic: bool, rigid: bool) -> None:
        self.box = PeriodicBox(40.0, 40.0) if periodic else None
        self.packing = Packing([0.0, 1.9, 3.8], [0.0, 0.1, 0.0], box=self.box)
        rows = np.array([[rigid_contacts.EDGE, -5.0, -0.95, 1.0, 0.0, 9.0, -0.95, 0.0]])
        self.primitives = rows if rigid else np.zeros((0, rigid_contacts.COLUMNS))

    def place(self) -> None:
        """One more grain, at random."""
        one, none = np.ones(1), np.full(1, -1, dtype=np.int64)
        generate.add(
            np.zeros(1),
            np.zeros(1),
            one,
            none + 1,
            0,
            np.zeros((1, 2)),
            self.primitives,
            none,
            none.copy(),
            1,
            1,
            np.zeros(2),
            np.ones(2),
            None if self.box is None else self.box.kernel_form(),
        )

    def contacts(self) -> tuple[observables.GrainContacts, observables.RigidContacts]:
        """All contacts."""
        return (
            observables.grain_contacts(self.packing),
            observables.body_contacts(self.packing, self.primitives),
        )

    def push(self) -> None:
        """What grains do to bodies: forces on them, and whether any has come through."""
        bodies, rows, state = self.contacts()[1], self.primitives, self.packing.state
        if len(rows):
            observables.reactions(bodies, np.zeros(len(rows), dtype=np.int64), np.zeros((1, 3)))
            which = bodies.grain, bodies.primitive, bodies.image_x, bodies.image_y
            crossed = np.zeros((len(self.packing), len(rows)), dtype=np.bool_)
            pass_faces(*which, state, state, rows, rows, crossed)

    def relax(self, *, friction: bool = False, gravity: bool = False) -> None:
        """One step of an increment in which nothing moves: what touched still does."""
        origin = None
        if friction:
            owner, still = np.zeros(len(self.primitives), dtype=np.int64), np.zeros((1, 3))
            memory = Friction(0.5, len(self.packing))
            origin = memory.begin(self.packing, self.primitives, owner, still, still)
        weight = (0.0, -1e-3) if gravity else None
        relaxation = Relaxation(
            self.packing, self.primitives, origin, weight, tolerance=0.5, max_iterations=1
        )
        if friction or gravity:
            # Before the lists: another process may be compiling those now, to pack with. This it does not need.
            relaxation.compile()
        relaxation.run(1)
        relaxation.gone_through()
        if friction:
            forces = relaxation.slips()[2]
            forces.beyond_cone(0.5, len(self.packing), *self.contacts())
