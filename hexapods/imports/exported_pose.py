"""Frame and stance of a robot whose file was exported here."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np

from hexapods.domain.types import FloatArray

HOME_KEY = "home"
"""Name of the keyframe of the stance."""


@dataclass(frozen=True)
class ExportedPose:
    """What such a file says of the robot's frame and stance.

    Attributes:
        keeps_frame: whether the torso's frame is the body frame, and the feet are in the order of
            the legs.
        home_rad: angles of joints in the stance, by their names.
    """

    keeps_frame: bool = False
    home_rad: Mapping[str, float] = field(default_factory=dict)

    def keyframes(self, model: mujoco.MjModel) -> dict[str, FloatArray]:
        """Return `qpos` of the stance as a keyframe; none if no joint's angle is known."""
        names = {model.joint(joint).name: joint for joint in range(model.njnt)}
        known = {names[name]: angle for name, angle in self.home_rad.items() if name in names}
        if not known:
            return {}
        qpos = np.array(model.qpos0)
        for joint, angle in known.items():
            qpos[model.jnt_qposadr[joint]] = angle
        return {HOME_KEY: qpos}


FOREIGN = ExportedPose()
"""Of the file of another program."""
