"""Jobs: what is to run, what runs, and the words that change it."""

import logging
import threading
from collections.abc import Callable, Mapping
from typing import Any

from app.agents import registry
from app.domain.errors import HexapodError, InvalidInput
from app.events.bus import EventBus
from app.events.run_view import run_view
from app.jobs.job import Job
from app.jobs.queue import RunQueue
from app.jobs.resume import resumed_runs
from app.jobs.submissions import (
    ExperimentStart,
    QueuedRun,
    RaceStart,
    TrainingStart,
    queued_experiment,
    queued_race,
    queued_training,
)
from app.jobs.supervisor import STUCK_S, Supervisor
from app.storage.errors import Busy, Conflict, NotAnswering, StorageFailed
from app.storage.recordings import Recordings
from app.storage.run_ids import RunIds
from app.storage.store import (
    LIVE,
    PAUSED,
    RESUMABLE,
    RUNNING,
    TABLE,
    UNENDED,
    AnyRun,
    Content,
    IdempotencyKey,
    Run,
    RunStore,
    State,
)

MAX_PAUSED = 16
MAX_CHANGING = 8
"""So many changes at once may wait to be obeyed; each keeps a thread of the server."""
_ANSWER_S = 5.0
_DIE_S = 2.0
_GONE_S = 10.0
"""For a process to be gone once its run has ended."""
_logger = logging.getLogger(__name__)


