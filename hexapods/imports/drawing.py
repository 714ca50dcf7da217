"""Drawn shape of a robot: its own meshes, merged for each link and simplified."""

from collections.abc import Mapping, Sequence
from itertools import chain

import numpy as np

from hexapods.domain.robot_model import MAX_TRIANGLES, ModelMesh
from hexapods.domain.text import counted
from hexapods.domain.types import FloatArray
from hexapods.imports.compiling import Compiled
from hexapods.imports.meshes.decimation import cluster
from hexapods.imports.notes import Notes
from hexapods.imports.posed_robot import PosedRobot
from hexapods.imports.surfaces import Triangles

_AIM = 0.7
"""Triangles that are aimed at, as a share of the most."""
MAX_BASE64 = 1_500_000
"""Characters of all meshes together."""
_LEAST = 60
"""Triangles of a shape, however many there are."""


def find_meshes(
    posed: PosedRobot, origins: Mapping[int | None, FloatArray], notes: Notes
) -> dict[int | None, ModelMesh]:
    """Return the drawn mesh of each link in its frame; links without shapes are left out.

    Args:
        posed: the robot.
        origins: origins of the links' frames in the body frame, by joint; None for the torso.
        notes: collects a note on simplified meshes.
    """
    geoms = {joint: _drawn(posed, joint) for joint in origins}
    all_geoms = chain.from_iterable(geoms.values())
    before = sum(posed.triangles(geom) for geom in all_geoms)  # whole numbers
    aim = _AIM * MAX_TRIANGLES
    while True:
        simplified = _Simplified(posed, min(1.0, aim / max(before, 1)))
        meshes = {
            joint: merged
            for joint, parts in geoms.items()
            if (merged := merged_mesh([simplified.surface(geom) for geom in parts], origins[joint]))
        }
        triangles = sum(mesh.triangles for mesh in meshes.values())
        size = sum(len(mesh.vertices) + len(mesh.faces) for mesh in meshes.values())
        if (triangles <= MAX_TRIANGLES and size <= MAX_BASE64) or aim < _LEAST:
            break
        aim *= 0.7
    if triangles < 0.9 * before:
        notes.repair(
            "meshes",
            f"what is drawn was simplified from {before:,} to {counted(triangles, 'triangle')}",
        )
    return meshes


def _drawn(posed: PosedRobot, joint: int | None) -> list[int]:
    bodies = [body for body in posed.bodies_of(joint) if body not in posed.skeleton.hidden]
    return [geom for body in bodies for geom in drawn_geoms(posed.compiled, body)]


def drawn_geoms(compiled: Compiled, body: int) -> list[int]:
    """Return the geoms that are drawn of a body: those that do not collide.

    Of a body that has no such geoms, or of which a mesh is missing, all geoms are drawn.
    """
    start, count = int(compiled.model.body_geomadr[body]), int(compiled.model.body_geomnum[body])
    geoms = [*range(start, start + count)]
    if compiled.body_name(body) in compiled.undrawn:
        return geoms
    return [geom for geom in geoms if not compiled.collides[geom]] or geoms


class _Simplified:
    """Surfaces with a share of their triangles; the same mesh is simplified once."""

    def __init__(self, posed: PosedRobot, share: float) -> None:
        self._posed, self._share = posed, share
        self._known: dict[int, Triangles] = {}

    def surface(self, geom: int) -> Triangles:
        """Return the surface of a geom in the body frame."""
        key = self._posed.mesh_of(geom)
        if key is None:
            return self._posed.surface(geom)
        if key not in self._known:
            vertices, faces = self._posed.own_surface(geom)
            most = max(int(self._share * len(faces)), _LEAST)
            self._known[key] = cluster(vertices, faces, most)
        return self._posed.placed(geom, self._known[key])


def merged_mesh(parts: Sequence[Triangles], origin: FloatArray) -> ModelMesh | None:
    """Return several surfaces as one mesh, relative to an origin; None if nothing is left."""
    all_vertices, all_faces, start = [], [], 0
    for vertices, faces in parts:
        if len(faces) and np.isfinite(vertices).all():
            all_vertices.append(vertices - origin)
            all_faces.append(faces + start)
            start += len(vertices)
    if not start:
        return None
    return ModelMesh.of(np.concatenate(all_vertices), np.concatenate(all_faces))
