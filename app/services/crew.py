"""The jobs at work: started as cores become free, heard to their end, sent home together."""

import logging
import os
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime

from app.domain.errors import HexapodError
from app.services.bus import EventBus
from app.services.entries import Entry
from app.services.errors import Conflict, StorageFailed, StorageFull
from app.services.experiment_job import ExperimentJob
from app.services.job import Job
from app.services.orders import ExperimentOrder, Order
from app.services.recordings import Recordings
from app.services.store import LIVE, QUEUED, Run, RunStore
from app.services.waiting import WaitingRuns

_LEAVE_S = 4.0
"""To write a last checkpoint; with all else that ends, a server is gone within 10 s."""
_DIE_S = 1.5
_AGAIN_S = 1.0
_NO_STORE = (StorageFailed, StorageFull)
_logger = logging.getLogger(__name__)


class Crew:
    """One process for each job, as many at once as there are cores.

    Attributes:
        changed: guards the jobs and the queue, and is held around every call but `open` and
            `close`; notified when something may be started.
        cores: how many jobs run at once.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        waiting: WaitingRuns,
        *,
        publish: Callable[[Run], None],
        cores: int | None = None,
    ) -> None:
        """Start nothing yet.

        Args:
            store: where runs are kept.
            recordings: where their motion goes.
            bus: who wants to know.
            waiting: the queue.
            publish: tells of a run that changed.
            cores: the machine's by default.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._waiting, self._publish = waiting, publish
        self.cores = cores or os.cpu_count() or 1
        self.changed = threading.Condition()
        self._jobs: dict[str, Job] = {}
        self._closing = False
        # The kernel ends a child with the thread that started it, so that one thread starts all.
        self._starter = threading.Thread(target=self._keep_starting, name="jobs", daemon=True)

    @property
    def is_open(self) -> bool:
        """Whether what is queued will be started."""
        return self._starter.is_alive() and not self._closing

    @property
    def running(self) -> int:
        """How many jobs take a core."""
        return sum(not job.paused for job in self._jobs.values())

    @property
    def paused(self) -> int:
        """How many jobs were told to wait."""
        return len(self._jobs) - self.running

    def find(self, run_id: str) -> Job | None:
        """The job of a run, if it has one."""
        return self._jobs.get(run_id)

    def open(self) -> None:
        """Begin to start what is queued."""
        self._starter.start()

    def close(self) -> None:
        """Start no more, and end every process, each with a checkpoint if it is in time.

        What ran or waited is `interrupted`.
        """
        with self.changed:
            self._closing = True
            self._waiting.interrupt("The server was stopped before its turn came.")
            self.changed.notify_all()
            jobs = list(self._jobs.values())
        for job in jobs:
            job.leave()
        _wait(jobs, _LEAVE_S)
        late = [job for job in jobs if not job.gone.is_set()]
        for job in late:
            job.child.kill()
        _wait(late, _DIE_S)
        if self._starter.is_alive():
            self._starter.join(_DIE_S)

    def note_company(self) -> None:
        """Decisions are measured in wall time, so a race says if it had the machine to itself."""
        running = [job for job in self._jobs.values() if not job.paused]
        for job in running:
            job.shared |= len(running) > 1

    def _keep_starting(self) -> None:
        with self.changed:
            while not self._closing:
                entry = self._waiting.take() if self.running < self.cores else None
                if entry is None:
                    self.changed.wait()
                    continue
                try:
                    self._start(entry)
                except _NO_STORE:
                    _logger.exception("a run cannot be started now", extra=_about(entry.run.id))
                    self._waiting.put_back(entry)
                    self.changed.wait(_AGAIN_S)
                except Conflict:
                    _logger.exception("a run waits no more", extra=_about(entry.run.id))
                with suppress(*_NO_STORE):
                    self._waiting.tell_all()
            # The thread outlives those that it started, or they would end at once.
            self.changed.wait_for(lambda: not self._jobs)

    def _start(self, entry: Entry) -> None:
        """Let a process take over a run that has waited."""
        # The clock may have been put back since.
        run_id, now = entry.run.id, max(datetime.now(UTC), entry.run.created_at)
        began_at = entry.run.started_at or now
        run = self._store.change(run_id, QUEUED, "running", started_at=began_at, waiting_for=())
        try:
            job = self._job(run, entry.make_order())
            job.child.start(lambda how: self._process_ended(job, how))
        except (HexapodError, OSError) as error:
            why = f"The {run.kind} could not be started: {error}"
            run = self._store.change(run_id, LIVE, "failed", error=why, ended_at=now)
            self._publish(run)
            self._waiting.settle(run)
            return
        self._jobs[run_id] = job
        self.note_company()
        self._publish(run)

    def _job(self, run: Run, order: Order) -> Job:
        if isinstance(order, ExperimentOrder):
            return ExperimentJob(run, order, self._store, self._recordings, self._bus)
        return Job(run, order, self._store, self._recordings, self._bus)

    def _process_ended(self, job: Job, how: str) -> None:
        while not self._see_off(job, how):
            with self.changed:
                self.changed.wait(_AGAIN_S)
        with self.changed:
            del self._jobs[job.run_id]
            self.changed.notify_all()
        job.gone.set()

    def _see_off(self, job: Job, how: str) -> bool:
        """Note how a run ended; False if the store cannot be used, and it is worth another try."""
        try:
            if self._closing:
                job.end("interrupted", "The server was stopped while it ran.")
                return True
            job.process_ended(how)
            with self.changed:
                if not self._closing:
                    self._waiting.settle(self._store.get(job.run_id))
        except _NO_STORE:
            _logger.exception("how a run ended cannot be noted", extra=_about(job.run_id))
            # The next start notes that it was interrupted.
            return self._closing
        return True


def _about(run_id: str) -> dict[str, str]:
    return {"run_id": run_id}


def _wait(jobs: list[Job], at_most_s: float) -> None:
    deadline = time.monotonic() + at_most_s
    for job in jobs:
        job.gone.wait(max(0.0, deadline - time.monotonic()))
