"""All robots on stage: one batched mesh per distinct shape, across lanes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.stage.stage_frame import SceneSpec, StageFrame
from app.viewer.colormap import Rgb, batch_colors, mix, rgb
from app.viewer.robot_mesh import RobotMesh

_DARK: Rgb = (88, 96, 110)
_SHADE = 0.25


class Robots:
    """The robots of a scene, each on its lane.

    Args:
        server: where to draw.
        root: scene node of the robots.
        spec: the scene.
        mesh: the robot.
        xs: centres of the lanes [m].
    """

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        spec: SceneSpec,
        mesh: RobotMesh,
        xs: Sequence[float],
    ) -> None:
        self._mesh, self._xs = mesh, xs
        self._poses: list[NDArray[np.floating[Any]]] = [mesh.default_qpos for _ in xs]
        self._body_poses = [mesh.body_poses(mesh.default_qpos).moved(x) for x in xs]
        self._batches: list[viser.BatchedMeshHandle] = []
        for number, part in enumerate(mesh.parts):
            colors = [_color(lane_spec.color, part.painted) for lane_spec in spec.lane_specs]
            positions, wxyzs = self._instances(number)
            handle = server.scene.add_batched_meshes_simple(
                f"{root}/{number}",
                part.shape.vertices,
                part.shape.faces,
                batched_positions=positions,
                batched_wxyzs=wxyzs,
                batched_colors=batch_colors(np.repeat(np.array(colors), len(part.links), axis=0)),
                lod="off",
                receive_shadow=False,
            )
            self._batches.append(handle)

    def draw(self, frame: StageFrame) -> bool:
        """Update the poses from a frame; True if any changed."""
        moved = False
        for lane, (view, x) in enumerate(zip(frame.lanes, self._xs, strict=True)):
            if not np.array_equal(view.qpos, self._poses[lane]):
                self._poses[lane], moved = view.qpos, True
                self._body_poses[lane] = self._mesh.body_poses(view.qpos).moved(x)
        if moved:
            for number, batch in enumerate(self._batches):
                batch.batched_positions, batch.batched_wxyzs = self._instances(number)
        return moved

    def _instances(self, part: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return positions (lanes · links, 3) [m] and quaternions wxyz (lanes · links, 4)."""
        links = self._mesh.parts[part].links
        positions = np.concatenate([body_poses.positions[links] for body_poses in self._body_poses])
        wxyzs = np.concatenate([body_poses.rotations[links] for body_poses in self._body_poses])
        return positions.astype(np.float32), wxyzs.astype(np.float32)


def _color(color: str, painted: bool) -> Rgb:
    return rgb(color) if painted else mix(_DARK, rgb(color), _SHADE)
