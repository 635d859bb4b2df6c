"""One run in two blocks of memory, whole numbers and others: what a kernel sees of it, and a page that reads the same numbers.

The blocks have room for all grains of the start. Of what is (rows, N) the rows lie one behind the other, N as it is now.
``ints`` begins with the sizes in the order of ``Sizes`` and then has, for each part in the order of ``PARTS``, where it begins.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.arrays import Floats, Indices
from core.jit import kernel
from sandbox.web.increment.cell import CELL, box_of
from sandbox.web.increment.systems import (
    PLACES,
    Bodies,
    Grains,
    Memory,
    Past,
    Settings,
    System,
)


class Sizes(NamedTuple):
    """The first numbers of ``ints``."""

    grains: int  # N, now
    bodies: int
    primitives: int
    room: int  # for contacts that remember a slip
    contacts: int  # room for contacts to be shown
    steps: int  # of the script
    corners: int  # of the space under the outlet
    capacity: int  # grains at the start


class Course(NamedTuple):
    """Places in the parts ``counts``: where a run stands apart from its grains (``sandbox.session.course``)."""

    rows: int = 0  # increments made, that at the start counted
    script: int = 1  # increments of the scripted drive so far; −1: it is off
    stuck: int = 2  # increments in a row in which all the hand's strength moved nothing
    out: int = 3  # grains that have left
    left: int = 4  # and in the latest increment
    touched: int = (
        5  # something was changed: relax where things stand, in so many increments at most
    )
    reason: int = 6  # why the latest relaxation ended
    iterations: int = 7  # of the latest increment
    pairs: int = 8  # contacts between grains that are shown
    shown: int = 9  # all contacts that are shown, those with bodies last
    driven: int = 10  # the body that the script drives and the curve is about
    curve: int = 11  # what is plotted: see ``curve``
    moving: int = 12  # do the grains go on by themselves?
    repeats: int = 13  # does the script begin again where it ends?
    changed: int = 14  # has the latest increment only relaxed what was changed?
    scene: int = 15  # whose remarks are made: see ``remarks``
    said: int = 16  # sentences about the latest increment
    before: int = 17  # contacts between grains in the increment before


class Row(NamedTuple):
    """Places in the part ``row``: what the latest increment came to."""

    stroke: int = 0  # [R]
    resisting: int = 1  # [k R]
    residual: int = 2
    scale: int = 3  # mean contact force [k R]
    energy: int = 4  # [k R²]
    share: int = 5  # of a step that the hand's strength was enough for
    exit_stroke: int = 6  # when a grain last left
    exit_force: int = 7
    direction_x: int = 8  # of the drive
    direction_y: int = 9
    outlet: int = 10  # who is below has left [R]
    beside: int = 11  # or lies under the funnel further from the middle than this [R]
    hand_x: int = 12  # force of the hand along the guide of its body [k R]
    hand_y: int = 13
    side: int = 14  # what the curve is about, see there [R]
    rest: int = (
        15  # grains that come no further in an increment are at rest [R]; ∞ where there is no drag
    )
    waited: int = 16  # stroke between the exits of the latest grain and of the one before it
    base: int = 17  # height of the lips of an orifice [R]
    unbalanced: int = (
        18  # root of the sum of squares of the forces that are left on the grains [k R]
    )
    usual_error: int = 19  # of the force on the handle, over its mean so far; nan: nobody knows
    force_error: int = 20  # and that nine of ten stay within


class Said(NamedTuple):
    """Columns of the part ``said``: a sentence a row."""

    sentence: int = 0  # which: see ``remarks``
    shown: int = 1  # 0: it only tells an event
    event: int = 2  # the kind of an event that begins with it, or −1
    values: int = 3  # four numbers from here on


class Drive(NamedTuple):
    """Places in the part ``drive``: what the increments before came to, for who looks for a sudden fall."""

    stroke: int = 0  # in the one before
    force: int = 1
    older_stroke: int = 2  # and before that
    older_force: int = 3
    sum: int = 4  # of the magnitudes of all that is plotted so far
    asked: int = 5  # was the driven body asked for?
    moved_x: int = 6  # [R]
    moved_y: int = 7
    felt: int = 8  # sum of the magnitudes of the force on the driven body so far [k R]


COUNTS, ROW, SIZES, SAID, DRIVE = Course(), Row(), Sizes(*range(8)), Said(), Drive()
SENTENCES, COLUMNS = (
    8,
    SAID.values + 4,
)  # sentences about an increment, at most, and numbers of each
KINDS = 4  # of events
SETTINGS = len(Settings._fields)
PLACE_OF_OFFSETS = 8


class Parts(NamedTuple):
    """For each part: which number of ``ints`` says where it begins."""

    state: int  # of floats, from here
    rest_radius: int
    poisson_ratio: int
    contact_stiffness: int
    spin: int
    last: int
    slips: int
    places: int
    local: int
    moved: int
    reactions: int
    targets: int  # (B, 3) as ``System.wanted``: where the hand wants bodies
    wanted: int
    settings: int
    row: int
    script: int  # (steps, 2) where the driven body goes [R]
    corners: int  # (corners, 2) [R]
    force: int  # (contacts,) of contacts that are shown [k R]
    ends: int  # (2, contacts) where those with bodies touch [R]
    pressure: int  # (N,) in each grain [k]
    difference: int  # (N,) of the principal stresses [k]
    motion: int  # (N,) in the latest increment, against the mean of all [R]
    said: int  # (SENTENCES, COLUMNS)
    drive: int
    accuracy: int  # (2, 3) bounds of ``scenes.accuracy``: one time in two, and nine of ten
    force_before: int  # (contacts,) between grains, in the increment before [k R]
    cell: int  # (CELL,) see ``cell`` [R]; 0 where it is open
    label: int  # of ints, from here
    keys: int
    known: int
    owner: int
    joints: int
    counts: int
    stopped: int  # (B,) why, in the latest increment
    blocked: int  # (B,) is it stopped until the hand moves?
    first: int  # (contacts,) grains of contacts that are shown
    second: int  # the other; −1: a body
    side: int  # (B,) of an orifice: −1 left of it, 1 right, 0 neither
    squeezed: int  # (N,) further than a real grain could be?
    pointed: int  # (N,) is it meant by what is said?
    going_on: int  # (KINDS,) events
    announced: int  # (KINDS,) grains that had left at the latest of a kind; −1: none yet
    pair_before: int  # (contacts,) labels of both grains


PART = Parts(*range(PLACE_OF_OFFSETS, PLACE_OF_OFFSETS + len(Parts._fields)))
FIRST_INT = "label"
HEAD = PLACE_OF_OFFSETS + len(Parts._fields)


def lengths(sizes: Sizes) -> dict[str, int]:
    """How long each part is, in the order of ``Parts``."""
    n, b, m = sizes.capacity, sizes.bodies, sizes.primitives
    return {
        "state": 5 * n,
        "rest_radius": n,
        "poisson_ratio": n,
        "contact_stiffness": n,
        "spin": n,
        "last": 5 * n,
        "slips": sizes.room,
        "places": PLACES * b,
        "local": 8 * m,
        "moved": 2 * b,
        "reactions": 3 * b,
        "targets": 3 * b,
        "wanted": 3 * b,
        "settings": SETTINGS,
        "row": len(ROW),
        "script": 2 * sizes.steps,
        "corners": 2 * sizes.corners,
        "force": sizes.contacts,
        "ends": 2 * sizes.contacts,
        "pressure": n,
        "difference": n,
        "motion": n,
        "said": SENTENCES * COLUMNS,
        "drive": len(DRIVE),
        "accuracy": 6,
        "force_before": sizes.contacts,
        "cell": CELL,
        "label": n,
        "keys": sizes.room,
        "known": 1,
        "owner": m,
        "joints": 2 * m,
        "counts": len(COUNTS),
        "stopped": b,
        "blocked": b,
        "first": sizes.contacts,
        "second": sizes.contacts,
        "side": b,
        "squeezed": n,
        "pointed": n,
        "going_on": KINDS,
        "announced": KINDS,
        "pair_before": sizes.contacts,
    }


def blank(sizes: Sizes) -> tuple[Indices, Floats]:
    """Both blocks, with nothing in them but sizes and offsets."""
    at = {True: 0, False: HEAD}
    offsets, of_floats = [], True
    for name, length in lengths(sizes).items():
        of_floats = of_floats and name != FIRST_INT
        offsets.append(at[of_floats])
        at[of_floats] += length
    ints, floats = np.zeros(at[False], dtype=np.int64), np.zeros(at[True])
    ints[:HEAD] = [*sizes, *offsets]
    return ints, floats


class Kept(NamedTuple):
    """Both blocks, for kernels."""

    ints: Indices
    floats: Floats


@kernel(allocates=True)
def floats_at(kept, which, size):
    """So many numbers of the part that ``ints[which]`` says the place of."""
    at = kept.ints[which]
    return kept.floats[at : at + size]


@kernel(allocates=True)
def ints_at(kept, which, size):
    """The same of whole numbers."""
    at = kept.ints[which]
    return kept.ints[at : at + size]


@kernel(allocates=True)
def clear(values):
    """All 0."""
    for k in range(values.shape[0]):
        values[k] = 0


@kernel(allocates=True)
def counts_of(kept):
    """The part ``counts``."""
    return ints_at(kept, PART.counts, len(COUNTS))


@kernel(allocates=True)
def row_of(kept):
    """The part ``row``."""
    return floats_at(kept, PART.row, len(ROW))


@kernel(allocates=True)
def system_in(kept):
    """What an increment works on; it writes into the blocks."""
    ints = kept.ints
    n, b, m, room = (
        ints[SIZES.grains],
        ints[SIZES.bodies],
        ints[SIZES.primitives],
        ints[SIZES.room],
    )
    settings = floats_at(kept, PART.settings, SETTINGS)
    return System(
        Grains(
            floats_at(kept, PART.state, 5 * n).reshape(5, n),
            floats_at(kept, PART.rest_radius, n),
            floats_at(kept, PART.poisson_ratio, n),
            floats_at(kept, PART.contact_stiffness, n),
            ints_at(kept, PART.label, n),
        ),
        Bodies(
            floats_at(kept, PART.places, PLACES * b).reshape(b, PLACES),
            floats_at(kept, PART.local, 8 * m).reshape(m, 8),
            ints_at(kept, PART.owner, m),
            ints_at(kept, PART.joints, 2 * m).reshape(m, 2),
        ),
        Settings(
            settings[0],
            settings[1],
            settings[2],
            settings[3],
            int(settings[4]),
            settings[5],
            settings[6],
            settings[7],
            settings[8],
            settings[9],
        ),
        Memory(
            floats_at(kept, PART.spin, n),
            ints_at(kept, PART.keys, room),
            floats_at(kept, PART.slips, room),
            ints_at(kept, PART.known, 1),
        ),
        Past(
            floats_at(kept, PART.last, 5 * n).reshape(5, n),
            floats_at(kept, PART.moved, 2 * b).reshape(b, 2),
            floats_at(kept, PART.reactions, 3 * b).reshape(b, 3),
        ),
        floats_at(kept, PART.wanted, 3 * b).reshape(b, 3),
        box_of(floats_at(kept, PART.cell, CELL)),
    )
