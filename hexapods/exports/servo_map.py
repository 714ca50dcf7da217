"""Servo maps: which servo turns each joint, and the pulse that brings it to an angle.

`servo_map_file` reads them; those of kits are built in.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hexapods.domain.types import FloatArray

_FOLDER = Path(__file__).parent / "servo_maps"
BUILT_IN_MAPS: Mapping[str, Path] = {
    name: _FOLDER / f"{name}.yaml" for name in ("freenove", "freenove-old")
}
"""Files of the maps of kits whose makers publish the channels, by name."""
USUAL_LIMITS_US = (500.0, 2500.0)
USUAL_SPEED_SHARE = 0.7
"""Share of its no-load speed that a servo is held to reach while it carries the robot."""


@dataclass(frozen=True)
class Servo:
    """A hobby servo: its place, and its pulse for an angle of its joint.

    Attributes:
        joint: label of the joint that it turns, such as `leg1_coxa`.
        board, channel: where it is connected.
        us_at_zero: pulse at the joint's angle 0 [µs]; it may be beyond the limits.
        us_per_rad: what is added for each rad, below 0 if the servo turns the other way [µs/rad].
        limits_us: lowest and highest pulse that it may get [µs].
        speed_deg_s: its no-load speed [°/s]; None if it is not known.
    """

    joint: str
    board: int
    channel: int
    us_at_zero: float
    us_per_rad: float
    limits_us: tuple[float, float] = USUAL_LIMITS_US
    speed_deg_s: float | None = None

    @property
    def title(self) -> str:
        """Its joint and its place, for messages."""
        return f"{self.joint} (board {self.board}, channel {self.channel})"

    def pulses_us(self, angles_rad: FloatArray) -> FloatArray:
        """Return the pulses for angles of its joint [µs], of the shape of the angles."""
        return self.us_at_zero + self.us_per_rad * angles_rad


@dataclass(frozen=True)
class ServoMap:
    """The servos of a robot.

    Attributes:
        name: of the map: that of a kit, or of a file.
        servos: one for each joint, in the order of poses.
        speed_share: share of their no-load speed that can be counted on, over 0 and at most 1.
    """

    name: str
    servos: tuple[Servo, ...]
    speed_share: float = USUAL_SPEED_SHARE
