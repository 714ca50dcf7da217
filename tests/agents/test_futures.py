"""Searches tell what they found about each action for their newest decision."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.explanation import ExplainingSearch
from hexapods.agents.registry import BUILT_IN, compares, searches
from hexapods.assembly import build_walkers
from hexapods.runs.lane import lane_config
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.walker import Walker

SEARCHES = [name for name in BUILT_IN if searches(name)]


def walker_of(agent: str, **settings: Any) -> Walker:
    lane = lane_config(agent, **settings)
    config = RaceConfig(gait="left-right-origin", simulator="kinematic", lanes=(lane,), steps=5)
    (walker,) = build_walkers(config, [None])
    return walker


@pytest.mark.parametrize("name", SEARCHES)
def test_futures_are_those_that_the_simulator_gives(name: str) -> None:
    walker = walker_of(name)
    assert isinstance(walker.agent, ExplainingSearch)
    for _ in range(4):
        legal, before = walker.legal, walker.transitions
        action = walker.decide()
        futures = {future.action: future for future in walker.agent.futures()}

        assert action in futures
        assert set(futures) <= set(legal)
        assert all(future.sequences >= 1 for future in futures.values())
        assert walker.transitions - before >= len(futures)
        simulated = {
            action: walker.simulator.step(walker.state, action).reward_m for action in futures
        }
        assert {action: future.reward_m for action, future in futures.items()} == simulated
        walker.carry_out(action)


def test_greedy_and_two_step_take_the_highest_return() -> None:
    for name, steps in (("greedy", 1), ("two-step", 2)):
        walker = walker_of(name)
        action = walker.decide()
        assert isinstance(walker.agent, ExplainingSearch)
        futures = list(walker.agent.futures())
        highest = max(future.return_m for future in futures)

        assert next(future.return_m for future in futures if future.action == action) == highest
        assert len(futures) == 12
        assert {(future.sequences, future.steps) for future in futures} == {
            (12 ** (steps - 1), steps)
        }


def test_two_step_adds_the_best_second_step() -> None:
    walker = walker_of("two-step")
    walker.decide()
    assert isinstance(walker.agent, ExplainingSearch)
    for future in walker.agent.futures():
        walker.set_state(walker.simulator.rest())
        first = walker.carry_out(future.action).reward_m
        second = max(walker.simulator.step(walker.state, a).reward_m for a in walker.legal)
        assert future.return_m == first + second


def test_futures_that_a_beam_dropped_have_fewer_steps() -> None:
    walker = walker_of("beam", width=2, depth=3)
    action = walker.decide()
    assert isinstance(walker.agent, ExplainingSearch)
    futures = {future.action: future for future in walker.agent.futures()}

    assert futures[action].steps == 3
    assert {future.steps for future in futures.values()} >= {1, 3}
    np.testing.assert_array_less(0, [future.sequences for future in futures.values()])


def test_each_search_says_what_it_compares() -> None:
    assert "mean" in compares("mcts")
    assert "highest sum" in compares("beam")
    assert compares("nowhere:Agent") == "return of its simulated sequences"
