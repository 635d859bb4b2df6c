"""The columns of the tables of a sweep, and what they mean."""

from __future__ import annotations

from scenes import registry
from scenes.parameter import Value

Entry = Value | str  # of a row, before it is written
# What a row holds beside the parameters of the scene: before them, and after.
BEFORE = {
    "row": "number of the run: what play DIR#ROW opens",
    "seed": "of the random packing",
    "packing": "kinds of grains",
}
AFTER = {
    "outcome": "locked: all of the hand's strength moves nothing; clogged: an arch holds what is left; emptied: nothing is left "
    "over the orifice; never started: at rest before a grain had left; ran through: the scripted drive came to its end; "
    "censored: it was broken off before any of these; failed",
    "why": "it was broken off or failed",
    "initial": "grains at the start",
    "out": "grains that left",
    "left": "grains in the scene at the end",
    "arch": "grains of the arch at the end; empty: none",
    "avalanches": "rows in avalanches.csv",
    "increments": "of the run",
    "peak_force": "on the handle, against the drive where there is one [k R]",
    "mean_force": "the same, mean over the increments [k R]",
    "converged": "share of increments relaxed to the tolerance",
    "friction_error": "share of contacts that pull harder than friction allows, mean over the increments",
    "version": "of the program",
    "kernels": "hash of the sources of the physics",
    "python": "version",
    "numpy": "version",
    "numba": "version",
    "state": "hash of every bit of the state at the end",
    "seconds": "of one core; the only column that another run of the same row may change",
}
AVALANCHE = {
    "row": "of runs.csv",
    "avalanche": "its number in the run, from 1",
    "seed": "of the random packing",
    "packing": "kinds of grains",
    "size": "grains that left in it: from one clog, or the start, to the next clog, or the end of the run",
    "ended": "clogged, or the outcome of the run: a size that did not end in a clog is a lower bound",
    "arch": "grains of the arch that ended it; empty: none",
    "increments": "of the run by then",
}


def columns(scene: str) -> dict[str, str]:
    """Of runs.csv: names and what they mean, with units."""
    parameters = {
        p.name: f"{p.help} [{p.unit}]" if p.unit else p.help for p in registry.get(scene).parameters
    }
    return {**BEFORE, **parameters, **AFTER}
