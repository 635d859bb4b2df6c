"""A hard case: what is done, what is expected, and what came of it."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from core.errors import InputError
from core.relaxation import StopReason
from sandbox.ensemble.pool import Stopped
from sandbox.studies.stability.watch import TimeLimit, Watch, fraction_of_allowed

SOLVED, REFUSED, TIME_LIMIT, CRASHED = "solved", "refused", "time limit", "crashed"
HOLDS, NOT_SOLVED, FAILS = "holds", "not solved", "FAILS"
# The worst first: what an outcome is called when increments ended for several reasons.
REASONS = (
    StopReason.NOT_FINITE,
    StopReason.COLLAPSED,
    StopReason.SUNK,
    StopReason.ITERATION_LIMIT,
)

Act = Callable[[Watch], None]


@dataclass(frozen=True)
class Case:
    """``act`` drives something under a watch. ``allowed`` are the outcomes that need no excuse.

    ``named`` are those that a case may end with because it may be too hard: it is then listed as not solved, with the reason.
    ``place`` puts it on the map of outcomes: kind of packing, Poisson's ratio, contact stiffness.
    """

    group: str
    name: str
    expectation: str
    act: Act
    allowed: tuple[str, ...] = (SOLVED,)
    named: tuple[str, ...] = (StopReason.ITERATION_LIMIT, TIME_LIMIT)
    seconds: float = 30.0  # of a core; then it is stopped
    quick: bool = True  # part of a quick study
    place: tuple[str, float, float] | None = None


@dataclass(frozen=True)
class Outcome:
    """What a case came to."""

    group: str
    name: str
    expectation: str
    ended: str
    message: str
    verdict: str
    increments: int = 0
    iterations: int = 0
    seconds: float = 0.0
    unconverged: int = 0
    closest: str = ""  # what came nearest to not holding
    share: float = 0.0  # of what was allowed there
    broken: tuple[str, ...] = ()
    guarded: int = 0  # increments after which the guard of the area acted
    flattest: float = 1.0  # least b/a of any grain after any increment
    place: tuple[str, float, float] | None = None

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Outcome:
        """What ``as_data`` wrote. Raises TypeError if it is none."""
        place = data["place"]
        return cls(
            **{
                **data,
                "broken": tuple(data["broken"]),
                "place": None if place is None else (place[0], place[1], place[2]),
            }
        )


def carry_out(
    case: Case, quick: bool = False, stopping: Callable[[], bool] = lambda: False
) -> Outcome:
    """Drive one case. Whatever it raises is its outcome, but Stopped."""
    watch = Watch(case.seconds, quick, stopping)
    ended, message = "", ""
    try:
        case.act(watch)
    except Stopped:
        raise
    except InputError as error:
        ended, message = REFUSED, str(error)
        watch.expect_true("refused with one line", bool(message) and "\n" not in message)
    except TimeLimit:
        ended, message = TIME_LIMIT, f"stopped after {case.seconds:g} s of a core"
    except Exception as error:  # noqa: BLE001 - finding these is what the study is for
        place = traceback.extract_tb(error.__traceback__)[-1]
        ended = CRASHED
        message = f"{type(error).__name__} in {place.name}: {' '.join(str(error).split())}"
    else:
        ended = next((str(reason) for reason in REASONS if watch.reasons[reason]), SOLVED)
        unsolved = watch.increments - watch.reasons[StopReason.CONVERGED]
        if unsolved:
            message = f"{unsolved} of {watch.increments} increments"
    if watch.broken or ended not in (*case.allowed, *case.named):
        verdict = FAILS
    else:
        verdict = HOLDS if ended in case.allowed else NOT_SOLVED
    nearest = max(watch.worst.values(), key=fraction_of_allowed, default=None)
    return Outcome(
        case.group,
        case.name,
        case.expectation,
        ended,
        message,
        verdict,
        watch.increments,
        watch.iterations,
        round(watch.seconds, 3),
        watch.increments - watch.reasons[StopReason.CONVERGED],
        "" if nearest is None else nearest.name,
        0.0 if nearest is None else fraction_of_allowed(nearest),
        tuple(watch.broken.values()),
        watch.guarded,
        watch.flattest,
        case.place,
    )
