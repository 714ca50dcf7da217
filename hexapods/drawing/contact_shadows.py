"""Soft shadows where robots are near the ground: a dark disc under each torso and each foot.

They take the place of a shadow map, which costs a machine without a GPU a third of its pictures.
"""

from functools import cache

import numpy as np
import viser
from numpy.typing import NDArray

from hexapods.domain.types import FloatArray
from hexapods.drawing.glb import unlit_glb
from hexapods.drawing.shapes import Shape

SHADOWS, GHOST_SHADOWS = "shadows", "ghost-shadows"
"""Names of the nodes of shadows, below those of robots; by them `static/viewer/shadows.js` finds
what to move, and `static/viewer/light.js` how dark they are in a theme."""
TORSO_REACH = 1.9
"""Radius of the shadow of a torso, which fades out, relative to the torso's."""
ABOVE_M = 0.0062
"""Height of a shadow over the ground [m]: above lines, marks and the cells of foot grids."""
_RINGS, _CORNERS = 5, 24


def add_shadows(
    server: viser.ViserServer, name: str, positions: FloatArray, radii: FloatArray
) -> viser.BatchedGlbHandle:
    """Add shadows that lie flat.

    Args:
        server: where to draw.
        name: of their scene node.
        positions: their centres, (n, 3) [m].
        radii: across and along, (n, 2) [m]; those of 0 are hidden.
    """
    scales = np.column_stack([radii, np.ones(len(radii))])
    return server.scene.add_batched_glb(
        name,
        # As an array, so that it is sent as bytes, and once for all that are equal.
        _disc(),  # type: ignore[arg-type]
        batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (len(positions), 1)),
        batched_positions=positions,
        batched_scales=scales,
        lod="off",
    )


def add_robot_shadows(
    server: viser.ViserServer, root: str, robots: int, legs: int, *, is_ghost: bool
) -> None:
    """Add the shadows of robots, of each its torso's and then those of its legs.

    They are hidden until a page moves them: it has the poses of all links, so that frames need not
    say where shadows are.
    """
    count = robots * (1 + legs)
    name = f"{root}/{GHOST_SHADOWS if is_ghost else SHADOWS}"
    add_shadows(server, name, np.zeros((count, 3)), np.zeros((count, 2)))


@cache
def _disc() -> NDArray[np.uint8]:
    """Return a black disc of radius 1 in the plane z = 0, whose opacity is (1 - r²)²."""
    angles = 2 * np.pi * np.arange(_CORNERS) / _CORNERS
    circle = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    shares = np.arange(1, _RINGS + 1) / _RINGS
    vertices = np.concatenate([np.zeros((1, 3)), *(share * circle for share in shares)])
    index = np.arange(_CORNERS)
    after = (index + 1) % _CORNERS
    faces = [np.stack([0 * index, 1 + index, 1 + after], axis=1)]
    for ring in range(1, _RINGS):
        inner, outer = 1 + (ring - 1) * _CORNERS, 1 + ring * _CORNERS
        faces.append(np.stack([inner + index, outer + index, outer + after], axis=1))
        faces.append(np.stack([inner + index, outer + after, inner + after], axis=1))
    shape = Shape(vertices.astype(np.float32), np.concatenate(faces).astype(np.uint32))
    radii = np.linalg.norm(vertices, axis=1)
    return unlit_glb(shape, np.zeros(3, np.uint8), np.clip(1 - radii**2, 0, 1) ** 2)
