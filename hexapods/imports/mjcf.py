"""Clean an MJCF document: keep what describes a body, and drop or refuse all other elements.

The elements and attributes that stay are listed: what MuJoCo adds in another version, or a plugin,
gets through only if it is added here.
"""

import math
import posixpath
from collections.abc import Iterable

from hexapods.domain.errors import DamagedFile
from hexapods.domain.text import counted
from hexapods.imports.documents.upload import last_part
from hexapods.imports.documents.xml import MAX_NAME, Element, check_kept
from hexapods.imports.meshes.mesh_files import MeshFiles
from hexapods.imports.notes import Notes, listed, quoted

MAX_BODIES, MAX_JOINTS, MAX_GEOMS = 300, 300, 2000
_MAX_NUMBER = 1e12
_MAX_NAMES = 100
"""Names that a note is about."""
_REFUSED = {
    "replicate": "copies by <replicate> are not made: write the bodies themselves",
    "composite": "a robot here is made of rigid bodies, not of <composite>",
    "flexcomp": "a robot here is made of rigid bodies, not of <flexcomp>",
    "flex": "a robot here is made of rigid bodies, not of <flex>",
    "plugin": "plugins are not loaded: leave it out",
    "extension": "plugins are not loaded: leave it out",
    "attach": "other files are not attached: merge them into this one",
    "model": "other files are not attached: merge them into this one",
}
_DROPPED_TYPES = ("plane", "hfield", "sdf")
"""Types of geoms that are left out: they are the ground, not the robot."""
_ACTUATORS = ("motor", "position", "velocity", "intvelocity", "general", "damper", "cylinder")
_KEPT: dict[str, frozenset[str]] = {
    "mujoco": frozenset({"compiler", "default", "asset", "worldbody", "actuator", "keyframe"}),
    "worldbody": frozenset({"body", "frame"}),
    "body": frozenset({"body", "frame", "inertial", "joint", "freejoint", "geom", "site"}),
    "frame": frozenset({"body", "frame", "joint", "freejoint", "geom", "site"}),
    "asset": frozenset({"mesh"}),
    "default": frozenset({"default", "joint", "geom", "site", "mesh", *_ACTUATORS}),
    "actuator": frozenset(_ACTUATORS),
    "keyframe": frozenset({"key"}),
}
"""Tags of the children that stay, by tag of the parent; of other parents no child stays."""


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_ACTUATOR = _words(
    "name class joint gear ctrlrange forcerange ctrllimited forcelimited kp gaintype biastype "
    "gainprm biasprm"
)
_TURNED = _words("quat axisangle xyaxes zaxis euler")
_PLACED = frozenset({"name", "class", "pos", *_TURNED})
_ATTRIBUTES: dict[str, frozenset[str]] = {
    "mujoco": frozenset({"model"}),
    "compiler": _words(
        "autolimits boundmass boundinertia settotalmass balanceinertia angle fitaabb eulerseq "
        "coordinate inertiafromgeom inertiagrouprange"
    ),
    "default": frozenset({"class"}),
    "body": _PLACED | {"childclass"},
    "frame": _PLACED | {"childclass"},
    "inertial": _TURNED | {"pos", "mass", "diaginertia", "fullinertia"},
    "joint": _words(
        "name class type pos axis limited range ref damping armature frictionloss "
        "actuatorfrclimited actuatorfrcrange"
    ),
    "freejoint": frozenset({"name"}),
    "geom": _PLACED
    | _words("type size fromto contype conaffinity group mass density shellinertia mesh fitscale"),
    "site": _PLACED | {"type", "size", "fromto"},
    "mesh": _words("name class file vertex face scale refpos refquat inertia smoothnormal"),
    "key": frozenset({"name", "qpos"}),
    **dict.fromkeys(_ACTUATORS, _ACTUATOR),
}
_TEXTS = _words(
    "name class childclass model mesh joint file type angle eulerseq coordinate autolimits limited "
    "actuatorfrclimited balanceinertia fitaabb inertiafromgeom shellinertia inertia smoothnormal "
    "ctrllimited forcelimited gaintype biastype"
)
"""Attributes that are no numbers."""


def clean_mjcf(root: Element, meshes: MeshFiles, notes: Notes) -> None:
    """Remove elements that do not describe a body from an MJCF document; add meshes to `meshes`.

    Raises:
        DamagedFile: if it has elements that are refused, or too many elements.
    """
    for element in root.all(*_REFUSED):
        if element.tag == "model" and "file" not in element.attributes:
            continue
        raise DamagedFile(f"{element.place}: {_REFUSED[element.tag]}")
    _tell_of_mechanisms(root, notes)
    _drop_other_actuators(root, notes)
    folder, strips = _mesh_folder(root)
    _keep_known(root)
    check_kept(root)
    _check_counts(root)
    _resolve_meshes(root, folder, strips, meshes)
    compiler = Element("compiler", root.line, {"usethread": "false"})
    root.children.insert(0, compiler)


