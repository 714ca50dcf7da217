"""Build tolerance: robots as they were built."""

from dataclasses import asdict

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import RANGES, Robot, as_mapping, robot
from hexapods.domain.tolerance import MAX_TOLERANCE, VARIED, build_tolerance


def built(share: float, seed: int = 0, design: Robot | None = None) -> Robot:
    return build_tolerance(design or Robot(), share, np.random.default_rng(seed))


def test_built_robot_differs_by_up_to_the_share() -> None:
    design, built_robot = Robot(), built(0.03)
    deviations = [getattr(built_robot, name) / getattr(design, name) - 1 for name in VARIED]
    angles = [a - b for a, b in zip(built_robot.azimuths_deg, design.azimuths_deg, strict=True)]

    assert all(0 < abs(deviation) <= 0.03 for deviation in deviations)
    assert all(0 < abs(angle) <= 0.03 * 60 for angle in angles)  # legs stand 60° apart
    assert len({*deviations, *(angle / 60 for angle in angles)}) == len(VARIED) + 6


def test_parameters_that_are_not_varied_are_as_designed() -> None:
    design, built_fields = asdict(Robot()), asdict(built(0.2))
    same = {name for name, value in built_fields.items() if value == design[name]}

    assert same == set(design) - {*VARIED, "legs"}


def test_a_seed_draws_one_robot() -> None:
    assert built(0.03, seed=7) == built(0.03, seed=7) != built(0.03, seed=8)


def test_a_larger_share_draws_the_same_deviations() -> None:
    small, large = built(0.05), built(0.1)

    assert large.femur_m - Robot().femur_m == pytest.approx(2 * (small.femur_m - Robot().femur_m))


def test_no_tolerance_is_the_robot_itself() -> None:
    assert built(0.0) == Robot()


def test_values_stay_in_their_ranges() -> None:
    design = robot({"friction": 5.0, "foot_kg": 0.001, "servo_kp": 1000.0})
    for seed in range(20):
        built_robot = built(MAX_TOLERANCE, seed, design)
        for name in VARIED:
            low, high = RANGES[name]
            assert low <= getattr(built_robot, name) <= high
        as_mapping(built_robot)  # is still a preset and what differs from it


@pytest.mark.parametrize("share", [-0.01, 0.21, float("nan")])
def test_share_out_of_range_is_refused(share: float) -> None:
    with pytest.raises(InvalidInput, match=r"from 0 to 0\.2"):
        built(share)
