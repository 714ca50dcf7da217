"""Messages between the server and a job's process, through a pipe; all are picklable."""

import math
import queue
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.records import LaneStep, RaceRecord, TrainingRecord
from hexapods.runs.tables import Checkpoint
from hexapods.runs.transition_log import Transitions

# To the process: a task first, then commands.


@dataclass(frozen=True)
class TrainingTask:
    """A training to run.

    Attributes:
        config: the training.
        table: table that the training continues from; None starts from zero.
        checkpoint: checkpoint of this same training, from which it resumes.
        changes: changes of rates and pace made after the checkpoint, to be replayed.
        baselines: distances of its baselines that were measured before [m], by their ids.
    """

    config: TrainingConfig
    table: Checkpoint | None = None
    checkpoint: Checkpoint | None = None
    changes: tuple[Mapping[str, Any], ...] = ()
    baselines: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class RaceTask:
    """A race to run.

    Attributes:
        config: the race.
        tables: a table or None for each lane.
        prefix: for each lane the steps, without motion, of the race from which it branches off, up
            to the branch, as far as they are recorded.
    """

    config: RaceConfig
    tables: tuple[Checkpoint | None, ...]
    prefix: tuple[tuple[LaneStep, ...], ...] = ()


class AddedTask(ABC):
    """A run of a kind that a feature adds."""

    @property
    @abstractmethod
    def done(self) -> int:
        """Progress that was made before the task begins, as after a resume."""

    @abstractmethod
    def run(
        self, send: "Callable[[Message], None]", commands: "queue.SimpleQueue[Command]"
    ) -> None:
        """Compute the run to its end, or until a `stop` or `checkpoint_and_exit` command.

        Args:
            send: sends a message to the server: `Began` first, and at the end `Ended`.
            commands: received from the server.

        Raises:
            HexapodError: if the run cannot continue.
        """


Task = TrainingTask | RaceTask | AddedTask


class Command(NamedTuple):
    """A command, executed between two steps."""

    verb: Literal["pause", "resume", "stop", "tune", "checkpoint_and_exit"]
    """`checkpoint_and_exit`: end with a checkpoint instead of a result."""
    token: int = 0
    """Identifies the acknowledgement of a `tune`."""
    changes: Mapping[str, Any] = {}
    """For `tune`: values of settings by name."""
    expires_s: float = math.inf
    """For `tune`: deadline on the machine's monotonic clock [s]."""


# To the server.


class Heartbeat(NamedTuple):
    """The process is alive."""


class Began(NamedTuple):
    """The task is built; these are the initial poses of the robots, one per lane, if any."""

    rest_qpos: tuple[NDArray[np.float32], ...]
    after_step: int = 0
    """Steps that a resumed training had done."""


class Batch(NamedTuple):
    """Records since the last batch."""

    records: tuple[TrainingRecord | RaceRecord, ...]
    done: int
    """Steps so far, of all lanes together."""
    transitions: Transitions | None = None
    """All steps of a practice since the last batch, for its log."""


class Changed(NamedTuple):
    """Acknowledges a `tune`, executed after this many steps."""

    token: int
    step: int
    changes: Mapping[str, Any]
    refusal: str | None = None
    """Why nothing was changed, a sentence."""


class Checkpointed(NamedTuple):
    """A checkpoint as a file; all records before it were sent before it."""

    data: bytes
    step: int


class Saved(NamedTuple):
    """The learned table, as a file."""

    table: bytes


class AddedMessage:
    """Base class of messages of a kind that a feature adds; its job handles them."""


class Ended(NamedTuple):
    """The job has ended; the result is that of its kind, None of a race, which is recorded."""

    outcome: Literal["finished", "stopped"]
    result: Any


class Failed(NamedTuple):
    """The job has failed; the reason is a sentence."""

    reason: str


Message = Began | Batch | Changed | Checkpointed | Saved | AddedMessage | Ended | Failed
