"""`hexapods sweep`: try a grid of practice parameters over many seeds, and write a report."""

from collections.abc import Mapping
from typing import Annotated, Any

from app.cli.setting_options import AgentOptions, DeclaredOptions
from app.features.experiments.command_trials import run_experiment
from app.features.experiments.trial_options import ExecutionOptions, TrialOptions
from hexapods.domain.settings import declared_fields
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.presets import GRID
from hexapods.runs.config import TrainingConfig

_SETTINGS = declared_fields(TrainingConfig)
_TRIALS, _EXECUTION = TrialOptions(), ExecutionOptions()


def sweep(
    *,
    trials: TrialOptions = _TRIALS,
    execution: ExecutionOptions = _EXECUTION,
    **settings: Annotated[
        Any,
        DeclaredOptions(_SETTINGS, GRID, lists=True),
        DeclaredOptions(_SETTINGS, ("reward",)),
        AgentOptions(lists=True),
    ],
) -> int:
    """Try a grid of practice parameters over many seeds, and write a report.

    Started again, it goes on from its results folder.

    Raises:
        HexapodError: if the options are not valid.
    """
    return run_experiment(config_of(trials, settings), execution)


def config_of(trials: TrialOptions, settings: Mapping[str, Any]) -> ExperimentConfig:
    """Return the sweep of some options.

    Raises:
        HexapodError: if the options are not valid.
    """
    return experiment_config("sweep", {**trials.fields(), **settings})
