"""The command ``bench``: how fast the program is here. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
from contextlib import suppress

from sandbox.cli import arguments
from sandbox.cli.exit_codes import INTERRUPTED, OK
from sandbox.interrupts import deferred


def bench(options: argparse.Namespace) -> int:
    """Measure the speed, and say which targets were missed."""
    data = arguments.output_file("--json", options.json, [".json"]) if options.json else None
    table = (
        arguments.output_file("--markdown", options.markdown, [".md"]) if options.markdown else None
    )
    from sandbox import environment

    environment.require_pygame_ce()
    from core.files import atomic_write
    from sandbox.studies.bench import bench as benchmark
    from sandbox.studies.bench import report as bench_report

    def show(section: bench_report.Section) -> None:
        print(f"{bench_report.as_text(section)}\n", flush=True)

    report = benchmark.run(quick=options.quick, peers=options.peers, show=show)
    with suppress(KeyboardInterrupt), deferred():
        for path, form in ((data, bench_report.as_json), (table, bench_report.as_markdown)):
            if path is not None:
                with atomic_write(path) as file:
                    file.write(form(report).encode())
        missed = len(report.missed())
        noun = "target" if missed == 1 else "targets"
        print(f"{missed} {noun} missed" if missed else "all targets met")
        return OK
    return INTERRUPTED
