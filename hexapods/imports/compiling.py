"""Compile a cleaned document with MuJoCo, and repair what its compiler refuses."""

import re
from dataclasses import dataclass

import mujoco
import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.xml import Document
from hexapods.imports.incomplete_shapes import (
    drop_shapes_of_missing_meshes,
    drop_sizeless_shapes,
    tell_of_bare_ends,
)
from hexapods.imports.meshes.mesh_files import MeshFiles
from hexapods.imports.notes import Notes, listed, quoted
from hexapods.imports.units import rescale, rescale_keyframes, scale_meshes_in_millimetres

LEAST_KG, _LEAST_INERTIA = 1e-6, 1e-9
"""Mass and inertia of moving bodies for which the file gives none."""
_ATTEMPTS = 6
_LINE = re.compile(r"line (\d+)")
_ELEMENT_NAME = re.compile(r"Element name '([^']*)'")
_OF_MESH = re.compile(r"mesh|vert|face|volume|STL|OBJ", re.IGNORECASE)
"""Words in complaints about meshes."""
_EIGENVALUE_RATIO = 1e-9


@dataclass(frozen=True)
class Compiled:
    """A model as MuJoCo compiled it; each body, joint and geom has a name.

    Attributes:
        model: the `MjModel`; none of its geoms collides.
        collides: whether each geom collides in the file, (geoms,).
        named_geoms: names of geoms that have one in the file.
        undrawn: names of bodies of which a mesh is missing.
    """

    model: mujoco.MjModel
    collides: list[bool]
    named_geoms: frozenset[str]
    undrawn: frozenset[str]

    def body_name(self, body: int) -> str:
        """Return the name of a body."""
        name: str = self.model.body(body).name
        return name

    def joint_name(self, joint: int) -> str:
        """Return the name of a joint."""
        name: str = self.model.joint(joint).name
        return name

    def geom_name(self, geom: int) -> str:
        """Return the name of a geom."""
        name: str = self.model.geom(geom).name
        return name


def silence_mujoco() -> None:
    """Let MuJoCo neither print warnings nor write them to a file."""
    log = mujoco.MjLogConfig.get()
    log.logto_file = log.logto_console = False
    log.set()


def compile_document(
    document: Document, meshes: MeshFiles, notes: Notes, scale: float | None = None
) -> Compiled:
    """Compile a cleaned document.

    Args:
        document: the document.
        meshes: its meshes.
        notes: gets the repairs.
        scale: factor of all lengths.

    Raises:
        DamagedFile: if MuJoCo refuses it, naming element and line.
        MemoryError: if it takes too much memory.
    """
    try:
        spec = mujoco.MjSpec.from_string(document.text, assets=dict(meshes.assets))
    except ValueError as error:
        raise _refused(error, document) from error
    except RuntimeError as error:
        raise _out_of_memory(error) from error
    if scale is not None:
        rescale(spec, scale)
    _mend_inertias(spec, notes)
    named = frozenset(geom.name for geom in spec.geoms if geom.name)
    _name_all(spec)
    undrawn = {*meshes.undrawn, *drop_shapes_of_missing_meshes(spec)}
    scale_meshes_in_millimetres(spec, meshes.sides, notes)
    drop_sizeless_shapes(spec, notes)
    _spare_volumes(spec)
    collides = [geom.contype != 0 or geom.conaffinity != 0 for geom in spec.geoms]
    for geom in spec.geoms:
        # Then the convex hulls of meshes are not computed.
        geom.contype = geom.conaffinity = 0
    collides_by_name = {geom.name: does for geom, does in zip(spec.geoms, collides, strict=True)}
    while True:
        try:
            model = _compile(spec, document, notes)
            break
        except _UnreadableMesh as error:
            meshes.drop(error.file, error.why)
            undrawn |= drop_shapes_of_missing_meshes(spec)
    tell_of_bare_ends(spec, undrawn, notes)
    if scale is not None:
        rescale_keyframes(model, scale)
    return Compiled(
        model,
        [collides_by_name[model.geom(geom).name] for geom in range(model.ngeom)],
        named,
        frozenset(undrawn),
    )


def _compile(spec: mujoco.MjSpec, document: Document, notes: Notes) -> mujoco.MjModel:
    for _ in range(_ATTEMPTS):
        try:
            return spec.compile()
        except ValueError as error:
            if not _repaired(spec, str(error).lower(), notes):
                _delete_mesh(spec, error)
                raise _refused(error, document) from error
        except RuntimeError as error:
            raise _out_of_memory(error) from error
    raise DamagedFile("MuJoCo cannot compile it, even after several repairs")


