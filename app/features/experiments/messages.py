"""The task of an experiment, and the messages of its process; all are picklable."""

import queue
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from app.jobs.messages import AddedMessage, AddedTask, Command, Message
from hexapods.experiments.config import ExperimentConfig


@dataclass(frozen=True)
class ExperimentTask(AddedTask):
    """An experiment whose remaining trials are to be run.

    Attributes:
        config: the experiment.
        workers: trials at once; None is one per core.
        rows: the trials that are done, as returned by `Trials.get`.
        wall_s: for how long it ran before [s].
    """

    config: ExperimentConfig
    workers: int | None = None
    rows: tuple[Mapping[str, Any], ...] = ()
    wall_s: float = 0.0

    @property
    def done(self) -> int:
        """Number of the trials that are done."""
        return len(self.rows)

    def run(self, send: Callable[[Message], None], commands: "queue.SimpleQueue[Command]") -> None:
        """See `AddedTask`."""
        # Only here: the server, which sends the task, needs no engine of experiments.
        from app.features.experiments.worker import experiment  # noqa: PLC0415

        experiment(self, send, commands)


@dataclass(frozen=True)
class TrialsDone(AddedMessage):
    """New trials, as for `Trials.append`, and how many are done now."""

    rows: tuple[Mapping[str, Any], ...]
    done: int


@dataclass(frozen=True)
class Reported(AddedMessage):
    """A file of an experiment's report; its summary also while it runs."""

    name: str
    data: bytes
