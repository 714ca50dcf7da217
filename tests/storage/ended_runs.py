"""Helpers for tests: ended runs, computed by the real loops and stored with all their files."""

import time
from dataclasses import replace
from typing import Any

import numpy as np

from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import TABLE, Run
from hexapods.assembly import build_learner, build_walkers
from hexapods.runs.config import training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.results import RaceResult, TrainingResult, race_result, training_result
from hexapods.runs.tables import from_bytes, snapshot, to_bytes
from hexapods.runs.training import train
from tests.storage.stores import training

GAIT = "left-right-origin"


def ended_training(
    store: RunStore, run_id: str, name: str = "It learned", steps: int = 120, **walk: Any
) -> Run:
    """Run a training, and store it with its curve, recording, table and result."""
    walk = {"gait": GAIT, **walk}
    config = training_config(steps=steps, simulator="kinematic", evaluate_every=5, **walk)
    store.create(training(run_id, name=name, config=config, total=steps))
    recordings, learner = Recordings(store), build_learner(config)
    rest = learner.walker.simulator.pose(learner.walker.state).astype(np.float32)
    recordings.begin_training(run_id, rest)
    learner.logged = []
    for record in train(learner, config):
        if isinstance(record, StepTaken | Evaluated):
            recordings.add(run_id, record)
        if isinstance(record, Evaluated):
            row = {n: getattr(record, n) for n in ("step", "distance_m", "epsilon")}
            store.curves.append(run_id, [row])
    taken = learner.take_transitions()
    assert taken is not None
    recordings.log(run_id, taken)
    recordings.finish(run_id)
    store.put_artifact(run_id, TABLE, to_bytes(snapshot(learner, config)))
    result = training_result(learner, config)
    changes = ({"step": 3, "settings": {"alpha": 0.25}}, {"step": 9, "pace": "max"})
    return store.change(run_id, {"queued"}, "finished", done=steps, result=result, changes=changes)


def ended_race(store: RunStore, run_id: str, training_id: str, **walk: Any) -> Run:
    """Run a race of a training's table against a greedy lane, and store it with its recordings."""
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    walk = {"gait": GAIT, **walk}
    config = RaceConfig(simulator="kinematic", steps=8, lanes=lanes, **walk)
    table = from_bytes(store.artifact(training_id, TABLE) or b"", "the table")
    store.create(
        Run(
            id=run_id,
            kind="race",
            name="It raced",
            config=config,
            lane_training_ids=(training_id, None),
            total=16,
        )
    )
    *_, recorded = record_race(build_walkers(config, [table, None]), config, time.perf_counter)
    recordings = Recordings(store)
    recordings.begin_race(run_id, [LaneRecording(lane.agent, lane.rest_qpos) for lane in recorded])
    for steps in zip(*(lane.steps for lane in recorded), strict=True):
        for step in steps:
            recordings.add(run_id, step)
    recordings.finish(run_id)
    first, *rest = race_result(recorded, config).lanes
    result = RaceResult(lanes=(replace(first, training_id=training_id), *rest))
    return store.change(run_id, {"queued"}, "finished", done=16, result=result)


def result_of_training(run: Run) -> TrainingResult:
    """Return the result of a training that has one."""
    assert isinstance(run.result, TrainingResult)
    return run.result


def result_of_race(run: Run) -> RaceResult:
    """Return the result of a race that has one."""
    assert isinstance(run.result, RaceResult)
    return run.result
