"""Metrics of runs: count computed steps, and log changes of the runs' states."""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable

from app.events.bus import Channel, EventBus
from app.storage.run import AnyRun, Run
from app.storage.run_kind import WALKS
from hexapods.domain.records import Record

_WINDOW_S = 10.0
_logger = logging.getLogger(__name__)


class RunMetrics(EventBus):
    """Event bus that derives step counts and log records from the runs it publishes."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        """Start counting at zero.

        Args:
            now: monotonic clock for the step rate [s].
        """
        super().__init__()
        self._now = now
        self._last_published: dict[str, tuple[str, int]] = {}
        """By run id: last published state and number of steps done."""
        self._steps = 0
        self._recent_steps: deque[tuple[float, int]] = deque()
        self._metrics_lock = threading.Lock()

    @property
    def steps(self) -> int:
        """Robot steps computed since the server started, summed over all runs."""
        return self._steps

    @property
    def steps_per_s(self) -> float:
        """Computed robot steps per second, averaged over the last ten seconds."""
        now = self._now()
        with self._metrics_lock:
            self._drop_old(now)
            return sum(steps for _, steps in self._recent_steps) / _WINDOW_S

    def publish_run(self, run: AnyRun, queue_position: int | None = None) -> None:
        """Publish a run, and update the metrics and the log."""
        super().publish_run(run, queue_position)
        if isinstance(run, Run):
            self._record(run)

    def publish(
        self,
        event: str,
        data: Record,
        run_id: str | None = None,
        channel: Channel | None = None,
    ) -> None:
        """Publish an event, and log the deletion of a run."""
        super().publish(event, data, run_id, channel)
        if event == "run-deleted" and run_id is not None:
            with self._metrics_lock:
                self._last_published.pop(run_id, None)
            _logger.info("deleted", extra={"run_id": run_id})

    def _record(self, run: Run) -> None:
        run_id, state, done = run.id, run.state, run.done
        with self._metrics_lock:
            # The first event of a run from before a restart sets the baseline of its steps.
            state_before, done_before = self._last_published.get(run_id, ("", done))
            self._last_published[run_id] = (state, done)
            now = self._now()
            self._drop_old(now)
            if done > done_before and run.kind in WALKS:
                self._steps += done - done_before
                self._recent_steps.append((now, done - done_before))
        if state != state_before:
            level = logging.WARNING if state in ("failed", "interrupted") else logging.INFO
            error = {"error": run.error} if run.error else {}
            _logger.log(level, "%s is %s", run.kind, state, extra={"run_id": run_id, **error})

    def _drop_old(self, now: float) -> None:
        while self._recent_steps and self._recent_steps[0][0] <= now - _WINDOW_S:
            self._recent_steps.popleft()
