"""Clean a URDF document: keep what describes a body, and check that its links form one tree."""

from collections.abc import Sequence

from hexapods.domain.errors import DamagedFile
from hexapods.imports.mesh_files import MeshFiles
from hexapods.imports.mjcf import MAX_BODIES, MAX_GEOMS, check_numbers
from hexapods.imports.notes import listed, quoted
from hexapods.imports.xml import Element

_KEPT: dict[str, frozenset[str]] = {
    "robot": frozenset({"link", "joint"}),
    "link": frozenset({"inertial", "visual", "collision"}),
    "inertial": frozenset({"origin", "mass", "inertia"}),
    "visual": frozenset({"origin", "geometry"}),
    "collision": frozenset({"origin", "geometry"}),
    "geometry": frozenset({"box", "cylinder", "sphere", "capsule", "mesh"}),
    "joint": frozenset({"origin", "parent", "child", "axis", "limit", "dynamics"}),
}
_ATTRIBUTES: dict[str, frozenset[str]] = {
    "robot": frozenset({"name"}),
    "link": frozenset({"name"}),
    "origin": frozenset({"xyz", "rpy"}),
    "mass": frozenset({"value"}),
    "inertia": frozenset(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]),
    "box": frozenset({"size"}),
    "cylinder": frozenset({"radius", "length"}),
    "capsule": frozenset({"radius", "length"}),
    "sphere": frozenset({"radius"}),
    "mesh": frozenset({"filename", "scale"}),
    "joint": frozenset({"name", "type"}),
    "parent": frozenset({"link"}),
    "child": frozenset({"link"}),
    "axis": frozenset({"xyz"}),
    "limit": frozenset({"lower", "upper", "effort"}),
    "dynamics": frozenset({"damping"}),
}
_TEXTS = frozenset({"name", "filename", "type", "link"})
_JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_XACRO = "http://www.ros.org/wiki/xacro"


def check_expanded(root: Element) -> None:
    """Check that a document is no unexpanded xacro.

    Raises:
        DamagedFile: if the document is a xacro.
    """
    for element in [root, *root.all()]:
        is_macro = element.tag.startswith("xacro:")
        if is_macro or any("${" in value for value in element.attributes.values()):
            raise DamagedFile(
                f"{element.place} is xacro, which is not expanded here: run `xacro robot.xacro > "
                "robot.urdf`, and give the result"
            )


def clean_urdf(root: Element, meshes: MeshFiles) -> None:
    """Remove elements that do not describe a body from a URDF document; add meshes to `meshes`.

    Raises:
        DamagedFile: if its links are no tree, or it has too many links or shapes.
    """
    check_expanded(root)
    for parent in [root, *root.all()]:
        kept_tags = _KEPT.get(parent.tag, frozenset())
        parent.children = [child for child in parent.children if child.tag in kept_tags]
        attributes = _ATTRIBUTES.get(parent.tag, frozenset())
        parent.attributes = {n: v for n, v in parent.attributes.items() if n in attributes}
    for element in [root, *root.all()]:
        check_numbers(element, _TEXTS)
    _check_tree(root)
    _resolve_shapes(root, meshes)
    for joint in root.all("joint"):
        if joint.attributes.get("type") == "continuous":
            _drop_range(joint)
    root.attributes.setdefault("name", "robot")
    options = {
        "discardvisual": "false",
        "fusestatic": "false",
        # A link without <inertial> has no mass in URDF.
        "inertiafromgeom": "false",
        "strippath": "false",
        "usethread": "false",
    }
    extension = Element("mujoco", root.line, {}, [Element("compiler", root.line, options)])
    root.children.insert(0, extension)


def _drop_range(joint: Element) -> None:
    limit = joint.first("limit")
    if limit is not None:
        limit.attributes.pop("lower", None)
        limit.attributes.pop("upper", None)


def _check_tree(root: Element) -> None:
    links = [child for child in root if child.tag == "link"]
    joints = [child for child in root if child.tag == "joint"]
    if not links:
        raise DamagedFile("the URDF has no <link>")
    if len(links) > MAX_BODIES:
        raise DamagedFile(f"it has {len(links):,} links; a robot has at most {MAX_BODIES}")
    shapes = sum(1 for _ in root.all("geometry"))
    if shapes > MAX_GEOMS:
        raise DamagedFile(f"it has {shapes:,} shapes; a robot has at most {MAX_GEOMS:,}")
    names = _unique_names(links)
    _unique_names(joints)
    parent_of: dict[str, str] = {}
    for joint in joints:
        if joint.attributes.get("type") not in _JOINT_TYPES:
            raise DamagedFile(f"{joint.place}: its type must be one of {', '.join(_JOINT_TYPES)}")
        parent, child = (_end_of(joint, tag, names) for tag in ("parent", "child"))
        if child in parent_of:
            raise DamagedFile(f"{joint.place}: link {quoted(child)} has two parents")
        parent_of[child] = parent
    roots = [name for name in names if name not in parent_of]
    if len(roots) != 1:
        raise DamagedFile(
            f"the links must be one tree below one link; {len(roots)} have no parent"
            + (f": {listed(sorted(roots))}" if roots else "")
        )
    _check_connected(names, parent_of)


def _unique_names(elements: Sequence[Element]) -> set[str]:
    names: set[str] = set()
    for element in elements:
        name = element.attributes.get("name", "")
        if not name or name in names:
            raise DamagedFile(f"{element.place}: each {element.tag} needs a name of its own")
        names.add(name)
    return names


def _end_of(joint: Element, tag: str, names: set[str]) -> str:
    element = joint.first(tag)
    link = "" if element is None else element.attributes.get("link", "")
    if link not in names:
        raise DamagedFile(f"{joint.place}: its {tag} is no link: {quoted(link)!r}")
    return link


def _check_connected(names: set[str], parent_of: dict[str, str]) -> None:
    below: dict[str, list[str]] = {name: [] for name in names}
    for child, parent in parent_of.items():
        below[parent].append(child)
    waiting, reached = [name for name in names if name not in parent_of], 0
    while waiting:
        waiting.extend(below[waiting.pop()])
        reached += 1
    if reached < len(names):
        raise DamagedFile("some links are their own ancestors; the links must be one tree")


def _resolve_shapes(root: Element, meshes: MeshFiles) -> None:
    """Give meshes their names in the assets, and remove shapes that cannot be read."""
    for link in root.all("link"):
        readable = []
        for child in link:
            geometry = child.first("geometry")
            if child.tag == "inertial" or (geometry is not None and _is_read(geometry, meshes)):
                readable.append(child)
            elif child.tag == "visual":
                meshes.undrawn.add(link.attributes["name"])
        link.children = readable


def _is_read(geometry: Element, meshes: MeshFiles) -> bool:
    mesh = geometry.first("mesh")
    if mesh is not None:
        name = meshes.add(mesh.attributes.get("filename", ""), mesh.attributes.get("scale", ""))
        if name is None:
            return False
        mesh.attributes["filename"] = name
    return bool(geometry.children)
