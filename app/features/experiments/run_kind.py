"""Experiments as a kind of run."""

from collections.abc import Iterable, Mapping
from typing import Any

from app.features.experiments import archived_trials
from app.features.experiments.job import ExperimentJob
from app.features.experiments.messages import ExperimentTask
from app.features.experiments.start import plan_of
from app.features.experiments.stored_trials import wall_s_of
from app.features.experiments.tables import TRIALS
from app.features.experiments.trial_rows import Trials
from app.storage.database.store import RunStore
from app.storage.run import Run
from app.storage.run_kind import AddedKind, Rows
from hexapods.domain.errors import HexapodError
from hexapods.experiments.config import SUMMARY, ExperimentConfig
from hexapods.experiments.names import experiment_name
from hexapods.experiments.result import ExperimentResult


class ExperimentKind(AddedKind):
    """An experiment: many trials, of which each is stored as it ends; resuming repeats none."""

    name, config, result = "experiment", ExperimentConfig, ExperimentResult
    counted = "trials"

    def checked_total(self, config: ExperimentConfig) -> int:
        return plan_of(config).total

    def has_made_name(self, run: Run) -> bool:
        config: ExperimentConfig = run.config
        try:
            return run.name == experiment_name(config)
        except HexapodError:
            # An agent whose settings it varies is not here: whoever added the run, named it.
            return False

    def task(self, run: Run, store: RunStore) -> ExperimentTask:
        rows = tuple(Trials(store.database).get(run.id))
        wall_s = wall_s_of(store.artifact(run.id, SUMMARY), run.id)
        return ExperimentTask(run.config, run.workers, rows, wall_s)

    def job_class(self) -> type[Any]:
        return ExperimentJob

    def response_model(self) -> type[Any]:
        from app.features.experiments.response_models import ExperimentView  # noqa: PLC0415 - of the API

        return ExperimentView

    def view(self, run: Run) -> Mapping[str, Any]:
        return {"workers": run.workers}

    def outcome(self, result: ExperimentResult) -> str:
        verdicts = [claim.verdict for claim in result.claims]
        return f"{verdicts.count('holds')} of {len(verdicts)} claims hold" if verdicts else ""

    def texts(self, run: Run, store: RunStore) -> Mapping[str, bytes]:
        rows = Trials(store.database).get(run.id)
        return {archived_trials.TRIALS: archived_trials.trials_json(run.id, rows)}

    def file_names(self, run: Run) -> Iterable[str]:
        files = run.result.files if run.result is not None else ()
        return dict.fromkeys([SUMMARY, *files])

    def is_member(self, name: str) -> bool:
        return name == archived_trials.TRIALS or archived_trials.is_report_file(name)

    def take_members(self, run: Run, members: dict[str, bytes], label: str) -> Rows:
        trials = archived_trials.take_trials(members, run.config, label)
        archived_trials.check_report_files(run, self.file_names(run), members, label)
        return {TRIALS: trials}


KIND = ExperimentKind()
