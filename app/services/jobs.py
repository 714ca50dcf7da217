"""Jobs: what is to run, what runs, and the words that change it."""

import logging
import os
import threading
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import Any

from app.agents import registry
from app.domain.errors import HexapodError, InvalidInput
from app.services.bus import EventBus
from app.services.entries import Entry, RaceStart, TrainingStart, race_entries, training_entry
from app.services.errors import Conflict
from app.services.ids import RunIds
from app.services.job import Job
from app.services.recordings import Recordings
from app.services.store import LIVE, PAUSED, QUEUED, RUNNING, TABLE, Run, RunStore, State
from app.services.views import run_view
from app.services.waiting import WaitingRuns

MAX_PAUSED = 16
STOP_GRACE_S = 10.0
_ANSWER_S = 5.0
_CLOSING_S = 2.0
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
        on_queued: Callable[[str], object] | None = None,
        cores: int | None = None,
    ) -> None:
        """Start nothing yet.

        Args:
            store: where runs are kept.
            recordings: where their motion goes.
            bus: who wants to know.
            on_queued: called with the id of what someone has asked for.
            cores: how many jobs run at once; the machine's by default.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._on_queued = on_queued
        self.cores = cores or os.cpu_count() or 1
        newest = store.list(limit=1).items
        self.new_id = RunIds(after=newest[0].id if newest else None)
        self._waiting = WaitingRuns(store, self._publish)
        self._jobs: dict[str, Job] = {}
        self._closing = False
        self._changed = threading.Condition()
        """Guards the queue and the jobs; notified when something may be started."""
        # The kernel ends a child with the thread that started it, so that one thread starts all.
        self._starter = threading.Thread(target=self._keep_starting, name="jobs", daemon=True)

    @property
    def is_open(self) -> bool:
        """Whether what is queued will be started."""
        return self._starter.is_alive() and not self._closing

    def open(self) -> None:
        """Begin to start what is queued."""
        self._starter.start()

    def close(self) -> None:
        """End every process, and start no more. What ran is `interrupted`."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
            jobs = list(self._jobs.values())
        for job in jobs:
            job.child.kill()
        deadline = time.monotonic() + _CLOSING_S
        for job in jobs:
            job.gone.wait(max(0.0, deadline - time.monotonic()))
        if self._starter.is_alive():
            self._starter.join(_CLOSING_S)

    def train(self, start: TrainingStart) -> Run:
        """Queue a training.

        Raises:
            InvalidInput, Conflict: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue([training_entry(start, self._store, self.new_id)])

    def race(self, start: RaceStart) -> Run:
        """Queue a race, and before it the trainings that it brings along.

        Raises:
            InvalidInput, Conflict: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue(race_entries(start, self._store, self.new_id))

    def keep(self, run: Run, table: bytes) -> None:
        """Add a training that ended elsewhere, with its table."""
        self._store.create(run)
        self._store.put_artifact(run.id, TABLE, table)
        self._publish(run)

    def pause(self, run_id: str) -> Run:
        """Let a running job wait.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it does not run, or too many are paused.
        """
        with self._changed:
            job = self._live(run_id, RUNNING, "paused")
            if sum(other.paused for other in self._jobs.values()) >= MAX_PAUSED:
                raise Conflict(f"{MAX_PAUSED} runs are paused; stop or resume one", "running")
            run = self._store.change(run_id, RUNNING, "paused", eta_s=None)
            job.pause()
            self._changed.notify_all()
        self._publish(run)
        return run

    def resume(self, run_id: str) -> Run:
        """Let a paused job go on.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it is not paused.
        """
        with self._changed:
            job = self._live(run_id, PAUSED, "resumed")
            run = self._store.change(run_id, PAUSED, "running")
            job.resume()
            self._note_company()
        self._publish(run)
        return run

    def stop(self, run_id: str) -> Run:
        """End a run with what has come of it, and wait until it has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has ended, or someone else is stopping it.
        """
        with self._changed:
            run = self._store.get(run_id)
            if run.state == "queued":
                for job in (self._jobs.get(training) for training in run.waiting_for):
                    if job is not None and not job.stopping:
                        job.stop()
                return self._waiting.stop(run)
            job = self._live(run_id, LIVE, "stopped")
            job.stop()
        if not job.ended.wait(STOP_GRACE_S):
            job.child.kill()
            job.ended.wait(_CLOSING_S)
        return self._store.get(run_id)

    def change(self, run_id: str, changes: Mapping[str, Any]) -> Run:
        """Change the rates or the pace of a training, and wait until that is obeyed.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it neither runs nor is paused.
            InvalidInput: if its agent has no rates.
        """
        with self._changed:
            job = self._live(run_id, LIVE, "changed")
            agent = getattr(self._store.get(run_id).config, "agent", "")
            if set(changes) - {"pace"} and not hasattr(registry.find(agent), "tune"):
                raise InvalidInput(f"{agent} has no rates that could be changed; give pace only")
            answer = job.tune(changes)
        answer.wait(_ANSWER_S)
        return self._store.get(run_id)

    def delete(self, run_id: str) -> None:
        """Forget a run that has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended, or a race that waits needs it.
        """
        with self._changed:
            race = self._waiting.needing(run_id)
            if race is not None:
                state = self._store.get(run_id).state
                raise Conflict(f"race {race.id} waits, and needs its table", state)
            self._store.delete(run_id)
        self._recordings.discard(run_id)
        self._bus.publish("run-deleted", {"id": run_id}, run_id)

    def _enqueue(self, entries: list[Entry]) -> Run:
        with self._changed:
            self._waiting.add(entries, max(0, self.cores - self._running))
            self._changed.notify_all()
        run = entries[-1].run
        if self._on_queued is not None:
            self._on_queued(run.id)
        return run

    def _live(self, run_id: str, states: frozenset[State], what: str) -> Job:
        """The job of a run in one of these states, that nobody is stopping."""
        run = self._store.get(run_id)
        job = self._jobs.get(run_id)
        if run.state not in states or job is None:
            choices = " or ".join(sorted(states))
            raise Conflict(
                f"{run.kind} {run_id} is {run.state}; it can be {what} while it is {choices}",
                run.state,
            )
        if job.stopping:
            raise Conflict(f"{run.kind} {run_id} is {run.state} and being stopped", run.state)
        return job

    @property
    def _running(self) -> int:
        return sum(not job.paused for job in self._jobs.values())

    def _keep_starting(self) -> None:
        with self._changed:
            while not self._closing:
                entry = self._waiting.take() if self._running < self.cores else None
                if entry is None:
                    self._changed.wait()
                else:
                    self._start(entry)

    def _start(self, entry: Entry) -> None:
        """Let a process take over a run that has waited."""
        # The clock may have been put back since.
        run_id, now = entry.run.id, max(datetime.now(UTC), entry.run.created_at)
        run = self._store.change(run_id, QUEUED, "running", started_at=now, waiting_for=())
        try:
            job = Job(run, entry.make_order(), self._store, self._recordings, self._bus)
            job.child.start(lambda how: self._process_ended(job, how))
        except (HexapodError, OSError) as error:
            why = f"The {run.kind} could not be started: {error}"
            run = self._store.change(run_id, LIVE, "failed", error=why, ended_at=now)
            self._publish(run)
            self._waiting.settle(run)
            return
        self._jobs[run_id] = job
        self._note_company()
        self._publish(run)

    def _note_company(self) -> None:
        """Decisions are measured in wall time, so a race says if it had the machine to itself."""
        running = [job for job in self._jobs.values() if not job.paused]
        for job in running:
            job.shared |= len(running) > 1

    def _process_ended(self, job: Job, how: str) -> None:
        if self._closing:
            job.end("interrupted", "The server was stopped while it ran.")
        else:
            job.process_ended(how)
        with self._changed:
            del self._jobs[job.run_id]
            if not self._closing:
                self._waiting.settle(self._store.get(job.run_id))
            self._changed.notify_all()
        job.gone.set()

    def _publish(self, run: Run) -> None:
        self._bus.publish("run", run_view(run), run.id)
