"""Sarsa(λ): update by hand, and validation of states."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.protocol import Tabular, Tunable
from hexapods.agents.sarsa_lambda import SarsaLambda
from hexapods.assembly import build_learner
from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import Action
from hexapods.runs.config import training_config
from hexapods.runs.training import train
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, THIRD, A, B, C, step, value


def learner(**settings: Any) -> SarsaLambda:
    return SarsaLambda(np.random.default_rng(0), PROBLEM, **settings)


def test_reward_is_credited_to_earlier_steps_by_gamma_lambda() -> None:
    agent = learner(alpha=0.5, gamma=0.9, trace_decay=0.8)
    agent.learn(step(A, FIRST, 0.0, B, SECOND))
    agent.learn(step(B, SECOND, 1.0, C, THIRD))

    assert value(agent, B, SECOND) == pytest.approx(0.5)
    assert value(agent, A, FIRST) == pytest.approx(0.5 * 0.9 * 0.8)


def test_update_uses_the_next_action_and_not_the_best() -> None:
    agent = learner(alpha=1, gamma=0.5, trace_decay=0)
    agent.learn(step(B, SECOND, 2.0, C, THIRD))
    agent.learn(step(A, FIRST, 0.0, B, Action(2, 4)))
    assert value(agent, A, FIRST) == 0
    agent.learn(step(A, FIRST, 0.0, B, SECOND))
    assert value(agent, A, FIRST) == pytest.approx(0.5 * 2)


def test_repeated_action_replaces_its_trace() -> None:
    agent = learner(alpha=1, gamma=0, trace_decay=1)
    agent.learn(step(A, FIRST, 1.0, A, FIRST))
    agent.learn(step(A, FIRST, 3.0, B, SECOND))
    assert value(agent, A, FIRST) == pytest.approx(3)


def test_lambda_can_be_tuned_during_practice() -> None:
    agent = learner(alpha=0.5, gamma=0.9, trace_decay=0.8)
    agent.learn(step(A, FIRST, 0.0, B, SECOND))
    agent.tune(trace_decay=0.0, alpha=1.0)
    agent.learn(step(B, SECOND, 1.0, C, THIRD))
    agent.learn(step(C, THIRD, 1.0, A, Action(2, 4)))

    assert value(agent, C, THIRD) == pytest.approx(1)
    assert value(agent, B, SECOND) == pytest.approx(1)


def test_learned_policy_reaches_the_expected_distance() -> None:
    config = training_config(
        "sarsa-lambda", gait="left-right-origin", simulator="kinematic", steps=1000, seed=1
    )
    *_, last = train(build_learner(config), config)
    assert last.distance_m > 0.3  # type: ignore[union-attr]  # of the last evaluation


@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("trace_decay", np.array([1.5])),
        ("traces", np.array([2.0])),
        ("traces", np.array([np.nan])),
        ("places", np.array([[125, 0]])),
        ("places", np.array([[0, -1]])),
        ("rates", np.array([0.0, 0.9, np.nan])),
        ("learned", np.array([-1])),
    ],
)
def test_check_state_refuses_an_invalid_state(name: str, array: Any) -> None:
    agent = learner()
    agent.learn(step(A, FIRST, 0.0, B, SECOND))
    SarsaLambda.check_state(agent.state())
    with pytest.raises((InvalidInput, ValueError)):
        SarsaLambda.check_state({**agent.state(), name: array})


def test_sarsa_lambda_is_tunable_and_tabular() -> None:
    assert isinstance(learner(), Tunable)
    assert isinstance(learner(), Tabular)
