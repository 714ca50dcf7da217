"""`hexapods bench` prints every figure; their values depend on the machine."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from app.cli import benchmarks
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from tests.cli.running import in_process, output
from tests.quick_robot import HASTY


@pytest.mark.promises
def test_bench_prints_every_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmarks, "ROUNDS", 1)
    monkeypatch.setattr(benchmarks, "WALK", replace(benchmarks.WALK, robot=HASTY))
    monkeypatch.setattr(benchmarks, "TrainingConfig", partial(TrainingConfig, robot=HASTY))
    monkeypatch.setattr(benchmarks, "RaceConfig", partial(RaceConfig, robot=HASTY))
    figures = output("bench", folder=tmp_path, run=in_process)
    assert set(figures) >= {
        "training_over_physics",
        "physics_substeps_per_second",
        "physics_over_all_that_is_drawn",
        "lookahead_speedup",
        "two_step_decision_over_motion",
        "planning_overhead",
        "picture_encoding_share",
        "picture_bytes_per_second",
    }
    assert all(isinstance(value, int | float) for value in figures.values())
    assert figures["training_over_physics"] > 0
    assert figures["two_step_decision_over_motion"] > 0
