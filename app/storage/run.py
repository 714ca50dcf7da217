"""A stored run: its fields, states and artifact names, and its config as JSON."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any, Literal, NamedTuple, get_args

from app.storage.run_kind import Rows
from app.storage.stored_robot import StoredRobot
from hexapods.domain.disturbance_documents import disturbance_from
from hexapods.domain.robot import Robot
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.results import Count, RaceResult, TrainingResult

Kind = str
"""Name of a kind of run: `training`, `race`, or one that a feature adds; see `run_kind`."""
State = Literal["queued", "running", "paused", "finished", "stopped", "failed", "interrupted"]
Sort = Literal["newest", "oldest", "name", "distance"]

Config = Any
"""A `TrainingConfig`, a `RaceConfig`, or a config of a kind that a feature adds."""
Result = Any
"""A `TrainingResult`, a `RaceResult`, or a result of a kind that a feature adds."""
STATES: tuple[State, ...] = get_args(State)
SORTS: tuple[Sort, ...] = get_args(Sort)
QUEUED: frozenset[State] = frozenset({"queued"})
RUNNING: frozenset[State] = frozenset({"running"})
PAUSED: frozenset[State] = frozenset({"paused"})
LIVE = RUNNING | PAUSED
"""States in which a job process works on the run."""
NOT_ENDED = QUEUED | LIVE
"""States from which a run can still change by itself; only ended runs can be deleted."""
INTERRUPTED: frozenset[State] = frozenset({"interrupted"})
ANNOTATIONS = ("name", "tags", "notes")
"""Fields of a run that users may change in any of its states."""
RESUMABLE: frozenset[State] = INTERRUPTED | {"stopped", "failed"}
"""States of an ended run from which it can be queued again. A training resumes from its newest
checkpoint, a race is repeated from its start, with the same motions: most failures are caused by
the machine, not by the run."""
TABLE = "q-table.npz"
"""Artifact of a training: its learned Q-table."""
CHECKPOINT = "checkpoint.npz"
"""Artifact of a training: the checkpoint from which it resumes after an interruption."""
KEY_LIFETIME = timedelta(days=1)
"""Lifetime of an idempotency key."""
MAX_KEY_LENGTH = 200
"""Characters of an idempotency key."""
MAX_KEYS = 10_000
"""Idempotency keys stored at most; the oldest are dropped first."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """A run of any kind: config, state, progress and result.

    Attributes:
        id: short and URL-safe; sorts by time of creation (see `run_ids`).
        lane_training_ids: of a race, for each lane the training whose Q-table it uses, or None.
        waiting_for: of a race, ids of the trainings that must end before it starts.
        continued_from: of a training, id of the training whose Q-table it continued from.
        done, total: steps summed over all lanes, or what its kind counts.
        workers: of a run of many parts, how many are computed at once; None is one per core.
        eta_s: estimated time left [s]; None if there is no estimate, or the run is not running.
        changes: learning rates and pace changed while the run ran, each with the number of steps
            done before the change.
        greedy_distance_m: of a training, distance of the greedy baseline [m], once measured.
        error: one sentence for the user; None if there was none.
        tags: by which users find it again, as `check_tags` returns them.
        notes: of users, as `check_notes` returns them.
        created_at, started_at, ended_at: in UTC.
    """

    id: str
    kind: Kind
    name: str
    state: State = "queued"
    config: Config
    lane_training_ids: tuple[str | None, ...] = ()
    waiting_for: tuple[str, ...] = ()
    continued_from: str | None = None
    workers: Count | None = None
    done: Count = 0
    total: Count
    eta_s: float | None = None
    changes: tuple[Mapping[str, Any], ...] = ()
    greedy_distance_m: float | None = None
    result: Result | None = None
    error: str | None = None
    tags: tuple[str, ...] = ()
    notes: str = ""
    created_at: datetime = field(default_factory=lambda: datetime.now(UTC))
    started_at: datetime | None = None
    ended_at: datetime | None = None


@dataclass(frozen=True, kw_only=True)
class DamagedRun:
    """A stored run that cannot be decoded; fields that cannot be read are None.

    Attributes:
        id: the id by which it can be deleted.
        kind: kind of the run; if None, it is listed under every kind.
        damaged: what is wrong with it, in a sentence.
        is_left_out: whether nothing is, but its kind is of a feature that is left out.
    """

    id: str
    kind: Kind | None = None
    name: str | None = None
    state: State | None = None
    created_at: datetime | None = None
    damaged: str
    is_left_out: bool = False


AnyRun = Run | DamagedRun


class ListedRuns(NamedTuple):
    """One page of a listing."""

    items: list[AnyRun]
    next_cursor: str | None
    """Cursor of the next page; None on the last page."""

    @property
    def runs(self) -> list[Run]:
        """The items that could be decoded."""
        return [run for run in self.items if isinstance(run, Run)]


class IdempotencyKey(NamedTuple):
    """Idempotency key of a start request, and the hexadecimal SHA-256 of that request."""

    key: str
    digest: str


class KeyRecord(NamedTuple):
    """A used idempotency key's record: digest of its request and ids of the runs it created."""

    digest: str
    run_ids: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Content:
    """Everything stored for a run besides its row.

    Attributes:
        evaluations: rows as for `Curves.append`.
        rows: of tables of its kind.
        artifacts: contents of files by name.
        robots: stored robots that its config names, each with its document.
    """

    evaluations: Sequence[Mapping[str, Any]] = ()
    rows: Rows = field(default_factory=dict)
    artifacts: Mapping[str, bytes] = field(default_factory=dict)
    robots: Sequence[tuple[StoredRobot, bytes]] = ()


def ranking_distance_m(result: Result | None) -> float | None:
    """Return the distance by which runs are ranked [m]: a training's, or that of a race's winner.

    None if there is none, as of other kinds, or if it is NaN, which databases sort differently.
    """
    distance_m = None
    if isinstance(result, TrainingResult):
        distance_m = result.distance_m
    elif isinstance(result, RaceResult):
        figures = [lane.clocks.paper for lane in result.lanes]
        distance_m = next(
            (figure.finished_distance_m for figure in figures if figure.rank == 1), None
        )
    return distance_m if distance_m is not None and math.isfinite(distance_m) else None


def robots_of(config: Config) -> tuple[Robot, ...]:
    """Return the robots of a config, which has one or several."""
    return config.robots if hasattr(config, "robots") else (config.robot,)


def world_of(run: Run) -> World:
    """Return all that happens in a training or race, including what was added while it ran.

    Raises:
        InvalidInput: if what is stored is damaged.
    """
    world = getattr(run.config, "world", UNDISTURBED)
    for change in run.changes:
        if "disturbance" in change:
            world = world.then(disturbance_from(change["disturbance"]))
    return world
