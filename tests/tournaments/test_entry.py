"""Entries that rules allow and refuse."""

from typing import Any

import pytest

from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot import PRESETS
from hexapods.domain.settings import SettingValues
from hexapods.tournaments.entry import EntryConfig, check_table, completed, references, training_of
from tests.tournaments.sample_tournaments import rules_of, table_of

DIGEST = "ab" * 32


def entry_of(agent: str = "q-learning", **fields: Any) -> EntryConfig:
    if "settings" in fields:
        fields["settings"] = SettingValues(fields["settings"])
    return EntryConfig(agent=agent, **fields)


def test_an_entry_practises_the_whole_budget_unless_it_says_less() -> None:
    rules = rules_of(steps=80)
    assert training_of(entry_of(), rules).steps == 80
    assert training_of(entry_of(steps=30), rules).steps == 30


def test_a_completed_entry_has_all_settings() -> None:
    entry = completed(entry_of(settings={"alpha": 0.5}), rules_of())
    assert entry.settings["alpha"] == 0.5
    assert entry.settings["gamma"] == 0.9
    assert completed(entry, rules_of()) == entry
    assert from_json(EntryConfig, to_json(entry)) == entry


def test_a_creature_walks_in_its_gait() -> None:
    rules = rules_of(robots=(PRESETS["dog"],))
    assert training_of(entry_of(robot=PRESETS["dog"]), rules).gait == "trot"
    assert training_of(entry_of(robot=PRESETS["stiff"]), rules).gait == rules.gait


def test_the_references_are_greedy_random_walk_and_linear_model() -> None:
    agents = [reference.agent for reference in references(rules_of())]
    assert agents == ["greedy", "random-walk", "linear-model"]


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (entry_of("no-such"), "unknown agent 'no-such'; choose one of: .*q-learning"),
        (entry_of("tests.own_agents:Restless"), "unknown agent"),
        (entry_of(observation="guessed"), "observation"),
        (entry_of(steps=61), "steps must be from 1 to 60, the budget of this tournament, not 61"),
        (entry_of(steps=0), "steps must be from 1 to 60"),
        (entry_of("greedy", steps=10), "greedy practises no steps here"),
        (entry_of(settings={"alpha": 7}), "alpha must be"),
        (entry_of(settings={"depth": 2}), "unknown setting of q-learning 'depth'"),
        (entry_of(settings={"seed": 5}), "unknown setting of q-learning 'seed'"),
        (entry_of(settings={"steps": 9}), "unknown setting of q-learning 'steps'"),
        (entry_of("greedy", settings={"depth": 2}), "greedy has no settings"),
        (entry_of(robot=PRESETS["crab"]), "crab is no robot of this tournament; .*: stiff, dog"),
        (entry_of(table=DIGEST), "no trained tables enter this tournament"),
    ],
)
def test_an_entry_that_the_rules_do_not_allow_is_refused(entry: EntryConfig, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        training_of(entry, rules_of(robots=(PRESETS["dog"],)))


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (entry_of("greedy", table=DIGEST), "greedy does not learn, so it has no table"),
        (entry_of(table=DIGEST, steps=5), "practises no steps here"),
        (entry_of(table=DIGEST, settings={"alpha": 0.5}), "leave out alpha"),
    ],
)
def test_an_entry_with_a_table_says_no_more(entry: EntryConfig, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        training_of(entry, rules_of(tables=True))


def test_a_table_must_be_of_the_agent_and_the_problem_and_within_the_budget() -> None:
    rules = rules_of(tables=True)
    check_table(entry_of(table=DIGEST), rules, table_of())
    with pytest.raises(TableMismatch, match="learned by q-learning, not by sarsa"):
        check_table(entry_of("sarsa", table=DIGEST), rules, table_of())
    with pytest.raises(TableMismatch, match="observation"):
        check_table(entry_of(table=DIGEST, observation="commanded"), rules, table_of())
    with pytest.raises(TableMismatch, match="divisions"):
        check_table(entry_of(table=DIGEST), rules, table_of(divisions=3))
    with pytest.raises(InvalidInput, match=r"has practised 61 steps; the budget .* is 60"):
        check_table(entry_of(table=DIGEST), rules, table_of(61))
