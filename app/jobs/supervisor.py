"""Supervises job processes: starts them as cores free up, collects their results, shuts them down.

No exception ends the supervisor's thread or the jobs' threads: whatever goes wrong with one run,
the next one starts.
"""

import logging
import os
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

from app.events.bus import EventBus
from app.jobs.job import Job
from app.jobs.queue import RunQueue
from app.jobs.tasks import task_for
from app.jobs.worker_process import Exit
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound, OwnershipLost, StorageFailed, StorageFull
from app.storage.recordings import Recordings
from app.storage.run import LIVE, NOT_ENDED, QUEUED, RUNNING, Run, State
from app.storage.run_kind import added_kind
from hexapods.domain.errors import HexapodError

STUCK_S = 5.0
"""A run that is ready for longer while a core is free is reported by the health check."""
_CHECKPOINT_S = 4.0
"""Time for jobs to write a last checkpoint at shutdown, of the 10 s that a shutdown may take."""
_KILL_S = 1.5
_CHECK_EVERY_S = 1.0
_FROZEN_S = 5.0
"""After a longer time between two checks the server was stopped itself, perhaps with its jobs."""
_STORE_UNAVAILABLE = (StorageFailed, StorageFull)
_logger = logging.getLogger(__name__)


class Supervisor:
    """Starts one worker process per job, at most one job per core, and watches over them.

    Attributes:
        changed: condition variable that guards the jobs and the queue. Callers hold it around
            every call but `open`, `close` and `stuck_s`; notified when a run may be started.
        cores: maximum number of jobs that run at once.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        queue: RunQueue,
        *,
        publish: Callable[[Run], None],
        cores: int | None,
        niceness: int,
    ) -> None:
        """Create the supervisor; `open` starts its thread.

        Args:
            store: store of the runs.
            recordings: receives the motion of the robots.
            bus: receives the jobs' events.
            queue: runs that wait to be started.
            publish: called with each run that changed.
            cores: maximum number of jobs that run at once; None means one per core.
            niceness: added to the server's nice value in worker processes.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._queue, self._publish = queue, publish
        self.cores = cores or os.cpu_count() or 1
        self._niceness = niceness
        self.changed = threading.Condition()
        self._jobs: dict[str, Job] = {}
        self._to_reconcile: set[str] = set()
        """Ids of jobs whose stored state may differ from theirs, since a write failed halfway."""
        self._started_again: set[str] = set()
        """Ids of running jobs whose first process was lost."""
        self._shutdown = threading.Event()
        self._last_progress_s = time.monotonic()
        """When a run was started last, or no run could be started; monotonic clock."""
        self._checked_s = time.monotonic()
        """When the jobs were checked last; monotonic clock."""
        self._thread = threading.Thread(target=self._supervise, name="supervisor", daemon=True)

    @property
    def is_open(self) -> bool:
        """Whether queued runs will be started."""
        return self._thread.is_alive() and not self._shutdown.is_set()

    @property
    def running(self) -> int:
        """Number of jobs that occupy a core."""
        return sum(not job.paused for job in list(self._jobs.values()))

    @property
    def paused(self) -> int:
        """Number of paused jobs."""
        return len(self._jobs) - self.running

    def stuck_s(self) -> float:
        """Return for how long a ready run has waited although a core was free [s], else 0."""
        if not self._queue.has_ready or self.running >= self.cores:
            return 0.0
        return time.monotonic() - self._last_progress_s

    def find(self, run_id: str) -> Job | None:
        """Return the job of a run, None if it has none."""
        return self._jobs.get(run_id)

    def open(self) -> None:
        """Begin to start queued runs."""
        self._last_progress_s = time.monotonic()
        self._thread.start()

    def close(self) -> None:
        """Shut down: start no more runs, let processes write a checkpoint, kill late ones.

        Running and queued runs become `interrupted`.
        """
        with self.changed:
            self._shutdown.set()
            try:
                self._queue.interrupt("The server was stopped before its turn came.")
            except HexapodError:
                _logger.exception(
                    "the queue could not be marked as interrupted; the next start does it"
                )
            self.changed.notify_all()
            jobs = list(self._jobs.values())
        for job in jobs:
            job.checkpoint_and_exit()
        _wait_until_gone(jobs, _CHECKPOINT_S)
        late = [job for job in jobs if not job.gone.is_set()]
        for job in late:
            job.process.kill()
        _wait_until_gone(late, _KILL_S)
        if self._thread.is_alive():
            self._thread.join(_KILL_S)

    def mark_shared(self) -> None:
        """Mark running jobs as sharing the machine if there are several.

        Decision times are measured in wall time, so a race's result reports it.
        """
        running = [job for job in self._jobs.values() if not job.paused]
        for job in running:
            job.shared |= len(running) > 1

    def reconcile_later(self, run_id: str) -> None:
        """Schedule a rewrite of a job's state, which a failed write may have left different."""
        self._to_reconcile.add(run_id)

    def _supervise(self) -> None:
        with self.changed:
            while not self._shutdown.is_set():
                try:
                    if not self._start_next():
                        self.changed.wait(_CHECK_EVERY_S)
                    self._check_jobs()
                except Exception:
                    _logger.exception("error in the supervisor; continuing")
                    self.changed.wait(_CHECK_EVERY_S)

    def _start_next(self) -> bool:
        """Start the first ready run if a core is free; False if none can be started now."""
        is_free = self.running < self.cores
        run = self._queue.pop_ready() if is_free else None
        if run is None:
            self._last_progress_s = time.monotonic()
            return False
        try:
            self._start(run)
        except OwnershipLost:
            _logger.exception("a run is not started", extra=_log_fields(run.id))
        except _STORE_UNAVAILABLE:
            _logger.exception("a run cannot be started now", extra=_log_fields(run.id))
            self._queue.push_front(run)
            return False
        except (Conflict, NotFound) as error:
            _logger.warning("a run has left the queue: %s", error, extra=_log_fields(run.id))
            self._settle(run)
        self._last_progress_s = time.monotonic()
        try:
            self._queue.publish_positions()
        except HexapodError:
            _logger.warning("publishing the places in the queue failed", exc_info=True)
        return True

    def _start(self, run: Run) -> None:
        """Start a worker process for a run that was queued."""
        # The system clock may have been set back since the run was created.
        run_id, now = run.id, max(datetime.now(UTC), run.created_at)
        started_at = run.started_at or now
        # It is stored as `running` already if the reply to an earlier attempt was lost.
        run = self._store.change(
            run_id, QUEUED | RUNNING, "running", started_at=started_at, waiting_for=()
        )
        try:
            job = self._job(run)
            job.process.start(lambda end: self._process_ended(job, end))
        except _STORE_UNAVAILABLE:
            raise
        except Exception as error:
            if not isinstance(error, HexapodError | OSError):
                _logger.exception("a run cannot be started", extra=_log_fields(run_id))
            reason = f"The {run.kind} could not be started: {error}"
            run = self._store.change(run_id, LIVE, "failed", error=reason, ended_at=now)
            self._publish(run)
            self._queue.settle(run)
            return
        self._jobs[run_id] = job
        self.mark_shared()
        job.publish()

    def _job(self, run: Run) -> Job:
        kind = added_kind(run.kind)
        job_class = Job if kind is None else kind.job_class()
        task = task_for(run, self._store, self._recordings)
        services = self._store, self._recordings, self._bus
        job: Job = job_class(run, task, *services, shutdown=self._shutdown, niceness=self._niceness)
        return job

    def _check_jobs(self) -> None:
        """Kill stalled processes, and reconcile the states that failed writes left uncertain."""
        checked_s, self._checked_s = self._checked_s, time.monotonic()
        for job in self._jobs.values():
            if self._checked_s - checked_s > _FROZEN_S:
                job.process.excuse_silence()
            job.end_if_stalled()
        for run_id in list(self._to_reconcile):
            running_job = self._jobs.get(run_id)
            try:
                if running_job is not None:
                    state: State = "paused" if running_job.paused else "running"
                    running_job.change_state(LIVE, state)
                self._to_reconcile.discard(run_id)
            except _STORE_UNAVAILABLE:
                return
            except HexapodError:
                self._to_reconcile.discard(run_id)
        self._queue.reconcile()

    def _process_ended(self, job: Job, end: Exit) -> None:
        """Write the final state of a run and free its core even if that fails."""
        try:
            if end.is_lost and self._start_again(job):
                return
            while not self._note_end(job, end) and not self._shutdown.is_set():
                # The store is unavailable; if that lasts, the next start marks it `interrupted`.
                self._shutdown.wait(_CHECK_EVERY_S)
        except Exception:
            _logger.exception("storing the end of a run failed", extra=_log_fields(job.run_id))
        finally:
            with self.changed:
                if self._jobs.get(job.run_id) is job:
                    del self._jobs[job.run_id]
                    self._started_again.discard(job.run_id)
                self._to_reconcile.discard(job.run_id)
                self.changed.notify_all()
            job.gone.set()

    def _start_again(self, job: Job) -> bool:
        """Start a run once more whose process was lost before it did anything; else False."""
        with self.changed:
            if self._shutdown.is_set() or job.run_id in self._started_again:
                return False
            if not job.can_start_again:
                return False
            self._started_again.add(job.run_id)
            _logger.warning("a lost process is started again", extra=_log_fields(job.run_id))
            try:
                self._start(job.last)
            except HexapodError:
                return False
            return True

    def _note_end(self, job: Job, end: Exit) -> bool:
        """Write a run's final state; False if the store is unavailable and a retry is needed."""
        try:
            if self._shutdown.is_set():
                job.end("interrupted", "The server was stopped while it ran.")
                return True
            job.process_ended(end)
        except OwnershipLost:
            return True
        except _STORE_UNAVAILABLE:
            _logger.warning("the end of a run cannot be stored yet", extra=_log_fields(job.run_id))
            return False
        except (NotFound, Conflict) as error:
            _logger.warning(
                "the end of a run is not stored: %s", error, extra=_log_fields(job.run_id)
            )
        with self.changed:
            if not self._shutdown.is_set():
                return self._settle(job.last)
        return True

    def _settle(self, run: Run) -> bool:
        """Resolve the dependencies on an ended run; False if the store is unavailable."""
        if run.state in NOT_ENDED:
            # Its row was deleted, or something else than its job changed its state.
            run = replace(run, state="stopped")
        try:
            self._queue.settle(run)
        except _STORE_UNAVAILABLE:
            return False
        return True


def _log_fields(run_id: str) -> dict[str, str]:
    return {"run_id": run_id}


def _wait_until_gone(jobs: list[Job], at_most_s: float) -> None:
    deadline = time.monotonic() + at_most_s
    for job in jobs:
        job.gone.wait(max(0.0, deadline - time.monotonic()))
