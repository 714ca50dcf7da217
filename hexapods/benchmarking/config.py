"""Config of a benchmark: an agent with its settings, and the part of a protocol that is run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from hexapods.agents.registry import learns
from hexapods.benchmarking.protocol import (
    DEFAULT_PROTOCOL,
    PLAIN_SEED,
    Protocol,
    protocol,
    tasks_of,
)
from hexapods.domain.checks import check_whole
from hexapods.domain.errors import InvalidInput
from hexapods.domain.observation import Observation, check_observation
from hexapods.domain.records import Record
from hexapods.domain.settings import SettingValues, Value, complete
from hexapods.experiments.config import MAX_SEEDS
from hexapods.runs.config import MAX_STEPS, agent_settings

WITHOUT_PRACTICE = 0
"""Budget of an agent that does not learn."""


@dataclass(frozen=True, kw_only=True)
class BenchmarkConfig(Record):
    """Config of a benchmark: its protocol, agent, settings, tasks, budgets and seeds.

    `benchmark_config` completes what is left out.

    Attributes:
        agent: a registered name, or `my.module:Agent`.
        observation: observation mode of the agent.
        settings: the agent's settings by name, all of them.
        protocol: name of the protocol.
        tasks: names of its tasks, in its order.
        budgets: numbers of steps of practice, ascending; `WITHOUT_PRACTICE` alone for an agent
            that does not learn.
        seeds: number of seeds of each task and budget.
        seed: root seed, from which bodies, damages, robots as built and all other chance follow.

    Raises:
        UnknownName: if the agent, the protocol or a task is unknown.
        InvalidInput: if a value is invalid, empty or repeated.
    """

    agent: str
    observation: Observation = "measured"
    settings: SettingValues[Value] = field(default_factory=SettingValues)
    protocol: str = DEFAULT_PROTOCOL
    tasks: tuple[str, ...]
    budgets: tuple[int, ...]
    seeds: int
    seed: int = PLAIN_SEED

    def __post_init__(self) -> None:
        tasks_of(self.chosen, self.tasks)
        check_observation(self.observation)
        valid = {
            "tasks": ", ".join(self.chosen.tasks),
            "budgets": f"whole numbers from 1 to {MAX_STEPS:,}",
        }
        for name, values in (("tasks", self.tasks), ("budgets", self.budgets)):
            if not values:
                raise InvalidInput(f"{name} must name at least one; valid: {valid[name]}")
            if len(set(values)) < len(values):
                raise InvalidInput(f"{name} names something twice")
        if learns(self.agent) or self.budgets != (WITHOUT_PRACTICE,):
            for budget in self.budgets:
                check_whole("budget", budget, 1, MAX_STEPS)
        check_whole("seeds", self.seeds, 1, MAX_SEEDS)
        check_whole("seed", self.seed, 0, None)

    @property
    def chosen(self) -> Protocol:
        """The protocol."""
        return protocol(self.protocol)

    @property
    def learns(self) -> bool:
        """Whether the agent practises."""
        return self.budgets != (WITHOUT_PRACTICE,)

    @property
    def is_whole(self) -> bool:
        """Whether this is the complete protocol with its root seed, with comparable scores."""
        chosen = self.chosen
        budgets = chosen.budgets if self.learns else (WITHOUT_PRACTICE,)
        shares = (len(self.tasks), self.budgets, self.seeds, self.seed)
        return shares == (len(chosen.tasks), budgets, chosen.seeds, PLAIN_SEED)


def benchmark_config(
    agent: str,
    settings: Mapping[str, Any],
    *,
    protocol_name: str = DEFAULT_PROTOCOL,
    tasks: Sequence[str] | None = None,
    budgets: Sequence[int] | None = None,
    seeds: int | None = None,
    seed: int = PLAIN_SEED,
    observation: Observation = "measured",
) -> BenchmarkConfig:
    """Return the config of a benchmark, with the agent's settings validated and completed.

    Args:
        agent: a registered name, or `my.module:Agent`.
        settings: settings of the agent, by name; its defaults apply to the others.
        protocol_name: name of the protocol.
        tasks: names of its tasks; None for all.
        budgets: numbers of steps of practice; None for those of the protocol. An agent that does
            not learn has none.
        seeds: number of seeds of each task and budget; None for that of the protocol.
        seed: root seed.
        observation: observation mode of the agent.

    Raises:
        UnknownName, InvalidInput: if a value is not valid; the message names what is.
    """
    chosen = protocol(protocol_name)
    completed = complete(agent_settings(agent), settings, agent)
    practises = learns(agent)
    if not practises and budgets is not None:
        raise InvalidInput(
            f"{agent} does not learn, so it has no budgets of practice; leave it out"
        )
    usual = chosen.budgets if practises else (WITHOUT_PRACTICE,)
    if tasks is not None and len(set(tasks)) < len(tasks):
        raise InvalidInput("tasks names something twice")
    return BenchmarkConfig(
        agent=agent,
        observation=observation,
        settings=completed,
        protocol=protocol_name,
        tasks=tuple(task.name for task in tasks_of(chosen, tasks)),
        budgets=usual if budgets is None else tuple(sorted(budgets)),
        seeds=chosen.seeds if seeds is None else seeds,
        seed=seed,
    )
