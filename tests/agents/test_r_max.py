"""R-max: where it goes, and the values of its plans by hand."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.r_max import RMax
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action, Cells
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, A, B, step, value

HIGHEST = 0.02 / (1 - 0.5)


def learner(**settings: Any) -> RMax:
    return RMax(np.random.default_rng(0), PROBLEM, gamma=0.5, max_reward_m=0.02, **settings)


def try_all(agent: RMax, state: Cells, after: Cells, reward_m: float = 0.0) -> None:
    for action in legal_actions(state, 5):
        agent.learn(step(state, action, reward_m, after))


def test_every_action_of_a_state_is_tried_before_one_is_repeated() -> None:
    agent, legal, chosen = learner(), legal_actions(A, 5), []
    for _ in legal:
        chosen.append(agent.act(A, legal))
        agent.learn(step(A, chosen[-1], 0.0, A))

    assert sorted(chosen) == sorted(legal)


def test_it_goes_where_something_is_unknown() -> None:
    agent = learner()
    try_all(agent, A, A, reward_m=0.001)
    agent.learn(step(B, SECOND, 0.0, A))

    # All of A is known: staying there pays 0.001 for ever. Of B the rest is unknown.
    assert agent.values(B)[SECOND] == pytest.approx(0.5 * 0.002, abs=1e-6)
    assert agent.values(B)[Action(2, 4)] == HIGHEST
    assert agent.act(B, legal_actions(B, 5)) != SECOND


def test_unknown_states_are_worth_the_most_and_what_leads_there_less() -> None:
    agent = learner()
    legal = legal_actions(A, 5)
    for action in legal:
        agent.learn(step(A, action, 0.01, B if action == FIRST else A))

    # To B, where nothing is known, and to A, from where FIRST is the best.
    to_unknown = 0.01 + 0.5 * HIGHEST
    assert agent.values(A)[FIRST] == pytest.approx(to_unknown)
    assert agent.values(A)[SECOND] == pytest.approx(0.01 + 0.5 * to_unknown, abs=1e-6)
    assert agent.act(A, legal) == FIRST


def test_a_known_pair_is_believed_for_ever() -> None:
    agent = learner(known_after=2)
    legal = legal_actions(A, 5)
    for action in legal:
        agent.learn(step(A, action, 0.0, A))
    assert agent.values(A)[FIRST] == HIGHEST

    agent.learn(step(A, FIRST, 0.004, A))
    agent.learn(step(A, FIRST, -1.0, A))
    agent.learn(step(A, FIRST, -1.0, A))
    (reward,) = agent.state()["model_rewards"][:, 0][agent.state()["model_pairs"][:, 2] == 2]
    assert reward == pytest.approx(0.004)
    assert agent.visits(A)[FIRST] == 4


def test_evaluations_follow_what_was_seen_and_not_what_is_hoped_for() -> None:
    agent, evaluated = learner(), learner(explore=False)
    agent.learn(step(A, FIRST, 0.01, A))
    evaluated.share_table(agent)

    # From A to A it earns 0.01 for ever; untried actions are worth nothing.
    assert value(evaluated, A, FIRST) == pytest.approx(0.01 / (1 - 0.5), abs=1e-5)
    assert evaluated.act(A, legal_actions(A, 5)) == FIRST
    assert agent.act(A, legal_actions(A, 5)) != FIRST
