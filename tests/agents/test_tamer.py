"""TAMER: credit of a press for the steps before it, by hand; its trainers; its explanations."""

import math
from typing import Any

import numpy as np
import pytest

from hexapods.agents.protocol import Press, Teachable
from hexapods.agents.tamer import MEMORY_STEPS, PRESS_M, Tamer
from hexapods.domain.errors import InvalidInput
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, THIRD, A, B, C, step, value


def learner(seed: int = 0, **settings: Any) -> Tamer:
    return Tamer(np.random.default_rng(seed), PROBLEM, **{"trainer": "people", **settings})


def walked(**settings: Any) -> Tamer:
    """Return a learner after the steps A → B → C, each of a second for who watches."""
    agent = learner(watched_step_s=1.0, delay_s=0.5, **settings)
    agent.learn(step(A, FIRST, 0.02, B))
    agent.learn(step(B, SECOND, -0.02, C))
    return agent


def test_shares_of_a_press_add_up_to_one_over_the_steps_before_it() -> None:
    agent = learner(watched_step_s=0.3, delay_s=0.56)
    shares = [agent.credit(10.4 - number) for number in range(12)]

    assert sum(shares) == pytest.approx(1, abs=1e-3)  # whole numbers of steps back to the start
    # Nothing is pressed about what was not seen yet.
    assert shares[11] == 0
    assert max(shares) == shares[9]


def test_a_press_is_credited_by_the_gamma_distribution_of_its_delay() -> None:
    """Pressed 0.8 steps after the second step began: of the delay's mass, 0 to 0.8 s and on."""
    agent = walked(alpha=0.5)
    agent.feel([Press(1.8, 1.0)])
    newest = 1 - (1 + 0.8 / 0.25) * math.exp(-0.8 / 0.25)
    before = 1 - (1 + 1.8 / 0.25) * math.exp(-1.8 / 0.25) - newest

    assert value(agent, B, SECOND) == pytest.approx(0.5 * newest * PRESS_M)
    assert value(agent, A, FIRST) == pytest.approx(0.5 * before * PRESS_M)
    assert value(agent, A, FIRST) > 0


def test_steps_that_share_in_a_press_learn_from_one_error() -> None:
    agent = walked(alpha=1.0)
    for _ in range(200):
        agent.feel([Press(1.8, -0.5)])
    shares = [agent.credit(1.8), agent.credit(0.8)]
    predicted = shares[0] * value(agent, A, FIRST) + shares[1] * value(agent, B, SECOND)

    assert predicted == pytest.approx(-0.5 * PRESS_M)


def test_rewards_teach_nothing_where_people_do() -> None:
    agent = walked()

    assert value(agent, A, FIRST) == value(agent, B, SECOND) == 0
    assert agent.visits(A)[FIRST] == 1


def test_it_takes_what_was_praised_and_avoids_what_was_not() -> None:
    agent = walked()
    agent.feel([Press(1.3, 1.0)])
    assert agent.act(A, [FIRST, SECOND, THIRD]) == FIRST

    agent.feel([Press(1.3, -1.0), Press(1.3, -1.0), Press(1.3, -1.0)])
    assert agent.act(A, [FIRST, SECOND]) == SECOND


@pytest.mark.parametrize("at_step", [0.0, 500.0])
def test_a_press_about_no_step_that_it_remembers_changes_nothing(at_step: float) -> None:
    agent = walked()
    agent.feel([Press(at_step, 1.0)])

    assert value(agent, A, FIRST) == value(agent, B, SECOND) == 0


def test_it_remembers_the_newest_steps_alone() -> None:
    agent = learner(watched_step_s=1.0, delay_s=0.5)
    agent.learn(step(A, FIRST, 0.0, B))
    for _ in range(MEMORY_STEPS):
        agent.learn(step(B, SECOND, 0.0, C))
    agent.feel([Press(1.0, 1.0)])

    assert value(agent, A, FIRST) == 0


def test_the_reward_itself_is_learned_without_presses() -> None:
    agent = walked(trainer="reward", alpha=0.5)

    assert value(agent, A, FIRST) == pytest.approx(0.01)
    assert value(agent, B, SECOND) == pytest.approx(-0.01)


def test_a_simulated_trainer_presses_late_by_the_reward_that_it_sees() -> None:
    agent = learner(trainer="simulated", watched_step_s=1.0, noise_m=0.0, attention=1.0)
    for _ in range(40):
        agent.learn(step(A, FIRST, 0.01, B))
        agent.learn(step(B, SECOND, -0.01, C))

    assert value(agent, A, FIRST) > 0 > value(agent, B, SECOND)
    coming = agent.state()["coming"]
    assert (coming[:, 0] > 80).all()


def test_a_trainer_who_does_not_attend_teaches_nothing() -> None:
    agent = learner(trainer="simulated", attention=0.0)
    agent.learn(step(A, FIRST, 1.0, B))

    assert agent.table.dump()["q"].tolist() == [0.0]


def test_every_update_is_explained_exactly() -> None:
    agent = learner(trainer="simulated", noise_m=0.0, attention=1.0, watched_step_s=0.3)
    explained = [agent.explain_update(step(A, FIRST, 0.01, B)) for _ in range(20)]
    updates = [
        update
        for update_explanation in explained
        for update in (update_explanation.update, *update_explanation.others)
        if update is not None
    ]

    assert updates
    assert all(update.is_exact for update in updates)
    assert updates[-1].after == value(agent, A, FIRST)
    assert "A press came" in explained[-1].summary


@pytest.mark.parametrize(
    ("trainer", "words"), [("people", "somebody presses"), ("reward", "Nobody presses")]
)
def test_it_says_who_teaches_it(trainer: str, words: str) -> None:
    explained = learner(trainer=trainer).explain_update(step(A, FIRST, 0.01, B))

    assert words in explained.summary


def test_people_are_needed_only_where_they_train() -> None:
    Tamer.check_unattended(trainer="simulated")
    Tamer.check_unattended(trainer="reward")

    with pytest.raises(InvalidInput, match=r"presses alone.*simulated or reward"):
        Tamer.check_unattended(trainer="people")


def test_it_can_be_taught() -> None:
    assert isinstance(learner(), Teachable)


@pytest.mark.parametrize(
    "damage",
    [
        {"taken": np.array([1])},
        {"recent": np.array([[0, 99]])},
        {"coming": np.array([[3.0, 2.0]])},
        {"coming": np.array([[np.nan, 1.0]])},
    ],
)
def test_a_state_that_cannot_be_is_refused(damage: dict[str, Any]) -> None:
    state = walked().state()
    Tamer.check_state(state)

    with pytest.raises(ValueError, match="it"):
        Tamer.check_state({**state, **damage})
