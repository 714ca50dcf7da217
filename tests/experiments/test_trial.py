"""A trial is deterministic, can be pickled, and agrees with the specification's figures."""

import json
import pickle
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hexapods.agents.registry import BUILT_IN
from hexapods.assembly import build_learner
from hexapods.domain.errors import UnknownName
from hexapods.domain.world import named_world
from hexapods.experiments.config import experiment_config
from hexapods.experiments.plan import Plan, Trial
from hexapods.experiments.trial import TrialConfig, TrialResult, run_trial
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.training import train
from tests.figures import GREEDY_H, H_M, interquartile_mean, kinematic_rows
from tests.promises.length import at_length
from tests.quick_robot import HASTY


def practice(**values: Any) -> TrainingConfig:
    fields: dict[str, Any] = {"simulator": "kinematic", "evaluate_every": 0, **values}
    return training_config(**{"gait": "left-right-origin", **fields})


def trials(experiment: str, **values: Any) -> list[Trial]:
    fields = {"simulator": "kinematic", "gaits": ("left-right-origin",), **values}
    return list(Plan(experiment_config(experiment, fields)).trials())


def distances_h(some_trials: list[Trial]) -> Any:
    """Run the learners among some trials; distances in half grid sides, (seeds, blocks)."""
    learners = [trial.config for trial in some_trials if trial.setting.role == "learner"]
    return np.array([run_trial(config).distances_m for config in learners]) / H_M


@pytest.mark.parametrize("simulator", ["kinematic", "mujoco"])
def test_a_trial_gives_the_same_result_each_time(simulator: str) -> None:
    config = TrialConfig(training=practice(simulator=simulator, steps=40, seed=5), blocks=2)
    result = run_trial(config)
    assert result.failure is None
    assert len(result.distances_m) == 2
    assert run_trial(pickle.loads(pickle.dumps(config))) == result


def test_a_trial_gives_the_same_result_in_another_process() -> None:
    config = TrialConfig(training=practice(steps=100, seed=5))
    script = (
        "import pickle, sys; from hexapods.experiments.trial import run_trial; "
        "config = pickle.load(sys.stdin.buffer); "
        "sys.stdout.buffer.write(pickle.dumps(run_trial(config)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], input=pickle.dumps(config), capture_output=True, check=True
    )
    assert pickle.loads(done.stdout) == run_trial(config)


def test_a_result_is_the_same_after_json() -> None:
    walked = run_trial(TrialConfig(training=practice(steps=60)))
    (timed,) = [
        trial
        for trial in trials(
            "table1",
            seeds=1,
            observations=("measured",),
            robots=experiment_config("sweep", {}).robots,
        )
        if trial.config.must_be_alone
    ]
    for result in (walked, run_trial(timed.config), TrialResult(failure="it fell")):
        assert TrialResult.from_json(json.loads(json.dumps(result.as_json()))) == result


@pytest.mark.parametrize(("agent", "transitions"), [("greedy", 600), ("two-step", 7800)])
@pytest.mark.parametrize("gait", ["left-right-origin", "front-back-vertical"])
def test_look_ahead_agents_reach_the_greatest_possible_distance(
    agent: str, transitions: int, gait: str
) -> None:
    result = run_trial(TrialConfig(training=practice(agent=agent, gait=gait), blocks=0))
    assert result.distances_m[0] / H_M == pytest.approx(GREEDY_H, abs=0.001)
    assert result.transitions == transitions


def test_search_without_practice_has_its_settings() -> None:
    search = practice(agent="beam", width=2, depth=2)
    result = run_trial(TrialConfig(training=search, blocks=0))

    assert result.transitions == 50 * (12 + 2 * 12)


def test_the_paper_clock_charges_for_simulated_transitions() -> None:
    learner = run_trial(TrialConfig(training=practice(steps=30)))
    greedy = run_trial(TrialConfig(training=practice(agent="greedy"), blocks=0))
    # 50 motions of 0.32 s, and 0.03 motions for each of 12 transitions a step
    assert learner.elapsed_s == pytest.approx(50 * 0.32)
    assert greedy.elapsed_s == pytest.approx(50 * 0.32 * 1.36)
    assert learner.finished_distance_m == learner.distances_m[0]
    assert greedy.finished_distance_m is not None
    assert greedy.finished_distance_m / greedy.distances_m[0] == pytest.approx(0.72, abs=0.02)


