"""What happens to runs, counted for the metrics and told to the log."""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from app.events.bus import EventBus

_WINDOW_S = 10.0
_logger = logging.getLogger(__name__)


class RunMetrics(EventBus):
    """The bus, noticing what it publishes of runs: their steps, and the changes of their states."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        """Count from zero.

        Args:
            now: the clock that rates go by, in seconds.
        """
        super().__init__()
        self._now = now
        self._seen: dict[str, tuple[str, int]] = {}
        """By run its last state, and the steps that were done."""
        self._steps = 0
        self._newest: deque[tuple[float, int]] = deque()
        self._seeing = threading.Lock()

    @property
    def steps(self) -> int:
        """Robots' steps that were computed since the server began, of all runs together."""
        return self._steps

    @property
    def steps_per_s(self) -> float:
        """Of the last ten seconds."""
        now = self._now()
        with self._seeing:
            self._forget(now)
            return sum(steps for _, steps in self._newest) / _WINDOW_S

    def publish(self, event: str, data: Mapping[str, Any] | str, run_id: str | None = None) -> None:
        """Tell everyone, and take note."""
        super().publish(event, data, run_id)
        if isinstance(data, str) or run_id is None:
            return
        if event == "run":
            self._note(data)
        elif event == "run-deleted":
            with self._seeing:
                self._seen.pop(run_id, None)
            _logger.info("deleted", extra={"run_id": run_id})

    def _note(self, run: Mapping[str, Any]) -> None:
        run_id, state, done = run["id"], run["state"], run["progress"]["done"]
        with self._seeing:
            # One that was there before the server counts from where it is.
            state_before, done_before = self._seen.get(run_id, ("", done))
            self._seen[run_id] = (state, done)
            now = self._now()
            self._forget(now)
            if done > done_before and run["kind"] != "experiment":
                self._steps += done - done_before
                self._newest.append((now, done - done_before))
        if state != state_before:
            level = logging.WARNING if state in ("failed", "interrupted") else logging.INFO
            more = {"error": run["error"]} if run["error"] else {}
            _logger.log(level, "%s is %s", run["kind"], state, extra={"run_id": run_id, **more})

    def _forget(self, now: float) -> None:
        while self._newest and self._newest[0][0] <= now - _WINDOW_S:
            self._newest.popleft()
