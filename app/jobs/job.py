"""A job while it runs: what its process says becomes the run's state, recording and events."""

import itertools
import logging
import threading
import time
from collections import deque
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from operator import itemgetter
from typing import Any

from app.domain.errors import HexapodError
from app.domain.robot import as_mapping
from app.events.bus import EventBus
from app.events.run_view import run_view
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
    Reported,
    Saved,
    Task,
    TrialsDone,
)
from app.jobs.worker_process import Exit, WorkerProcess
from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.runs.records import Evaluated, Reference
from app.runs.results import race_result
from app.storage.database.engine import retry_during_outage
from app.storage.errors import OwnershipLost, StorageFailed
from app.storage.recordings import Recordings
from app.storage.store import CHECKPOINT, LIVE, SUMMARY, TABLE, Run, RunStore, State

EVENTS_PER_S = 10
MAX_OUTAGE_S = 600.0
"""For so long a job waits for a database that cannot be used; then it is interrupted."""
STALLED_S = 8.0
"""A process that was stopped for so long is ended: a run that reads `running` must run."""
SILENT_S = 60.0
"""The same of one that says nothing, which on a busy machine may still be alive."""
_logger = logging.getLogger(__name__)


class Job:
    """One run that a process works on.

    Attributes:
        run_id: of the run.
        is_race: what kind of run it is.
        stop_grace_s: how long it may take to end when it is told to stop.
        paused: whether it was told to wait.
        stopping: whether it was told to stop.
        shared: whether another job ran at the same time.
        eta_window_s: from how much of the past it is told how long it will take.
        process: works on it.
        last: the run as this job wrote it last, its end included.
        ended: set when the run's last state is in the store.
        gone: set when its process is no more, and everyone has been told.
    """

    stop_grace_s = 20.0
    eta_window_s = 5.0

    def __init__(
        self,
        run: Run,
        order: Task,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        *,
        shutdown: threading.Event,
        niceness: int,
    ) -> None:
        self.run_id, self.is_race = run.id, run.kind == "race"
        self.paused = self.stopping = self.shared = False
        self.ended, self.gone = threading.Event(), threading.Event()
        self.process = WorkerProcess(f"{run.kind} {run.id}", order, self._take_patiently, niceness)
        self.last = run
        self._run, self._order, self._shutdown = run, order, shutdown
        self._began_s = time.monotonic()
        self._began_at = max(datetime.now(UTC), run.started_at or run.created_at)
        self._store, self._recordings, self._bus = store, recordings, bus
        self._answers: dict[int, threading.Event] = {}
        self._tokens = itertools.count()
        self._has_begun = False
        self._published_s = 0.0
        self._progress: deque[tuple[float, int]] = deque()

    def pause(self) -> None:
        """Wait after the present step."""
        self.paused = True
        self.process.send(Command("pause"))

    def resume(self) -> None:
        """Go on."""
        self.paused = False
        self._progress.clear()
        self.process.send(Command("resume"))

    def stop(self) -> None:
        """End after the present step, with what has come of it so far."""
        self.stopping = True
        if self._has_begun:
            self.process.send(Command("stop"))
        else:
            self.process.kill()

    def leave(self) -> None:
        """End after the present step with a checkpoint, if it is a training that has begun."""
        if self._has_begun and not self.is_race:
            self.process.send(Command("leave"))
        else:
            self.process.kill()

    def tune(self, changes: Mapping[str, Any], within_s: float) -> threading.Event:
        """Change rates or pace after the present step; the event is set once that is done.

        Args:
            changes: any of alpha, gamma, epsilon, pace.
            within_s: after which it is not done any more.
        """
        token, answer = next(self._tokens), threading.Event()
        self._answers[token] = answer
        self.process.send(Command("tune", token, changes, time.monotonic() + within_s))
        return answer

    @property
    def is_answering(self) -> bool:
        """Whether its process has said something lately, and was not stopped by a signal."""
        return self.process.stopped_s() == 0 and self.process.silent_s() < SILENT_S

    def end_if_stalled(self) -> None:
        """End the process if it answers no more; its run is then `failed`, and can be resumed."""
        stopped_s, silent_s = self.process.stopped_s(), self.process.silent_s()
        if stopped_s > STALLED_S:
            self.process.kill(f"its process was stopped by a signal for {stopped_s:.0f} s")
        elif silent_s > SILENT_S:
            self.process.kill(f"its process said nothing for {silent_s:.0f} s")

    def end(self, state: State, error: str | None = None, result: Any = None) -> None:
        """Give the run its last state, if it has none yet."""
        if self.ended.is_set():
            return
        self._keep_recording(state)
        # By a clock that nobody puts forward or back.
        ended_at = self._began_at + timedelta(seconds=time.monotonic() - self._began_s)
        run = self._store.change(
            self.run_id, LIVE, state, error=error, result=result, ended_at=ended_at, eta_s=None
        )
        self.last = run
        self.ended.set()
        self._publish(run)

    def _keep_recording(self, state: State) -> None:
        try:
            self._recordings.finish(self.run_id)
        except OwnershipLost:
            raise
        except HexapodError:
            if state in ("finished", "stopped"):
                raise
            # It is lost, which is no reason to hide what was wrong in the first place.
            _logger.warning("no recording was kept", extra={"run_id": self.run_id}, exc_info=True)

    def process_ended(self, end: Exit) -> None:
        """Give the run its last state if its process died before it could say one.

        Raises:
            StorageFailed: if the store cannot be used; worth another try.
        """
        if self.ended.is_set():
            return
        # Before anything is given up: during an outage nothing can be noted, nor kept.
        self._store.get(self.run_id)
        if self.stopping:
            if self._has_begun:
                self.end("stopped", f"It did not answer when it was to stop, so {end.how}.")
            elif self._run.done:
                self.end("stopped", "It was stopped before it went on; what was done is kept.")
            else:
                self.end("stopped", "It was stopped before it began.")
        elif isinstance(end.error, StorageFailed):
            self.end("interrupted", f"What came of it could not be kept: {end.error}.")
        else:
            self.end("failed", f"The job ended before it was done: {end.how}.")

    def _take_patiently(self, message: Message) -> None:
        """Take in a message, for as long as it needs if the database is away.

        Meanwhile the process fills its pipe and then waits, so that nothing is lost.
        """
        with retry_during_outage(MAX_OUTAGE_S, self._shutdown):
            self._take(message)

    def _take(self, message: Message) -> None:
        """Take in a message of the process; called from its thread."""
        if isinstance(message, Batch):
            self._take_records(message)
        elif isinstance(message, Began):
            self._begin(message)
        elif isinstance(message, Changed):
            self._take_change(message)
        elif isinstance(message, Checkpointed):
            self._recordings.save(self.run_id)
            self._store.put_artifact(self.run_id, CHECKPOINT, message.data, done=message.step)
        elif isinstance(message, Saved):
            self._store.put_artifact(self.run_id, TABLE, message.table)
        elif isinstance(message, Ended):
            self._take_end(message)
        elif isinstance(message, Failed):
            self.end("failed", f"The {self._run.kind} failed: {message.reason}")

    def _begin(self, began: Began) -> None:
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

    def _take_records(self, batch: Batch) -> None:
        evaluated = [r for r in batch.records if isinstance(r, Evaluated)]
        rows = [
            {"step": r.step, "distance_m": r.distance_m, "epsilon": r.epsilon} for r in evaluated
        ]
        if rows:
            self._store.append_evaluations(self.run_id, rows)
        for record in batch.records:
            self._recordings.add(self.run_id, record)
            if isinstance(record, Reference):
                distance = record.greedy_distance_m
                self._store.update(self.run_id, greedy_distance_m=distance)
                self._tell("reference", greedy_distance_m=distance)
        for row in rows:
            self._tell("evaluation", **row)
        run = self._store.update_progress(self.run_id, batch.done, self._eta_s(batch.done))
        if time.monotonic() - self._published_s >= 1 / EVENTS_PER_S:
            self._publish(run)

    def _take_change(self, changed: Changed) -> None:
        change = {"step": changed.step, **changed.changes}
        # After a checkpoint some may be there already that are yet to be made again.
        made = sorted((*self._store.get(self.run_id).changes, change), key=itemgetter("step"))
        run = self._store.update(self.run_id, changes=tuple(made))
        self._progress.clear()
        self._tell("rates", **change)
        self._publish(run)
        self._answers.pop(changed.token).set()

    def _take_end(self, ended: Ended) -> None:
        lanes = self._recordings.race(self.run_id)
        if lanes is None or not isinstance(self._order, RaceTask):
            self.end(ended.outcome, result=ended.result)
            return
        result = self._race_result(lanes, self._order)
        failures = [lane.failure for lane in lanes if lane.failure]
        if ended.outcome == "finished" and len(failures) == len(lanes):
            self.end("failed", f"No lane could finish the race: {failures[0]}", result)
        else:
            self.end(ended.outcome, result=result)

    def _race_result(self, lanes: list[LaneRecording], order: RaceTask) -> dict[str, Any]:
        result = race_result(lanes, order.config.steps)
        robots = _trained_robots(order)
        numbered = zip(result["lanes"], self._run.lane_training_ids, robots, strict=True)
        result["lanes"] = [
            {"agent": lane["agent"], "training_id": training, "trained_robot": robot, **lane}
            for lane, training, robot in numbered
        ]
        return {**result, "shared_machine": self.shared}

    def _eta_s(self, done: int) -> float | None:
        """From the newest seconds, since pace and machine change."""
        now = time.monotonic()
        self._progress.append((now, done))
        while self._progress[0][0] < now - self.eta_window_s:
            self._progress.popleft()
        began, before = self._progress[0]
        if done == before:
            return None
        return round((self._run.total - done) * (now - began) / (done - before), 1)

    def _tell(self, event: str, **data: Any) -> None:
        self._bus.publish(event, {"run_id": self.run_id, **data}, self.run_id)

    def _publish(self, run: Run) -> None:
        self._published_s = time.monotonic()
        self._bus.publish("run", run_view(run), self.run_id)


