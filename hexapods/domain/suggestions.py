"""Default size of the foot grid of a robot from a file, by the length and reach of its legs."""

from hexapods.domain.body import Robot
from hexapods.domain.errors import Unreachable
from hexapods.domain.gait import GaitSpec, resolve
from hexapods.domain.grid import MAX_SIDE_M, MIN_SIDE_M, FootGrid
from hexapods.domain.kinematics import check_reach
from hexapods.domain.model_geometry import home_angles, leg_chains
from hexapods.domain.model_robot import ModelRobot, leg_length_m

_GRID_SHARE = 0.2
"""Side of the grid of robots that walk well, relative to the distance of foot and first joint."""
_MARGIN = 1.25
"""Least ratio of a leg's reach to its grid."""
_SMALLER = 0.8
"""Factor by which the side is reduced until all legs reach the grid."""


def usual_grid_side_m(robot: Robot, gait: str | GaitSpec) -> float:
    """Return the side of a foot grid that all legs of a robot reach with a margin [m].

    It is proportional to the length of the legs of a robot from a file, and the paper's for any
    other robot; `MIN_SIDE_M` if the legs do not reach a larger one.
    """
    if not isinstance(robot, ModelRobot):
        return FootGrid.side_m
    chains = leg_chains(robot.model, home_angles(robot.model))
    side_m, resolved = _GRID_SHARE * leg_length_m(chains), resolve(gait, robot.azimuths_deg)
    while side_m > MIN_SIDE_M:
        try:
            if check_reach(robot, resolved, FootGrid(_MARGIN * side_m)) is None:
                return min(max(round(side_m, 3), MIN_SIDE_M), MAX_SIDE_M)
        except Unreachable:
            pass
        side_m *= _SMALLER
    return MIN_SIDE_M
