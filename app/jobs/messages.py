"""Messages between the server and a job's process, through a pipe; all are picklable."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.experiments.config import ExperimentConfig
from app.runs.config import RaceConfig, TrainingConfig
from app.runs.records import RaceRecord, TrainingRecord
from app.runs.tables import Checkpoint

# To the process: a task first, then commands.


@dataclass(frozen=True)
class TrainingTask:
    """Train, from what a table holds if one is given.

    Attributes:
        config: the training.
        table: to begin with; it starts a training of its own.
        checkpoint: where to go on with this same training.
        changes: those that were made after the checkpoint, to be made again.
    """

    config: TrainingConfig
    table: Checkpoint | None = None
    checkpoint: Checkpoint | None = None
    changes: tuple[Mapping[str, Any], ...] = ()


@dataclass(frozen=True)
class RaceTask:
    """Race, each lane with its table if it has one."""

    config: RaceConfig
    tables: tuple[Checkpoint | None, ...]


@dataclass(frozen=True)
class ExperimentTask:
    """Try what has not been tried yet, and report.

    Attributes:
        config: the experiment.
        workers: how many trials at once; None is one for each core.
        rows: the trials that are done, as the store has them.
        wall_s: how long it ran before.
    """

    config: ExperimentConfig
    workers: int | None = None
    rows: tuple[Mapping[str, Any], ...] = ()
    wall_s: float = 0.0


Task = TrainingTask | RaceTask | ExperimentTask


class Command(NamedTuple):
    """Something to obey between two steps."""

    verb: Literal["pause", "resume", "stop", "tune", "leave"]
    """`leave`: end with a checkpoint instead of a result."""
    token: int = 0
    """By which the answer to `tune` is known."""
    changes: Mapping[str, Any] = {}
    """For `tune`: values of settings by name."""
    expires_s: float = math.inf
    """For `tune`: when it is too late, by the machine's monotonic clock."""


# Up.


class Heartbeat(NamedTuple):
    """The process lives, whatever it is at."""


class Began(NamedTuple):
    """All is built, and the robots stand at rest in these poses, one for each lane if any."""

    rest_qpos: tuple[NDArray[np.float32], ...]
    after_step: int = 0
    """How many steps a training had done that goes on."""


class Batch(NamedTuple):
    """Records since the last batch."""

    records: tuple[TrainingRecord | RaceRecord, ...]
    done: int
    """Steps so far, of all lanes together."""


class Changed(NamedTuple):
    """A `tune` was obeyed after this many steps."""

    token: int
    step: int
    changes: Mapping[str, Any]


class Checkpointed(NamedTuple):
    """All that it takes to go on from here, as a file; what came before was sent before."""

    data: bytes
    step: int


class Saved(NamedTuple):
    """The table as it is now, as a file."""

    table: bytes


class TrialsDone(NamedTuple):
    """Trials since the last of these, as the store takes them, and how many are done now."""

    rows: tuple[Mapping[str, Any], ...]
    done: int


class Reported(NamedTuple):
    """A file of an experiment's report; its summary also while it runs."""

    name: str
    data: bytes


class Ended(NamedTuple):
    """The job is done, or was stopped; the result is a training's or an experiment's."""

    outcome: Literal["finished", "stopped"]
    result: dict[str, Any] | None


class Failed(NamedTuple):
    """The job cannot go on, for a reason that fits a sentence."""

    reason: str


Message = Began | Batch | Changed | Checkpointed | Saved | TrialsDone | Reported | Ended | Failed
