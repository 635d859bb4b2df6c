"""What a study writes down after each increment of a run, besides the scene's own curve."""

from __future__ import annotations

import numpy as np

from core import observables
from core.avalanches import force_changes, participation, weights
from core.exact import approximate_distance, contact_distance
from core.packing import Packing
from sandbox.session.session import Session

LEAST_DROP = (
    0.005  # of the pressure at the start: smaller falls of the shear stress are no avalanche
)
CHANGE_BINS = np.geomspace(1e-6, 1.0, 61)  # of |Δf_c| [k R]


class Probe:
    """The scene's curve; subclasses add columns and lists."""

    def look(self, session: Session) -> dict[str, float]:
        """The numbers of the increment that has just ended."""
        row = session.history[-1]
        return {
            "stroke": float(row.stroke),
            "force": float(row.resisting),
            "residual": float(row.residual),
            "grains_out": float(row.grains_out),
        }

    def lists(self) -> dict[str, list[float]]:
        """Numbers that do not come one an increment."""
        return {}


class GrainShape(Probe):
    """Strains of the height and the width of a single grain, and the plate's force [k R] and approach [R]."""

    def look(self, session: Session) -> dict[str, float]:
        grains = session.run.setup.packing
        radius = float(grains.rest_radius[0])
        tall, wide = float(grains.p[0] - grains.q1[0]), float(grains.p[0] + grains.q1[0])
        return {
            **super().look(session),
            "radius": radius,
            "height_strain": tall / radius - 1.0,
            "width_strain": wide / radius - 1.0,
        }


class Outlines(Probe):
    """Contact distance of two ellipses as the model has it and as it is [R]; the shorter semi-axis, and the tilt [deg]."""

    def look(self, session: Session) -> dict[str, float]:
        grains = session.run.setup.packing
        a, b = (float(axes[0]) for axes in grains.semi_axes)
        angle = float(np.arctan2(grains.y[1] - grains.y[0], grains.x[1] - grains.x[0]))
        return {
            **super().look(session),
            "model_distance": approximate_distance(grains, 0, 1, angle),
            "exact_distance": contact_distance(grains, 0, 1, angle),
            "a": a,
            "b": b,
        }


class Sideways(Probe):
    """A row of grains: the scene's curve is the force on the walls; the force down on one grain is added [k R]."""

    def look(self, session: Session) -> dict[str, float]:
        run = session.run
        floor = run.engine.reactions[run.setup.world.index("floor"), 1]
        return {**super().look(session), "down": -float(floor) / len(run.setup.packing)}


class Contacts(Probe):
    """Coordination number of a periodic packing, all grains counted and rattlers left out."""

    def look(self, session: Session) -> dict[str, float]:
        packing = session.run.engine.packing
        everyone, backbone = observables.coordination(packing, observables.grain_contacts(packing))
        return {**super().look(session), "z_all": everyone, "z": backbone}


class Plate(Probe):
    """Normal stress on the upper plate of a shear cell [k]; the scene's curve is shear stress against shear strain."""

    def look(self, session: Session) -> dict[str, float]:
        run = session.run
        box = run.setup.packing.box
        assert box is not None
        push = run.engine.reactions[run.setup.world.index("upper plate"), 1]
        return {**super().look(session), "normal": float(push) / box.width}


class Avalanches(Probe):
    """Falls of the shear stress: the share of grains that take part, and how much contact forces change [k R]."""

    def __init__(self) -> None:
        self._participation: list[float] = []
        self._mean_change: list[float] = []
        self._drops: list[float] = []
        self._histogram = np.zeros(len(CHANGE_BINS) - 1)
        self._before: tuple[observables.GrainContacts, float] | None = None
        self._least = 0.0

    def look(self, session: Session) -> dict[str, float]:
        packing = session.run.engine.packing
        assert packing.box is not None
        contacts = observables.grain_contacts(packing)
        columns = super().look(session)
        pressure = observables.pressure(observables.stress(contacts, packing.box.area))
        if self._before is None:
            self._least = LEAST_DROP * pressure
        else:
            earlier, stress = self._before
            if stress - columns["force"] > self._least:
                self._note(packing, earlier, contacts, stress - columns["force"])
        self._before = contacts, columns["force"]
        return {**columns, "pressure": pressure}

    def _note(
        self,
        packing: Packing,
        before: observables.GrainContacts,
        after: observables.GrainContacts,
        drop: float,
    ) -> None:
        changes = force_changes(before, after, packing.label, packing.label)
        sizes = np.abs(changes.change)
        self._participation.append(participation(weights(changes, packing.label)))
        self._mean_change.append(float(np.mean(sizes)))
        self._drops.append(drop)
        self._histogram += np.histogram(sizes, CHANGE_BINS)[0]

    def lists(self) -> dict[str, list[float]]:
        return {
            "participation": self._participation,
            "mean_change": self._mean_change,
            "drop": self._drops,
            "change_histogram": self._histogram.tolist(),
        }


PROBES: dict[str, type[Probe]] = {
    "curve": Probe,
    "grain shape": GrainShape,
    "outlines": Outlines,
    "sideways": Sideways,
    "contacts": Contacts,
    "plate": Plate,
    "avalanches": Avalanches,
}
