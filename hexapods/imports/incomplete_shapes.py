"""Removes shapes that MuJoCo cannot compile: of size 0, or of a mesh that is not there.

The mass that a removed shape has in the file stays with its body.
"""

import math
from collections.abc import Collection, Iterator

import mujoco
import numpy as np

from hexapods.domain.types import FloatArray
from hexapods.imports.notes import Notes, listed

_DENSITY = 1000.0
"""Density of the ball whose inertia a mass without a shape gets [kg/m³]."""
_LEAST_M = 1e-9
_SITE_M = 0.005
"""Size of a site for which the file gives none, MuJoCo's default."""
_GEOM = mujoco.mjtGeom
_SIZES = {
    int(_GEOM.mjGEOM_SPHERE): 1,
    int(_GEOM.mjGEOM_CAPSULE): 2,
    int(_GEOM.mjGEOM_CYLINDER): 2,
    int(_GEOM.mjGEOM_ELLIPSOID): 3,
    int(_GEOM.mjGEOM_BOX): 3,
}
"""Numbers in the size of a primitive."""


def drop_sizeless_shapes(spec: mujoco.MjSpec, notes: Notes) -> None:
    """Remove primitives of size 0; a capsule of length 0 becomes a ball."""
    bodies: list[str] = []
    for geom in list(spec.geoms):
        if int(geom.type) not in _SIZES or geom.meshname or _has_size(geom):
            continue
        if int(geom.type) == int(_GEOM.mjGEOM_CAPSULE) and geom.size[0] > 0:
            _make_ball(geom)
            continue
        bodies.append(geom.parent.name)
        _remove(spec, geom)
    if bodies:
        names = list(dict.fromkeys(bodies))
        notes.repair("shapes", f"shapes of size 0 were left out, of: {listed(names)}", parts=names)
    for site in spec.sites:
        if int(site.type) in _SIZES and not _has_size(site):
            site.type, site.size = _GEOM.mjGEOM_SPHERE, np.full(3, _SITE_M)
            site.fromto = np.full(6, np.nan)


def drop_shapes_of_missing_meshes(spec: mujoco.MjSpec) -> frozenset[str]:
    """Remove the geoms whose mesh the model does not have, and return the names of their bodies."""
    present = {mesh.name for mesh in spec.meshes}
    bodies = set()
    for geom in list(spec.geoms):
        if geom.meshname and geom.meshname not in present:
            bodies.add(geom.parent.name)
            _remove(spec, geom)
    return frozenset(bodies)


def tell_of_bare_ends(spec: mujoco.MjSpec, undrawn: Collection[str], notes: Notes) -> None:
    """Tell of last links of which nothing is left without their mesh: how long they are."""
    names = [
        body.name
        for body in spec.bodies
        if body.name in undrawn and list(body.joints) and not [*body.bodies, *body.geoms]
    ]
    if names:
        notes.guess(
            "legs",
            "without the missing meshes it is not known how long the last links are, and feet are "
            f"at their joints: {listed(names)}",
            parts=names,
        )


def _has_size(shape: mujoco.MjsGeom | mujoco.MjsSite) -> bool:
    """Return whether a primitive has a size; one between two points needs only its thickness."""
    needed = _SIZES[int(shape.type)]
    ends = np.array(shape.fromto)
    if np.isfinite(ends).all() and needed > 1:
        return bool(shape.size[0] > 0 and np.linalg.norm(ends[3:] - ends[:3]) > _LEAST_M)
    return bool((np.array(shape.size[:needed]) > 0).all())


def _make_ball(geom: mujoco.MjsGeom) -> None:
    if np.isfinite(geom.fromto[0]):
        geom.pos = np.array(geom.fromto[:3])
        geom.fromto = np.full(6, np.nan)
    geom.type = _GEOM.mjGEOM_SPHERE


def _remove(spec: mujoco.MjSpec, geom: mujoco.MjsGeom) -> None:
    """Remove a geom; if the masses are those of geoms, its own stays with the body."""
    body, kg, at_m = geom.parent, float(geom.mass), np.array(geom.pos)
    rule = int(spec.compiler.inertiafromgeom)
    from_geoms = rule == int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE) or (
        rule == int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO) and not body.explicitinertial
    )
    spec.delete(geom)
    if not (from_geoms and math.isfinite(kg) and kg > 0):
        return
    if not at_m.any():
        at_m = _middle(spec, body)
    # Lists of a body raise the error of a compilation that failed; those of the model do not.
    has_shapes = any(other.parent.name == body.name for other in spec.geoms)
    if not has_shapes and not body.explicitinertial:
        _give_mass(body, kg, at_m)
        return
    names = {other.name for other in spec.bodies}
    _give_mass(body.add_body(name=next(_free_names(f"mass of {body.name}", names))), kg, at_m)


def _middle(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> FloatArray:
    """Return the middle between the origin of a body and those of its children, in its frame."""
    children = [np.array(child.pos) for child in spec.bodies[1:] if child.parent.name == body.name]
    return np.mean(children, axis=0) / 2 if children else np.zeros(3)


def _give_mass(body: mujoco.MjsBody, kg: float, at_m: FloatArray) -> None:
    """Give a body the mass and inertia of a ball."""
    radius_m = (3 * kg / (4 * math.pi * _DENSITY)) ** (1 / 3)
    body.explicitinertial = True
    body.mass, body.ipos = kg, at_m
    body.inertia = np.full(3, 0.4 * kg * radius_m**2)


def _free_names(name: str, used: Collection[str]) -> Iterator[str]:
    while True:
        if name not in used:
            yield name
        name += "'"
