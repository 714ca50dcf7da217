import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.model_geometry import home_angles, leg_chains
from hexapods.imports.choices import Choices
from hexapods.imports.imported import ImportedRobot
from tests.imports.robots import HOME, bug, dog, read


def feet(robot: ImportedRobot) -> np.ndarray:
    """Return the feet at home, (legs, 3) [m]."""
    return np.array([chain.foot_m for chain in leg_chains(robot.model, home_angles(robot.model))])


@pytest.mark.parametrize("text", [dog(keyframes={"home": HOME}), bug()])
def test_a_robot_stands_at_each_height_that_is_possible(text: str) -> None:
    robot = read(text)
    assert robot.body_heights_m is not None
    low, high = robot.body_heights_m
    assert low < robot.body_height_m < high

    for height_m in (low, 0.4 * low + 0.6 * high, high):
        moved = read(text, choices=Choices(body_height_m=height_m))

        assert moved.body_height_m == pytest.approx(height_m, abs=1e-4)
        assert moved.body_heights_m == (low, high)
        assert feet(moved)[:, :2] == pytest.approx(feet(robot)[:, :2], abs=1e-3)


def test_another_height_is_refused_with_those_that_are_possible() -> None:
    robot = read(bug())
    assert robot.body_heights_m is not None
    low, high = robot.body_heights_m

    for height_m in (low - 0.01, high + 0.01):
        with pytest.raises(InvalidInput, match=f"must be from {low:g} to {high:g} m, not"):
            read(bug(), choices=Choices(body_height_m=height_m))


def test_angles_that_are_chosen_stay_at_another_height() -> None:
    choices = Choices(body_height_m=0.25, home_rad={"FL_thigh_joint": 0.5})
    robot = read(dog(keyframes={"home": HOME}), choices=choices)

    thighs = {
        leg.foot: robot.model.joints_of(number)[1].home_rad
        for number, leg in enumerate(robot.legs, start=1)
    }
    assert thighs["FL"] == 0.5
    assert thighs["FR"] == pytest.approx(thighs["RR"]) != 0.5
