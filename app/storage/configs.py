"""What any kind of run was asked to do, in plain types and back."""

from collections.abc import Mapping
from typing import Any

from app.experiments import config as experiments
from app.experiments.config import ExperimentConfig
from app.runs.config import RaceConfig, TrainingConfig, as_json, config_from_json
from app.storage.store import Config, Kind

CONFIGS: Mapping[Kind, type[Config]] = {
    "training": TrainingConfig,
    "race": RaceConfig,
    "experiment": ExperimentConfig,
}
"""The config of each kind of run."""


def config_as_json(config: Config) -> dict[str, Any]:
    """In plain types, as the API shows it and the database keeps it."""
    if isinstance(config, ExperimentConfig):
        return experiments.as_json(config)
    return as_json(config)


def config_of(kind: str, shown: Mapping[str, Any]) -> Config:
    """The config that `config_as_json` wrote of a run of this kind.

    Raises:
        InvalidInput: if a value cannot be.
        KeyError, TypeError, ValueError: if `config_as_json` did not write it.
    """
    if kind == "experiment":
        return experiments.from_json(shown)
    return config_from_json(shown)
