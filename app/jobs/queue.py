"""The queue: runs in the order in which they were asked for, and what each waits for."""

from collections.abc import Callable, Sequence
from datetime import UTC, datetime

from app.domain.errors import HexapodError
from app.jobs.submissions import QueuedRun
from app.storage.errors import Busy, StorageFailed, StorageFull
from app.storage.store import (
    QUEUED,
    RESUMABLE,
    RUNNING,
    IdempotencyKey,
    Run,
    RunStore,
    State,
)

MAX_QUEUED = 32
RETRY_AFTER_S = 10


class RunQueue:
    """Runs that wait for a core or for their trainings. Its owner holds a lock around every call.

    Args:
        store: where the runs are kept.
        tell: is told of every run that changes here.
    """

    def __init__(self, store: RunStore, tell: Callable[[Run], None]) -> None:
        self._store, self._tell = store, tell
        self._entries: list[QueuedRun] = []
        self._unsure: set[str] = set()
        """Runs that may be in the store although it failed to say so."""

    def add(
        self, entries: Sequence[QueuedRun], free: int, key: IdempotencyKey | None = None
    ) -> None:
        """Store runs and let them wait, all or none.

        Args:
            entries: in order.
            free: how many could start at once.
            key: of the request for the last of them.

        Raises:
            Busy: if too many are waiting.
            StorageFull: if there is no room for another run.
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
                entry.run = self._queue_again(entry.run)
        except HexapodError:
            # Some may read `queued` now, with nothing that will start them.
            self._unsure |= {entry.run.id for entry in entries}
            raise
        self._entries += entries
        for entry in entries:
            self._tell(entry.run)

    def _queue_again(self, run: Run) -> Run:
        """What came after the step from which it goes on comes again."""
        fields = ("done", "waiting_for", "error", "result", "ended_at")
        changed = {field: getattr(run, field) for field in fields}
        queued = self._store.change(run.id, RESUMABLE[run.kind], "queued", **changed)
        self._store.delete_evaluations(run.id, after_step=run.done)
        return queued

    def reconcile(self) -> None:
        """End runs that were stored although their start was answered with an error."""
        for run_id in list(self._unsure):
            try:
                now = datetime.now(UTC)
                why = "The database failed when it was started."
                self._tell(
                    self._store.change(run_id, QUEUED, "interrupted", error=why, ended_at=now)
                )
            except (StorageFailed, StorageFull):
                return
            except HexapodError:
                pass  # it was never stored
            self._unsure.discard(run_id)

    @property
    def has_ready(self) -> bool:
        """Whether a run waits for nothing but a core; from any thread."""
        return any(not entry.waits_for for entry in list(self._entries))

    def take(self) -> QueuedRun | None:
        """The first that waits for nothing but a core; it does not wait any more."""
        ready = (entry for entry in self._entries if not entry.waits_for)
        entry = next(ready, None)
        if entry is not None:
            self._entries.remove(entry)
        return entry

    def put_back(self, entry: QueuedRun) -> None:
        """It could not be started after all, and is the first again."""
        self._entries.insert(0, entry)

    def tell_all(self) -> None:
        """All who wait have moved up, or some of them."""
        for entry in self._entries:
            self._tell(self._store.get(entry.run.id))

    def position(self, run_id: str) -> int | None:
        """Its place among those that wait, 1 for the first; from any thread."""
        ids = [entry.run.id for entry in self._entries]
        return ids.index(run_id) + 1 if run_id in ids else None

    def interrupt(self, why: str) -> None:
        """End all that wait, so that each may be resumed another time."""
        for entry in self._entries:
            now = max(datetime.now(UTC), entry.run.created_at)
            changed = {"error": why, "ended_at": now, "waiting_for": ()}
            # It reads `running` if its start failed halfway.
            states = QUEUED | RUNNING
            self._tell(self._store.change(entry.run.id, states, "interrupted", **changed))
        self._entries = []

    def needing(self, training_id: str) -> Run | None:
        """A race that waits, and needs the table of this training."""
        runs = (entry.run for entry in self._entries)
        return next((run for run in runs if training_id in run.lane_training_ids), None)

    def stop(self, run: Run) -> Run:
        """End a run that waits, and the trainings that were made for it and wait as well."""
        stopped = self._drop(run, "stopped", None)
        for entry in [entry for entry in self._entries if entry.run.id in run.waiting_for]:
            self._drop(entry.run, "stopped", f"Stopped together with race {run.id}.")
        return stopped

    def settle(self, run: Run) -> None:
        """Tell those that wait for a run how it ended: go on, or end as it did."""
        for entry in [entry for entry in self._entries if run.id in entry.waits_for]:
            if run.state == "finished":
                left = [i for i in entry.run.waiting_for if i in entry.waits_for - {run.id}]
                updated = self._store.update(entry.run.id, waiting_for=tuple(left))
                # After it was written, so that it is tried again if that fails.
                entry.waits_for.discard(run.id)
                self._tell(updated)
            elif run.state == "failed":
                self._drop(entry.run, "failed", f"Its training {run.id} failed: {run.error}")
            else:
                self._drop(entry.run, "stopped", f"Its training {run.id} was {run.state}.")

    def _drop(self, run: Run, state: State, error: str | None) -> Run:
        now = datetime.now(UTC)
        run = self._store.change(run.id, QUEUED, state, error=error, ended_at=now)
        # After it was written, so that it still waits if that fails.
        self._entries = [entry for entry in self._entries if entry.run.id != run.id]
        self._tell(run)
        self.tell_all()
        self.settle(run)
        return run