def _trained_robots(order: RaceTask) -> list[Any]:
    """For each lane the robot that its table was learned on, where that is another one."""
    here = as_mapping(order.config.robot)
    learned = [table and table.meta["config"]["robot"] for table in order.tables]
    return [None if robot == here else robot for robot in learned]


EVENTS_PER_S = 4


class ExperimentJob(Job):
    """An experiment that a process works on."""

    # It ends with a report of what there is, whose figures take a while to draw.
    stop_grace_s = 90.0
    eta_window_s = 60.0

    def _take(self, message: Message) -> None:
        if isinstance(message, TrialsDone):
            self._take_trials(message)
        elif isinstance(message, Reported):
            self._store.put_artifact(self.run_id, message.name, message.data)
            if message.name == SUMMARY:
                run = self._store.get(self.run_id)
                self._tell("summary", done=run.done, total=run.total)
        else:
            super()._take(message)

    def _take_trials(self, tried: TrialsDone) -> None:
        self._store.append_trials(self.run_id, tried.rows)
        run = self._store.update_progress(self.run_id, tried.done, self._eta_s(tried.done))
        if time.monotonic() - self._published_s >= 1 / EVENTS_PER_S:
            self._publish(run)

    def _take_end(self, ended: Ended) -> None:
        result: dict[str, Any] = {**(ended.result or {}), "shared_machine": self.shared}
        self.end(ended.outcome, result=result)
