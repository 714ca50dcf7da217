"""All robots on stage: one batched mesh for each distinct shape, across lanes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.stage.stage_frame import SceneSpec, StageFrame
from app.viewer.colormap import Rgb, batched, mixed, rgb
from app.viewer.robot_mesh import RobotMesh

_DARK: Rgb = (88, 96, 110)
_SHADE = 0.25


class Robots:
    """Draws the robots of a cast, each on its lane."""

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        spec: SceneSpec,
        mesh: RobotMesh,
        xs: Sequence[float],
    ) -> None:
        self._mesh, self._xs = mesh, xs
        self._poses: list[NDArray[np.floating[Any]]] = [mesh.standing for _ in xs]
        self._placed = [mesh.place(mesh.standing).moved(x) for x in xs]
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
                batched_colors=batched(np.repeat(np.array(colors), len(part.links), axis=0)),
                lod="off",
                receive_shadow=False,
            )
            self._batches.append(handle)

    def draw(self, frame: StageFrame) -> bool:
        """Take the poses of a frame; whether any is another than before."""
        moved = False
        for lane, (view, x) in enumerate(zip(frame.lanes, self._xs, strict=True)):
            if not np.array_equal(view.qpos, self._poses[lane]):
                self._poses[lane], moved = view.qpos, True
                self._placed[lane] = self._mesh.place(view.qpos).moved(x)
        if moved:
            for number, batch in enumerate(self._batches):
                batch.batched_positions, batch.batched_wxyzs = self._instances(number)
        return moved

    def _instances(self, part: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(lanes · links, 3) and (lanes · links, 4)."""
        links = self._mesh.parts[part].links
        positions = np.concatenate([placed.places[links] for placed in self._placed])
        wxyzs = np.concatenate([placed.attitudes[links] for placed in self._placed])
        return positions.astype(np.float32), wxyzs.astype(np.float32)


def _color(color: str, painted: bool) -> Rgb:
    return rgb(color) if painted else mixed(_DARK, rgb(color), _SHADE)
