"""What an engine has before it: grains among bodies, how they are relaxed, and what acts on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from core.friction import Friction
from core.packing import Packing
from core.rigid import Point, RigidWorld
from core.settings import Settings


@dataclass
class System:
    """Held here and nowhere else: an engine works on it, and whoever drives the engine exchanges parts between two increments.

    With ``drag``, see ``Relaxation``, an increment is a step of slow motion even where no body moves. ``follow`` is called when
    bodies have moved: it moves what hangs on them. Without ``relaxes`` it alone says where the grains are and what shape they
    have; forces are then measured, and move nothing.
    """

    packing: Packing
    world: RigidWorld
    solver: Settings = field(default_factory=Settings)
    friction: Friction | None = None  # None: nothing of it is computed
    gravity: Point | None = None  # [k/R]; the weight of a grain is this times R0²
    drag: float = 0.0  # [k/R²]; where there is some, the grains go on by themselves
    follow: Callable[[Packing, RigidWorld], None] | None = None
    relaxes: bool = True

    def rub(self, coefficient: float) -> None:
        """Let contacts have this Coulomb coefficient from now on, and go on remembering; 0: the term does not exist."""
        if self.friction is None or coefficient == 0.0:
            self.friction = Friction.of(coefficient, len(self.packing))
        else:
            self.friction.coefficient = coefficient
