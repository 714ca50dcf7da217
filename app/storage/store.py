"""Runs and what they leave behind, behind one interface."""

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
"""A process works on it."""
UNENDED = QUEUED | LIVE
INTERRUPTED: frozenset[State] = frozenset({"interrupted"})
RESUMABLE: Mapping[Kind, frozenset[State]] = {
    # From its newest checkpoint: most failures are of the machine, not of the run.
    "training": INTERRUPTED | {"failed"},
    "race": INTERRUPTED | {"failed"},
    # Its trials are kept one by one, so that none is repeated however it ended.
    "experiment": INTERRUPTED | {"stopped", "failed"},
}
"""The states of an ended run from which it can be queued again."""
TABLE = "q-table.npz"
"""The artifact of a training that holds what was learned."""
CHECKPOINT = "checkpoint.npz"
"""The artifact of a training from which it goes on if it is interrupted."""
SUMMARY = "summary.json"
"""The artifact of an experiment that says what its trials so far show."""
REPORT = "report.html"
"""The artifact of an experiment that has ended: all of its report in one file."""
KEY_KEPT = timedelta(days=1)
"""How long an idempotency key is remembered."""
MAX_KEYS = 10_000
"""Of these the newest are remembered."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """A training, a race or an experiment, as everyone sees it.

    Attributes:
        id: short, fit for a URL; later runs sort after earlier ones.
        lane_training_ids: for each lane of a race the training whose table it uses.
        waiting_for: trainings that must end before this race begins.
        continued_from: the training whose table this training went on from.
        done, total: steps, of all lanes together; trials, of an experiment.
        workers: of an experiment's cluster; None is one for each core.
        eta_s: how much longer it will take [s], as far as that can be told; None unless it runs.
        changes: rates and pace that were changed while it ran, each with the number of steps
            that were done before.
        greedy_distance_m: of a training, the line to beat, once it is known.
        error: one sentence for the user.
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
    """A stored run that cannot be read, and what of it can; None for what cannot.

    Attributes:
        id: by which it can be deleted.
        kind: of the run; one of none is listed with every kind.
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
    """Some runs of a list, newest first."""

    items: list[AnyRun]
    next_cursor: str | None
    """Where the next page begins; None on the last."""

    @property
    def runs(self) -> list[Run]:
        """Those that can be read."""
        return [run for run in self.items if isinstance(run, Run)]


class IdempotencyKey(NamedTuple):
    """The key of a request that starts a run, and the SHA-256 of the request in hexadecimal."""

    key: str
    digest: str


class Started(NamedTuple):
    """What is known of an idempotency key that was used before."""

    digest: str
    run_id: str


@dataclass(frozen=True, kw_only=True)
class Content:
    """All that a run has beside its row.

    Attributes:
        evaluations: as `RunStore.append_evaluations` takes them.
        trials: as `RunStore.append_trials` takes them.
        artifacts: files by name.
    """

    evaluations: Sequence[Mapping[str, Any]] = ()
    trials: Sequence[Mapping[str, Any]] = ()
    artifacts: Mapping[str, bytes] = field(default_factory=dict)


class RunStore(Protocol):
    """Where runs live. Safe to use from any thread."""

    @property
    def sessions(self) -> SessionRows:
        """The sessions of operators, which are kept in the same place."""

    def check_room(self) -> None:
        """Make sure that there is room for one more run.

        Raises:
            StorageFull: if there is not, or there may soon be none.
        """

    def create(self, *runs: Run, key: IdempotencyKey | None = None) -> None:
        """Add new runs, all or none.

        Args:
            runs: in order.
            key: of the request for the last of them, remembered in the same transaction.
        """

    def add(
        self,
        run: Run,
        content: Content,
        new_id: Callable[[], str],
        key: IdempotencyKey | None = None,
    ) -> Run:
        """Add a run that ended elsewhere with all it has: visible whole or not at all.

        Args:
            run: as it was there.
            content: what else it has.
            new_id: makes an id in place of the run's own, if that is taken here.
            key: of the request, remembered in the same transaction.

        Returns:
            the run as it is here.

        Raises:
            StorageFull: if there is no room; nothing is left behind then.
        """

    def started_by(self, key: str) -> Started | None:
        """What an idempotency key was used for in the last day; None if for nothing."""

    def get(self, run_id: str) -> Run:
        """The run as it is now.

        Raises:
            NotFound: if there is none.
            Damaged: if it cannot be read.
        """

    def find(self, run_id: str) -> AnyRun:
        """The run as it is now, or what can be read of it.

        Raises:
            NotFound: if there is none.
        """

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page:
        """Runs, newest first.

        One that cannot be read stands in its place; if not even its kind can be, it is listed with
        every kind.
        """

    def counts(self) -> Mapping[State, int]:
        """How many runs there are in each state that any is in."""

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        """Change the state, and with it other fields, if it still is one of `from_states`.

        The time left is told anew: `eta_s` is None afterwards.

        Raises:
            NotFound: if there is no such run.
            Conflict: if its state is another.
        """

    def update(self, run_id: str, **fields: Any) -> Run:
        """Set fields other than the state.

        Raises:
            NotFound: if there is no such run.
        """

    def update_progress(self, run_id: str, done: int, eta_s: float | None = None) -> Run:
        """How far it is.

        Raises:
            NotFound: if there is no such run.
        """

    def delete(self, run_id: str) -> None:
        """Forget a run that has ended, with all it left behind.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended.
        """

    def append_evaluations(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Add to a training's curve, in place of what it has from the first of these steps on.

        A training that goes on from a checkpoint evaluates again what came after that.
        """

    def evaluations(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """A training's curve so far: `step`, `distance_m`, `epsilon`."""

    def forget_evaluations(self, run_id: str, after_step: int) -> None:
        """Drop what a training's curve has after this step."""

    def append_trials(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Add trials of an experiment, each in place of what had its key.

        Args:
            run_id: of the experiment.
            rows: `key`, `result` (plain types, or None), `set_aside` (why there is none, or None)
                and `compute_s`.

        Raises:
            NotFound: if there is no such run.
        """

    def trials(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """The trials of an experiment so far, by key.

        Raises:
            NotFound: if there is no such run.
        """

    def put_artifact(self, run_id: str, name: str, data: bytes, **fields: Any) -> None:
        """Keep a file of the run's, in place of what had this name, and set fields, or neither."""

    def artifact(self, run_id: str, name: str) -> bytes | None:
        """A file of the run's; None if it has none of this name."""

    def open_artifact(self, run_id: str, name: str) -> ArtifactFile | None:
        """The same, to be read piece by piece, and to be closed."""