def _tell_of_mechanisms(root: Element, notes: Notes) -> None:
    """Tell of tendons, equality constraints and springs of joints, which are left out."""
    springs = [joint for joint in root.all("joint") if _has_spring(joint)]
    if springs:
        joints = _names(springs, "name", "class")
        notes.repair(
            "joints",
            f"springs of joints are left out: {listed(joints) or 'those by default'}",
            parts=joints,
        )
    mechanisms = [
        element for section in root if section.tag in ("equality", "tendon") for element in section
    ]
    coupled = [element for element in mechanisms if element.tag == "joint"]
    connecting = [element for element in mechanisms if element.tag != "joint"]
    if coupled:
        joints = _names(coupled, "joint1", "joint2")
        notes.repair(
            "joints",
            f"equality constraints of joints are not followed, each joint has a servo of its own: "
            f"{listed(joints)}",
            parts=joints,
        )
    if connecting:
        tags = sorted({element.tag for element in connecting})
        jointed = [joint for element in connecting for joint in element]
        notes.repair(
            "joints",
            f"left out what connects bodies beside joints ({', '.join(map(quoted, tags))}): "
            "each joint gets a servo of its own",
            parts=[*_names(connecting, "body1", "body2"), *_names(jointed, "joint")],
        )


def _has_spring(joint: Element) -> bool:
    return any(word.strip("0.") for word in joint.attributes.get("stiffness", "").split())


def _names(elements: Iterable[Element], *attributes: str) -> list[str]:
    """Return what some attributes of elements name, each name once; of very many the first."""
    names = [element.attributes.get(name, "") for element in elements for name in attributes]
    return list(dict.fromkeys(name for name in names if 0 < len(name) <= MAX_NAME))[:_MAX_NAMES]


def _drop_other_actuators(root: Element, notes: Notes) -> None:
    """Remove actuators that act on no joint: what they act on is left out, or no servo can do."""
    dropped: list[Element] = []
    for section in root:
        if section.tag != "actuator":
            continue
        for actuator in section:
            # For hinges the same; it differs for balls and free joints.
            joint = actuator.attributes.pop("jointinparent", None)
            if joint is not None:
                actuator.attributes.setdefault("joint", joint)
        kept = [
            actuator
            for actuator in section
            if actuator.tag in _ACTUATORS and "joint" in actuator.attributes
        ]
        dropped += [actuator for actuator in section if actuator not in kept]
        section.children = kept
    if dropped:
        names = [actuator.attributes.get("name", f"<{actuator.tag}>") for actuator in dropped]
        notes.repair(
            "servos",
            f"left out {counted(len(dropped), 'actuator')} that no servo of a joint can replace "
            f"(of a tendon, a site or a body, or muscles): {listed(names)}",
            parts=_names(dropped, "joint", "body"),
        )


def _mesh_folder(root: Element) -> tuple[str, bool]:
    """Return the folder of meshes beside the document, and whether their paths are cut off."""
    folder, strips = "", False
    for compiler in root.all("compiler"):
        folder = compiler.attributes.get("assetdir", folder)
        folder = compiler.attributes.get("meshdir", folder)
        strips = compiler.attributes.get("strippath", str(strips)).lower() == "true"
    return folder, strips


def _keep_known(root: Element) -> None:
    for parent in [root, *root.all()]:
        kept_tags = _KEPT.get(parent.tag, frozenset())
        parent.children = [
            child for child in parent.children if child.tag in kept_tags and _stays(child)
        ]
        attributes = _ATTRIBUTES.get(parent.tag, frozenset())
        parent.attributes = {n: v for n, v in parent.attributes.items() if n in attributes}
    for element in [root, *root.all()]:
        check_numbers(element, _TEXTS)


def _stays(element: Element) -> bool:
    if element.tag in ("geom", "site"):
        return element.attributes.get("type") not in _DROPPED_TYPES
    return True


def check_numbers(element: Element, texts: frozenset[str]) -> None:
    """Check that the numbers in an element's attributes are finite, and not absurdly large.

    Args:
        element: the element.
        texts: names of attributes that are no numbers.

    Raises:
        DamagedFile: naming the element.
    """
    for name, value in element.attributes.items():
        if name in texts:
            continue
        for word in value.split():
            try:
                number = float(word)
            except ValueError as error:
                raise DamagedFile(
                    f"{element.place}: {name} must be numbers, not {quoted(word)!r}"
                ) from error
            if not (math.isfinite(number) and abs(number) <= _MAX_NUMBER):
                raise DamagedFile(
                    f"{element.place}: {name} must be finite numbers, not {quoted(word)}"
                )


def _check_counts(root: Element) -> None:
    for tag, most in (("body", MAX_BODIES), ("joint", MAX_JOINTS), ("geom", MAX_GEOMS)):
        count = sum(1 for _ in root.all(tag))
        if count > most:
            raise DamagedFile(f"it has {count:,} elements <{tag}>; a robot has at most {most:,}")


def _resolve_meshes(root: Element, folder: str, strips: bool, meshes: MeshFiles) -> None:
    """Give meshes their names in the assets, and remove those that are missing."""

    def path_of(mesh: Element) -> str:
        path = mesh.attributes["file"]
        return posixpath.join(folder, last_part(path) if strips else path)

    meshes.expect(path_of(mesh) for mesh in root.all("mesh") if "file" in mesh.attributes)
    for asset in root.all("asset"):
        present = []
        for mesh in asset:
            wanted = mesh.attributes.get("file")
            if wanted is not None:
                stem = posixpath.splitext(last_part(wanted))[0]
                mesh.attributes.setdefault("name", stem)
                name = meshes.add(path_of(mesh), is_copied=True)
                if name is None:
                    continue
                mesh.attributes["file"] = name
            present.append(mesh)
        asset.children = present
