"""The examples of evolutionary search and of deep learning practise on the robot, and walk."""

import subprocess
import sys

import numpy as np
import pytest

import hexapods as hx
from hexapods.agents.registry import build, find
from hexapods.assembly import build_learner
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.tables import from_bytes, restore, snapshot, to_bytes
from hexapods.runs.training import Learner, train
from tests.cli.running import EXAMPLES, ROOT

EVOLUTIONARY = ("cma_es_agent:Agent", "map_elites_agent:Agent")
DEEP = ("sb3_agents:Dqn", "sb3_agents:Ppo")


@pytest.fixture(autouse=True)
def _examples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Add the folder of the examples to Python's module path."""
    monkeypatch.syspath_prepend(str(EXAMPLES))


@pytest.mark.parametrize(("agent", "steps"), [(EVOLUTIONARY[0], 250), (EVOLUTIONARY[1], 60)])
def test_gait_that_it_finds_walks_almost_as_far_as_greedy(agent: str, steps: int) -> None:
    training = hx.train(
        agent, gait="tripod", simulator="kinematic", steps=steps, seed=1, evaluate_every=0
    )

    assert training.result is not None
    assert (training.result.distance_m or 0) > 0.9 * (training.result.greedy_distance_m or 1)


@pytest.mark.parametrize("agent", EVOLUTIONARY)
def test_search_that_is_resumed_amid_a_trial_ends_in_the_same_state(agent: str) -> None:
    config = training_config(
        agent, gait="tripod", simulator="kinematic", steps=60, seed=4, evaluate_every=0
    )
    whole, stopped, resumed = (build_learner(config) for _ in range(3))
    _practise(whole, config, 60)
    _practise(stopped, config, 37)
    restore(resumed, from_bytes(to_bytes(snapshot(stopped, config)), "stopped"))
    _practise(resumed, config, 60)

    expected = whole.walker.agent.state()
    for name, array in resumed.walker.agent.state().items():
        np.testing.assert_array_equal(array, expected[name], name)


def _practise(learner: Learner, config: TrainingConfig, steps: int) -> None:
    for _ in train(learner, config):
        if learner.step == steps:
            return


@pytest.mark.parametrize("agent", DEEP)
def test_frozen_network_is_matrices_that_need_no_torch(agent: str) -> None:
    problem = hx.Problem(((1, 3, 5), (2, 4, 6)), FootGrid().cells)
    offered = {"rng": np.random.default_rng(0), "problem": problem, "explore": False}
    network = build(find(agent), offered)
    biases = np.zeros(10)
    biases[[0, 7]] = 3.0, 2.0  # group 0 to cell 0, group 1 to cell 2
    network.load({"weights0": np.zeros((10, 10)), "biases0": biases})

    assert network.act((1, 0), legal_actions((1, 0), 5)) == (0, 0)
    assert network.act((0, 0), legal_actions((0, 0), 5)) == (1, 2)  # that is not legal here
    np.testing.assert_array_equal(network.state()["biases0"], biases)


def test_deep_learners_practise_without_resets_and_repeat_themselves() -> None:
    program = """
import numpy as np, hexapods as hx
problem = {"gait": "tripod", "simulator": "kinematic", "seed": 2, "evaluate_every": 0}
for agent in ("sb3_agents:Dqn", "sb3_agents:Ppo"):
    first, second = (hx.train(agent, **problem, steps=120).table.part("agent.") for _ in range(2))
    assert all(np.array_equal(array, second[name]) for name, array in first.items())
result = hx.train("sb3_agents:Ppo", **problem, steps=300).result
assert result.distance_m > 0.5 * result.greedy_distance_m, result
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=EXAMPLES,
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
