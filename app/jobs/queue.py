"""The queue: runs in order of submission, each with the trainings that it depends on."""

from collections.abc import Callable, Sequence
from datetime import UTC, datetime

from app.domain.errors import HexapodError
from app.jobs.submissions import QueuedRun
from app.storage.database.store import RunStore
from app.storage.errors import Busy, StorageFailed, StorageFull
from app.storage.run import QUEUED, RESUMABLE, RUNNING, IdempotencyKey, Run, State

MAX_QUEUED = 32
RETRY_AFTER_S = 10


class RunQueue:
    """First-in first-out queue of runs that wait for a core or for their trainings.

    Not thread-safe but for `has_ready` and `position`: the owner holds a lock around other calls.

    Args:
        store: store of the runs.
        publish: called with every run that changes here.
    """

    def __init__(self, store: RunStore, publish: Callable[[Run], None]) -> None:
        self._store, self._publish = store, publish
        self._entries: list[QueuedRun] = []
        self._unreconciled: set[str] = set()
        """Ids of runs that the store may have written although it raised an error."""

    def add(
        self, entries: Sequence[QueuedRun], free: int, key: IdempotencyKey | None = None
    ) -> None:
        """Store runs and append them, all or none.

        Args:
            entries: runs in order, dependencies first.
            free: number of free cores; so many runs may exceed the limit.
            key: idempotency key of the request for the last of them.

        Raises:
            Busy: if the queue is full.
            StorageFull: if the disk has no space for another run.
        """
        if len(self._entries) + len(entries) > MAX_QUEUED + free:
            raise Busy(
                f"{len(self._entries)} runs are waiting, the most is {MAX_QUEUED}; wait for one "
                "to end, or stop one",
                RETRY_AFTER_S,
            )
        self._store.check_disk_space()
        new = [entry.run for entry in entries if not entry.goes_on]
        try:
            self._store.create(*new, key=key)
            for entry in (entry for entry in entries if entry.goes_on):
                entry.run = self._requeue(entry.run)
        except HexapodError:
            # Some may be stored as `queued` although they are not in the queue.
            self._unreconciled |= {entry.run.id for entry in entries}
            raise
        self._entries += entries
        for entry in entries:
            self._publish(entry.run)

    def _requeue(self, run: Run) -> Run:
        """Store a resumed run as queued and delete the evaluations that it will repeat."""
        fields = ("done", "waiting_for", "error", "result", "ended_at")
        changed = {field: getattr(run, field) for field in fields}
        queued = self._store.change(run.id, RESUMABLE[run.kind], "queued", **changed)
        self._store.delete_evaluations(run.id, after_step=run.done)
        return queued

    def reconcile(self) -> None:
        """Interrupt runs that were stored although their submission failed with an error."""
        for run_id in list(self._unreconciled):
            try:
                now = datetime.now(UTC)
                reason = "The database failed when it was started."
                self._publish(
                    self._store.change(run_id, QUEUED, "interrupted", error=reason, ended_at=now)
                )
            except (StorageFailed, StorageFull):
                return
            except HexapodError:
                pass  # it was never stored
            self._unreconciled.discard(run_id)

    @property
    def has_ready(self) -> bool:
        """Whether a run waits for nothing but a core; callable from any thread."""
        return any(not entry.waits_for for entry in list(self._entries))

    def pop_ready(self) -> QueuedRun | None:
        """Remove and return the first run that waits for nothing but a core, None if none does."""
        ready = (entry for entry in self._entries if not entry.waits_for)
        entry = next(ready, None)
        if entry is not None:
            self._entries.remove(entry)
        return entry

    def push_front(self, entry: QueuedRun) -> None:
        """Insert a run that could not be started at the head of the queue."""
        self._entries.insert(0, entry)

    def publish_positions(self) -> None:
        """Publish all queued runs after their positions changed."""
        for entry in self._entries:
            self._publish(self._store.get(entry.run.id))

    def position(self, run_id: str) -> int | None:
        """Return a run's position, 1 for the first, None if absent; callable from any thread."""
        ids = [entry.run.id for entry in self._entries]
        return ids.index(run_id) + 1 if run_id in ids else None

    def interrupt(self, reason: str) -> None:
        """Set all queued runs to `interrupted`, which can be resumed, and empty the queue."""
        for entry in self._entries:
            now = max(datetime.now(UTC), entry.run.created_at)
            changed = {"error": reason, "ended_at": now, "waiting_for": ()}
            # It is stored as `running` if its start failed halfway.
            states = QUEUED | RUNNING
            self._publish(self._store.change(entry.run.id, states, "interrupted", **changed))
        self._entries = []

    def race_needing(self, training_id: str) -> Run | None:
        """Return a queued race that needs the table of this training, None if there is none."""
        runs = (entry.run for entry in self._entries)
        return next((run for run in runs if training_id in run.lane_training_ids), None)

    def stop(self, run: Run) -> Run:
        """Stop a queued run and the queued trainings that were created for it."""
        stopped = self._drop(run, "stopped", None)
        for entry in [entry for entry in self._entries if entry.run.id in run.waiting_for]:
            self._drop(entry.run, "stopped", f"Stopped together with race {run.id}.")
        return stopped

    def settle(self, run: Run) -> None:
        """Resolve dependencies on an ended run: release its dependents, or end them as it ended."""
        for entry in [entry for entry in self._entries if run.id in entry.waits_for]:
            if run.state == "finished":
                remaining = [i for i in entry.run.waiting_for if i in entry.waits_for - {run.id}]
                updated = self._store.update(entry.run.id, waiting_for=tuple(remaining))
                # After the write, so that a failed write is retried.
                entry.waits_for.discard(run.id)
                self._publish(updated)
            elif run.state == "failed":
                self._drop(entry.run, "failed", f"Its training {run.id} failed: {run.error}")
            else:
                self._drop(entry.run, "stopped", f"Its training {run.id} was {run.state}.")

    def _drop(self, run: Run, state: State, error: str | None) -> Run:
        now = datetime.now(UTC)
        run = self._store.change(run.id, QUEUED, state, error=error, ended_at=now)
        # After the write, so that the run stays queued if it fails.
        self._entries = [entry for entry in self._entries if entry.run.id != run.id]
        self._publish(run)
        self.publish_positions()
        self.settle(run)
        return run
