"""The studies that ``study NAME`` can run: each reads the options of the command line and returns an exit code.

Light at the top, as the command line is; a study imports what it needs when it runs.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from core.errors import InputError
from sandbox.cli.exit_codes import FAILED, INTERRUPTED, OK
from scenes.text import counted

Study = Callable[[argparse.Namespace], int]


def paper(options: argparse.Namespace) -> int:
    """Judge the claims of the paper."""
    from sandbox.extras import require_matplotlib, require_scipy
    from sandbox.files.folder import prepare_folder
    from sandbox.studies.paper import study
    from sandbox.studies.paper.report import summary

    study.choose(options.only)
    require_matplotlib()
    require_scipy()
    folder = prepare_folder(options.out)
    outcome = study.study(folder, quick=options.quick, only=options.only, jobs=options.jobs)
    if outcome.interrupted:
        return stopped(outcome.runs)
    for line in summary(outcome.judged):
        print(line)
    print(f"tables, numbers and figures: {folder / 'claims.md'}, runs.csv, results.json, *.png")
    return OK


def accuracy(options: argparse.Namespace) -> int:
    """Measure error against run time."""
    from sandbox.extras import require_matplotlib, require_scipy
    from sandbox.files.folder import prepare_folder
    from sandbox.studies.accuracy import study

    study.choose(options.scene)
    require_matplotlib()
    require_scipy()
    folder = prepare_folder(options.out)
    outcome = study.study(
        folder,
        scenes=options.scene,
        quick=options.quick,
        jobs=options.jobs,
        only_estimate=options.estimate,
    )
    if outcome.interrupted:
        return stopped(outcome.jobs)
    for name, words in (*outcome.statements.items(), *outcome.failures.items()):
        print(f"{name:<18}{words}")
    print(f"tables, numbers and plots: {folder / 'accuracy.md'}, results.json, *.png")
    return FAILED if outcome.failures else OK


def stability(options: argparse.Namespace) -> int:
    """Carry out the hard cases."""
    from collections import Counter

    from sandbox.extras import require_matplotlib
    from sandbox.files.folder import prepare_folder
    from sandbox.studies.stability import study
    from sandbox.studies.stability.case import FAILS

    require_matplotlib()
    folder = prepare_folder(options.out, "")
    done = study.study(folder, quick=options.quick, jobs=options.jobs)
    if done.interrupted:
        return stopped(len(done.outcomes))
    verdicts = Counter(outcome.verdict for outcome in done.outcomes)
    counts = ", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items()))
    print(f"{len(done.outcomes)} cases: {counts}")
    print(f"table, numbers and figures: {folder / 'stability.md'}, results.json, *.png")
    return FAILED if verdicts[FAILS] else OK


def hand(options: argparse.Namespace) -> int:
    """Measure what a hand can move, play every tour, let random hands loose."""
    from sandbox.extras import require_scipy
    from sandbox.files.folder import prepare_folder
    from sandbox.studies.hand import study
    from sandbox.studies.hand.report import wrong

    require_scipy()
    folder = prepare_folder(options.out, "")
    done = study.study(folder, quick=options.quick, jobs=options.jobs)
    if done.interrupted:
        return stopped(len(done.rows))
    found = [*wrong(done.rows), *done.failures]
    for line in found:
        print(line)
    print(f"{counted(len(done.rows), 'run')}: {len(found) or 'nothing'} not as it should be")
    print(f"tables and numbers: {folder / 'hand.md'}, runs.csv, results.json")
    return FAILED if found else OK


def classics(options: argparse.Namespace) -> int:
    """Hold the program against textbook and published cases."""
    from sandbox.extras import require_scipy
    from sandbox.files.folder import prepare_folder
    from sandbox.studies.classics import study
    from sandbox.studies.common.verdicts import FAILS

    cases = study.choose(options.only)
    require_scipy()
    folder = prepare_folder(options.out, "")
    done = study.study(folder, quick=options.quick, jobs=options.jobs, cases=cases)
    if done.interrupted:
        return stopped(len(done.rows))
    width = max((len(case.name) for case, _, _, _ in done.verdicts), default=0)
    for case, check, verdict, _ in done.verdicts:
        print(f"{case.name:<{width}}  {verdict:<15}  {check.quantity}: {check.estimate.value:.6g}")
    for line in done.failures:
        print(f"failed: {line}")
    print(f"tables and numbers: {folder / 'classics.md'}, runs.csv, results.json")
    wrong = any(verdict == FAILS for _, _, verdict, _ in done.verdicts)
    return FAILED if done.failures or wrong else OK


def clogging(options: argparse.Namespace) -> int:
    """Clogging as an experiment: ensembles of drains and pushes."""
    from sandbox.extras import require_matplotlib, require_scipy
    from sandbox.files.folder import prepare_folder
    from sandbox.studies.clogging import study
    from sandbox.sweep import workers
    from sandbox.sweep.sweep import Ways

    parts = study.choose(options.only)
    require_matplotlib()
    require_scipy()
    ways = Ways(workers.check(options.executor or workers.LOCAL), options.jobs)
    folder = prepare_folder(options.out, "")
    done = study.study(folder, ways, parts, quick=options.quick)
    if done.interrupted:
        return stopped(done.runs)
    width = max((len(claim.name) for claim, _, _, _ in done.verdicts), default=0)
    for claim, check, verdict, _ in done.verdicts:
        print(f"{claim.name:<{width}}  {verdict:<15}  {check.quantity}: {check.estimate.value:.4g}")
    print(f"tables, numbers and pictures: {folder / 'clogging.md'}, results.json, PART/index.html")
    return FAILED if done.failed else OK


def stopped(runs: int) -> int:
    """Say that a study was interrupted after so many runs; the exit code for that."""
    print(
        f"stopped after {counted(runs, 'run')}: the same command goes on from there",
        file=sys.stderr,
    )
    return INTERRUPTED


def refuse_foreign_options(options: argparse.Namespace) -> None:
    """Raise InputError for an option that belongs to other studies."""
    for name, owners in OWN_OPTIONS.items():
        if options.name not in owners and getattr(options, name):
            whose = " and ".join(owners)
            raise InputError(f"--{name} belongs to study {whose}, not to study {options.name}")


STUDIES: dict[str, Study] = {
    "paper": paper,
    "accuracy": accuracy,
    "stability": stability,
    "hand": hand,
    "classics": classics,
    "clogging": clogging,
}
OWN_OPTIONS = {
    "only": ("paper", "classics", "clogging"),
    "scene": ("accuracy",),
    "estimate": ("accuracy",),
    "executor": ("clogging",),
}


def study(options: argparse.Namespace) -> int:
    """Carry out one of the studies."""
    refuse_foreign_options(options)
    try:
        return STUDIES[options.name](options)
    except KeyboardInterrupt:
        # After the last run, that is: a study that is stopped earlier says how far it has come.
        there = Path(options.out).is_dir()
        kept = f"; what was finished is in {options.out}, the same command goes on from there"
        print(f"stopped{kept if there else ': nothing was written'}", file=sys.stderr)
        return INTERRUPTED
