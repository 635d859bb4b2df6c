"""The study of clogging as a command, on drains that cost nothing: parts, verdicts, and what it goes on from."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("matplotlib")

from sandbox.cli import main as cli
from sandbox.studies.clogging import parts, study
from sandbox.sweep import sweep
from sandbox.sweep.outcome import CLOGGED, EMPTIED, Found
from sandbox.sweep.request import Job
from tests.sweep.conftest import in_threads, invented

__all__ = ["in_threads"]


def drain(job: Job) -> Found:
    """Geometric sizes whose hazard falls with width, weight, and the share of auxetic grains."""
    settings = job.settings
    soft = {"regular": 0.0, "auxetic": 1.0}.get(job.packing, settings["auxetic_fraction"])
    width = float(settings["orifice"]) * (1.0 + 0.3 * float(soft)) + 10.0 * float(
        settings.get("gravity", 0.0)
    )
    rng = np.random.default_rng([job.seed, round(1e6 * width), job.row])
    size = int(rng.geometric(min(0.9, np.exp(0.5 - 0.3 * width**2))))
    return invented(job, CLOGGED if size < 200 else EMPTIED, min(size, 200))


def test_every_part_can_be_asked_and_judging_seeds_are_apart() -> None:
    for quick in (True, False):
        for part in parts.PARTS:
            request = part.request(quick)
            assert request.seeds[0] == parts.FIRST
            assert quick or request.seeds[1] - request.seeds[0] + 1 >= (
                20 if part is parts.WIDE else 50
            )
    runs = sum(part.request(False).runs for part in parts.PARTS)
    assert runs < 5000


@pytest.mark.usefixtures("in_threads")
def test_the_study_judges_what_its_sweeps_hold(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sweep, "carry_out", drain)
    monkeypatch.setattr(study, "draw_all", lambda *_: [])
    monkeypatch.setattr(parts, "QUICK_SEEDS", 12)
    words = ["study", "clogging", "--quick", "--out", str(tmp_path)]
    assert cli.main([*words, "--only", "widths", "wide"]) == 0
    assert cli.main(words) == 0
    said = capsys.readouterr().out
    data = json.loads((tmp_path / "results.json").read_text())
    claims = {claim["claim"] for claim in data["claims"]}
    assert claims == {"jamming", "sizes", "decay", "softness", "maps"}
    slope = next(c for c in data["claims"] if c["quantity"].startswith("slope"))
    assert slope["verdict"] == "holds"
    assert slope["value"] == pytest.approx(-0.3, abs=0.2)
    assert not any(c["verdict"] == "does not hold" for c in data["claims"])
    text = (tmp_path / "clogging.md").read_text()
    assert "| all |" in text
    assert all(part.title in text for part in parts.PARTS)
    assert "holds" in said
    assert (tmp_path / "hazard.png").read_bytes().startswith(b"\x89PNG")
    assert "(hazard.png)" in text
    assert cli.main(["study", "clogging", "--out", str(tmp_path)]) == 2
    assert "a quick one perhaps" in capsys.readouterr().err