class Jobs:
    """Starts runs in order, as many at once as there are cores, and tells them what to do.

    Every verb may be called from any thread. A paused job needs no core and gives its place away.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        *,
        on_queued: Callable[[str], object] | None = None,
        cores: int | None = None,
        niceness: int = 0,
    ) -> None:
        """Start nothing yet.

        Args:
            store: where runs are kept.
            recordings: where their motion goes.
            bus: who wants to know.
            on_queued: called with the id of what someone has asked for.
            cores: how many jobs run at once; the machine's by default.
            niceness: by how much the priority of a job's process is lower than the server's.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._on_queued = on_queued
        self.new_id = RunIds.of(store)
        self._waiting = RunQueue(store, self._publish)
        self._supervisor = Supervisor(
            store,
            recordings,
            bus,
            self._waiting,
            publish=self._publish,
            cores=cores,
            niceness=niceness,
        )
        self._changed = self._supervisor.changed
        self._changing = threading.BoundedSemaphore(MAX_CHANGING)

    @property
    def cores(self) -> int:
        """How many jobs run at once."""
        return self._supervisor.cores

    @property
    def is_open(self) -> bool:
        """Whether what is queued will be started."""
        return self._supervisor.is_open

    def trouble(self) -> str | None:
        """What keeps queued runs from being started, in a sentence; None if nothing does."""
        if not self.is_open:
            return "The server is starting, or stopping."
        stuck_s = self._supervisor.stuck_s()
        if stuck_s > STUCK_S:
            return f"A run has waited beside a free core for {stuck_s:.0f} s; the log says why."
        return None

    def open(self) -> None:
        """Begin to start what is queued."""
        self._supervisor.open()

    def close(self) -> None:
        """Start no more, and end every process with a checkpoint: all is `interrupted` then."""
        self._supervisor.close()

    def view(self, run: AnyRun) -> dict[str, Any]:
        """The resource of a run, with its place in the queue."""
        return run_view(run, self._waiting.position(run.id))

    def train(self, start: TrainingStart, key: IdempotencyKey | None = None) -> Run:
        """Queue a training.

        Args:
            start: what is asked for.
            key: of the request, remembered with the run.

        Raises:
            InvalidInput, Conflict: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue([queued_training(start, self._store, self.new_id)], key)

    def race(self, start: RaceStart, key: IdempotencyKey | None = None) -> Run:
        """Queue a race, and before it the trainings that it brings along.

        Args:
            start: what is asked for.
            key: of the request, remembered with the race.

        Raises:
            InvalidInput, Conflict: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue(queued_race(start, self._store, self.new_id), key)

    def experiment(self, start: ExperimentStart, key: IdempotencyKey | None = None) -> Run:
        """Queue an experiment.

        Args:
            start: what is asked for.
            key: of the request, remembered with the run.

        Raises:
            InvalidInput: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue([queued_experiment(start, self.new_id)], key)

    def keep(self, run: Run, table: bytes, key: IdempotencyKey | None = None) -> Run:
        """Add a training that ended elsewhere, with its table."""
        run = self._store.add(run, Content(artifacts={TABLE: table}), self.new_id, key)
        self._publish(run)
        return run

    def pause(self, run_id: str) -> Run:
        """Let a running job wait.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it does not run, or too many are paused.
        """
        with self._changed:
            job = self._live(run_id, RUNNING, "paused")
            if self._supervisor.paused >= MAX_PAUSED:
                raise Conflict(f"{MAX_PAUSED} runs are paused; stop or resume one", "running")
            run = self._change(run_id, RUNNING, "paused", eta_s=None)
            job.pause()
            self._changed.notify_all()
        self._publish(run)
        return run

    def resume(self, run_id: str) -> Run:
        """Let a paused job go on, or queue a run again that did not come to its end.

        Raises:
            NotFound: if there is no such run.
            Conflict, InvalidInput: if it is neither, or what it needs is gone.
            Busy: if too many runs are waiting.
        """
        self._await_process(run_id)
        with self._changed:
            run = self._store.get(run_id)
            if run.state in RESUMABLE[run.kind]:
                return self._enqueue(resumed_runs(run, self._store))
            try:
                resumed = self._resume_paused(run)
            except Conflict as conflict:
                if conflict.state not in RESUMABLE[run.kind]:
                    raise
                resumed = None
        # A process can die between the look and the change: then the run is one to queue again.
        return resumed or self.resume(run_id)

    def _resume_paused(self, run: Run) -> Run:
        choices = " or ".join(sorted(PAUSED | RESUMABLE[run.kind]))
        job = self._live(run.id, PAUSED, "resumed", choices)
        resumed = self._change(run.id, PAUSED, "running")
        job.resume()
        self._supervisor.mark_shared()
        self._publish(resumed)
        return resumed

    def stop(self, run_id: str) -> Run:
        """End a run with what has come of it, and wait until it has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has ended, or someone else is stopping it.
        """
        with self._changed:
            run = self._store.get(run_id)
            if run.state == "queued":
                for job in (self._supervisor.find(training) for training in run.waiting_for):
                    if job is not None and not job.stopping:
                        job.stop()
                return self._waiting.stop(run)
            job = self._live(run_id, LIVE, "stopped")
            job.stop()
        if not job.ended.wait(job.stop_grace_s):
            job.process.kill()
            job.ended.wait(_DIE_S)
        return self._store.get(run_id)

    def change(self, run_id: str, changes: Mapping[str, Any]) -> Run:
        """Change the rates or the pace of a training, and wait until that is obeyed.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it neither runs nor is paused.
            InvalidInput: if its agent has no rates.
            NotAnswering: if its process does not obey in time; nothing is changed then.
            Busy: if too many changes wait to be obeyed.
        """
        if not self._changing.acquire(blocking=False):
            raise Busy(f"{MAX_CHANGING} changes wait to be obeyed, which is the most; try again", 1)
        try:
            with self._changed:
                job = self._live(run_id, LIVE, "changed")
                agent = getattr(self._store.get(run_id).config, "agent", "")
                if set(changes) - {"pace"} and not hasattr(registry.find(agent), "tune"):
                    raise InvalidInput(
                        f"{agent} has no rates that could be changed; give pace only"
                    )
                answer = job.tune(changes, _ANSWER_S) if job.is_answering else None
            if answer is None or not answer.wait(_ANSWER_S):
                raise NotAnswering(
                    f"the process of training {run_id} does not answer, so nothing was changed; "
                    "if that lasts it is ended, and the training can be resumed",
                    int(_ANSWER_S),
                )
        finally:
            self._changing.release()
        return self._store.get(run_id)

    def delete(self, run_id: str) -> None:
        """Forget a run that has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended, or a race that waits needs it.
        """
        self._await_process(run_id)
        with self._changed:
            race = self._waiting.needing(run_id)
            if race is not None:
                state = self._store.find(run_id).state or "damaged"
                raise Conflict(f"race {race.id} waits, and needs its table", state)
            self._store.delete(run_id)
        self._recordings.discard(run_id)
        self._bus.publish("run-deleted", {"id": run_id}, run_id)

    def _enqueue(self, entries: list[QueuedRun], key: IdempotencyKey | None = None) -> Run:
        with self._changed:
            free = max(0, self.cores - self._supervisor.running)
            self._waiting.add(entries, free, key)
            self._changed.notify_all()
        run = entries[-1].run
        if self._on_queued is not None and run.kind != "experiment":
            try:
                self._on_queued(run.id)
            except HexapodError:
                # It is queued, whatever became of showing it.
                _logger.warning("a run is not shown", extra={"run_id": run.id}, exc_info=True)
        return run

    def _await_process(self, run_id: str) -> None:
        """Wait until the process of a run that has ended is gone, and everyone has been told.

        Otherwise the last words about a run would come after its deletion, or its next start.

        Raises:
            Conflict: if it takes too long.
        """
        job = self._supervisor.find(run_id)
        if job is None or (run := self._store.get(run_id)).state in UNENDED:
            return
        if not job.gone.wait(_GONE_S):
            raise Conflict(f"{run.kind} {run_id} is still ending; try again", run.state)

    def _change(
        self, run_id: str, from_states: frozenset[State], to_state: State, **fields: Any
    ) -> Run:
        """Change a job's state in the store; if that fails halfway it is set right later."""
        try:
            return self._store.change(run_id, from_states, to_state, **fields)
        except StorageFailed:
            self._supervisor.reconcile_later(run_id)
            raise

    def _live(
        self, run_id: str, states: frozenset[State], what: str, choices: str | None = None
    ) -> Job:
        """The job of a run in one of these states, that nobody is stopping."""
        run = self._store.get(run_id)
        job = self._supervisor.find(run_id)
        if run.state not in states or job is None:
            choices = choices or " or ".join(sorted(states))
            raise Conflict(
                f"{run.kind} {run_id} is {run.state}; it can be {what} while it is {choices}",
                run.state,
            )
        if job.stopping:
            raise Conflict(f"{run.kind} {run_id} is {run.state} and being stopped", run.state)
        return job

    def _publish(self, run: Run) -> None:
        self._bus.publish("run", self.view(run), run.id)
