"""Encoding of a training's recording: round trip, and truncation at a checkpoint."""

import io
from dataclasses import replace

import numpy as np
import pytest

from hexapods.assembly import build_learner
from hexapods.domain.simulator import Motion
from hexapods.runs.config import training_config
from hexapods.runs.recording import Arrays, PracticeRecording
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.stored_practice import (
    evaluation_arrays,
    practice_arrays,
    practice_recording,
    rewound,
)
from hexapods.runs.training import train


def practise(steps: int, simulator: str = "kinematic") -> PracticeRecording:
    """Record a training as a job does, with an evaluation every 10 steps."""
    config = training_config(
        gait="left-right-origin",
        simulator=simulator,
        steps=steps,
        evaluate_every=10,
    )
    recording = PracticeRecording(np.arange(25, dtype=np.float32))
    for record in train(build_learner(config), config, record=True):
        if isinstance(record, StepTaken | Evaluated):
            recording.add(record)
    return recording


def through_a_file(arrays: Arrays) -> Arrays:
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    with np.load(io.BytesIO(buffer.getvalue()), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def stored(recording: PracticeRecording, a_file: int = 3) -> PracticeRecording:
    evaluations = recording.evaluations
    files = [
        through_a_file(evaluation_arrays(evaluations[start : start + a_file]))
        for start in range(0, len(evaluations), a_file)
    ]
    return practice_recording(through_a_file(practice_arrays(recording)), files)


def assert_same(recorded: PracticeRecording, decoded: PracticeRecording) -> None:
    assert np.array_equal(recorded.rest_qpos, decoded.rest_qpos)
    assert len(recorded.steps) == len(decoded.steps)
    for step, same in zip(recorded.steps, decoded.steps, strict=True):
        assert replace(step, motion=None, action_values=None) == replace(
            same, motion=None, action_values=None
        )
        assert_same_motion(step.motion, same.motion)
        assert (step.action_values is None) == (same.action_values is None)
        if step.action_values and same.action_values:
            for name in ("values", "visits"):
                before, after = getattr(step.action_values, name), getattr(same.action_values, name)
                np.testing.assert_allclose(before, after, rtol=1e-6)
    assert len(recorded.evaluations) == len(decoded.evaluations)
    for evaluation, same_evaluation in zip(recorded.evaluations, decoded.evaluations, strict=True):
        assert replace(evaluation, motion=None) == replace(same_evaluation, motion=None)
        assert_same_motion(evaluation.motion, same_evaluation.motion)


def assert_same_motion(before: Motion | None, after: Motion | None) -> None:
    assert (before is None) == (after is None)
    if before is not None and after is not None:
        assert np.array_equal(before.time_s, after.time_s)
        assert np.array_equal(before.qpos, after.qpos)


@pytest.mark.parametrize(("steps", "simulator"), [(35, "mujoco"), (700, "kinematic")])
def test_recording_round_trips_through_arrays(steps: int, simulator: str) -> None:
    recording = practise(steps, simulator)
    assert recording.steps[0].action_values is not None
    assert recording.evaluations[0].motion is not None
    assert_same(stored(recording), recording)


def test_records_without_motion_or_action_values_round_trip() -> None:
    whole = practise(30)
    bare = PracticeRecording(whole.rest_qpos)
    for number, step in enumerate(whole.steps):
        bare.add(
            replace(
                step,
                motion=step.motion if number % 2 else None,
                action_values=step.action_values if number % 3 else None,
            )
        )
    for evaluation in whole.evaluations:
        bare.add(replace(evaluation, motion=None))
    assert_same(stored(bare), bare)


def test_empty_recording_round_trips() -> None:
    empty = PracticeRecording(np.zeros(25, np.float32))
    assert_same(stored(empty), empty)


def test_evaluations_newer_than_the_file_of_steps_are_dropped() -> None:
    early, late = practise(40), practise(80)
    files = [through_a_file(evaluation_arrays(late.evaluations))]
    assert_same(practice_recording(through_a_file(practice_arrays(early)), files), early)


@pytest.mark.parametrize("step", [5, 45, 60])
def test_recording_is_truncated_at_a_checkpoint(step: int) -> None:
    whole = practise(100)
    again = rewound(whole, step)
    assert [s.step for s in again.steps] == list(range(1, step + 1))
    records: list[StepTaken | Evaluated] = [*whole.steps, *whole.evaluations]
    for record in records:
        if record.step > step:
            again.add(record)
    assert_same(again, whole)
