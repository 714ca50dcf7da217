"""The queue: runs in order of submission, each with the trainings that it depends on.

Runs that operators have started keep their order. Of those that others own, that of the owner who
has had the fewest turns comes first. Runs of guests come after all others, fairly among the groups
of guests and then among the guests.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from typing import Literal, NamedTuple

from cachetools import LRUCache

from app.storage.database.store import RunStore
from app.storage.errors import Busy, StorageFailed, StorageFull
from app.storage.run import QUEUED, RESUMABLE, RUNNING, IdempotencyKey, Run, State
from hexapods.domain.errors import HexapodError

MAX_QUEUED = 32
"""Runs of operators that wait."""
MAX_OF_OWNERS = 2048
MAX_OF_GUESTS = 256
RETRY_AFTER_S = 10
_MAX_TURNS_KEPT = 20_000
"""Owners and groups whose turns are known; of others it is forgotten that they had any."""
_Class = Literal["operator", "owner", "guest"]
_PLACES: dict[_Class, int] = {
    "operator": MAX_QUEUED,
    "owner": MAX_OF_OWNERS,
    "guest": MAX_OF_GUESTS,
}


class Owner(NamedTuple):
    """Someone other than an operator, who waits for a run.

    Attributes:
        name: of the owner; nobody else has it.
        group: owners who take turns together before each takes their own, such as those of one
            address, which could pose as many.
        is_guest: whether the owner's runs wait until nobody else's do.
    """

    name: str
    group: str = ""
    is_guest: bool = False


class RunQueue:
    """First-in first-out queue of runs that wait for a core or for their trainings.

    Not thread-safe but for `has_ready` and `position`: the owner holds a lock around other calls.

    Args:
        store: store of the runs.
        publish: called with every run that changes here, and its position in the queue.
        owner_of: returns who waits for the run of an id; None for an operator.
    """

    def __init__(
        self,
        store: RunStore,
        publish: Callable[[Run, int | None], None],
        owner_of: Callable[[str], Owner | None] = lambda run_id: None,  # noqa: ARG005
    ) -> None:
        self._store, self._publish, self._owner_of = store, publish, owner_of
        self._turns: LRUCache[str, int] = LRUCache(_MAX_TURNS_KEPT)
        """Number of runs of each owner, and of each group, that were started."""
        self._runs: dict[str, Run] = {}
        """By id, in order; each as it was stored last."""
        self._unreconciled: set[str] = set()
        """Ids of runs that the store may have written although it raised an error."""

    def add(
        self,
        runs: Sequence[Run],
        free: int,
        key: IdempotencyKey | None = None,
        *,
        resumed: bool = False,
    ) -> Run:
        """Store runs and append them, all or none.

        Args:
            runs: in order, dependencies first.
            free: number of free cores; so many runs may exceed the limit.
            key: idempotency key of the request for the last of them.
            resumed: whether the runs are in the store already, with the state in which they ended.

        Returns:
            the last of them, as stored.

        Raises:
            Busy: if the queue is full.
            StorageFull: if the disk has no space for another run.
        """
        self._check_room_for(runs, free)
        self._store.check_disk_space()
        try:
            if resumed:
                runs = [self._requeue(run) for run in runs]
            else:
                self._store.create(*runs, key=key)
        except HexapodError:
            # Some may be stored as `queued` although they are not in the queue.
            self._unreconciled |= {run.id for run in runs}
            raise
        self._runs |= {run.id: run for run in runs}
        positions = self._positions()
        for run in runs:
            self._publish(run, positions[run.id])
        return runs[-1]

    def _check_room_for(self, runs: Sequence[Run], free: int) -> None:
        kind = self._class_of(runs[-1].id)
        alike = sum(self._class_of(run_id) == kind for run_id in self._runs)
        most = _PLACES[kind]
        if alike + len(runs) > most + free:
            raise Busy(
                f"{alike} runs are waiting, the most is {most}; wait for one to end, or stop one",
                RETRY_AFTER_S,
            )

    def _class_of(self, run_id: str) -> _Class:
        owner = self._owner_of(run_id)
        if owner is None:
            return "operator"
        return "guest" if owner.is_guest else "owner"

    def _requeue(self, run: Run) -> Run:
        """Store a resumed run as queued and delete the evaluations that it will repeat."""
        fields = ("done", "waiting_for", "error", "result", "ended_at")
        changed = {field: getattr(run, field) for field in fields}
        queued = self._store.change(run.id, RESUMABLE, "queued", **changed)
        self._store.curves.delete_after(run.id, after_step=run.done)
        return queued

    def reconcile(self) -> None:
        """Interrupt runs that were stored although their submission failed with an error."""
        for run_id in list(self._unreconciled):
            try:
                now = datetime.now(UTC)
                reason = "The database failed when it was started."
                self._publish(
                    self._store.change(run_id, QUEUED, "interrupted", error=reason, ended_at=now),
                    None,
                )
            except (StorageFailed, StorageFull):
                return
            except HexapodError:
                pass  # it was never stored
            self._unreconciled.discard(run_id)

    def replace(self, run: Run) -> None:
        """Replace a queued run by what is stored of it now; nothing if it is not in the queue."""
        if run.id in self._runs:
            self._runs[run.id] = run

    @property
    def has_ready(self) -> bool:
        """Whether a run waits for nothing but a core; callable from any thread."""
        return any(not run.waiting_for for run in list(self._runs.values()))

    def pop_ready(self) -> Run | None:
        """Remove and return the first run that waits for nothing but a core, None if none does.

        If somebody owns it, the first of the owner who has had the fewest turns; both exchange
        their places, so that the runs of others keep theirs. A guest's only if there is no other,
        the first of the group, and there of the guest, with the fewest turns.
        """
        ready = [run for run in self._runs.values() if not run.waiting_for]
        ready = [run for run in ready if self._class_of(run.id) != "guest"] or ready
        if not ready:
            return None
        first = ready[0]
        if self._owner_of(first.id) is None:
            return self._runs.pop(first.id)
        owned = [(owner, run) for run in ready if (owner := self._owner_of(run.id)) is not None]
        owner, run = min(owned, key=lambda pair: self._turns_of(pair[0]))
        for name in (owner.name, _group_key(owner)):
            self._turns[name] = self._turns.get(name, 0) + 1
        if owner.is_guest:  # only theirs wait
            return self._runs.pop(run.id)
        places = {run.id: first, first.id: run}
        self._runs = {
            owner.id: owner for owner in (places.get(i, r) for i, r in self._runs.items())
        }
        return self._runs.pop(run.id)

    def _turns_of(self, owner: Owner) -> tuple[int, int]:
        return self._turns.get(_group_key(owner), 0), self._turns.get(owner.name, 0)

    def push_front(self, run: Run) -> None:
        """Insert a run that could not be started at the head of the queue."""
        self._runs = {run.id: run, **self._runs}

    def publish_positions(self) -> None:
        """Publish all queued runs after their positions changed."""
        positions = self._positions()
        for run_id, run in self._runs.items():
            self._publish(run, positions[run_id])

    def position(self, run_id: str) -> int | None:
        """Return a run's position, 1 for the first, None if absent; callable from any thread."""
        return self._positions().get(run_id) if run_id in self._runs else None

    def _positions(self) -> dict[str, int]:
        return {
            run_id: number for number, run_id in enumerate(self._order(list(self._runs)), start=1)
        }

    def _order(self, ids: Sequence[str]) -> list[str]:
        """Return ids in the order in which runs are started if none is added."""
        first = [run_id for run_id in ids if self._class_of(run_id) != "guest"]
        owners = {
            run_id: owner for run_id in ids if (owner := self._owner_of(run_id)) and owner.is_guest
        }
        ahead: Counter[str] = Counter()
        own_turns: dict[str, int] = {}
        for run_id, owner in owners.items():
            own_turns[run_id] = self._turns_of(owner)[1] + ahead[owner.name]
            ahead[owner.name] += 1
        places: dict[str, tuple[int, int]] = {}
        for run_id in sorted(owners, key=lambda owned: own_turns[owned]):
            group = _group_key(owners[run_id])
            places[run_id] = self._turns.get(group, 0) + ahead[group], own_turns[run_id]
            ahead[group] += 1
        return [*first, *sorted(owners, key=lambda owned: places[owned])]

    def interrupt(self, reason: str) -> None:
        """Set all queued runs to `interrupted`, which can be resumed, and empty the queue."""
        # One is stored as `running` if its start failed halfway.
        runs = self._store.interrupt(self._runs, QUEUED | RUNNING, reason)
        self._runs = {}
        for run in runs:
            self._publish(run, None)

    def run_needing(self, training_id: str) -> Run | None:
        """Return a queued run that needs the table of this training, None if there is none."""
        return next((run for run in self._runs.values() if training_id in _needed_by(run)), None)

    def stop(self, run: Run) -> Run:
        """Stop a queued run and the queued trainings that were created for it."""
        stopped = self._drop(run, "stopped", None)
        for training in [queued for queued in self._runs.values() if queued.id in run.waiting_for]:
            self._drop(training, "stopped", f"Stopped together with race {run.id}.")
        return stopped

    def settle(self, ended: Run) -> None:
        """Resolve dependencies on an ended run: release its dependents, or end them as it ended."""
        for run in [run for run in self._runs.values() if ended.id in run.waiting_for]:
            if ended.state == "finished":
                remaining = tuple(
                    training_id for training_id in run.waiting_for if training_id != ended.id
                )
                # If the write fails, the run still waits, so that it is retried.
                self._runs[run.id] = self._store.update(run.id, waiting_for=remaining)
                self._publish(self._runs[run.id], self.position(run.id))
            elif ended.state == "failed":
                self._drop(run, "failed", f"Its training {ended.id} failed: {ended.error}")
            else:
                self._drop(run, "stopped", f"Its training {ended.id} was {ended.state}.")

    def _drop(self, run: Run, state: State, error: str | None) -> Run:
        now = datetime.now(UTC)
        run = self._store.change(run.id, QUEUED, state, error=error, ended_at=now)
        # After the write, so that the run stays queued if it fails.
        self._runs.pop(run.id, None)
        self._publish(run, None)
        self.publish_positions()
        self.settle(run)
        return run


def _group_key(owner: Owner) -> str:
    return f"group {owner.group}"


def _needed_by(run: Run) -> tuple[str | None, ...]:
    """Return the trainings whose tables a queued run loads when it starts."""
    # A training that has done steps starts from its own checkpoint.
    return run.lane_training_ids if run.done else (*run.lane_training_ids, run.continued_from)
