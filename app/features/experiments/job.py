"""A running experiment: applies its process's messages to the store and the bus."""

from dataclasses import replace
from typing import cast

from app.features.experiments.messages import Reported, TrialsDone
from app.features.experiments.response_models import SummaryEvent
from app.features.experiments.trial_rows import Trials
from app.jobs.job import Job
from app.jobs.messages import Ended, Message
from hexapods.experiments.config import SUMMARY
from hexapods.experiments.result import ExperimentResult


class ExperimentJob(Job):
    """An experiment and the worker process that runs its trials."""

    # A stopped experiment still writes its report, whose figures take a while to draw.
    stop_grace_s = 90.0
    events_per_s = 4
    eta_window_s = 60.0

    def _handle(self, message: Message) -> None:
        if isinstance(message, TrialsDone):
            Trials(self._store.database).append(self.run_id, message.rows)
            self._handle_progress(message.done)
        elif isinstance(message, Reported):
            self._store.put_artifact(self.run_id, message.name, message.data)
            if message.name == SUMMARY:
                event = SummaryEvent(run_id=self.run_id, done=self.last.done, total=self.last.total)
                self._publish_event("summary", event)
        else:
            super()._handle(message)

    def _handle_end(self, ended: Ended) -> None:
        result = cast(ExperimentResult, ended.result)
        self.end(ended.outcome, result=replace(result, shared_machine=self.shared))
