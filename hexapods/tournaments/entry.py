"""Entries of a tournament: data, never code."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from hexapods.agents.registry import check_problem, learns, registered, searches
from hexapods.domain.errors import InvalidInput, TableMismatch, UnknownName, about
from hexapods.domain.observation import Observation
from hexapods.domain.records import Record
from hexapods.domain.robot import AnyRobot
from hexapods.domain.settings import SettingValues, Value, complete
from hexapods.runs.config import (
    PracticeSteps,
    TrainingConfig,
    agent_settings,
    problem_of,
)
from hexapods.runs.tables import Checkpoint, check_fits
from hexapods.tournaments.rules import TournamentRules

REFERENCES = ("greedy", "random-walk", "linear-model")
"""Agents that are judged in every tournament, beside the entries."""


@dataclass(frozen=True, kw_only=True)
class EntryConfig(Record):
    """An entry: an agent with its settings, a creature where allowed, or a trained table.

    Attributes:
        agent: a registered name.
        observation: observation mode; with a table that of its training.
        settings: the agent's settings by name; the agent's default applies to a missing one, and
            with a table those of its training.
        steps: steps of practice on each draw, within the budget; None for all of it. An agent that
            does not learn, or enters with a table, practises none.
        robot: a creature that the rules allow; None for the robot of the rules.
        table: SHA-256 of the trained table, hexadecimal; None for an agent that practises on each
            draw.
    """

    agent: str
    observation: Observation = "measured"
    settings: SettingValues[Value] = field(default_factory=SettingValues)
    steps: PracticeSteps | None = None
    robot: AnyRobot | None = None
    table: str | None = None


def training_of(entry: EntryConfig, rules: TournamentRules) -> TrainingConfig:
    """Return the training of an entry on any draw, of the seed 0 and undisturbed.

    Raises:
        UnknownName, InvalidInput: if the rules do not allow the entry; the message names what they
            allow.
    """
    if entry.agent not in registered():
        raise UnknownName("agent", entry.agent, registered())
    if learns(entry.agent) and searches(entry.agent):
        # It would practise with a simulator of the draw's world.
        raise InvalidInput(
            f"{entry.agent} learns and plans with a simulator; only one of both is judged here",
            field="agent",
        )
    _check_steps(entry, rules)
    if entry.table is not None:
        _check_table_allowed(entry, rules)
    robot = rules.robot if entry.robot is None else entry.robot
    with about("robot"):
        gait = rules.gait_of(robot)
    walk: dict[str, Any] = vars(rules.walk()) | {"robot": robot, "gait": gait}
    config = TrainingConfig(
        **walk,
        agent=entry.agent,
        observation=entry.observation,
        steps=rules.steps if entry.steps is None else entry.steps,
        evaluate_every=0,
        settings=complete(agent_settings(entry.agent), entry.settings, entry.agent),
    )
    with about("agent"):
        check_problem(entry.agent, problem_of(config), config.settings)
    return config


def check_table(entry: EntryConfig, rules: TournamentRules, table: Checkpoint) -> None:
    """Check that what a table has learned may race for an entry.

    The robot and the simulator with which it was learned may be others than those of the rules.

    Raises:
        UnknownName, InvalidInput: if the rules do not allow it.
        TableMismatch: if it is of another agent or walking problem.
    """
    config, learned_by = training_of(entry, rules), table.meta["agent"]
    if learned_by != entry.agent:
        raise TableMismatch(f"the table was learned by {learned_by}, not by {entry.agent}")
    check_fits(table, config, entry.observation)
    if table.meta["step"] > rules.steps:
        raise InvalidInput(
            f"the table has practised {table.meta['step']:,} steps; the budget of this tournament "
            f"is {rules.steps:,}"
        )


def references(rules: TournamentRules) -> Sequence[EntryConfig]:
    """Return the entries that are judged in every tournament, each with the whole budget."""
    return [completed(EntryConfig(agent=agent), rules) for agent in REFERENCES]


def completed(entry: EntryConfig, rules: TournamentRules) -> EntryConfig:
    """Return an entry with all settings of its agent, as it is judged.

    Raises:
        UnknownName, InvalidInput: as `training_of`.
    """
    config = training_of(entry, rules)
    if entry.table is not None:
        return entry
    return replace(entry, settings=config.settings)


def _check_steps(entry: EntryConfig, rules: TournamentRules) -> None:
    if entry.steps is None:
        return
    if entry.table is not None or not learns(entry.agent):
        raise InvalidInput(f"{entry.agent} practises no steps here; leave out steps", field="steps")
    if isinstance(entry.steps, bool) or not 1 <= entry.steps <= rules.steps:
        raise InvalidInput(
            f"steps must be from 1 to {rules.steps:,}, the budget of this tournament, not "
            f"{entry.steps:,}",
            field="steps",
        )


def _check_table_allowed(entry: EntryConfig, rules: TournamentRules) -> None:
    if not rules.tables:
        raise InvalidInput(
            "no trained tables enter this tournament; leave out the table, and the agent practises "
            "on each draw"
        )
    if not learns(entry.agent):
        raise InvalidInput(f"{entry.agent} does not learn, so it has no table; leave it out")
    if entry.settings:
        raise InvalidInput(
            "an entry with a table has the settings of its training; leave out "
            + ", ".join(entry.settings),
            field="settings",
        )
