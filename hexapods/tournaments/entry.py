"""Entries of a tournament: data, never code."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from hexapods.agents.registry import check_problem, learns, registered
from hexapods.domain.creatures import own_gait
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.observation import Observation
from hexapods.domain.records import Record
from hexapods.domain.robot import AnyRobot
from hexapods.domain.settings import SettingValues, Value
from hexapods.runs.config import PracticeSteps, TrainingConfig, problem_of, training_config
from hexapods.tournaments.rules import TournamentRules

REFERENCES = ("greedy", "random-walk", "linear-model")
"""Agents that are judged in every tournament, beside the entries."""


@dataclass(frozen=True, kw_only=True)
class Entry(Record):
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


def training_of(entry: Entry, rules: TournamentRules) -> TrainingConfig:
    """Return the training of an entry on any draw, of the seed 0 and undisturbed.

    Raises:
        UnknownName, InvalidInput: if the rules do not allow the entry; the message names what they
            allow.
    """
    if entry.agent not in registered():
        raise UnknownName("agent", entry.agent, registered())
    _check_steps(entry, rules)
    walk: dict[str, Any] = vars(rules.walk())
    if entry.robot is not None and entry.robot != rules.robot:
        if entry.robot not in rules.robots:
            raise UnknownName("robot", entry.robot.name, _names(rules))
        walk |= {"robot": entry.robot, "gait": own_gait(entry.robot)}
    config = training_config(
        entry.agent,
        **walk,
        observation=entry.observation,
        steps=rules.steps if entry.steps is None else entry.steps,
        evaluate_every=0,
        **entry.settings,
    )
    check_problem(entry.agent, problem_of(config), config.settings)
    return config


def references(rules: TournamentRules) -> Sequence[Entry]:
    """Return the entries that are judged in every tournament, each with the whole budget."""
    del rules  # a robot of another kind may one day need other references
    return [Entry(agent=agent) for agent in REFERENCES]


def completed(entry: Entry, rules: TournamentRules) -> Entry:
    """Return an entry with all settings of its agent, as it is judged.

    Raises:
        UnknownName, InvalidInput: as `training_of`.
    """
    config = training_of(entry, rules)
    if entry.table is not None:
        return entry
    return replace(entry, settings=config.settings)


def _check_steps(entry: Entry, rules: TournamentRules) -> None:
    if entry.steps is None:
        return
    if entry.table is not None or not learns(entry.agent):
        raise InvalidInput(f"{entry.agent} practises no steps here; leave out steps")
    if entry.steps > rules.steps:
        raise InvalidInput(
            f"steps must be from 1 to {rules.steps}, the budget of this tournament, not "
            f"{entry.steps}"
        )


def _names(rules: TournamentRules) -> list[str]:
    return [one.name for one in (rules.robot, *rules.robots)]
