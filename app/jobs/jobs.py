"""Facade of the package: submit, pause, resume, stop, change and delete runs."""

import logging
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any

from app.events.bus import EventBus
from app.events.event_records import DeletedRun
from app.events.run_view import DamagedRunView, RunView, view_of
from app.jobs.job import Job
from app.jobs.messages import Changed
from app.jobs.queue import Owner, RunQueue
from app.jobs.submissions import Start
from app.jobs.supervisor import STUCK_S, Supervisor
from app.jobs.tasks import resumed_runs
from app.storage.database.store import RunStore
from app.storage.errors import (
    Busy,
    Conflict,
    NotAnswering,
    StorageFailed,
)
from app.storage.recordings import Recordings
from app.storage.run import (
    ANNOTATIONS,
    LIVE,
    NOT_ENDED,
    PAUSED,
    RESUMABLE,
    RUNNING,
    AnyRun,
    Content,
    IdempotencyKey,
    Run,
    State,
    world_of,
)
from app.storage.run_ids import RunIds
from app.storage.run_kind import WALKS
from hexapods.domain.disturbance_documents import as_mapping, disturbance_from
from hexapods.domain.disturbances import Disturbance
from hexapods.domain.errors import HexapodError, InvalidInput, UnknownName
from hexapods.domain.world import check_ends
from hexapods.runs.config import TrainingConfig, changeable_settings
from hexapods.runs.presses import read_presses

MAX_PAUSED = 16
MAX_PENDING_CHANGES = 8
"""Maximum number of changes that wait for acknowledgement at once; each blocks a thread."""
MAX_CHANGES = 2_000
"""Maximum number of live changes of a run; each of its events has all of them."""
_ACKNOWLEDGE_S = 5.0
_KILL_S = 2.0
_EXIT_S = 10.0
"""Time for a process to exit after the final state of its run was written."""
_logger = logging.getLogger(__name__)


