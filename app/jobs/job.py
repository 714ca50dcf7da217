"""A running job: applies its worker process's messages to the store, the recordings and the bus."""

import itertools
import logging
import threading
import time
from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from operator import itemgetter
from typing import Any

from app.answer import Answer
from app.events.bus import EventBus
from app.events.event_records import EvaluationEvent, RatesEvent, ReferenceEvent
from app.jobs.job_control import CHECKPOINT_EVERY_S
from app.jobs.messages import (
    Batch,
    Began,
    Changed,
    Checkpointed,
    Command,
    Ended,
    Failed,
    Message,
    RaceTask,
    Saved,
    Task,
)
from app.jobs.worker_process import Exit, WorkerProcess
from app.storage.database.engine import retry_during_outage
from app.storage.database.store import RunStore
from app.storage.errors import OwnershipLost, StorageFailed
from app.storage.recordings import Recordings
from app.storage.run import ANNOTATIONS, CHECKPOINT, LIVE, RUNNING, TABLE, Run, State
from hexapods.domain.errors import HexapodError
from hexapods.domain.robot import as_mapping
from hexapods.processes import STALLED_S
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import Evaluated, Reference
from hexapods.runs.results import RaceResult, race_result

MAX_OUTAGE_S = 600.0
"""Longest database outage that a job waits out; after that its run becomes `interrupted`."""
SILENT_S = 60.0
"""A process without a heartbeat for longer is killed. Longer than `STALLED_S`, since on a busy
machine a silent process may still work."""
_EVENT_S_PER_CHANGE = 0.001
_logger = logging.getLogger(__name__)


class Acknowledgement:
    """The answer of a job's process to a change, once it was received."""

    def __init__(self) -> None:
        self.received = threading.Event()
        self.changed: Changed | None = None


