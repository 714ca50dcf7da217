"""Configs of trainings and races as plain JSON types, as in API responses and in files."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from hexapods.domain import disturbances
from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import as_mapping, robot
from hexapods.domain.settings import SettingValues
from hexapods.domain.world import world
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.lane import lane_as_json, lane_from_json
from hexapods.runs.race_config import Branch, RaceConfig


def as_json(config: WalkingProblem) -> dict[str, Any]:
    """Convert a config to plain types, as in API responses and in files."""
    data: dict[str, Any] = {}
    for one in fields(config):
        value = getattr(config, one.name)
        data[one.name] = dict(value) if isinstance(value, SettingValues) else value
    data["robot"] = as_mapping(config.robot)
    del data["world"]
    data["disturbances"] = [disturbances.as_mapping(one) for one in config.world.disturbances]
    if isinstance(config.gait, GaitSpec):
        data["gait"] = {k: v for k, v in asdict(config.gait).items() if v is not None}
    if isinstance(config, RaceConfig):
        data["lanes"] = [lane_as_json(lane) for lane in config.lanes]
        branch = config.branch_from
        data["branch_from"] = None if branch is None else branch._asdict()
    return data


def config_from_json(data: Mapping[str, Any]) -> TrainingConfig | RaceConfig:
    """Parse the output of `as_json`; a config with lanes is that of a race.

    The agents are not imported.

    Raises:
        InvalidInput: if a value is invalid.
        KeyError, TypeError, ValueError: if it is not the output of `as_json`.
    """
    values = {**data, "gait": gait_from_json(data["gait"]), "robot": robot(data["robot"])}
    values["world"] = world(values.pop("disturbances", ()))  # earlier versions had none
    if "lanes" in values:
        lanes = tuple(lane_from_json(lane) for lane in values.pop("lanes"))
        branch = values.pop("branch_from", None)  # earlier versions had none
        branch_from = None if branch is None else Branch(branch["race_id"], branch["step"])
        return RaceConfig(**values, lanes=lanes, branch_from=branch_from)
    values["settings"] = SettingValues(values["settings"])
    return TrainingConfig(**values)


def gait_from_json(value: str | Mapping[str, Any]) -> str | GaitSpec:
    """Parse a gait from the output of `as_json`."""
    if isinstance(value, str):
        return value
    parts = dict(value)
    if "pairs" in parts:
        parts["pairs"] = tuple((int(a), int(b)) for a, b in parts["pairs"])
    return GaitSpec(**parts)
