"""The same config and seed give the same results, also after the code was redesigned.

On one machine they are the same to the last bit, in every Python: `make pythons` runs this file in
each that is here. Other processors round sines differently, so that distances and values are
compared to a billionth; hashes of all agents and robots are those of Linux on x86-64, with
instructions that all processors with AVX2 have.
"""

import hashlib
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest

from hexapods.assembly import build_learner, build_walkers
from hexapods.experiments.config import experiment_config
from hexapods.experiments.plan import Plan
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.tables import Checkpoint, snapshot
from hexapods.runs.training import train
from tests.digests import COMMON_INSTRUCTIONS, digests_of, results

pytestmark = pytest.mark.test

DIGESTS = {
    "training": "3fd5285abdd8",
    "race": "8aea485629bb",
    "q-learning": "e51eacd968ea",
    "double-q": "fe0efba730fc",
    "q-lambda": "2171349623f9",
    "sarsa": "46ab440a20df",
    "expected-sarsa": "0bb29352a332",
    "n-step-sarsa": "31b27202b515",
    "sarsa-lambda": "66afcbc8d572",
    "dyna-q": "8098024df581",
    "dyna-q-plus": "f36c1596aa32",
    "prioritized-sweeping": "4bc31555c44b",
    "r-max": "4429de9c25ea",
    "posterior-sampling": "3d0d0585fbc2",
    "afterstate-q": "45f5093ba3af",
    "afterstate-r-max": "6377e539c469",
    "multilevel-model": "15500c0bc749",
    "linear-model": "4f1b0571cbcc",
    "tamer": "756a9b2ad027",
    "greedy": "41057ef4948b",
    "two-step": "41057ef4948b",
    "look-ahead": "41057ef4948b",
    "beam": "41057ef4948b",
    "informed": "41057ef4948b",
    "mcts": "17c2779ccb8b",
    "wave": "2d6371b3c103",
    "random-walk": "b0c6c26019fd",
    "robot stiff": "598de02e88a4",
    "robot compliant": "06e1341104a1",
    "robot slippery": "7a97fd3047de",
    "robot ant": "7e95e53ff563",
    "robot crab": "0fe3055e6adb",
    "robot spider": "f273ee915fae",
    "robot starfish": "4a74ed2d0329",
    "robot dog": "e7e56bafaae0",
    "robot centipede": "9ae916d4ea01",
    "robot freenove": "c823495ac15b",
    "robot phantomx": "c645a816b80b",
    "robot chica": "7bf701ff1472",
    "robot of a file": "2ed95bd11f32",
}
"""By the name of a result the beginning of its SHA-256, as Python 3.11 gave it first."""


@pytest.mark.promises
def test_all_results_have_the_same_bits_in_every_python() -> None:
    is_recorded = sys.platform == "linux" and platform.machine() == "x86_64"
    # Of another kind of processor a second time, in a process with other hashes of texts.
    expected = DIGESTS if is_recorded else digests_of(PYTHONHASHSEED="1", **COMMON_INSTRUCTIONS)

    assert digests_of(**COMMON_INSTRUCTIONS) == expected


def test_a_digest_is_recorded_of_every_agent_and_robot() -> None:
    assert list(DIGESTS) == [name for name, _ in results()]


@pytest.mark.parametrize(
    ("config", "value_sum", "distances_m"),
    [
        (
            training_config(gait="left-right-origin", steps=60, seed=3),
            -0.0022191144659891165,
            [0.04388996258182566, 0.05818422492351775, 0.05815430715091744],
        ),
        (
            training_config(gait="front-back-vertical", observation="commanded", steps=60, seed=3),
            -0.0023965468032757726,
            [0.026096609296010827, 0.0580572694484731, 0.058295708284079956],
        ),
        (
            training_config(gait="left-right-vertical", simulator="kinematic", steps=400, seed=3),
            0.3557536924154252,
            [0.04957475994513032, 0.05681755829903978, 0.05681755829903978],
        ),
    ],
)
def test_a_training_and_its_race_give_the_same_table_and_distances(
    config: TrainingConfig, value_sum: float, distances_m: Sequence[float]
) -> None:
    config = replace(config, evaluate_every=0)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    checkpoint = snapshot(learner, config)

    assert float(checkpoint.arrays["agent.q"].sum()) == pytest.approx(value_sum, abs=1e-9)
    assert _race(config, checkpoint) == pytest.approx(distances_m, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "values", "total", "digest"),
    [
        ("table1", {"seeds": 2}, 112, "a2b8666e87ee9f87"),
        (
            "sweep",
            {
                "seeds": 2,
                "gaits": ("left-right-origin",),
                "steps": (40, 80),
                "alpha": (0.1, 0.3),
                "gamma": (0.5, 0.9),
                "divisions": (2, 3),
            },
            34,
            "5db253b56299eb02",
        ),
    ],
)
def test_an_experiment_has_the_same_trials_with_the_same_seeds(
    name: str, values: Mapping[str, Any], total: int, digest: str
) -> None:
    trials = list(Plan(experiment_config(name, values)).trials())

    assert len(trials) == total
    text = "|".join(f"{trial.key} {trial.config.training.seed}" for trial in trials)
    assert hashlib.sha256(text.encode()).hexdigest().startswith(digest)


def _race(training: TrainingConfig, table: Checkpoint) -> list[float]:
    """Distances of the learner, greedy and two-step in six steps [m]."""
    learner = LaneConfig(agent=training.agent, observation=training.observation)
    lanes = (learner, LaneConfig(agent="greedy"), LaneConfig(agent="two-step"))
    race = RaceConfig(
        gait=training.gait, simulator=training.simulator, lanes=lanes, steps=6, seed=1
    )
    walkers = build_walkers(race, [table, None, None], threads=1)
    *_, recorded = record_race(walkers, race, lambda: 0.0)
    return [lane.distance_m for lane in recorded]
