"""Servo maps for tests."""

from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot

JOINTS = [joint.label for joint in legs_of(Robot()).joints]


def map_text(head: str = "", **servos: str | None) -> str:
    """Return a map of the hexapod's servos, which turn 400 µs a rad around 1500 µs.

    Args:
        head: lines before those of the servos.
        servos: of some joints their servos; None for those that are left out.
    """
    lines = []
    for number, joint in enumerate(JOINTS):
        board, channel = divmod(number, 16)
        usual = f"{{board: {board}, channel: {channel}, us_at_zero: 1500, us_per_rad: 400}}"
        servo = servos.get(joint, usual)
        if servo is not None:
            lines.append(f"  {joint}: {servo}")
    return "\n".join([*filter(None, [head]), "servos:", *lines]) + "\n"
