"""Trainings that are finished: evaluate, save, read again, and let the agent act."""

import html
import os
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Union

from hexapods.agents.protocol import Agent
from hexapods.agents.registry import AgentClass
from hexapods.agents.table_rows import flat_entry
from hexapods.arguments import agent_name
from hexapods.assembly import build_learner
from hexapods.domain.errors import DamagedFile, InvalidInput, TableMismatch
from hexapods.domain.records import from_json
from hexapods.files import path_of, write_atomically
from hexapods.result_table import ResultTable
from hexapods.runs.config import TrainingConfig
from hexapods.runs.results import TrainingResult
from hexapods.runs.tables import Checkpoint, from_bytes, load_agent, table_of, to_bytes

Table = Union["Training", str, os.PathLike[str]]
"""A trained agent: a training, or the path of its file."""


class CurvePoint(NamedTuple):
    """An evaluation: distance in 50 steps from rest [m], after `step` steps of practice."""

    step: int
    distance_m: float
    epsilon: float
    """ε of the practice at that step."""


@dataclass(frozen=True, repr=False, eq=False)
class Training:
    """A finished training, as `train` and `load` return it.

    Attributes:
        config: config of the training, which decides its result.
        table: checkpoint of the learned table, with its generator.
        curve: its evaluations, in order; `pandas.DataFrame(training.curve)` takes them. None are
            known of a file that the dashboard wrote.
        result: distance, references and hash of the Q-table, as in answers of the dashboard; None
            of such a file.
    """

    config: TrainingConfig
    table: Checkpoint
    curve: tuple[CurvePoint, ...] = ()
    result: TrainingResult | None = None

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "Training":
        """Return the training that `save`, the dashboard or the command line has saved.

        Raises:
            InvalidInput: if the file cannot be read.
            DamagedFile: if it is no table, or was changed since it was written.
        """
        return read_table(path_of(path, "a table"))

    @property
    def distance_m(self) -> float | None:
        """Distance in 50 steps from rest, after the practice [m]; None if it is not known."""
        return None if self.result is None else self.result.distance_m

    @property
    def greedy_distance_m(self) -> float | None:
        """Distance of the one-step look-ahead agent in as many steps [m]; None if not known."""
        return None if self.result is None else self.result.greedy_distance_m

    @property
    def best_known_m(self) -> float | None:
        """Distance of the farthest walk known of this problem [m]; None if none is."""
        return None if self.result is None else self.result.best_known_m

    @property
    def q_table_sha256(self) -> str | None:
        """Hash of the Q-table; None for an agent without one, or if it is not known."""
        return None if self.result is None else self.result.q_table_sha256

    def values(self) -> ResultTable:
        """Return the entries of the table: a row for each state and action, or for each landing.

        `pandas.DataFrame(training.values())` is a data frame. `state_0`, `state_1` … are the cells
        of the groups, `action_pair` and `action_cell` the group that moves and where to; of a
        learner over landings `landing_0`, `landing_1` … are the cells in which the feet land.
        `value` is in metres, `visits` a number of steps.

        Raises:
            TableMismatch: if the agent keeps no table.
        """
        return ResultTable.of(map(flat_entry, table_of(self.table).entries()))

    @cached_property
    def agent(self) -> Agent:
        """An agent with what was learned, of the agent's own class; it does not explore."""
        learner = build_learner(self.config)
        load_agent(learner.walker.agent, self.table)
        return learner.walker.agent

    def __getstate__(self) -> dict[str, Any]:
        """Return the state to pickle, without the agent: a simulator is not pickled."""
        return {name: value for name, value in self.__dict__.items() if name != "agent"}

    def to_bytes(self) -> bytes:
        """Return the content of the `.npz` file that `save` writes."""
        meta = dict(self.table.meta)
        if self.result is not None:
            meta |= {"curve": [list(point) for point in self.curve], "result": asdict(self.result)}
        return to_bytes(Checkpoint(meta, self.table.arrays))

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the table to an `.npz` file, which `load`, the dashboard and the command line read.

        Returns:
            the path.

        Raises:
            InvalidInput: if it is no path.
            OSError: if the file cannot be written.
        """
        target = path_of(path, "a file")
        write_atomically(target, self.to_bytes())
        return target

    def __repr__(self) -> str:
        steps = self.table.meta["step"]
        return f"<Training of {self.config.agent}: {steps:,} steps, {_metres(self.distance_m)}>"

    def _repr_html_(self) -> str:
        rows = {
            "agent": self.config.agent,
            "steps of practice": f"{self.table.meta['step']:,}",
            "distance in 50 steps": _metres(self.distance_m),
            "one-step look-ahead": _metres(self.greedy_distance_m),
            "best known walk": _metres(self.best_known_m),
        }
        cells = "".join(f"<tr><th>{k}</th><td>{html.escape(v)}</td></tr>" for k, v in rows.items())
        return f"<table>{cells}</table>"


def learned_by(
    agent: str | AgentClass | Training, table: Table | None
) -> tuple[str, Training | None]:
    """Return the name of an agent, and its training if there is one.

    Args:
        agent: a training, or an agent's name or class.
        table: training of the agent, or its file, unless `agent` is a training.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid, or both are a training.
        TableMismatch: if the table was learned by another agent.
    """
    if isinstance(agent, Training):
        if table is not None:
            raise InvalidInput(
                "a training comes with what it has learned: leave out table, or give the agent by "
                f"its name, {agent.config.agent!r}, with the table"
            )
        return agent.config.agent, agent
    name = agent_name(agent)
    trained = None if table is None else read_table(table)
    if trained is not None and trained.config.agent != name:
        raise TableMismatch(
            f"the table was learned by {trained.config.agent}, not by {name}; choose a table of "
            "the same agent"
        )
    return name, trained


def read_table(table: Table) -> Training:
    """Return a training, read from its file if it is given by its path.

    Raises:
        InvalidInput: if the file cannot be read.
        DamagedFile: if it is no table, or was changed since it was written.
    """
    if isinstance(table, Training):
        return table
    if not isinstance(table, str | os.PathLike):
        raise InvalidInput(f"a table is a training or the path of its file, not {table!r}")
    try:
        data = path_of(table, "a table").read_bytes()
    except OSError as error:
        raise InvalidInput(f"cannot read the table {table}: {error.strerror}") from error
    return training_from_bytes(data, str(table))


def training_from_bytes(data: bytes, name: str) -> Training:
    """Decode the file of a training.

    Args:
        data: content of the file.
        name: name of the file, for error messages.

    Raises:
        DamagedFile: if it is no table, or was changed since it was written.
    """
    checkpoint = from_bytes(data, name)
    try:
        config = from_json(TrainingConfig, checkpoint.meta["config"])
        curve = tuple(CurvePoint(*point) for point in checkpoint.meta.get("curve", ()))
        fields = checkpoint.meta.get("result")
        result = None if fields is None else TrainingResult(**fields)
    except InvalidInput:
        raise
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedFile(f"{name} does not say how it was learned: {error}") from error
    return Training(config, checkpoint, curve, result)


def _metres(value: float | None) -> str:
    return "not known" if value is None else f"{value:.2f} m"
