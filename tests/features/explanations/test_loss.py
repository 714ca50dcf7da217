"""Why a learner loses: what it had tried of its table, and which better moves it passed over."""

from typing import Any

import numpy as np
import pytest

from app.features.explanations.loss import Deficit, count_tried, loss_view, passed_over
from hexapods.agents.afterstate_q import AfterstateQ
from hexapods.agents.protocol import Problem, Transition
from hexapods.agents.q_learning import QLearning
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.grid import FootGrid
from hexapods.domain.types import Action, Cells
from hexapods.runs.move_comparison import ComparedMove

HOME: Cells = (0, 0, 0)
PAIRS = ((1, 4), (2, 5), (3, 6))
MADE, BEST = Action(0, 1), Action(1, 2)
BEHIND = Deficit("race", 0, "q-learning", "paper", is_ranked=True, ahead=1, behind_m=0.1)


def learner(kind: type[TabularLearner] = QLearning, **rewards_m: float) -> Any:
    """Return a learner that has tried these moves at home, `made` or `best`, once each."""
    problem = Problem(PAIRS, FootGrid(0.04, 2).cells)
    agent = kind(
        rng=np.random.default_rng(0), problem=problem, explore=False, steps=10, steps_per_episode=5
    )
    for name, reward_m in rewards_m.items():
        action = MADE if name == "made" else BEST
        agent.learn(Transition(HOME, action, reward_m, (1, 1, 1), [Action(0, 0)]))
    return agent


def step(best_reward_m: float = 0.01) -> ComparedMove:
    return ComparedMove(HOME, MADE, 0.005, BEST, best_reward_m)


@pytest.mark.parametrize(
    ("rewards_m", "reason"),
    [
        ({}, "untried"),
        ({"made": 0.01}, "untried"),
        ({"made": 0.01, "best": 0.002}, "undervalued"),
        ({"made": 0.01, "best": 0.02}, "not chosen"),
    ],
)
def test_a_better_move_is_passed_over_for_a_reason(rewards_m: dict[str, Any], reason: str) -> None:
    assert passed_over(learner(**rewards_m), step()) == reason


def test_a_move_that_is_no_millimetre_better_is_none() -> None:
    assert passed_over(learner(), step(best_reward_m=0.0059)) is None


def test_tried_moves_are_counted_in_the_table_and_where_it_walked() -> None:
    agent = learner(made=0.01, best=0.02)
    tried = count_tried(agent, [HOME, HOME, (1, 1, 1)])

    assert (tried.tried, tried.entries, tried.kind) == (2, 1500, "moves")
    assert (tried.states, tried.tried_there, tried.moves_there) == (2, 2, 24)


def test_of_a_learner_over_landings_these_are_counted() -> None:
    agent = learner(AfterstateQ, made=0.01, best=0.02)
    tried = count_tried(agent, [HOME])

    # A landing is that of several moves, of which one from here.
    assert (tried.tried, tried.entries, tried.kind) == (2, 125, "landings")
    assert (tried.tried_there, tried.moves_there) == (2, 12)


def test_three_sentences_have_the_numbers() -> None:
    agent = learner(made=0.01)
    loss = loss_view(BEHIND, [step(), step(), step(0.005)], lambda _: agent, practised_steps=10)
    table, moves, better = loss.sentences

    assert (loss.better, loss.untried, loss.undervalued) == (2, 2, 0)
    assert "In 10 steps of practice it had tried 1 of the 1500 moves in its table (0 %)" in table
    assert "1 of the 12 moves in the state that it walked through" in table
    assert "Its 3 steps brought 5.0 mm each on average" in moves
    assert "would have brought 8.3 mm" in moves
    assert better.startswith("In 2 of its 3 steps the best move would have brought at least 1 mm")
    assert better.endswith("in each of them it had never tried that move.")


def test_where_no_move_was_better_it_says_so() -> None:
    loss = loss_view(BEHIND, [step(0.005)], lambda _: learner(), practised_steps=None)

    assert loss.sentences[0].startswith("Before its last step it had tried 0 of")
    assert "In none of its 1 step would another move have brought 1 mm more" in loss.sentences[2]
