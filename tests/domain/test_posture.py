"""Posture: whether a robot lies on the ground, and which way it faces."""

import math

import numpy as np
import pytest

from hexapods.domain.posture import TILT, has_fallen, have_fallen, heading_deg
from hexapods.domain.robot import Robot


def pose(z: float, tilt_deg: float = 0.0, yaw_deg: float = 0.0) -> list[float]:
    """Return a torso's pose, tilted about the world's x axis or turned about its z axis."""
    tilt, yaw = math.radians(tilt_deg) / 2, math.radians(yaw_deg) / 2
    if tilt_deg:
        return [0, 0, z, math.cos(tilt), math.sin(tilt), 0, 0]
    return [0, 0, z, math.cos(yaw), 0, 0, math.sin(yaw)]


@pytest.mark.parametrize(
    ("z", "tilt_deg", "fallen"),
    [
        (0.1, 0, False),
        (0.1, 30, False),
        (0.021, 0, True),
        (0.03, 0, False),
        (0.06, 45, True),
        (0.1, 90, True),
        (0.02, 180, True),
    ],
)
def test_a_robot_has_fallen_when_its_torso_lies_on_the_ground(
    z: float, tilt_deg: float, fallen: bool
) -> None:
    assert has_fallen(Robot(), pose(z, tilt_deg)) == fallen


def test_many_poses_are_judged_at_once() -> None:
    cases = [(z, tilt) for z in (0.02, 0.03, 0.06, 0.1) for tilt in (0.0, 30.0, 45.0, 90.0, 180.0)]
    poses = [pose(z, tilt_deg) for z, tilt_deg in cases]
    for ground_m in (0.0, 0.02):
        fallen = have_fallen(Robot(), np.array(poses)[:, TILT], ground_m)
        assert fallen.tolist() == [has_fallen(Robot(), row, ground_m) for row in poses]


@pytest.mark.parametrize(("z", "fallen"), [(0.16, True), (0.18, False)])
def test_an_elongated_torso_lies_by_its_lowest_corner(z: float, fallen: bool) -> None:
    """Tilted by 90° about its width it stands on an end, 15 cm below its centre."""
    long = Robot(torso_length_m=0.3, torso_width_m=0.1)
    on_its_end, on_its_side = pose(z, tilt_deg=90), [0, 0, z - 0.1, 0.5**0.5, 0, 0.5**0.5, 0]

    assert has_fallen(long, on_its_end, ground_m=0.01) == fallen
    assert has_fallen(long, on_its_side, ground_m=0.01) == fallen
    flags = have_fallen(long, np.array([on_its_end, on_its_side])[:, TILT], ground_m=0.01)
    assert flags.tolist() == [fallen, fallen]


def test_bumps_are_ground_too() -> None:
    assert not has_fallen(Robot(), pose(0.035))
    assert has_fallen(Robot(), pose(0.035), ground_m=0.02)


@pytest.mark.parametrize(
    ("start", "end", "turned"), [(0, 30, 30), (90, 60, -30), (170, -170, 20), (0, 180, -180)]
)
def test_the_heading_is_what_it_turned_to_the_left(start: float, end: float, turned: float) -> None:
    heading = heading_deg(pose(0.1, yaw_deg=end), pose(0.1, yaw_deg=start))
    assert heading == pytest.approx(turned)
