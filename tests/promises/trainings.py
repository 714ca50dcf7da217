"""References for tests of trainings: an uninterrupted run, and the step of a checkpoint."""

import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from app.storage.database.opening import DATABASE_FILE
from app.storage.run import CHECKPOINT
from hexapods.agents.protocol import Tunable
from hexapods.assembly import build_learner
from hexapods.domain.records import from_json
from hexapods.runs.config import TrainingConfig
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.tables import from_bytes, snapshot, to_bytes
from hexapods.runs.training import train


def uninterrupted(
    shown: Mapping[str, Any], changes: Sequence[Mapping[str, Any]]
) -> tuple[bytes, list[dict[str, Any]]]:
    """Run a training without interruption, in this process.

    Args:
        shown: its config, as returned by the API.
        changes: changes of its rates, each with its step.

    Returns:
        The file of its table, with random generator and robot; and its curve.
    """
    config = from_json(TrainingConfig, {k: v for k, v in shown.items() if k != "continue_from"})
    assert isinstance(config, TrainingConfig)
    learner, curve, later = build_learner(config), [], list(changes)
    agent = learner.walker.agent
    assert isinstance(agent, Tunable)
    for record in train(learner, config):
        if isinstance(record, Evaluated):
            row = {"step": record.step, "distance_m": record.distance_m, "epsilon": record.epsilon}
            curve.append(row)
        while isinstance(record, StepTaken) and later and later[0]["step"] == learner.step:
            change = later.pop(0)
            agent.tune(**change.get("settings", {}))
    assert not later
    return to_bytes(snapshot(learner, config, changes=list(changes))), curve


def checkpoint_step(folder: Path, run_id: str) -> int | None:
    """Return the step of a run's newest checkpoint, read beside the running server."""
    query = "SELECT file FROM artifacts WHERE run_id = ? AND name = ?"
    with closing(sqlite3.connect(folder / DATABASE_FILE)) as connection:
        row = connection.execute(query, (run_id, CHECKPOINT)).fetchone()
    if row is None:
        return None
    (file,) = folder.glob(f"artifacts/*/{row[0]}")
    step: int = from_bytes(file.read_bytes(), "the checkpoint").meta["step"]
    return step
