"""An experiment in its worker process: runs the remaining trials, sends results and summaries."""

import json
import os
import queue
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from app.features.experiments.messages import ExperimentTask, Reported, TrialsDone
from app.features.experiments.stored_trials import outcomes_of
from app.jobs.messages import Began, Command, Ended, Message
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.config import SUMMARY
from hexapods.experiments.progress import Progress
from hexapods.experiments.result import ClaimVerdict, ExperimentResult, TrialCounts
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.worker import Outcome

BATCHES_PER_S = 5
SUMMARY_EVERY_S = 2.0
_SUMMARY_SHARE = 0.15
"""Largest share of the time spent on summaries, which take a core away from the trials."""


def experiment(
    task: ExperimentTask, send: Callable[[Message], None], commands: "queue.SimpleQueue[Command]"
) -> None:
    """Run an experiment to its end, or until a `stop` or `checkpoint_and_exit` command.

    Args:
        task: the experiment, with the trials that are done.
        send: sends a message to the server.
        commands: commands received from the server.

    Raises:
        HexapodError: if it cannot continue.
    """
    send(Began((), len(task.rows)))
    control, progress = _TrialControl(commands), _SentProgress(task, send)
    progress.summarise()
    while control.wait():
        progress.run_remaining(control.may_continue)
        if not control.draining:
            break
        if control.paused:
            # The workers have ended during a pause, since they take memory.
            progress.summarise()
    if not control.exiting:
        progress.report()
        send(Ended("stopped" if control.stopped else "finished", progress.result()))


class _TrialControl:
    """Executes the server's commands between trials.

    Attributes:
        paused: whether to wait for `resume`.
        stopped: whether to end with a report on the trials so far.
        exiting: whether to end at once without a report, to be resumed later.
        draining: whether no more trials are started until the next call of `wait`.
    """

    def __init__(self, commands: "queue.SimpleQueue[Command]") -> None:
        self.paused = self.stopped = self.exiting = self.draining = False
        self._commands = commands

    def may_continue(self) -> bool:
        """Execute pending commands; False if no trial may start before the next `wait`."""
        # False stays False: a `resume` must not restart an engine that is draining.
        while not self.draining and not self._commands.empty():
            self._execute(self._commands.get())
            self.draining = self.paused or self.stopped or self.exiting
        return not self.draining

    def wait(self) -> bool:
        """Block while paused; False if the experiment is to end."""
        while not (self.stopped or self.exiting):
            if not self.paused and self._commands.empty():
                self.draining = False
                return True
            self._execute(self._commands.get())
        return False

    def _execute(self, command: Command) -> None:
        if command.verb in ("pause", "resume"):
            self.paused = command.verb == "pause"
        self.stopped |= command.verb == "stop"
        self.exiting |= command.verb == "checkpoint_and_exit"


class _SentProgress(Progress):
    """Progress of which every outcome, and summaries now and then, are sent to the server."""

    def __init__(self, task: ExperimentTask, send: Callable[[Message], None]) -> None:
        super().__init__(task.config)
        for outcome in outcomes_of(task.rows):
            super().add(outcome)
        self.wall_s = task.wall_s
        self._workers = task.workers or os.cpu_count() or 1
        self._send_now, self._send_lock = send, threading.Lock()
        self._summary_executor = ThreadPoolExecutor(1, "summary")
        self._pending_summary: Future[None] | None = None
        self._pending: list[dict[str, Any]] = []
        self._sent_s = self._due_s = time.monotonic()
        self._summary: dict[str, Any] = {}
        self._is_stale = True
        self._files: list[str] = []

    def run_remaining(self, may_continue: Callable[[], bool]) -> None:
        """Run the remaining trials on worker processes.

        Args:
            may_continue: polled between trials; False ends the run.
        """

        def send_and_check() -> bool:
            self._send_due()
            return may_continue()

        for _ in self.run(self.remaining(), ClusterSpec(workers=self._workers), send_and_check):
            pass
        self.flush()

    def add(self, outcome: Outcome) -> None:
        """Add the outcome of a trial to the results and to the next batch."""
        super().add(outcome)
        self._pending.append(outcome.as_json())
        self._is_stale = True

    def flush(self) -> None:
        """Send the pending batch of trials."""
        if self._pending:
            self._send(TrialsDone(tuple(self._pending), self.done))
        self._pending = []
        self._sent_s = time.monotonic()

    def summarise(self) -> None:
        """Send a summary of the trials so far unless the last one is up to date; wait for it."""
        self._wait_for_summary()
        if self._is_stale:
            self._start_summary()
            self._wait_for_summary()

    def _start_summary(self) -> None:
        """Start computing a summary in a thread, so that trials need not wait for it."""
        self.flush()
        self._is_stale = False
        inputs = *self.planned(), self.cost(self._workers)
        self._pending_summary = self._summary_executor.submit(self._compute_summary, *inputs)

    def _wait_for_summary(self) -> None:
        if self._pending_summary is not None:
            self._pending_summary.result()
            self._pending_summary = None

    def _compute_summary(
        self, results: Mapping[str, TrialResult], set_aside: Mapping[str, str], cost: Any
    ) -> None:
        from hexapods.experiments.summary import summarise  # noqa: PLC0415 - slow to import

        started_s = time.monotonic()
        self._summary = summarise(self.plan.config, results, set_aside, cost)
        took_s = time.monotonic() - started_s
        self._due_s = started_s + max(SUMMARY_EVERY_S, took_s / _SUMMARY_SHARE)
        self._send_file(SUMMARY, json.dumps(self._summary, allow_nan=False).encode())

    def report(self) -> None:
        """Send the files of the report."""
        from hexapods.experiments.report.files import report_files  # noqa: PLC0415 - needed once

        self.flush()
        self._is_stale = True
        self.summarise()
        for name, data in report_files(self._summary, self.results):
            self._send_file(name, data)

    def result(self) -> ExperimentResult:
        """Return the run's result, short enough for lists of runs."""
        counts, claims = self._summary["trials"], self._summary["claims"]
        return ExperimentResult(
            trials=TrialCounts(
                done=counts["done"],
                total=counts["total"],
                failed=counts["failed"],
                set_aside=len(self.set_aside),
            ),
            claims=tuple(
                ClaimVerdict(id=claim["id"], verdict=claim["verdict"]) for claim in claims
            ),
            files=tuple(self._files),
            finding=self._summary["finding"],
        )

    def _send_due(self) -> None:
        now_s = time.monotonic()
        if self._pending and now_s - self._sent_s >= 1 / BATCHES_PER_S:
            self.flush()
        if self._pending_summary is not None and self._pending_summary.done():
            self._wait_for_summary()
        if self._is_stale and now_s >= self._due_s and self._pending_summary is None:
            self._start_summary()

    def _send_file(self, name: str, data: bytes) -> None:
        if name not in self._files:
            self._files.append(name)
        self._send(Reported(name, data))

    def _send(self, message: Message) -> None:
        with self._send_lock:
            self._send_now(message)