class Job:
    """One run and the worker process that computes it.

    Messages arrive in the receiving thread of the process, one at a time; commands may be sent
    from any thread.

    Attributes:
        run_id: id of the run.
        is_race: whether the run is a race.
        stop_grace_s: time that the process may take to end after `stop` before it is killed [s].
        paused: whether `pause` was sent last.
        stopping: whether `stop` was called.
        shared: whether another job ran at the same time; a race's result reports it.
        events_per_s: maximum rate of events that tell of nothing but progress.
        eta_window_s: length of the moving window from which the remaining time is estimated [s].
        process: the worker process.
        last: the run as it was published last, or more recent in its progress.
        ended: set when the run's final state is in the store.
        gone: set when the process has exited and all events of the run were published.
    """

    stop_grace_s = 20.0
    events_per_s = 10
    eta_window_s = 5.0

    def __init__(
        self,
        run: Run,
        task: Task,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        *,
        shutdown: threading.Event,
        niceness: int,
    ) -> None:
        """Create the job and its process, which `process.start` starts.

        Args:
            run: the run, stored as `running`.
            task: sent to the process.
            store: store of the runs.
            recordings: receives the motion of the robots.
            bus: receives the run's events.
            shutdown: set when the server stops; ends retries during a database outage.
            niceness: added to the server's nice value in the process.
        """
        self.run_id, self.is_race = run.id, run.kind == "race"
        self.paused = self.stopping = self.shared = False
        self.ended, self.gone = threading.Event(), threading.Event()
        self.process = WorkerProcess(
            f"{run.kind} {run.id}", task, self._handle_with_retry, niceness
        )
        self.last = run
        self._publish_lock = threading.RLock()
        """Held from the change of a run that lives to its event, so that events are in order."""
        self._run, self._task, self._shutdown = run, task, shutdown
        self._started_s = time.monotonic()
        self._started_at = max(datetime.now(UTC), run.started_at or run.created_at)
        self._store, self._recordings, self._bus = store, recordings, bus
        self._acknowledgements: dict[int, Acknowledgement] = {}
        self._tokens = itertools.count()
        self._has_begun = self._has_reported = False
        self._published_s = 0.0
        self._saved_s = self._started_s
        """When the recording of a race was stored last; monotonic clock."""
        self._progress: deque[tuple[float, int]] = deque()

    def pause(self) -> None:
        """Pause after the current step."""
        self.paused = True
        self.process.send(Command("pause"))

    def resume(self) -> None:
        """Continue after a pause."""
        self.paused = False
        self._progress.clear()
        self.process.send(Command("resume"))

    def stop(self) -> None:
        """Stop after the current step, keeping the results; kill a run that has not begun."""
        self.stopping = True
        if self._has_begun:
            self.process.send(Command("stop"))
        else:
            self.process.kill()

    def checkpoint_and_exit(self) -> None:
        """Exit with a checkpoint after the current step; kill a race, or a run that has not begun.

        Used when the server shuts down: the run is `interrupted` and can be resumed.
        """
        if self._has_begun and not self.is_race:
            self.process.send(Command("checkpoint_and_exit"))
        else:
            self.process.kill()

    def tune(self, changes: Mapping[str, Any], within_s: float) -> Acknowledgement:
        """Change settings or pace, or disturb the training, after the current step.

        Args:
            changes: values of settings by name, `disturbance` in plain types, or `presses`.
            within_s: time after which the process discards the command [s].

        Returns:
            the acknowledgement, which is set once the process has answered.
        """
        token, acknowledged = next(self._tokens), Acknowledgement()
        self._acknowledgements[token] = acknowledged
        self.process.send(Command("tune", token, changes, time.monotonic() + within_s))
        return acknowledged

    def change_state(self, from_states: Collection[State], to_state: State) -> Run:
        """Change the state in which the run lives in the store, and publish the run.

        Raises:
            NotFound: if there is no such run.
            Conflict: if its state is not in `from_states`.
        """
        # Without the lock, which the messages of a process need that ends meanwhile.
        self._store.change(self.run_id, from_states, to_state)
        with self._publish_lock:
            if self.ended.is_set():
                return self.last
            return self.publish(state=to_state, eta_s=None)

    def publish(self, **changed: Any) -> Run:
        """Publish the run with these fields changed, which are stored already; return it."""
        with self._publish_lock:
            self.last = replace(self.last, **changed)
            self._published_s = time.monotonic()
            self._bus.publish_run(self.last)
            return self.last

    @property
    def can_start_again(self) -> bool:
        """Whether the run is as before the start of the process, which has reported nothing."""
        return not (self._has_reported or self.paused or self.stopping or self.ended.is_set())

    @property
    def is_answering(self) -> bool:
        """Whether the process sent a heartbeat lately and is not stopped by a signal."""
        return self.process.stopped_s() == 0 and self.process.silent_s() < SILENT_S

    def end_if_stalled(self) -> None:
        """Kill the process if it is stopped or silent for too long (watchdog).

        Its run is then `failed` and can be resumed.
        """
        stopped_s, silent_s = self.process.stopped_s(), self.process.silent_s()
        if stopped_s > STALLED_S:
            self.process.kill(f"its process was stopped by a signal for {stopped_s:.0f} s")
        elif silent_s > SILENT_S:
            self.process.kill(f"its process said nothing for {silent_s:.0f} s")

    def end(self, state: State, error: str | None = None, result: Any = None) -> None:
        """Write the run's final state to the store, unless one was written; publish it.

        Args:
            state: the final state.
            error: a sentence for the user if it did not finish.
            result: the run's result, in plain types.
        """
        if self.ended.is_set():
            return
        self._finish_recording(state)
        # From the monotonic clock, which clock adjustments do not affect.
        ended_at = self._started_at + timedelta(seconds=time.monotonic() - self._started_s)
        run = self._store.change(
            self.run_id, LIVE, state, error=error, result=result, ended_at=ended_at
        )
        with self._publish_lock:
            # They may have been changed since it was read.
            self.last = replace(run, **{name: getattr(self.last, name) for name in ANNOTATIONS})
            self.ended.set()
            self.publish()

    def _finish_recording(self, state: State) -> None:
        try:
            self._recordings.finish(self.run_id)
        except OwnershipLost:
            raise
        except HexapodError:
            if state in ("finished", "stopped"):
                raise
            # The run has failed anyway: do not let this error hide the first one.
            _logger.warning("no recording was kept", extra={"run_id": self.run_id}, exc_info=True)

    def process_ended(self, end: Exit) -> None:
        """Write a final state for a run whose process exited without reporting one.

        Raises:
            StorageFailed: if the store cannot be used; to be retried.
        """
        if self.ended.is_set():
            return
        # Check that the store works before anything is discarded: raises during an outage.
        self._store.get(self.run_id)
        if self.stopping:
            self._keep_checkpoint()
            if self._has_begun:
                error = f"It did not answer when it was to stop, so {end.how}."
                self.end("stopped", error, self._result_so_far())
            elif self._run.done:
                self.end("stopped", "It was stopped before it went on; what was done is kept.")
            else:
                self.end("stopped", "It was stopped before it began.")
        elif isinstance(end.error, StorageFailed):
            self.end("interrupted", f"What came of it could not be kept: {end.error}.")
        else:
            self.end("failed", f"The job ended before it was done: {end.how}.")

    def _keep_checkpoint(self) -> None:
        """Store the newest checkpoint as the table of a training that cannot save one any more.

        Raises:
            StorageFailed: if the store cannot be used; to be retried.
        """
        try:
            if self._store.artifact(self.run_id, TABLE) is None:
                checkpoint = self._store.artifact(self.run_id, CHECKPOINT)
                if checkpoint is not None:
                    self._store.put_artifact(self.run_id, TABLE, checkpoint)
        except StorageFailed:
            raise
        except HexapodError:  # a full disk, or a damaged file: the run ends all the same
            _logger.warning("no table was kept", extra={"run_id": self.run_id}, exc_info=True)

    def _handle_with_retry(self, message: Message) -> None:
        """Handle a message, retrying while the database is unavailable.

        Meanwhile the pipe fills and blocks the process (back-pressure), so that nothing is lost.
        """
        self._has_reported |= not isinstance(message, Began)
        with retry_during_outage(MAX_OUTAGE_S, self._shutdown):
            self._handle(message)

    def _handle(self, message: Message) -> None:
        """Handle one message of the process; called from its receiving thread."""
        if isinstance(message, Batch):
            self._handle_batch(message)
        elif isinstance(message, Began):
            self._handle_began(message)
        elif isinstance(message, Changed):
            self._handle_change(message)
        elif isinstance(message, Checkpointed):
            self._recordings.save(self.run_id)
            self._store.put_artifact(self.run_id, CHECKPOINT, message.data, done=message.step)
        elif isinstance(message, Saved):
            self._store.put_artifact(self.run_id, TABLE, message.table)
        elif isinstance(message, Ended):
            self._handle_end(message)
        elif isinstance(message, Failed):
            self.end("failed", f"The {self._run.kind} failed: {message.reason}")

    def _handle_began(self, began: Began) -> None:
        self._has_begun = True
        config = self._run.config
        if not began.rest_qpos:
            return
        if isinstance(config, RaceConfig):
            poses = zip(config.lanes, began.rest_qpos, strict=True)
            lanes = [LaneRecording(lane.agent, pose) for lane, pose in poses]
            self._recordings.begin_race(self.run_id, lanes)
        else:
            self._recordings.begin_training(self.run_id, began.rest_qpos[0], began.after_step)

    def _handle_batch(self, batch: Batch) -> None:
        rows: list[dict[str, Any]] = [
            {"step": record.step, "distance_m": record.distance_m, "epsilon": record.epsilon}
            for record in batch.records
            if isinstance(record, Evaluated)
        ]
        if rows:
            self._store.curves.append(self.run_id, rows)
        if batch.transitions is not None:
            self._recordings.log(self.run_id, batch.transitions)
        for record in batch.records:
            self._recordings.add(self.run_id, record)
            if isinstance(record, Reference):
                greedy_distance_m = record.greedy_distance_m
                self._store.baselines.add(record.baseline, greedy_distance_m)
                self._store.update(self.run_id, greedy_distance_m=greedy_distance_m)
                self.publish(greedy_distance_m=greedy_distance_m)
                reference = ReferenceEvent(
                    run_id=self.run_id,
                    greedy_distance_m=greedy_distance_m,
                    best_known_m=record.best_known_m,
                )
                self._publish_event("reference", reference)
        for row in rows:
            self._publish_event("evaluation", EvaluationEvent(run_id=self.run_id, **row))
        self._handle_progress(batch.done)
        if self.is_race:
            self._save_regularly()

    def _save_regularly(self) -> None:
        """Store the recording of a race every `CHECKPOINT_EVERY_S`, for a crash of the server.

        The recording of a training is stored with its checkpoints.
        """
        now = time.monotonic()
        if now - self._saved_s >= CHECKPOINT_EVERY_S:
            self._recordings.save(self.run_id)
            self._saved_s = now

    def _handle_progress(self, done: int) -> None:
        eta_s = self._eta_s(done)
        self._store.update_progress(self.run_id, done, eta_s)
        with self._publish_lock:
            # The process may report its last steps after the run was paused.
            eta_s = eta_s if self.last.state in RUNNING else None
            self.last = replace(self.last, done=done, eta_s=eta_s)
            # An event has all changes of the run.
            period_s = max(1 / self.events_per_s, len(self.last.changes) * _EVENT_S_PER_CHANGE)
            if time.monotonic() - self._published_s >= period_s:
                self.publish()

    def _handle_change(self, changed: Changed) -> None:
        if changed.refusal is not None:
            self._acknowledge(changed)
            return
        change = {"step": changed.step, **changed.changes}
        # After a resume the stored changes may include later ones that are still to be replayed.
        changes = tuple(sorted((*self.last.changes, change), key=itemgetter("step")))
        self._store.update(self.run_id, changes=changes)
        self._progress.clear()
        if change.keys() & {"pace", "settings"}:
            rates = {k: v for k, v in change.items() if k in ("step", "pace", "settings")}
            self._publish_event("rates", RatesEvent(run_id=self.run_id, **rates))
        self.publish(changes=changes)
        self._acknowledge(changed)

    def _acknowledge(self, changed: Changed) -> None:
        acknowledged = self._acknowledgements.pop(changed.token)
        acknowledged.changed = changed
        acknowledged.received.set()

    def _handle_end(self, ended: Ended) -> None:
        lanes = self._recordings.race(self.run_id)
        if lanes is None or not isinstance(self._task, RaceTask):
            self.end(ended.outcome, result=ended.result)
            return
        result = self._race_result(lanes, self._task)
        failures = [lane.failure for lane in lanes if lane.failure]
        if ended.outcome == "finished" and len(failures) == len(lanes):
            self.end("failed", f"No lane could finish the race: {failures[0]}", result)
        else:
            self.end(ended.outcome, result=result)

    def _result_so_far(self) -> RaceResult | None:
        """Return the result of a race from its recording so far; None for other runs."""
        lanes = self._recordings.race(self.run_id)
        if lanes is None or not isinstance(self._task, RaceTask):
            return None
        return self._race_result(lanes, self._task)

    def _race_result(self, lanes: list[LaneRecording], task: RaceTask) -> RaceResult:
        result = race_result(lanes, task.config)
        numbered = zip(
            result.lanes, self._run.lane_training_ids, _trained_robots(task), strict=True
        )
        named = tuple(
            replace(lane, training_id=training, trained_robot=robot)
            for lane, training, robot in numbered
        )
        return replace(result, lanes=named, shared_machine=self.shared)

    def _eta_s(self, done: int) -> float | None:
        """Return the estimated remaining time [s], None without progress.

        From a moving window, since pace and machine load change.
        """
        now = time.monotonic()
        self._progress.append((now, done))
        while self._progress[0][0] < now - self.eta_window_s:
            self._progress.popleft()
        began, first_done = self._progress[0]
        if done == first_done:
            return None
        return round((self._run.total - done) * (now - began) / (done - first_done), 1)

    def _publish_event(self, event: str, data: Answer) -> None:
        self._bus.publish(event, data, self.run_id)


def _trained_robots(task: RaceTask) -> list[Any]:
    """Return for each lane the robot its table was learned on, None if it is the race's own."""
    race_robot = as_mapping(task.config.robot)
    table_robots = [table and table.meta["config"]["robot"] for table in task.tables]
    return [None if robot == race_robot else robot for robot in table_robots]
