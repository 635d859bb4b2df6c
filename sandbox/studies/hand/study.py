"""The study of the hand: what locks at which strength, whether every tour keeps its word, and what random hands can break."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from core.warmup import compile_kernels
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.machine import machine
from sandbox.ensemble.pool import Pool, stopping
from sandbox.files.folder import write_text
from sandbox.lessons import tours
from sandbox.studies.common.kept import keep, read
from sandbox.studies.hand.jobs import Job, Row, carry_out
from sandbox.studies.hand.report import as_json, as_markdown, as_table
from scenes import registry
from scenes.scene import HAND_STRENGTH, STRONGEST, Ingredients

KEPT = "unfinished.jsonl"  # runs so far, until all are there
SEEDS, QUICK_SEEDS = 20, 2
MACHINE_SEEDS = 3  # of the scenes whose drive only says what force it needs
RANDOM, QUICK_RANDOM = 1000, 40  # random hands in all
# [k R], the strongest first: what it never asked for, a weaker hand does in just the same way.
STRENGTHS = {"hopper": (12.0, 8.0, 6.0, 4.0), "intruder": (1.2, 0.9, 0.6, 0.3)}


@dataclass(frozen=True)
class Study:
    """What the study came to: rows of all runs, and what went wrong with those that have none."""

    rows: tuple[Row, ...]
    failures: tuple[str, ...]
    interrupted: bool


def scenes_with_a_hand() -> tuple[str, ...]:
    """Those whose hand has a strength."""
    return tuple(
        name
        for name in registry.names()
        if any(p.name == HAND_STRENGTH for p in registry.get(name).parameters)
    )


def pushes(seeds: int) -> list[Job]:
    """The scenes in which a hand locks, at four strengths each."""
    return [
        Job("push", scene, packing, seed, strength)
        for scene, strengths in STRENGTHS.items()
        for strength in strengths
        for packing in registry.get(scene).packings
        for seed in range(1, seeds + 1)
    ]


def machines(seeds: int) -> list[Job]:
    """The other scenes under a testing machine: the peaks of the force say what a hand would need."""
    return [
        Job("push", scene, packing, seed, STRONGEST)
        for scene in scenes_with_a_hand()
        if scene not in STRENGTHS
        for packing in registry.get(scene).packings
        for seed in range(1, seeds + 1)
    ]


def random_hands(count: int) -> list[Job]:
    """Spread evenly over scenes and packings, with all defaults; each has a seed of its own."""
    places = [
        (scene, packing)
        for scene in scenes_with_a_hand()
        for packing in registry.get(scene).packings
    ]
    return [Job("random", *places[k % len(places)], 1 + k // len(places)) for k in range(count)]


def played_tours(seeds: int) -> list[Job]:
    """Every tour on every seed."""
    return [
        Job("tour", scene, "", seed) for scene in tours.scenes() for seed in range(1, seeds + 1)
    ]


def all_jobs(quick: bool = False) -> list[Job]:
    """What the study carries out."""
    seeds, count = (QUICK_SEEDS, QUICK_RANDOM) if quick else (SEEDS, RANDOM)
    return [
        *pushes(seeds),
        *played_tours(seeds),
        *random_hands(count),
        *machines(min(seeds, MACHINE_SEEDS)),
    ]


def study(
    folder: Path, *, quick: bool = False, jobs: int = 2, chosen: Sequence[Job] | None = None
) -> Study:
    """Carry out all runs. Ctrl-C keeps the finished ones; the same call goes on from there."""
    began = time.perf_counter()
    wanted = {job.key(): job for job in (all_jobs(quick) if chosen is None else chosen)}
    kept = folder / KEPT
    rows = {key: row for key, row in read(kept).items() if key in wanted}
    found, failures = len(rows), list[str]()

    def done(job: Job, row: Row) -> None:
        rows[job.key()] = row
        keep(kept, job.key(), row)

    def failed(job: Job, reason: str) -> str:
        failures.append(f"{job}: {reason}")
        return f"failed: {failures[-1]}"

    batch = Batch(
        _carry_out,
        [job for key, job in wanted.items() if key not in rows],
        done,
        failed,
        known=lambda job: implied(job, rows.values()),
        prepare=_compile,
        label=lambda _: "hands",
    )
    try:
        with Pool(jobs) as pool:
            carry_out_all(batch, pool, jobs, found)
    except KeyboardInterrupt:
        return Study(tuple(rows.values()), tuple(failures), interrupted=True)
    ordered = [rows[key] for key in wanted if key in rows]
    about = {
        "quick": quick,
        "seconds": round(time.perf_counter() - began, 1),
        "runs_from_before": found,
        **machine(),
    }
    write_text(folder / "runs.csv", as_table(ordered))
    write_text(folder / "results.json", as_json(ordered, failures, about))
    write_text(folder / "hand.md", as_markdown(ordered, failures, about))
    kept.unlink(missing_ok=True)
    return Study(tuple(ordered), tuple(failures), interrupted=False)


def implied(job: Job, rows: Iterable[Row]) -> Row | None:
    """What a push comes to if a stronger hand's run never asked for more than this one has: the same, to the last bit."""
    if job.part != "push" or job.strength is None:
        return None
    for row in rows:
        same = all(row[name] == getattr(job, name) for name in ("part", "scene", "packing", "seed"))
        if same and row["strength"] > job.strength and row["peak_force"] <= job.strength:
            return {**row, "strength": job.strength}
    return None


def _carry_out(job: Job) -> Row:
    """In a process of the pool."""
    return carry_out(job, stopping)


def _compile() -> None:
    """Every sort of kernels that the scenes use, once."""
    sorts = [registry.get(name) for name in registry.names()]
    terms: set[Ingredients] = {scene.ingredients(scene.settings()) for scene in sorts}
    for each in terms:
        compile_kernels(**asdict(each))
