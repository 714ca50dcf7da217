"""Serialise the config of any kind of run to plain JSON types, and parse it back."""

from collections.abc import Mapping
from typing import Any

from app.experiments import config as experiments
from app.experiments.config import ExperimentConfig
from app.runs.config import RaceConfig, TrainingConfig, as_json, config_from_json
from app.storage.run import Config, Kind

CONFIGS: Mapping[Kind, type[Config]] = {
    "training": TrainingConfig,
    "race": RaceConfig,
    "experiment": ExperimentConfig,
}
"""Config class by kind of run."""


def config_as_json(config: Config) -> dict[str, Any]:
    """Serialise a config to plain JSON types, as sent by the API and stored in the database."""
    if isinstance(config, ExperimentConfig):
        return experiments.as_json(config)
    return as_json(config)


def config_of(kind: str, fields: Mapping[str, Any]) -> Config:
    """Parse a config that `config_as_json` wrote for a run of this kind.

    Raises:
        InvalidInput: if a value is out of range.
        KeyError, TypeError, ValueError: if the structure is not that of `config_as_json`.
    """
    if kind == "experiment":
        return experiments.from_json(fields)
    return config_from_json(fields)