class Jobs:
    """Runs jobs in order of submission, at most one per core, and controls them.

    Every method may be called from any thread. A paused job frees its core for the next one.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        *,
        on_queued: Callable[[str], object] | None = None,
        owner_of: Callable[[str], Owner | None] = lambda run_id: None,  # noqa: ARG005
        cores: int | None = None,
        niceness: int = 0,
    ) -> None:
        """Create the queue and the supervisor; `open` starts them.

        Args:
            store: store of the runs.
            recordings: receives the motion of the robots.
            bus: receives the events.
            on_queued: called with the id of each training or race that was submitted.
            owner_of: returns the owner of a run; None for an operator.
            cores: maximum number of jobs that run at once; by default one per core.
            niceness: added to the server's nice value in worker processes.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._on_queued = on_queued
        self.new_id = RunIds.of(store)
        self._queue = RunQueue(store, bus.publish_run, owner_of)
        self._supervisor = Supervisor(
            store,
            recordings,
            bus,
            self._queue,
            publish=self._publish,
            cores=cores,
            niceness=niceness,
        )
        self._changed = self._supervisor.changed
        self._pending_changes = threading.BoundedSemaphore(MAX_PENDING_CHANGES)

    @property
    def cores(self) -> int:
        """Maximum number of jobs that run at once."""
        return self._supervisor.cores

    @property
    def is_open(self) -> bool:
        """Whether queued runs will be started."""
        return self._supervisor.is_open

    def health_problem(self) -> str | None:
        """Return a sentence on why queued runs are not started; None if they are (health check)."""
        if not self.is_open:
            return "The server is starting, or stopping."
        stuck_s = self._supervisor.stuck_s()
        if stuck_s > STUCK_S:
            return f"A run has waited beside a free core for {stuck_s:.0f} s; the log says why."
        return None

    def open(self) -> None:
        """Begin to start queued runs."""
        self._supervisor.open()

    def close(self) -> None:
        """Shut down: end every process with a checkpoint; unfinished runs become `interrupted`."""
        self._supervisor.close()

    def view(self, run: AnyRun) -> RunView | DamagedRunView:
        """Return the view of a run, with its position in the queue."""
        return view_of(run, self._queue.position(run.id))

    def start(self, start: Start, key: IdempotencyKey | None = None) -> Run:
        """Queue a run, preceded by the trainings that are part of the request.

        Args:
            start: the run requested.
            key: idempotency key of the request, stored with the run.

        Raises:
            InvalidInput, TableMismatch, NotFound, Conflict: if the request is invalid.
            Busy: if the queue is full.
        """
        return self._enqueue(start.runs(self._store, self.new_id), key)

    def keep(
        self, run: Run, artifacts: Mapping[str, bytes], key: IdempotencyKey | None = None
    ) -> Run:
        """Store a run that no job computes, since it ended elsewhere, and publish it.

        Args:
            run: the run, with its final state.
            artifacts: its files, by name.
            key: idempotency key of the request, stored with the run.
        """
        content = Content(artifacts=artifacts)
        (stored,) = self._store.add([(run, content)], self.new_id, key)
        self._publish(stored)
        return stored

    def pause(self, run_id: str) -> Run:
        """Pause a running job.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it is not running, or too many runs are paused.
        """
        with self._changed:
            job = self._live_job(run_id, RUNNING, "paused")
            if self._supervisor.paused >= MAX_PAUSED:
                raise Conflict(f"{MAX_PAUSED} runs are paused; stop or resume one", "running")
            run = self._change_state(job, RUNNING, "paused")
            job.pause()
            self._changed.notify_all()
        return run

    def resume(self, run_id: str) -> Run:
        """Continue a paused job, or queue a run again that ended before it was finished.

        Raises:
            NotFound: if there is no such run.
            Conflict, InvalidInput: if its state does not allow it, or what it needs is missing.
            Busy: if the queue is full.
        """
        while True:
            with self._changed:
                run = self._store.get(run_id)
                ending = self._ending(run)
                if not ending and run.state in RESUMABLE:
                    runs = resumed_runs(run, self._store)
                    for queued in runs:
                        self._check_needed_by_none(queued)
                    return self._enqueue(runs, resumed=True)
                if not ending:
                    try:
                        return self._resume_paused(run)
                    except Conflict as conflict:
                        # Its process may have died since: then the run is queued again.
                        if conflict.state not in RESUMABLE:
                            raise
            for job in ending:
                self._await_exit(job)

    def _ending(self, run: Run) -> list[Job]:
        """Return the jobs that end now, of a run that ended and of the trainings that it needs.

        A training that is being stopped would otherwise end the race that is queued again behind
        it.
        """
        ending = []
        for run_id in dict.fromkeys((run.id, *filter(None, run.lane_training_ids))):
            job = self._supervisor.find(run_id)
            if job is None:
                continue
            is_being_stopped = job.stopping and run_id != run.id
            if is_being_stopped or self._store.get(run_id).state not in NOT_ENDED:
                ending.append(job)
        return ending

    def _resume_paused(self, run: Run) -> Run:
        choices = " or ".join(sorted(PAUSED | RESUMABLE))
        job = self._live_job(run.id, PAUSED, "resumed", choices)
        resumed = self._change_state(job, PAUSED, "running")
        job.resume()
        self._supervisor.mark_shared()
        return resumed

    def stop(self, run_id: str) -> Run:
        """Stop a run, keep its results so far, and wait until it has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has ended, or is being stopped already.
        """
        with self._changed:
            run = self._store.get(run_id)
            if run.state == "queued":
                for job in (self._supervisor.find(training) for training in run.waiting_for):
                    if job is not None and not job.stopping:
                        job.stop()
                return self._queue.stop(run)
            job = self._live_job(run_id, LIVE, "stopped")
            job.stop()
        if not job.ended.wait(job.stop_grace_s):
            job.process.kill(f"it was ended after {job.stop_grace_s:.0f} s; what was done is kept")
            job.ended.wait(_KILL_S)
        return self._store.get(run_id)

    def change(self, run_id: str, changes: Mapping[str, Any]) -> Run:
        """Change settings of a training that may change live, and wait for the acknowledgement.

        Args:
            run_id: id of the training.
            changes: a new `pace`, and `settings` of its agent by name, of its
                `changeable_settings`.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it neither runs nor is paused, or was changed `MAX_CHANGES` times.
            UnknownName, InvalidInput: if a setting cannot be changed live, or has no such value.
            NotAnswering: if its process does not acknowledge in time; nothing is changed then.
            Busy: if too many changes wait for acknowledgement.
        """

        def checked(run: Run) -> Mapping[str, Any]:
            agent = getattr(run.config, "agent", "")
            valid = changeable_settings(agent)
            checked: dict[str, Any] = {}
            if "pace" in changes:
                checked["pace"] = valid["pace"].normalized(changes["pace"])
            for name, value in changes.get("settings", {}).items():
                if name not in valid or name == "pace":
                    raise UnknownName(f"live setting of {agent}", name, valid.keys() - {"pace"})
                checked.setdefault("settings", {})[name] = valid[name].normalized(value)
            if "presses" in changes:
                checked["presses"] = read_presses(changes["presses"], agent)
            return checked

        self._change_live(run_id, checked)
        return self._store.get(run_id)

    def disturb(self, run_id: str, disturbance: Disturbance) -> Disturbance:
        """Disturb a training from its next step on, and wait for the acknowledgement.

        Args:
            run_id: id of the training.
            disturbance: the disturbance; its `at_step` is replaced.

        Returns:
            the disturbance, with the step in which it begins.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it neither runs nor is paused, or was changed `MAX_CHANGES` times.
            InvalidInput: if it cannot happen to this robot, or contradicts another disturbance.
            NotAnswering: if its process does not acknowledge in time; nothing happens then.
            Busy: if too many changes wait for acknowledgement.
        """

        def checked(run: Run) -> Mapping[str, Any]:
            config = run.config
            if isinstance(config, TrainingConfig):
                soon = replace(disturbance, at_step=min(run.done, config.steps - 1))
                check_ends([soon], config.steps)
                world_of(run).then(soon).check(config.robot, config.simulator, config.steps)
            return {"disturbance": as_mapping(disturbance)}

        return disturbance_from(self._change_live(run_id, checked).changes["disturbance"])

    def _change_live(self, run_id: str, checked: Callable[[Run], Mapping[str, Any]]) -> Changed:
        """Send a change to a training's process, and wait for the acknowledgement.

        Args:
            run_id: id of the training.
            checked: returns the changes, or raises if they are not valid for the run.
        """
        if not self._pending_changes.acquire(blocking=False):
            raise Busy(
                f"{MAX_PENDING_CHANGES} changes wait to be obeyed, which is the most; try again", 1
            )
        try:
            with self._changed:
                job = self._live_job(run_id, LIVE, "changed")
                run = self._store.get(run_id)
                if len(run.changes) >= MAX_CHANGES:
                    raise Conflict(
                        f"training {run_id} was changed {MAX_CHANGES:,} times, which is the most; "
                        "stop it, and continue from its table",
                        run.state,
                    )
                changes = checked(run)
                sent = job.tune(changes, _ACKNOWLEDGE_S) if job.is_answering else None
            if sent is None or not sent.received.wait(_ACKNOWLEDGE_S) or sent.changed is None:
                raise NotAnswering(
                    f"the process of training {run_id} does not answer, so nothing was changed; "
                    "if that lasts it is ended, and the training can be resumed",
                    int(_ACKNOWLEDGE_S),
                )
        finally:
            self._pending_changes.release()
        if sent.changed.refusal is not None:
            raise InvalidInput(sent.changed.refusal)
        return sent.changed

    def annotate(self, run_id: str, changes: Mapping[str, Any]) -> Run:
        """Change the `ANNOTATIONS` of a run, name, tags and notes, in any state.

        Raises:
            NotFound: if there is no such run.
            Damaged: if it cannot be decoded.
            InvalidInput: if its name is empty.
        """
        if changes.get("name") == "":
            raise InvalidInput("a run keeps a name: give one with a visible character")
        with self._changed:
            self._store.get(run_id)
            run = self._store.update(run_id, **changes)
            self._queue.replace(run)
            job = self._supervisor.find(run_id)
            if job is not None:
                return job.publish(**{name: getattr(run, name) for name in ANNOTATIONS})
            self._publish(run)
        return run

    def trash(self, run_id: str) -> datetime | None:
        """Delete a run that has ended, so that it can be restored for a while.

        Returns:
            until when; None if it is gone at once, to make room on the disk.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended, or a queued race needs its table.
        """
        self._await_process(run_id)
        with self._changed:
            self._check_needed_by_none(self._store.find(run_id))
            until = self._store.trash(run_id)
        self._forget(run_id)
        return until

    def restore(self, run_id: str) -> AnyRun:
        """Bring back a run that was deleted lately, and return it; one that is there stays.

        Raises:
            NotFound: if there is no such run, or it was deleted too long ago.
        """
        with self._changed:
            run = self._store.restore(run_id)
        self._bus.publish_run(run)
        return run

    def delete(self, run_id: str) -> None:
        """Delete a run that has ended, at once and for good.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended, or a queued race needs its table.
        """
        self._await_process(run_id)
        with self._changed:
            self._check_needed_by_none(self._store.find(run_id))
            self._store.delete(run_id)
        self._forget(run_id)

    def _forget(self, run_id: str) -> None:
        """Drop what memory has of a run that was deleted, and tell of it."""
        self._recordings.discard(run_id)
        self._bus.publish("run-deleted", DeletedRun(id=run_id), run_id)

    def _check_needed_by_none(self, run: AnyRun) -> None:
        needing = self._queue.run_needing(run.id)
        if needing is not None:
            state = run.state or "damaged"
            raise Conflict(f"{needing.kind} {needing.id} waits, and needs its table", state)

    def _enqueue(
        self, runs: list[Run], key: IdempotencyKey | None = None, *, resumed: bool = False
    ) -> Run:
        with self._changed:
            free = max(0, self.cores - self._supervisor.running)
            run = self._queue.add(runs, free, key, resumed=resumed)
            self._changed.notify_all()
        if self._on_queued is not None and run.kind in WALKS:
            try:
                self._on_queued(run.id)
            except HexapodError:
                # An error of the stage must not fail the submission.
                _logger.warning("a run is not shown", extra={"run_id": run.id}, exc_info=True)
        return run

    def _await_process(self, run_id: str) -> None:
        """Wait until the process of an ended run has exited and its last events are published.

        Otherwise its last events could follow its deletion or its next start.

        Raises:
            Conflict: if it does not exit in time.
        """
        job = self._supervisor.find(run_id)
        if job is not None and self._store.get(run_id).state not in NOT_ENDED:
            self._await_exit(job)

    def _await_exit(self, job: Job) -> None:
        if not job.gone.wait(_EXIT_S):
            run = job.last
            raise Conflict(f"{run.kind} {run.id} is still ending; try again", run.state)

    def _change_state(self, job: Job, from_states: frozenset[State], to_state: State) -> Run:
        """Change a job's state in the store; after a failed write it is reconciled later."""
        try:
            return job.change_state(from_states, to_state)
        except StorageFailed:
            self._supervisor.reconcile_later(job.run_id)
            raise

    def _live_job(
        self, run_id: str, states: frozenset[State], action: str, choices: str | None = None
    ) -> Job:
        """Return the job of a run that is in one of these states and is not being stopped.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it is in another state, or being stopped.
        """
        run = self._store.get(run_id)
        job = self._supervisor.find(run_id)
        if run.state not in states or job is None:
            choices = choices or " or ".join(sorted(states))
            raise Conflict(
                f"{run.kind} {run_id} is {run.state}; it can be {action} while it is {choices}",
                run.state,
            )
        if job.stopping:
            raise Conflict(f"{run.kind} {run_id} is {run.state} and being stopped", run.state)
        return job

    def _publish(self, run: Run) -> None:
        self._bus.publish_run(run, self._queue.position(run.id))
