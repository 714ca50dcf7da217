"""Settings that a robot's exported file carries, by which it is read back as the same robot.

Neither MJCF nor URDF has a place for the gait, the times of a step or the order of the legs.
`hexapods.imports.exported_settings` reads what is written here.
"""

import json
from collections.abc import Mapping

from hexapods.domain.creatures import own_gait
from hexapods.domain.gait import gait_as_json
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot import Robot

_UNKNOWN_GAIT = "one-by-one"
_SERVO = "servo_"


def exported_settings(robot: Robot) -> Mapping[str, str | float]:
    """Return the settings of a robot by name: texts, and numbers in `ModelRobot.changeable`.

    `feet` are the names of the feet in the order of the legs, `gait` is its name or JSON. Without a
    gait that suits the robot it is left out, for the reader to find one.
    """
    settings: dict[str, str | float] = {
        "feet": " ".join(f"leg{leg}_foot" for leg in range(1, len(robot.legs) + 1))
    }
    gait = own_gait(robot)
    if gait != _UNKNOWN_GAIT:
        settings["gait"] = gait if isinstance(gait, str) else json.dumps(gait_as_json(gait))
    for name in ModelRobot.changeable:
        if not name.startswith(_SERVO):
            settings[name] = float(getattr(robot, name))
    return settings
