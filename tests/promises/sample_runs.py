"""Runs of all kinds and states with every field, for tests of storage."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

from app.features.experiments.trial_rows import Trials
from app.storage.database.store import RunStore
from app.storage.run import TABLE, Run
from hexapods.domain.settings import SettingValues
from hexapods.runs.results import RaceResult, TrainingResult
from tests.storage.stores import ODD, SWEEP, TRIALS, experiment, race, training

_RATES = {"alpha": 0.3, "gamma": 0.9, "epsilon_start": 1.0, "epsilon_end": 0.0}
_GRID = {name: (value,) for name, value in _RATES.items()} | {"alpha": (0.1, 0.3)}
_T = datetime(2026, 2, 28, 23, 59, 59, 123456, tzinfo=UTC)
RUNS: list[Run] = [
    training(
        "0pmz0000a0001",
        name="Grüße, 'quoted' \\ and so on",
        state="finished",
        config=replace(ODD, settings=SettingValues(_RATES)),
        done=500,
        changes=({"step": 20, "settings": {"alpha": 0.1}}, {"step": 30, "pace": "max"}),
        greedy_distance_m=0.4321,
        result=TrainingResult(distance_m=None, q_table_sha256="ab" * 32),
        created_at=_T,
        started_at=_T + timedelta(seconds=1),
        ended_at=_T + timedelta(hours=1),
    ),
    training(
        "0pmz0000a0002",
        state="failed",
        continued_from="0pmz0000a0001",
        error="The physics diverged.",
        created_at=_T,
    ),
    race("0pmz0000a0003", state="stopped", result=RaceResult(lanes=()), created_at=_T, ended_at=_T),
]
EXPERIMENT = experiment(
    "0pmz0000a0004",
    state="interrupted",
    config=replace(SWEEP, settings=SettingValues(_GRID)),
    workers=2,
    done=2,
    created_at=_T,
    ended_at=_T,
)
"""It has `TRIALS`."""
ANNOTATIONS: dict[str, Any] = {"tags": ("Übung 1", "kept"), "notes": "Slips.\n\tNext: µ = 0.4"}
"""Tags and notes of the first run."""
CURVE: list[dict[str, Any]] = [
    {"step": 50, "distance_m": 0.125, "epsilon": 1.0},
    {"step": 100, "distance_m": -0.25, "epsilon": 0.9},
]
FILE = bytes(range(256)) * 4


def put(store: RunStore) -> None:
    """Fill an empty store."""
    store.create(*RUNS, EXPERIMENT)
    Trials(store.database).append(EXPERIMENT.id, TRIALS)
    store.curves.append(RUNS[0].id, CURVE)
    store.put_artifact(RUNS[0].id, TABLE, FILE)
    store.update(RUNS[0].id, **ANNOTATIONS)
