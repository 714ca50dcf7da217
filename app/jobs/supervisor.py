"""Supervises job processes: starts them as cores free up, collects their results, shuts them down.

The thread of the supervisor and those of the jobs never end by an exception: whatever is wrong with
one run, the next one starts.
"""

import logging
import os
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

from app.domain.errors import HexapodError
from app.events.bus import EventBus
from app.jobs.job import ExperimentJob, Job
from app.jobs.messages import ExperimentTask, Task
from app.jobs.queue import RunQueue
from app.jobs.submissions import QueuedRun
from app.jobs.worker_process import Exit
from app.storage.errors import Conflict, NotFound, OwnershipLost, StorageFailed, StorageFull
from app.storage.recordings import Recordings
from app.storage.store import LIVE, QUEUED, RUNNING, UNENDED, Run, RunStore, State

STUCK_S = 5.0
"""A run that waits for so long beside a free core shows that something is wrong."""
_LEAVE_S = 4.0
"""To write a last checkpoint; with all else that ends, a server is gone within 10 s."""
_DIE_S = 1.5
_CHECK_EVERY_S = 1.0
_NO_STORE = (StorageFailed, StorageFull)
_logger = logging.getLogger(__name__)


class Supervisor:
    """One process for each job, as many at once as there are cores.

    Attributes:
        changed: guards the jobs and the queue, and is held around every call but `open`, `close`
            and `stuck_s`; notified when something may be started.
        cores: how many jobs run at once.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        waiting: RunQueue,
        *,
        publish: Callable[[Run], None],
        cores: int | None,
        niceness: int,
    ) -> None:
        """Start nothing yet.

        Args:
            store: where runs are kept.
            recordings: where their motion goes.
            bus: who wants to know.
            waiting: the queue.
            publish: tells of a run that changed.
            cores: how many jobs run at once; None is the machine's.
            niceness: by how much the priority of a job's process is lower than the server's.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._waiting, self._publish = waiting, publish
        self.cores = cores or os.cpu_count() or 1
        self._niceness = niceness
        self.changed = threading.Condition()
        self._jobs: dict[str, Job] = {}
        self._unsure: set[str] = set()
        """Jobs whose state in the store may be another than theirs: a write failed halfway."""
        self._shutdown = threading.Event()
        self._moved_s = time.monotonic()
        """When something was started last, or nothing was there to be started."""
        # The kernel ends a child with the thread that started it, so that one thread starts all.
        self._thread = threading.Thread(target=self._supervise, name="supervisor", daemon=True)

    @property
    def is_open(self) -> bool:
        """Whether what is queued will be started."""
        return self._thread.is_alive() and not self._shutdown.is_set()

    @property
    def running(self) -> int:
        """How many jobs take a core."""
        return sum(not job.paused for job in list(self._jobs.values()))

    @property
    def paused(self) -> int:
        """How many jobs were told to wait."""
        return len(self._jobs) - self.running

    def stuck_s(self) -> float:
        """For how long a run has waited for nothing but a core while one was free."""
        if not self._waiting.has_ready or self.running >= self.cores:
            return 0.0
        return time.monotonic() - self._moved_s

    def find(self, run_id: str) -> Job | None:
        """The job of a run, if it has one."""
        return self._jobs.get(run_id)

    def open(self) -> None:
        """Begin to start what is queued."""
        self._moved_s = time.monotonic()
        self._thread.start()

    def close(self) -> None:
        """Start no more, and end every process, each with a checkpoint if it is in time.

        What ran or waited is `interrupted`.
        """
        with self.changed:
            self._shutdown.set()
            try:
                self._waiting.interrupt("The server was stopped before its turn came.")
            except HexapodError:
                _logger.exception("the queue cannot be noted; the next start does it")
            self.changed.notify_all()
            jobs = list(self._jobs.values())
        for job in jobs:
            job.leave()
        _wait(jobs, _LEAVE_S)
        late = [job for job in jobs if not job.gone.is_set()]
        for job in late:
            job.process.kill()
        _wait(late, _DIE_S)
        if self._thread.is_alive():
            self._thread.join(_DIE_S)

    def mark_shared(self) -> None:
        """Decisions are measured in wall time, so a race says if it had the machine to itself."""
        running = [job for job in self._jobs.values() if not job.paused]
        for job in running:
            job.shared |= len(running) > 1

    def reconcile_later(self, run_id: str) -> None:
        """Note that the store may have taken a state that the job has not, and set it right."""
        self._unsure.add(run_id)

    def _supervise(self) -> None:
        with self.changed:
            while not self._shutdown.is_set():
                try:
                    if not self._start_next():
                        self.changed.wait(_CHECK_EVERY_S)
                    self._check_jobs()
                except Exception:
                    _logger.exception("the supervisor goes on after an error of its own")
                    self.changed.wait(_CHECK_EVERY_S)
            # The thread outlives those that it started, or they would end at once.
            self.changed.wait_for(lambda: not self._jobs)

    def _start_next(self) -> bool:
        """Start a run if a core is free; False if there is nothing to be done now."""
        is_free = self.running < self.cores
        entry = self._waiting.take() if is_free else None
        if entry is None:
            self._moved_s = time.monotonic()
            return False
        try:
            self._start(entry)
        except OwnershipLost:
            _logger.exception("a run is not started", extra=_about(entry.run.id))
        except _NO_STORE:
            _logger.exception("a run cannot be started now", extra=_about(entry.run.id))
            self._waiting.put_back(entry)
            return False
        except (Conflict, NotFound) as error:
            _logger.warning("a run waits no more: %s", error, extra=_about(entry.run.id))
            self._settle(entry.run)
        self._moved_s = time.monotonic()
        try:
            self._waiting.tell_all()
        except HexapodError:
            _logger.warning("places in the queue cannot be told now", exc_info=True)
        return True

    def _start(self, entry: QueuedRun) -> None:
        """Let a process take over a run that has waited."""
        # The clock may have been put back since.
        run_id, now = entry.run.id, max(datetime.now(UTC), entry.run.created_at)
        began_at = entry.run.started_at or now
        # It may read `running` already, if the answer to an earlier try was lost.
        run = self._store.change(
            run_id, QUEUED | RUNNING, "running", started_at=began_at, waiting_for=()
        )
        try:
            job = self._job(run, entry.make_task())
            job.process.start(lambda end: self._process_ended(job, end))
        except _NO_STORE:
            raise
        except Exception as error:
            if not isinstance(error, HexapodError | OSError):
                _logger.exception("a run cannot be started", extra=_about(run_id))
            why = f"The {run.kind} could not be started: {error}"
            run = self._store.change(run_id, LIVE, "failed", error=why, ended_at=now)
            self._publish(run)
            self._waiting.settle(run)
            return
        self._jobs[run_id] = job
        self.mark_shared()
        self._publish(run)

    def _job(self, run: Run, order: Task) -> Job:
        kind = ExperimentJob if isinstance(order, ExperimentTask) else Job
        given = self._store, self._recordings, self._bus
        return kind(run, order, *given, shutdown=self._shutdown, niceness=self._niceness)

    def _check_jobs(self) -> None:
        """End processes that answer no more, and set right what a failed write left open."""
        for job in self._jobs.values():
            job.end_if_stalled()
        for run_id in list(self._unsure):
            unsure = self._jobs.get(run_id)
            try:
                if unsure is not None:
                    state: State = "paused" if unsure.paused else "running"
                    self._publish(self._store.change(run_id, LIVE, state))
                self._unsure.discard(run_id)
            except _NO_STORE:
                return
            except HexapodError:
                self._unsure.discard(run_id)
        self._waiting.reconcile()

    def _process_ended(self, job: Job, end: Exit) -> None:
        """Note how a run ended, and free its core whatever comes of that."""
        try:
            while not self._note_end(job, end) and not self._shutdown.is_set():
                # The store cannot be used; if that lasts, the next start notes the interruption.
                self._shutdown.wait(_CHECK_EVERY_S)
        except Exception:
            _logger.exception("how a run ended cannot be noted", extra=_about(job.run_id))
        finally:
            with self.changed:
                if self._jobs.get(job.run_id) is job:
                    del self._jobs[job.run_id]
                self._unsure.discard(job.run_id)
                self.changed.notify_all()
            job.gone.set()

    def _note_end(self, job: Job, end: Exit) -> bool:
        """Give a run its last state; False if the store cannot be used, and to be tried again."""
        try:
            if self._shutdown.is_set():
                job.end("interrupted", "The server was stopped while it ran.")
                return True
            job.process_ended(end)
        except OwnershipLost:
            return True
        except _NO_STORE:
            _logger.warning("a run's end cannot be noted yet", extra=_about(job.run_id))
            return False
        except (NotFound, Conflict) as error:
            _logger.warning("a run is gone at its end: %s", error, extra=_about(job.run_id))
        with self.changed:
            if not self._shutdown.is_set():
                return self._settle(job.last)
        return True

    def _settle(self, run: Run) -> bool:
        """Let those that wait for a run go on, or end; False if the store cannot be used."""
        if run.state in UNENDED:
            # Its row is gone, or was taken to another state by something else than its job.
            run = replace(run, state="stopped")
        try:
            self._waiting.settle(run)
        except _NO_STORE:
            return False
        return True


def _about(run_id: str) -> dict[str, str]:
    return {"run_id": run_id}


def _wait(jobs: list[Job], at_most_s: float) -> None:
    deadline = time.monotonic() + at_most_s
    for job in jobs:
        job.gone.wait(max(0.0, deadline - time.monotonic()))
