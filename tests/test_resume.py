"""`hx.resume`, and what keeps a training that is interrupted: equal to the unbroken one."""

import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from hexapods.runs.tables import digest_of

QUICK: dict[str, Any] = {"simulator": "kinematic", "steps": 60, "evaluate_every": 20, "seed": 5}
CHANGES: list[dict[str, Any]] = [
    {"step": 10, "settings": {"alpha": 0.1}},
    {"step": 15, "disturbance": "sensor-noise:sd_m=0.004"},
    {"step": 40, "settings": {"epsilon": 0.2}},
    {"step": 45, "disturbance": "sensor-noise:sd_m=0.01"},
]


class At:
    """Sends SIGINT to this process after a number of steps, as Ctrl-C does."""

    def __init__(self, step: int) -> None:
        self.step = step

    def __call__(self, record: object) -> None:
        if isinstance(record, hx.StepTaken) and record.step == self.step:
            os.kill(os.getpid(), signal.SIGINT)


def assert_equal(resumed: hx.Training, unbroken: hx.Training) -> None:
    """Check that two trainings are equal to the last bit, their generators and robots too."""
    assert resumed.config == unbroken.config
    assert resumed.result == unbroken.result
    assert resumed.curve == unbroken.curve
    assert digest_of(resumed.table.arrays) == digest_of(unbroken.table.arrays)
    assert resumed.to_bytes() == unbroken.to_bytes()


def interrupted(path: Path, at: int, agent: str, **options: Any) -> hx.Interrupted:
    """Train until SIGINT after some steps, and return what is raised."""
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(hx.Interrupted) as raised:
        hx.train(agent, checkpoint=path, on_record=At(at), **options)
    assert signal.getsignal(signal.SIGINT) is before
    return raised.value


@pytest.mark.parametrize(
    "agent", ["q-learning", "double-q", "sarsa", "q-lambda", "dyna-q", "r-max", "linear-model"]
)
@pytest.mark.parametrize("at", [1, 40, 47])
def test_a_training_that_is_resumed_equals_the_unbroken_one(
    agent: str, at: int, tmp_path: Path
) -> None:
    path = tmp_path / "q.checkpoint.npz"
    raised = interrupted(path, at, agent, **QUICK)
    assert (raised.path, raised.step, raised.steps) == (path, at, 60)
    assert f"hexapods.resume({str(path)!r})" in str(raised)
    assert hx.Training.load(path).table.meta["step"] == at
    assert_equal(hx.resume(path), hx.train(agent, **QUICK))


@pytest.mark.test
@pytest.mark.parametrize("agent", ["q-learning", "expected-sarsa"])
def test_in_mujoco_too(agent: str, tmp_path: Path) -> None:
    options: dict[str, Any] = {**QUICK, "simulator": "mujoco", "steps": 12, "evaluate_every": 0}
    world = ["sensor-noise:sd_m=0.003", "slope:degrees=3:at=8"]
    disturbed: dict[str, Any] = {"tolerance": 0.03, "world": world}
    interrupted(tmp_path / "q.npz", 7, agent, **options, **disturbed)
    assert_equal(hx.resume(tmp_path / "q.npz"), hx.train(agent, **options, **disturbed))


@pytest.mark.parametrize("at", [5, 10, 15, 30, 45])
def test_changes_that_were_made_and_those_to_come_are_kept(at: int, tmp_path: Path) -> None:
    interrupted(tmp_path / "q.npz", at, "q-learning", changes=CHANGES, **QUICK)
    assert_equal(hx.resume(tmp_path / "q.npz"), hx.train(changes=CHANGES, **QUICK))


def test_it_may_be_interrupted_again_and_goes_on_in_the_same_file(tmp_path: Path) -> None:
    path = tmp_path / "q.npz"
    first = hx.train("sarsa", **QUICK)
    interrupted(path, 10, "sarsa", table=first, **QUICK)
    for step in (20, 33, 59):
        with pytest.raises(hx.Interrupted) as raised:
            hx.resume(path, on_record=At(step))
        assert raised.value.step == step
    assert_equal(hx.resume(path), hx.train("sarsa", table=first, **QUICK))


def test_what_on_record_raises_keeps_the_training(tmp_path: Path) -> None:
    path = tmp_path / "q.npz"

    def break_at_30(record: object) -> None:
        if isinstance(record, hx.StepTaken) and record.step == 30:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError) as raised:
        hx.train(checkpoint=path, on_record=break_at_30, **QUICK)
    assert "hexapods.resume(" in raised.value.__notes__[0]
    assert_equal(hx.resume(path), hx.train(**QUICK))


def test_a_practice_that_was_left_goes_on(tmp_path: Path) -> None:
    practice = hx.iter_train(changes=CHANGES, **QUICK)
    for record in practice:
        if isinstance(record, hx.StepTaken) and record.step == 25:
            break
    saved = practice.training.save(tmp_path / "half.npz")
    whole = hx.train(changes=CHANGES, **QUICK)
    assert_equal(hx.resume(practice.training), whole)
    assert_equal(hx.resume(saved), whole)


def test_an_invalid_value_in_a_checkpoint_keeps_the_message_of_its_error(tmp_path: Path) -> None:
    practice = hx.iter_train(**QUICK)
    next(practice)
    training = practice.training
    meta = {**training.table.meta, "disturbances": [{"kind": "flood"}]}
    with pytest.raises(hx.UnknownName, match=r"^unknown kind of disturbance 'flood'"):
        hx.resume(replace(training, table=replace(training.table, meta=meta)))


def test_a_finished_training_is_returned_as_it_is(tmp_path: Path) -> None:
    done = hx.train(**QUICK)
    assert_equal(hx.resume(done.save(tmp_path / "q.npz")), done)


def test_training_and_race_are_loaded_by_their_classes(tmp_path: Path) -> None:
    training = hx.train(**QUICK)
    assert_equal(hx.Training.load(training.save(tmp_path / "q.npz")), training)
    race = hx.race([training, "wave"], steps=5)
    loaded = hx.Race.load(race.save(tmp_path / "race.npz"))
    assert loaded.config == race.config
    assert loaded.recording_sha256 == race.recording_sha256
    assert loaded.standings == race.standings
    with pytest.raises(hx.DamagedFile):
        hx.Training.load(tmp_path / "race.npz")
    with pytest.raises(hx.DamagedFile):
        hx.Race.load(tmp_path / "q.npz")
    with pytest.raises(hx.InvalidInput):
        hx.Race.load(tmp_path / "nothing.npz")
