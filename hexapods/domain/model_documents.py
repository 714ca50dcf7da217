"""Robots from files by value, as in the documents of stored robots."""

import json
from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from hexapods.domain.body import NO_NUMBERS, LegMount, Robot
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot_model import RobotModel

NUMBERS = tuple(field.name for field in fields(Robot) if field.name not in NO_NUMBERS)
_LEG = ("azimuth_deg", "radius_m", "z_m", "yaw_deg", "foot_out_m")
_LARGEST = 1e6


def model_content(robot: ModelRobot) -> dict[str, Any]:
    """Return a robot from a file by value: its model, and the fields that were derived from it."""
    return {
        "model": _without_defaults(to_json(robot.model)),
        "robot": {
            **{name: float(getattr(robot, name)) for name in NUMBERS},
            "legs": [{name: asdict(leg)[name] for name in _LEG} for leg in robot.legs],
        },
    }


def _without_defaults(model: dict[str, Any]) -> dict[str, Any]:
    """Leave out numbers that documents lacked when the first robots were stored.

    The id of a robot is that of its document: with a friction of 0 it stays the same.
    """
    for link in model["links"]:
        if link["joint"] is not None and link["joint"]["friction_nm"] == 0:
            del link["joint"]["friction_nm"]
    return model


def read_model_content(content: Mapping[str, Any]) -> ModelRobot:
    """Return the robot of the output of `model_content`.

    Raises:
        DamagedFile: if the content is not such an output.
        InvalidInput: if its model or a number is not valid.
    """
    try:
        robot = dict(content["robot"])
        legs = tuple(LegMount(**_numbers(leg, _LEG)) for leg in robot.pop("legs"))
        # As JSON: there Pydantic's strict mode takes lists for tuples, but no texts for numbers.
        model = from_json(RobotModel, json.dumps(content["model"]).encode(), strict=True)
        if len(legs) != len(model.feet):
            raise ValueError("it has other legs than its model")
        if {*content} != {"model", "robot"}:
            raise ValueError("it holds more than a robot")
        numbers: dict[str, Any] = _numbers(robot, NUMBERS)
        return ModelRobot(name="robot", legs=legs, model=model, **numbers)
    except InvalidInput:
        raise
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise DamagedFile(f"the document of a robot is damaged: {error}") from error


def _numbers(values: Mapping[str, Any], names: tuple[str, ...]) -> dict[str, float]:
    """Return the numbers of these names.

    Raises:
        ValueError: if the names differ.
        InvalidInput: if a value is not a number, or too large.
    """
    if {*values} != {*names}:
        raise ValueError(f"it must have {', '.join(names)}")
    for name, number in values.items():
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise InvalidInput(f"robot.{name} must be a number, not {str(number)[:100]!r}")
        if not abs(number) <= _LARGEST:
            raise InvalidInput(f"robot.{name} is too large: {number}")
    return {name: float(number) for name, number in values.items()}
