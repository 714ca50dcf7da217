"""The gait of who names none is the same in Python, on the command line, over REST and a page."""

import json
from pathlib import Path

import hexapods as hx
from app.server import create_app
from app.settings import Settings
from hexapods.domain.gait import DEFAULT_GAIT
from hexapods.runs.config import TrainingConfig
from tests.cli.running import in_process
from tests.storage.stores import temporary_store

SHORT = ("--simulator", "kinematic", "--steps", "5")


def test_the_gait_has_one_default(tmp_path: Path) -> None:
    assert TrainingConfig().gait == DEFAULT_GAIT
    assert hx.train("q-learning", simulator="kinematic", steps=5).config.gait == DEFAULT_GAIT
    trained = json.loads(in_process("train", *SHORT, "--json", folder=tmp_path).stdout)
    assert trained["config"]["gait"] == DEFAULT_GAIT
    raced = in_process("race", *SHORT, "--lane", "greedy", "--json", folder=tmp_path)
    assert json.loads(raced.stdout)["config"]["gait"] == DEFAULT_GAIT
    with temporary_store() as store:
        schemas = create_app(Settings(data=tmp_path), store).openapi()["components"]["schemas"]
    for body in ("QLearningTraining", "RaceBody"):
        assert schemas[body]["properties"]["gait"]["default"] == DEFAULT_GAIT
        assert "gait" not in schemas[body].get("required", ())
