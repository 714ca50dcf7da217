"""Ghost of a robot that stands in a state: each group of legs in a cell of its foot grid."""

import viser

from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.types import Cells, FloatArray
from hexapods.domain.world import World
from hexapods.drawing.footgrid import ABOVE_GROUND_M
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.robots import Robots
from hexapods.shows.stage_frame import LaneFrame, SceneSpec


def posture(spec: SceneSpec, cells: Cells) -> FloatArray:
    """Return the qpos of the robot in a state, in the frame of its foot grid, (7 + joints,).

    Raises:
        InvalidInput: if that is not one cell of the grid for each group.
        Unreachable: if a cell of the grid is out of a leg's reach.
    """
    simulator = KinematicSimulator(spec.robot, spec.gait, spec.grid)
    pose = simulator.pose(simulator.standing(cells))
    pose[2] -= ABOVE_GROUND_M
    return pose


def draw_posture(
    server: viser.ViserServer, root: str, spec: SceneSpec, cells: Cells, conditions: World
) -> None:
    """Draw the ghost under a node of its own in that of a foot grid.

    Args:
        server: where to draw.
        root: scene node of the ghost, a child of the grid's.
        spec: the scene, with the robot's lane only.
        cells: the cell of each group.
        conditions: what holds for the robot, a result of `World.as_of`.

    Raises:
        InvalidInput, Unreachable: see `posture`.
    """
    qpos = posture(spec, cells)
    server.scene.add_frame(root, show_axes=False)
    # It stands about where the robot does, whose shadows are there.
    mesh = RobotMesh(spec.robot)
    ghost = Robots(server, root, spec, mesh, [0.0], is_ghost=True, has_shadows=False)
    ghost.draw([LaneFrame(qpos, 0, 0, 0.0, conditions=conditions)])
