"""The `RunStore` interface, the `Run` that it stores, run states and artifact names."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any, Literal, NamedTuple, Protocol, get_args

from app.experiments.config import ExperimentConfig
from app.runs.config import RaceConfig, TrainingConfig
from app.storage.artifact_file import ArtifactFile
from app.storage.sessions import SessionRows

Kind = Literal["training", "race", "experiment"]
State = Literal["queued", "running", "paused", "finished", "stopped", "failed", "interrupted"]

Config = TrainingConfig | RaceConfig | ExperimentConfig

KINDS: tuple[Kind, ...] = get_args(Kind)
STATES: tuple[State, ...] = get_args(State)
QUEUED: frozenset[State] = frozenset({"queued"})
RUNNING: frozenset[State] = frozenset({"running"})
PAUSED: frozenset[State] = frozenset({"paused"})
LIVE = RUNNING | PAUSED
"""States in which a job process works on the run."""
UNENDED = QUEUED | LIVE
"""States from which a run can still change by itself; only ended runs can be deleted."""
INTERRUPTED: frozenset[State] = frozenset({"interrupted"})
RESUMABLE: Mapping[Kind, frozenset[State]] = {
    # Resumes from its newest checkpoint: most failures are caused by the machine, not the run.
    "training": INTERRUPTED | {"failed"},
    "race": INTERRUPTED | {"failed"},
    # Each trial is stored as it ends, so resuming repeats none, whatever ended the experiment.
    "experiment": INTERRUPTED | {"stopped", "failed"},
}
"""By kind, the states of an ended run from which it can be queued again."""
TABLE = "q-table.npz"
"""Artifact of a training: its learned Q-table."""
CHECKPOINT = "checkpoint.npz"
"""Artifact of a training: the checkpoint from which it resumes after an interruption."""
SUMMARY = "summary.json"
"""Artifact of an experiment: statistics and claims computed from its trials so far."""
REPORT = "report.html"
"""Artifact of an ended experiment: its report as one self-contained HTML file."""
KEY_LIFETIME = timedelta(days=1)
"""Lifetime of an idempotency key."""
MAX_KEYS = 10_000
"""Idempotency keys stored at most; the oldest are dropped first."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """A training, a race or an experiment: config, state, progress and result.

    Attributes:
        id: short and URL-safe; sorts by time of creation (see `run_ids`).
        lane_training_ids: of a race, for each lane the training whose Q-table it uses, or None.
        waiting_for: of a race, ids of the trainings that must end before it starts.
        continued_from: of a training, id of the training whose Q-table it continued from.
        done, total: steps summed over all lanes; of an experiment, trials.
        workers: of an experiment, worker processes of its cluster; None is one per core.
        eta_s: estimated time left [s]; None if there is no estimate, or the run is not running.
        changes: learning rates and pace changed while the run ran, each with the number of steps
            done before the change.
        greedy_distance_m: of a training, distance of the greedy baseline [m], once measured.
        error: one sentence for the user; None if there was none.
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
    workers: int | None = None
    done: int = 0
    total: int
    eta_s: float | None = None
    changes: tuple[Mapping[str, Any], ...] = ()
    greedy_distance_m: float | None = None
    result: dict[str, Any] | None = None
    error: str | None = None
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
    """

    id: str
    kind: Kind | None = None
    name: str | None = None
    state: State | None = None
    created_at: datetime | None = None
    damaged: str


AnyRun = Run | DamagedRun


class Page(NamedTuple):
    """One page of a listing, newest run first."""

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
    """A used idempotency key's record: digest of its request and id of the run it created."""

    digest: str
    run_id: str


@dataclass(frozen=True, kw_only=True)
class Content:
    """Everything stored for a run besides its row.

    Attributes:
        evaluations: rows as for `RunStore.append_evaluations`.
        trials: rows as for `RunStore.append_trials`.
        artifacts: contents of files by name.
    """

    evaluations: Sequence[Mapping[str, Any]] = ()
    trials: Sequence[Mapping[str, Any]] = ()
    artifacts: Mapping[str, bytes] = field(default_factory=dict)