def test_distances_after_practice_agree_with_the_specification() -> None:
    seeds = at_length(40, 80)
    distances = distances_h(
        trials("sweep", seeds=seeds, steps=(250, 500), observations=("measured",))
    )
    shares = [100 * interquartile_mean(row) / GREEDY_H for row in distances.reshape(seeds, 2).T]
    assert shares == pytest.approx([60, 74], rel=0.05)


@pytest.mark.parametrize("seed", [0, 1])
def test_blocks_are_those_whose_figures_are_checked_over_a_thousand_seeds(seed: int) -> None:
    config = TrialConfig(training=practice(observation="commanded", steps=250, seed=seed), blocks=4)
    rows = kinematic_rows(seed)
    expected = [rows[f"block {steps}"] for steps in (250, 500, 750, 1000)]
    assert np.array(run_trial(config).distances_m) / H_M == pytest.approx(expected, abs=1e-12)


def test_rivals_are_timed_by_the_wall_clock() -> None:
    config = TrialConfig(training=practice(steps=60), rivals=("greedy", "two-step"))
    ticks = iter(range(10_000))
    result = run_trial(config, timer=lambda: float(next(ticks)))
    assert config.must_be_alone
    assert result.wall is not None
    assert [lane["agent"] for lane in result.wall] == ["q-learning", "greedy", "two-step"]
    assert [lane["decision_s"] for lane in result.wall] == [50.0, 50.0, 50.0]
    alone = run_trial(TrialConfig(training=practice(steps=60)))
    assert result.distances_m == alone.distances_m, "the other lanes do not affect a walk"


def test_failing_agent_gives_a_result_with_the_failure() -> None:
    clumsy = practice(agent="tests.own_agents:Clumsy", steps=1)
    result = run_trial(TrialConfig(training=clumsy, blocks=0))
    assert result.distances_m == ()
    assert result.failure is not None
    assert "I tripped" in result.failure


def test_an_unknown_agent_is_refused() -> None:
    with pytest.raises(UnknownName, match=", ".join(BUILT_IN)):
        run_trial(TrialConfig(training=practice(agent="skynet")))


def test_evaluations_on_the_way_are_those_of_a_training() -> None:
    training = practice(steps=60, seed=5)
    learner = build_learner(replace(training, evaluate_every=20))
    records = list(train(learner, replace(training, evaluate_every=20)))
    curve = {record.step: record.distance_m for record in records if isinstance(record, Evaluated)}
    rewards = [record.reward_m for record in records if isinstance(record, StepTaken)]

    result = run_trial(
        TrialConfig(training=training, evaluations=(0, 20, 40, 60), earning_steps=20)
    )

    assert result.distances_m[1:] == (curve[20], curve[40], curve[60])
    assert result.earned_m == tuple(sum(rewards[n : n + 20]) for n in (0, 20, 40, 60))
    assert TrialResult.from_json(json.loads(json.dumps(result.as_json()))) == result


def test_learner_is_evaluated_in_the_world_as_it_is() -> None:
    values: dict[str, Any] = {"steps": 4, "seed": 1, "simulator": "mujoco", "robot": HASTY}
    training = practice(**values, world=named_world("ice").later(2))
    icy = practice(**values, world=named_world("ice"))
    flat = practice(**values)

    def frozen(config: TrainingConfig, steps: int) -> float:
        (distance_m,) = run_trial(TrialConfig(training=config, evaluations=(steps,))).distances_m
        return distance_m

    assert frozen(training, 1) == frozen(flat, 1) != frozen(icy, 1)
    assert frozen(training, 2) != frozen(flat, 2)


def test_searcher_may_plan_with_the_robot_as_designed() -> None:
    values: dict[str, Any] = {"simulator": "mujoco", "robot": HASTY, "steps": 1}
    limp = practice(agent="greedy", **values, world=named_world("limp-pair"))
    knows = run_trial(TrialConfig(training=limp, blocks=0))
    nominal = run_trial(TrialConfig(training=limp, blocks=0, plans_with="nominal"))

    assert nominal.distances_m[0] < 0.5 * knows.distances_m[0]
