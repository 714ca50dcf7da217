"""Cycles of groups: which are tried, how long each decides, and which one is kept."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hexapods.agents.group_cycles import Cycle, CycleBandit, cycles_of
from hexapods.agents.linear_model import LinearModel
from hexapods.agents.protocol import Problem, Transition
from hexapods.assembly import build_learner
from hexapods.domain.errors import InvalidInput
from hexapods.runs.config import training_config
from hexapods.runs.tables import from_bytes, restore, snapshot, to_bytes
from hexapods.runs.training import train
from tests.agents.test_linear_model import AT_HOME, LEGAL, PROBLEM, Plan, practice, practised

LAW_M = 0.01
POLICIES: Sequence[Cycle | None] = (*cycles_of(3), None)
FORTH, BACK, FIRST_TWICE, SECOND_TWICE, THIRD_TWICE, FREE = range(6)


@pytest.mark.parametrize(
    ("groups", "cycles"),
    [
        (1, ["0"]),
        (2, ["01"]),
        (3, ["012", "021", "0102", "0121", "0212"]),
        (4, ["0123", "0321", "010203", "012131", "021232", "031323"]),
    ],
)
def test_in_a_cycle_each_group_moves_once_or_one_after_each_of_the_others(
    groups: int, cycles: list[str]
) -> None:
    assert ["".join(map(str, cycle)) for cycle in cycles_of(groups)] == cycles


def blocks_of(
    bandit: CycleBandit, earned_m: Callable[[int, int], float], steps: int
) -> list[tuple[int, int]]:
    """Return policy and length of each block in so many steps.

    Args:
        bandit: chooses.
        earned_m: reward of a policy in a step of its block, counted from 0.
        steps: number of steps.
    """
    policy, last, taken = bandit.kept, 0, 0
    blocks: list[tuple[int, int]] = [(policy, 0)]
    for _ in range(steps):
        if bandit.is_over:
            policy, taken = bandit.choose(policy, last), 0
            blocks.append((policy, 0))
        group = bandit.next_group(policy)
        last = last if group is None else group
        bandit.earn(earned_m(policy, taken))
        taken += 1
        blocks[-1] = policy, taken
    return [block for block in blocks if block[1]]


def test_both_orders_are_tried_and_what_is_kept_decides_for_twice_as_long() -> None:
    """Where both earn what the law says, nothing else is tried."""
    rewards_m = {FORTH: 0.0099, BACK: 0.0101}
    blocks = blocks_of(CycleBandit(POLICIES, 3, LAW_M), lambda policy, _: rewards_m[policy], 200)

    assert blocks[:3] == [(FORTH, 6), (BACK, 6), (BACK, 12)]
    assert {policy for policy, _ in blocks} == {FORTH, BACK}
    assert [length for policy, length in blocks if policy == BACK][-1] > 12


def test_other_cycles_are_tried_where_orders_earn_little_and_the_best_is_kept() -> None:
    rewards_m = (0.003, 0.002, 0.001, 0.0035, 0.004, -0.001)
    bandit = CycleBandit(POLICIES, 3, LAW_M)
    blocks = blocks_of(bandit, lambda policy, _: rewards_m[policy], 600)

    assert {policy for policy, _ in blocks} == set(range(6))
    assert bandit.kept == THIRD_TWICE
    lengths = [length for policy, length in blocks if policy == THIRD_TWICE]
    assert lengths[0] == 8  # two rounds of four
    assert max(lengths) == 96
    assert sum(lengths) > 400


def test_a_cycle_is_judged_in_the_second_half_of_its_block() -> None:
    """Changing over costs its first half, which says nothing of the steady walk."""

    def earned_m(policy: int, taken: int) -> float:
        return -0.02 if policy == BACK and taken < 3 else (0.0095, 0.0098)[policy]

    bandit = CycleBandit(POLICIES, 3, LAW_M)
    blocks_of(bandit, earned_m, 12)

    assert bandit.choose(BACK, 0) == bandit.kept == BACK


def test_after_a_change_the_orders_are_tried_again() -> None:
    bandit = CycleBandit(POLICIES, 3, LAW_M)
    blocks_of(bandit, lambda policy, _: (0.012, 0.009)[policy], 100)
    assert bandit.kept == FORTH

    bandit.restart(FORTH, 2)
    after = blocks_of(bandit, lambda policy, _: (0.011, 0.013)[policy], 30)

    assert [policy for policy, _ in after[:3]] == [FORTH, BACK, BACK]
    assert bandit.kept == BACK


def moved(agent: LinearModel, steps: int, reward_m: float) -> list[int]:
    """Return the groups that move in so many steps of one reward."""
    groups = []
    for _ in range(steps):
        action = agent.act(AT_HOME, LEGAL)
        groups.append(action.group)
        agent.learn(Transition(AT_HOME, action, reward_m, AT_HOME, LEGAL))
    return groups


def test_a_linear_model_moves_its_groups_in_cycles() -> None:
    agent = LinearModel(PROBLEM, Plan(), order="cycles")

    assert moved(agent, 12, 0.009) == [0, 1, 2, 0, 1, 2, 1, 0, 2, 1, 0, 2]
    groups = moved(agent, 40, 0.002)
    assert any(groups[place] == groups[place + 2] for place in range(38))
    explained = agent.explain_choice(AT_HOME, LEGAL)
    assert "cycle" in explained.criterion


def test_a_saved_learner_of_cycles_goes_on_to_the_last_bit() -> None:
    config = practice(steps=70, order="cycles", seed=3)
    whole, half = practised(config), practised(replace(config, steps=31))
    resumed = build_learner(config)
    restore(resumed, from_bytes(to_bytes(snapshot(half, config)), "a table"))
    for _ in train(resumed, config):
        pass

    expected, resumed_state = (learner.walker.agent.state() for learner in (whole, resumed))
    assert {k: v.tobytes() for k, v in resumed_state.items()} == {
        k: v.tobytes() for k, v in expected.items()
    }


def test_a_frozen_copy_walks_in_the_cycle_that_was_kept() -> None:
    agent = LinearModel(PROBLEM, Plan(), order="cycles")
    moved(agent, 300, 0.009)
    copy = LinearModel(PROBLEM, Plan(), order="cycles", explore=False)
    copy.load(agent.state())
    best_cycle = POLICIES[int(agent.state()["cycle_counts"][0])]
    assert best_cycle is not None

    groups = [copy.act(AT_HOME, LEGAL).group for _ in range(2 * len(best_cycle))]

    assert groups == [*best_cycle, *best_cycle]


def _broken() -> list[tuple[str, Any, str]]:
    return [
        ("cycle_rewards", np.zeros(4), "cycle_rewards are no 6 numbers"),
        ("cycle_rewards", np.full(6, np.inf), "cycle_rewards are no 6 numbers"),
        ("cycle_judged", np.array([np.nan]), "no whole numbers"),
        ("cycle_counts", np.full(6, 0.5), "no whole numbers"),
        ("cycle_counts", np.full(6, -1.0), "no whole numbers"),
        ("cycle_counts", np.array([6.0, 0, 0, 0, 0, 6]), "out of range"),
    ]


@pytest.mark.parametrize(("name", "value", "complaint"), _broken())
def test_a_broken_state_is_refused(name: str, value: Any, complaint: str) -> None:
    state = LinearModel(PROBLEM, Plan(), order="cycles").state()
    LinearModel.check_state(state)
    with pytest.raises(ValueError, match=complaint):
        LinearModel.check_state({**state, name: value})


def test_what_was_learned_in_another_order_is_refused() -> None:
    turns, cycles = (LinearModel(PROBLEM, Plan(), order=order) for order in ("turns", "cycles"))
    with pytest.raises(ValueError, match="another order"):
        cycles.load(turns.state())
    with pytest.raises(ValueError, match="earned has the shape"):
        turns.load(cycles.state())


def test_an_unknown_order_is_refused_with_the_valid_ones() -> None:
    with pytest.raises(InvalidInput, match="order must be turns, or cycles"):
        training_config("linear-model", gait="left-right-origin", order="random")


@pytest.mark.parametrize("groups", [((1, 3, 5), (2, 4, 6)), ((1, 2, 3, 4, 5, 6),)])
def test_fewer_groups_have_fewer_cycles(groups: tuple[tuple[int, ...], ...]) -> None:
    agent = LinearModel(
        Problem(groups, PROBLEM.cells_m), Plan(((0.0, 0.0),) * len(groups)), order="cycles"
    )

    assert len(agent.state()["cycle_rewards"]) == 2
    LinearModel.check_state(agent.state())
