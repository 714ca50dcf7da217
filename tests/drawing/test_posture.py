"""Ghosts in a state of the foot grid: where their feet stand, and what is left out or refused."""

from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.disturbances import Lost
from hexapods.domain.errors import InvalidInput, Unreachable
from hexapods.domain.gait import PAPER_GAITS, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import legs_of
from hexapods.domain.types import Cells
from hexapods.domain.world import World
from hexapods.drawing.footgrid import ABOVE_GROUND_M, FootGridDrawing
from hexapods.drawing.posture import posture
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.scene import grid_root
from hexapods.drawing.viser_internals.server import RecordedViser
from tests.drawing.drawn_scene import race_of, scene_nodes
from tests.drawing.replay_decoding import decoded
from tests.stage.stage_parts import StageParts
from tests.viewer.test_replay_frames import LANES, frames_of, shown

FAR = 0.2
"""Side of a foot grid that no leg can reach all of [m]."""


@pytest.mark.parametrize("gait", PAPER_GAITS)
@pytest.mark.parametrize(("divisions", "cells"), [(2, (0, 3, 1)), (2, (4, 4, 2)), (3, (8, 0, 5))])
def test_feet_of_a_ghost_stand_in_the_cells_that_are_drawn(
    server: RecordedViser, gait: str, divisions: int, cells: Cells
) -> None:
    spec = race_of(1)
    azimuths = [leg.azimuth_deg for leg in spec.robot.legs]
    grid = FootGrid(0.04, divisions)
    spec = replace(spec, grid=grid, gait=resolve(gait, azimuths))
    FootGridDrawing(server, "/world/grid", spec, 0.0)
    nodes, legs = scene_nodes(server), len(spec.robot.legs)
    home, other_cells = (
        nodes[f"/world/grid/{name}/fills"]["batched_positions"].reshape(legs, -1, 3)
        for name in ("home", "others")
    )
    drawn = np.concatenate([home, other_cells], axis=1)
    # So that the robot's forward direction is that of the grid's node.
    turn = np.radians(90 - spec.gait.forward_deg)
    pose = posture(spec, cells)
    (feet,) = legs_of(spec.robot).foot_positions(pose[None])

    assert 2 * np.arctan2(pose[6], pose[3]) == pytest.approx(turn)
    for pair, cell in zip(spec.gait.groups, cells, strict=True):
        for leg in pair:
            assert feet[leg - 1, :2] == pytest.approx(drawn[leg - 1, cell, :2], abs=1e-3)
    soles = feet[:, 2] - spec.robot.foot_radius_m
    assert soles == pytest.approx(-ABOVE_GROUND_M, abs=1e-3)


def test_a_ghost_is_drawn_in_the_grid_of_its_lane(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES), frames_of(parts)
    answer, arrays = decoded(frames.posture(run.id, "paper", 1.0, 1, (1, 2, 3)))
    (frame,) = answer["frames"]
    names = [message["name"] for message in frame["messages"]]
    spec = race_of(1)
    mesh = RobotMesh(spec.robot)

    assert names[0] == f"{grid_root(1)}/posture"
    assert all(f"{name}/".startswith(f"{names[0]}/") for name in names)
    state = shown(answer["frames"], arrays)
    opacities = {value for name, value in state.items() if name.endswith(" opacity")}
    assert opacities == {0.4}
    # The torso stands over the middle of the grid.
    for number, part in enumerate(mesh.parts):
        drawn = np.frombuffer(
            state[f"{names[0]}/{mesh.part_name(number, is_ghost=True)} batched_positions"],
            np.float32,
        )
        if len(part.links) == 1:
            assert drawn[:2] == pytest.approx(0, abs=1e-6)


def test_lost_legs_of_a_ghost_are_missing(parts: StageParts) -> None:
    world = World((Lost(legs=(2, 5), at_step=3),))
    run = parts.finished_race(("q-learning",), simulator="mujoco", steps=5, world=world)
    frames = frames_of(parts)

    hidden = []
    for time_s in (0.0, 1e9):
        answer, arrays = decoded(frames.posture(run.id, "paper", time_s, 0, (0, 0, 0)))
        scales = [
            np.frombuffer(value, np.float32)
            for name, value in shown(answer["frames"], arrays).items()
            if name.endswith(" batched_scales") and value is not None
        ]
        hidden.append(sum(int((scale == 0).sum()) for scale in scales))
    assert hidden[0] == 0
    assert hidden[1] >= 6, "three links of each of two legs"


@pytest.mark.parametrize(
    ("lane", "cells", "words"),
    [
        (0, (1, 2), "cells must be 3 numbers, one for each group of legs, not 2"),
        (0, (1, 2, 9), "each of the cells must be from 0 to 4, not 9"),
        (3, (1, 2, 3), "lane must be from 0 to 2, not 3"),
        (-1, (1, 2, 3), "lane must be from 0 to 2, not -1"),
    ],
)
def test_states_that_there_are_not_are_refused(
    parts: StageParts, lane: int, cells: Cells, words: str
) -> None:
    run = parts.finished_race(LANES)

    with pytest.raises(InvalidInput, match=words):
        frames_of(parts).posture(run.id, "paper", 1.0, lane, cells)


def test_a_state_out_of_reach_is_refused() -> None:
    with pytest.raises(Unreachable, match=r"leg 2 cannot reach cell .* choose a smaller"):
        posture(replace(race_of(1), grid=FootGrid(FAR)), (1, 2, 3))