class RunStore(Protocol):
    """Interface of the run store: runs, curves, trials and artifacts. Thread-safe.

    Implemented by `SqlStore` for SQLite and PostgreSQL.
    """

    @property
    def sessions(self) -> SessionRows:
        """Storage of operators' browser sessions, in the same database."""

    def check_disk_space(self) -> None:
        """Check that there is disk space for one more run.

        Raises:
            StorageFull: if there is too little, or would be while the run runs.
        """

    def create(self, *runs: Run, key: IdempotencyKey | None = None) -> None:
        """Insert new runs, all or none, in one transaction.

        Args:
            runs: in order of insertion.
            key: idempotency key of the request that starts the last of them, stored in the same
                transaction.
        """

    def add(
        self,
        run: Run,
        content: Content,
        new_id: Callable[[], str],
        key: IdempotencyKey | None = None,
    ) -> Run:
        """Insert an ended run with its content (used by imports), atomically.

        Args:
            run: the run; keeps its id if that is free in this store.
            content: its curve, trials and artifacts.
            new_id: creates an id if the run's own is already in use.
            key: idempotency key of the request, stored in the same transaction.

        Returns:
            the run as stored.

        Raises:
            StorageFull: if there is too little disk space; nothing is left behind then.
        """

    def find_key(self, key: str) -> KeyRecord | None:
        """Look up an idempotency key; None if it was not used within its lifetime."""

    def get(self, run_id: str) -> Run:
        """Return the run with its newest progress.

        Raises:
            NotFound: if there is no such run.
            Damaged: if it cannot be decoded.
        """

    def find(self, run_id: str) -> AnyRun:
        """Return the run with its newest progress, or a `DamagedRun` if it cannot be decoded.

        Raises:
            NotFound: if there is no such run.
        """

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page:
        """Return one page of runs, newest first (keyset pagination by id).

        A run that cannot be decoded is listed in its place as a `DamagedRun`; if its kind cannot
        be decoded either, it is listed under every kind.

        Args:
            kind: only runs of this kind; None for all.
            state: only runs in this state; None for all.
            limit: items per page.
            cursor: `Page.next_cursor` of the page before; None for the first page.
        """

    def counts(self) -> Mapping[State, int]:
        """Return the number of runs by state, for states that have any."""

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        """Change the state and other fields if the state is in `from_states` (compare-and-set).

        `eta_s` is reset to None unless it is among the fields.

        Raises:
            NotFound: if there is no such run.
            Conflict: if its state is not in `from_states`.
        """

    def update(self, run_id: str, **fields: Any) -> Run:
        """Set fields other than the state.

        Raises:
            NotFound: if there is no such run.
        """

    def update_progress(self, run_id: str, done: int, eta_s: float | None = None) -> Run:
        """Set the number of steps or trials done and the estimated time left [s].

        Raises:
            NotFound: if there is no such run.
        """

    def delete(self, run_id: str) -> None:
        """Delete an ended run with its curve, trials and artifacts.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended.
        """

    def append_evaluations(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Append rows to a training's curve, replacing its rows from the first new step on.

        A training that resumes from a checkpoint repeats the evaluations after that checkpoint.

        Args:
            run_id: id of the training.
            rows: `step`, `distance_m` [m] and `epsilon` (exploration rate) of each evaluation.

        Raises:
            NotFound: if there is no such run.
        """

    def evaluations(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """Return a training's curve so far, by step: `step`, `distance_m`, `epsilon`."""

    def delete_evaluations(self, run_id: str, after_step: int) -> None:
        """Delete the rows of a training's curve after this step."""

    def append_trials(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Add trials of an experiment, replacing those with the same key (upsert).

        Args:
            run_id: id of the experiment.
            rows: `key`, `result` (plain types, or None), `set_aside` (why there is no result, or
                None) and `compute_s` [s].

        Raises:
            NotFound: if there is no such run.
        """

    def trials(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """Return the trials of an experiment so far, sorted by key.

        Raises:
            NotFound: if there is no such run.
        """

    def put_artifact(self, run_id: str, name: str, data: bytes, **fields: Any) -> None:
        """Store a file of the run and set fields of the run, atomically.

        Replaces the file that had this name.

        Raises:
            NotFound: if there is no such run.
            StorageFull: if there is too little disk space.
        """

    def artifact(self, run_id: str, name: str) -> bytes | None:
        """Return the content of a file of the run; None if it has no file of this name."""

    def open_artifact(self, run_id: str, name: str) -> ArtifactFile | None:
        """Open a file of the run for reading in chunks; None if it has no file of this name.

        The caller closes it.
        """
