"""Gaits and robots as the options list them."""

from typing import Any

from app.api.option_texts import GAIT_TEXTS
from app.storage.stored_robot import StoredRobot
from hexapods.domain import disturbances
from hexapods.domain.creatures import Creature, own_gait
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GAIT_TITLES, NAMED_GAITS, GaitSpec, gait_as_json, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot, as_mapping, by_value
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.domain.text import counted
from hexapods.runs.recommendation import recommend


def gait_options(name: str) -> dict[str, Any]:
    """Return a named gait with its groups on the robot of the paper."""
    gait = resolve(name, Robot().azimuths_deg)
    return {
        "name": name,
        "title": GAIT_TITLES[name],
        "forward_deg": gait.forward_deg,
        "azimuths_deg": gait.azimuths_deg,
        "pairs": gait.groups,
        "description": GAIT_TEXTS[name],
    }


def built_in_options(creature: Creature) -> dict[str, Any]:
    """Return a robot that is built in."""
    return {
        "name": creature.robot.name,
        "title": creature.title,
        "description": creature.description,
        **_robot(creature.robot, creature.gait),
    }


def stored_options(stored: StoredRobot) -> dict[str, Any]:
    """Return a stored robot, with its body."""
    robot = stored.robot
    origin = "made here" if stored.file is None else f"from {stored.file}"
    return {
        "name": stored.id,
        "title": stored.name,
        "description": f"{counted(len(robot.legs), 'leg')}; {origin}.",
        **_robot(robot, own_gait(robot)),
        "hidden": stored.hidden,
        "body": by_value(robot),
    }


def _robot(robot: Robot, gait: str | GaitSpec) -> dict[str, Any]:
    legs = legs_of(robot)
    numbers = range(1, len(legs) + 1)
    gaits = [name for name in NAMED_GAITS if _divides(name, robot)]
    return {
        "id": robot.id,
        "hidden": False,
        "body": None,
        "robot": as_mapping(robot),
        "grid_side_m": usual_grid_side_m(robot, gait),
        "joints": [[joint.name for joint in legs.of_leg(number)] for number in numbers],
        "limits_rad": [[joint.limits_rad for joint in legs.of_leg(number)] for number in numbers],
        "azimuths_deg": [*robot.azimuths_deg],
        "gait": gait_as_json(gait),
        "gaits": gaits,
        "recommended_agent": {
            name: recommend(robot, resolve(name, robot.azimuths_deg), len(FootGrid())).agent
            for name in gaits
        },
        "built": {name: getattr(robot, name) for name in _replaced_parts()},
    }


def _divides(gait: str, robot: Robot) -> bool:
    """Return whether a named gait divides the legs of a robot into groups."""
    try:
        resolve(gait, robot.azimuths_deg)
    except InvalidInput:
        return False
    return True


def _replaced_parts() -> list[str]:
    """Return the fields of a robot in whose place disturbances put another value."""
    values = (kind.nothing for kind in disturbances.KINDS.values())
    return [value for value in values if isinstance(value, str)]
