"""Posterior sampling: what the drawn worlds have in common, by hand."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.posterior_sampling import PosteriorSampling
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, A, B, step, value


def learner(seed: int = 0, **settings: Any) -> PosteriorSampling:
    return PosteriorSampling(np.random.default_rng(seed), PROBLEM, **settings)


def test_drawn_rewards_have_the_mean_and_deviation_of_the_posterior() -> None:
    """Without a discount the values are the rewards. 4 tries of 0.02: by Bayes' rule."""
    drawn, untried = [], []
    for seed in range(400):
        agent = learner(
            seed, gamma=0.0, plan_every=4, prior_deviation_m=0.01, noise_deviation_m=0.02
        )
        for _ in range(4):
            agent.learn(step(A, FIRST, 0.02, A))
        drawn.append(agent.values(A)[FIRST])
        untried.append(agent.values(A)[SECOND])

    # Precision 4 / 0.02² + 1 / 0.01² = 20,000; mean 4 · 0.02 / 0.02² / 20,000 = 0.01.
    assert np.mean(drawn) == pytest.approx(0.01, abs=0.001)
    assert np.std(drawn) == pytest.approx(1 / np.sqrt(20_000), rel=0.15)
    assert np.mean(untried) == pytest.approx(0, abs=0.002)
    assert np.std(untried) == pytest.approx(0.01, rel=0.15)


def test_a_world_is_kept_for_some_steps() -> None:
    agent = learner(plan_every=3)
    values = []
    for _ in range(6):
        agent.learn(step(A, FIRST, 0.01, A))
        values.append(agent.values(A)[FIRST])

    assert values[0] == values[1] == 0
    assert values[2] == values[3] == values[4] != values[5]


def test_it_does_what_is_best_in_the_drawn_world() -> None:
    agent, legal = learner(plan_every=1), legal_actions(A, 5)
    for _ in range(20):
        agent.learn(step(A, FIRST, 0.0, A))
        values = agent.values(A)
        chosen = agent.act(A, legal)
        assert values[chosen] == np.nanmax(values)


def test_worlds_agree_on_what_was_tried_often() -> None:
    agent = learner(plan_every=1200, prior_deviation_m=0.001, noise_deviation_m=0.0001)
    for _ in range(100):
        for action in legal_actions(A, 5):
            agent.learn(step(A, action, 0.01 if action == FIRST else 0.0, A))

    assert agent.values(A)[FIRST] == pytest.approx(0.01 / (1 - 0.9), rel=0.05)
    assert agent.act(A, legal_actions(A, 5)) == FIRST


def test_evaluations_follow_the_mean_of_what_was_seen() -> None:
    agent, evaluated = learner(gamma=0.5), learner(gamma=0.5, explore=False)
    for reward, after in ((0.01, A), (0.03, B)):
        agent.learn(step(A, FIRST, reward, after))
    evaluated.share_table(agent)

    # v = 0.02 + 0.5 · (v + 0) / 2, B being worth nothing.
    assert value(evaluated, A, FIRST) == pytest.approx(0.02 / 0.75, abs=1e-5)
    assert evaluated.act(A, legal_actions(A, 5)) == FIRST


def test_in_a_state_of_which_nothing_was_drawn_it_goes_anywhere() -> None:
    agent, legal = learner(), legal_actions(B, 5)

    assert len({agent.act(B, legal) for _ in range(200)}) == 12
    assert agent.values(B)[Action(2, 3)] == 0