def _repaired(spec: mujoco.MjSpec, problem: str, notes: Notes) -> bool:
    """Repair the cause of MuJoCo's error in the model; False if no repair is known."""
    if "mass and inertia of moving bodies" in problem and not spec.compiler.boundmass:
        # Which bodies these are, and what they get, is told where masses are guessed.
        spec.compiler.boundmass, spec.compiler.boundinertia = LEAST_KG, _LEAST_INERTIA
        return True
    if "balanceinertia" in problem and not spec.compiler.balanceinertia:
        spec.compiler.balanceinertia = True
        notes.repair(
            "masses", "inertias that no body can have (A + B < C) were replaced by their mean"
        )
        return True
    if "mesh" in problem and any(word in problem for word in ("volume", "orient", "inertia")):
        return _weigh_as_shells(spec, notes)
    if "key" in problem and "invalid" in problem and spec.keys:
        for key in list(spec.keys):
            spec.delete(key)
        notes.repair("stance", "keyframes do not fit the joints, and were left out")
        return True
    return False


class _UnreadableMesh(Exception):
    """A mesh that MuJoCo refuses, and that was deleted from the model."""

    def __init__(self, file: str, why: str) -> None:
        super().__init__(why)
        self.file, self.why = file, why


def _delete_mesh(spec: mujoco.MjSpec, error: ValueError) -> None:
    """Delete the mesh that MuJoCo complains about, if it is one.

    Raises:
        _UnreadableMesh: if it was one.
    """
    problem = str(error)
    name_match = _ELEMENT_NAME.search(problem)
    if name_match is None or not _OF_MESH.search(problem):
        return
    for mesh in spec.meshes:
        if mesh.name == name_match[1] and mesh.file:
            file = mesh.file
            spec.delete(mesh)
            raise _UnreadableMesh(file, _complaint(error))


_SHELL = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL


def _spare_volumes(spec: mujoco.MjSpec) -> None:
    """Let MuJoCo compute no volume of meshes on which no mass depends: they may be open or flat."""
    if int(spec.compiler.inertiafromgeom) == int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE):
        return
    weighed = {geom.meshname for geom in spec.geoms if not geom.parent.explicitinertial}
    if int(spec.compiler.inertiafromgeom) == int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE):
        weighed = set()
    for mesh in spec.meshes:
        if mesh.name not in weighed:
            mesh.inertia = _SHELL


def _weigh_as_shells(spec: mujoco.MjSpec, notes: Notes) -> bool:
    changed = [mesh for mesh in spec.meshes if mesh.inertia != _SHELL]
    for mesh in changed:
        mesh.inertia = _SHELL
    if changed:
        notes.repair(
            "masses", "some meshes enclose no volume: for the mass meshes count as thin shells"
        )
    return bool(changed)


def _mend_inertias(spec: mujoco.MjSpec, notes: Notes) -> None:
    """Replace inertias that are not positive by those of a ball of some size."""
    mended = []
    for body in spec.bodies:
        if not body.explicitinertial or not np.isfinite(body.mass):
            continue
        full, diagonal = np.array(body.fullinertia), np.array(body.inertia)
        if np.isfinite(full).all():
            xx, yy, zz, xy, xz, yz = full
            values = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            values = np.sort(diagonal)
        if body.mass == 0 and not np.any(values):
            body.explicitinertial = False  # it says that it has no mass
            continue
        if body.mass > 0 and values[0] > _EIGENVALUE_RATIO * max(values[-1], 1e-12):
            continue
        if body.mass <= 0:
            # As if it had no element <inertial>.
            body.explicitinertial = False
            body.mass = 0
        else:
            radius_m = 0.05
            body.fullinertia = np.full(6, np.nan)
            body.inertia = np.full(3, 0.4 * body.mass * radius_m**2)
        mended.append(body.name)
    if mended:
        notes.repair(
            "masses",
            f"the inertia of {listed(mended)} was not positive, and was replaced by that of a ball",
        )


def _name_all(spec: mujoco.MjSpec) -> None:
    """Give each body, joint and geom a name; those of the file stay."""
    for kind, elements in (("body", spec.bodies), ("joint", spec.joints), ("geom", spec.geoms)):
        used = {element.name for element in elements}
        for number, element in enumerate(elements):
            if not element.name:
                name = f"{kind} {number}"
                while name in used:
                    name += "'"
                element.name = name
                used.add(name)


def _refused(error: ValueError, document: Document) -> DamagedFile:
    """Return MuJoCo's complaint as a sentence, with the line of the original."""
    text = str(error)
    line_match, name_match = _LINE.search(text), _ELEMENT_NAME.search(text)
    line = document.original_line(int(line_match[1])) if line_match else None
    place = f" in line {line}" if line else ""
    name = f" ({quoted(name_match[1])})" if name_match and name_match[1] else ""
    return DamagedFile(f"MuJoCo refuses the file{place}{name}: {_complaint(error)}")


def _out_of_memory(error: RuntimeError) -> Exception:
    """Return what MuJoCo's error means: it calls each failed allocation unknown."""
    return MemoryError() if "unknown exception" in str(error).lower() else error


def _complaint(error: ValueError) -> str:
    """Return what MuJoCo says, in one line without the place."""
    text = str(error).split("\nElement", maxsplit=1)[0]
    line = " ".join(re.sub(r"^(XML )?Error: ?", "", text).strip().rstrip(".").split())
    return line if len(line) <= 200 else f"{line[:199]}…"
