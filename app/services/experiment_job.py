"""A job that runs an experiment: its trials, its summary and its report become the run's."""

import time
from typing import Any

from app.services.job import Job
from app.services.orders import Ended, Message, Reported, Tried
from app.services.store import SUMMARY

EVENTS_PER_S = 4


class ExperimentJob(Job):
    """An experiment that a process works on."""

    # It ends with a report of what there is, whose figures take a while to draw.
    stop_grace_s = 90.0
    eta_window_s = 60.0

    def _take(self, message: Message) -> None:
        if isinstance(message, Tried):
            self._take_trials(message)
        elif isinstance(message, Reported):
            self._store.put_artifact(self.run_id, message.name, message.data)
            if message.name == SUMMARY:
                run = self._store.get(self.run_id)
                self._tell("summary", done=run.done, total=run.total)
        else:
            super()._take(message)

    def _take_trials(self, tried: Tried) -> None:
        self._store.append_trials(self.run_id, tried.rows)
        run = self._store.update_progress(self.run_id, tried.done, self._eta_s(tried.done))
        if time.monotonic() - self._published_s >= 1 / EVENTS_PER_S:
            self._publish(run)

    def _take_end(self, ended: Ended) -> None:
        result: dict[str, Any] = {**(ended.result or {}), "shared_machine": self.shared}
        self.end(ended.outcome, result=result)
