"""Runs and what they leave behind, behind one interface; here in memory."""

import math
import threading
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any, Literal, NamedTuple, Protocol, get_args

from app.runs.config import RaceConfig, TrainingConfig
from app.services.errors import Conflict, NotFound

Kind = Literal["training", "race"]
State = Literal["queued", "running", "paused", "finished", "stopped", "failed", "interrupted"]

KINDS: tuple[Kind, ...] = get_args(Kind)
STATES: tuple[State, ...] = get_args(State)
QUEUED: frozenset[State] = frozenset({"queued"})
RUNNING: frozenset[State] = frozenset({"running"})
PAUSED: frozenset[State] = frozenset({"paused"})
LIVE = RUNNING | PAUSED
"""A process works on it."""
UNENDED = QUEUED | LIVE
INTERRUPTED: frozenset[State] = frozenset({"interrupted"})
TABLE = "q-table.npz"
"""The artifact of a training that holds what was learned."""
CHECKPOINT = "checkpoint.npz"
"""The artifact of a training from which it goes on if it is interrupted."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """A training or a race, as everyone sees it.

    Attributes:
        id: short, fit for a URL; later runs sort after earlier ones.
        lane_training_ids: for each lane of a race the training whose table it uses.
        waiting_for: trainings that must end before this race begins.
        continued_from: the training whose table this training went on from.
        done, total: steps, of all lanes together.
        eta_s: how much longer it will take, as far as that can be told.
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
    config: TrainingConfig | RaceConfig
    lane_training_ids: tuple[str | None, ...] = ()
    waiting_for: tuple[str, ...] = ()
    continued_from: str | None = None
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


class Page(NamedTuple):
    """Some runs of a list, newest first."""

    items: list[Run]
    next_cursor: str | None
    """Where the next page begins; None on the last."""


class RunStore(Protocol):
    """Where runs live. Safe to use from any thread."""

    def check_room(self) -> None:
        """Make sure that there is room for one more run.

        Raises:
            StorageFull: if there is not, or there may soon be none.
        """

    def create(self, *runs: Run) -> None:
        """Add new runs, all or none."""

    def get(self, run_id: str) -> Run:
        """The run as it is now.

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
        """Runs, newest first."""

    def counts(self) -> Mapping[State, int]:
        """How many runs there are in each state that any is in."""

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        """Change the state, and with it other fields, if it still is one of `from_states`.

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

    def put_artifact(self, run_id: str, name: str, data: bytes, **fields: Any) -> None:
        """Keep a file of the run's, in place of what had this name, and set fields, or neither."""

    def artifact(self, run_id: str, name: str) -> bytes | None:
        """A file of the run's; None if it has none of this name."""


class MemoryStore:
    """Implements `RunStore` for as long as the process lives."""

    def __init__(self) -> None:
        self._runs: dict[str, Run] = {}
        self._curves: dict[str, list[Mapping[str, Any]]] = {}
        self._artifacts: dict[str, dict[str, bytes]] = {}
        self._lock = threading.Lock()

    def check_room(self) -> None:
        pass

    def create(self, *runs: Run) -> None:
        with self._lock:
            self._runs |= {run.id: run for run in runs}

    def get(self, run_id: str) -> Run:
        with self._lock:
            return self._run(run_id)

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page:
        with self._lock:
            found = [
                run
                for run in self._runs.values()
                if (kind is None or run.kind == kind)
                and (state is None or run.state == state)
                and (cursor is None or run.id < cursor)
            ]
        found.sort(key=lambda run: run.id, reverse=True)
        more = len(found) > limit
        return Page(found[:limit], found[limit - 1].id if more else None)

    def counts(self) -> Mapping[State, int]:
        with self._lock:
            return Counter(run.state for run in self._runs.values())

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        with self._lock:
            run = self._run(run_id)
            if run.state not in from_states:
                raise Conflict(f"{run.kind} {run_id} is {run.state}", run.state)
            self._runs[run_id] = replace(run, state=to_state, **fields)
            return self._runs[run_id]

    def update(self, run_id: str, **fields: Any) -> Run:
        with self._lock:
            self._runs[run_id] = replace(self._run(run_id), **fields)
            return self._runs[run_id]

    def update_progress(self, run_id: str, done: int, eta_s: float | None = None) -> Run:
        return self.update(run_id, done=done, eta_s=eta_s)

    def delete(self, run_id: str) -> None:
        with self._lock:
            run = self._run(run_id)
            if run.state in UNENDED:
                raise Conflict(f"{run.kind} {run_id} is {run.state}; stop it first", run.state)
            for kept in (self._runs, self._curves, self._artifacts):
                kept.pop(run_id, None)

    def append_evaluations(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        with self._lock:
            self._run(run_id)
            first = min((row["step"] for row in rows), default=math.inf)
            before = [row for row in self._curves.get(run_id, ()) if row["step"] < first]
            self._curves[run_id] = [*before, *rows]

    def evaluations(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        with self._lock:
            self._run(run_id)
            return [*self._curves.get(run_id, ())]

    def forget_evaluations(self, run_id: str, after_step: int) -> None:
        with self._lock:
            curve = self._curves.get(run_id, [])
            self._curves[run_id] = [row for row in curve if row["step"] <= after_step]

    def put_artifact(self, run_id: str, name: str, data: bytes, **fields: Any) -> None:
        with self._lock:
            self._runs[run_id] = replace(self._run(run_id), **fields)
            self._artifacts.setdefault(run_id, {})[name] = data

    def artifact(self, run_id: str, name: str) -> bytes | None:
        with self._lock:
            self._run(run_id)
            return self._artifacts.get(run_id, {}).get(name)

    def _run(self, run_id: str) -> Run:
        if run_id not in self._runs:
            raise NotFound(f"there is no run {run_id!r} (any more)")
        return self._runs[run_id]
