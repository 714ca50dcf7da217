"""Robots that were read from files walk."""

import pytest

import hexapods as hx
from hexapods.domain.model_robot import model_robot
from hexapods.domain.suggestions import usual_grid_side_m
from tests.imports.robots import HOME, bug, dog, read

STEPS = 20


@pytest.mark.test
@pytest.mark.parametrize(
    "text", [dog(keyframes={"home": HOME}), dog(), bug()], ids=["keyframe", "searched", "URDF"]
)
def test_greedy_walks_as_far_as_two_groups_do(text: str) -> None:
    imported = read(text)
    robot = model_robot(imported.model, imported.name)
    side_m = usual_grid_side_m(robot, imported.gait)

    race = hx.race(["greedy"], robot=robot, gait=imported.gait, grid_side_m=side_m, steps=STEPS)

    # By the law an advance of a third of the side a step.
    by_law_m = STEPS * side_m / 3
    assert race.standings[0].total_distance_m == pytest.approx(by_law_m, rel=0.25)
