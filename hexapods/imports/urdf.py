"""Clean a URDF document: keep what describes a body, and find the tree of links of the robot."""

from collections.abc import Collection, Mapping, Sequence

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.xml import Element, check_kept
from hexapods.imports.meshes.mesh_files import MeshFiles
from hexapods.imports.mjcf import MAX_BODIES, MAX_GEOMS, check_numbers
from hexapods.imports.notes import Notes, listed, quoted

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
    "dynamics": frozenset({"damping", "friction"}),
}
_TEXTS = frozenset({"name", "filename", "type", "link"})
_MAY_REPEAT = frozenset({"link", "joint", "visual", "collision"})
"""Tags of which a parent may have several children."""
_VECTORS = frozenset({"xyz", "rpy", "size", "scale"})
"""Attributes of three numbers; the others have one."""
_MAX_TOLD = 100
_WORLD = "world"
"""Name of a link that MuJoCo takes for the world."""
_JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


def clean_urdf(root: Element, meshes: MeshFiles, notes: Notes) -> None:
    """Remove elements that do not describe a body from a URDF document; add meshes to `meshes`.

    Raises:
        DamagedFile: if its links are no tree, or it has too many links or shapes.
    """
    _tell_of_mimics(root, notes)
    for parent in [root, *root.all()]:
        kept_tags = _KEPT.get(parent.tag, frozenset())
        parent.children = [child for child in parent.children if child.tag in kept_tags]
        attributes = _ATTRIBUTES.get(parent.tag, frozenset())
        parent.attributes = {n: v for n, v in parent.attributes.items() if n in attributes}
    check_kept(root)
    _drop_repeated(root, notes)
    _keep_first(root, notes)
    for element in [root, *root.all()]:
        check_numbers(element, _TEXTS)
    _keep_robot(root, notes)
    _check_counts(root)
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


def _tell_of_mimics(root: Element, notes: Notes) -> None:
    names = [
        joint.attributes.get("name", "")
        for joint in root
        if joint.tag == "joint" and joint.first("mimic") is not None
    ]
    if names:
        notes.repair(
            "joints",
            "<mimic> is not followed, each joint has a servo of its own: " + listed(names),
            parts=names[:_MAX_TOLD],
        )


def _drop_repeated(root: Element, notes: Notes) -> None:
    """Remove links of the same name as one before, and joints that are also of the same child."""
    kept: list[Element] = []
    repeated: list[Element] = []
    seen: set[tuple[str, ...]] = set()
    for child in root:
        name = child.attributes.get("name", "")
        key = (child.tag, name, _link_at(child, "child") if child.tag == "joint" else "")
        (repeated if name and key in seen else kept).append(child)
        seen.add(key)
    root.children = kept
    if repeated:
        names = [child.attributes["name"] for child in repeated]
        notes.repair(
            "file",
            f"links and joints are there twice, the first count: {listed(names)}",
            parts=list(dict.fromkeys(names))[:_MAX_TOLD],
        )


def _keep_first(root: Element, notes: Notes) -> None:
    """Remove elements and numbers that are more than URDF has: the first count."""
    places, links = [], []
    for top in root:
        for parent in [top, *top.all()]:
            kept = _first_of_each(parent)
            _repeat_scale(parent)
            if len(kept) < len(parent.children) or _cut_numbers(parent):
                places.append(f"{parent.place} of {top.place}" if parent is not top else top.place)
                links.append(top.attributes.get("name", ""))
            parent.children = kept
    if places:
        notes.repair(
            "file",
            "of elements that a URDF has once, and of more numbers than it has, the first count: "
            + listed(places),
            parts=list(dict.fromkeys(links))[:_MAX_TOLD],
        )


def _first_of_each(parent: Element) -> list[Element]:
    """Return the children without those that are there a second time; a geometry has one shape."""
    kept: list[Element] = []
    tags: set[str] = set()
    for child in parent:
        tag = "shape" if parent.tag == "geometry" else child.tag
        if tag not in tags or tag in _MAY_REPEAT:
            kept.append(child)
        tags.add(tag)
    return kept


def _repeat_scale(element: Element) -> None:
    """Write the one number of a scale, which some programs read so, as three."""
    words = element.attributes.get("scale", "").split()
    if len(words) == 1:
        element.attributes["scale"] = " ".join(words * 3)


def _cut_numbers(element: Element) -> bool:
    """Cut off the numbers that an attribute has too many; False if there are none."""
    is_cut = False
    for name, value in element.attributes.items():
        words = value.split()
        most = 3 if name in _VECTORS else 1
        if name not in _TEXTS and len(words) > most:
            element.attributes[name] = " ".join(words[:most])
            is_cut = True
    return is_cut


def _drop_range(joint: Element) -> None:
    limit = joint.first("limit")
    if limit is not None:
        limit.attributes.pop("lower", None)
        limit.attributes.pop("upper", None)


def _keep_robot(root: Element, notes: Notes) -> None:
    """Keep of several trees of links the one with the most joints, which is the robot.

    A floating joint parts two trees: what is below it moves freely.
    """
    links = [child for child in root if child.tag == "link"]
    joints = [child for child in root if child.tag == "joint"]
    if not links:
        raise DamagedFile("the URDF has no <link>")
    joint_above = _joints_above(_unique_names(links), joints)
    _check_acyclic(joint_above)
    parent_of = {
        link: _link_at(joint, "parent")
        for link, joint in joint_above.items()
        if joint.attributes["type"] != "floating"
    }
    roots = [link.attributes["name"] for link in links if link.attributes["name"] not in parent_of]
    if len(roots) == 1:
        return
    trees = {name: _below(name, parent_of) for name in roots}
    moving = {
        name: sum(joint_above[link].attributes["type"] != "fixed" for link in tree if link != name)
        for name, tree in trees.items()
    }
    best = max(roots, key=lambda name: moving[name])
    if not moving[best]:
        raise DamagedFile(
            f"the links must be one tree below one link; {len(roots)} have no parent: "
            f"{listed(roots)}"
        )
    root.children = [
        child
        for child in root
        if (child.attributes["name"] if child.tag == "link" else _link_at(child, "child"))
        in trees[best]
    ]
    left = [name for name in roots if name != best]
    if best in joint_above:
        above = _float_in_world(root, joint_above[best], parent_of)
        if not any(link.children for link in links if link.attributes["name"] in trees[above]):
            left.remove(above)
    if left:
        notes.repair(
            "links",
            f"left out what is not joined to the robot, which begins at {quoted(best)}: "
            f"{listed(left)}",
            parts=[best],
        )


def _joints_above(names: Collection[str], joints: Sequence[Element]) -> dict[str, Element]:
    """Return the joint above each link that has one."""
    _unique_names(joints)
    joint_above: dict[str, Element] = {}
    for joint in joints:
        if joint.attributes.get("type") not in _JOINT_TYPES:
            raise DamagedFile(f"{joint.place}: its type must be one of {', '.join(_JOINT_TYPES)}")
        for tag in ("parent", "child"):
            if _link_at(joint, tag) not in names:
                raise DamagedFile(
                    f"{joint.place}: its {tag} is no link: {quoted(_link_at(joint, tag))!r}"
                )
        child = _link_at(joint, "child")
        if child in joint_above:
            raise DamagedFile(f"{joint.place}: link {quoted(child)} has two parents")
        joint_above[child] = joint
    return joint_above


def _link_at(joint: Element, tag: str) -> str:
    """Return the name of a joint's parent or child; empty if there is none."""
    element = joint.first(tag)
    return "" if element is None else element.attributes.get("link", "")


def _float_in_world(root: Element, joint: Element, parent_of: Mapping[str, str]) -> str:
    """Let a robot float in the world, as MuJoCo reads it, and return the root that it was below."""
    above = _link_at(joint, "parent")
    joint.children = [Element("parent", joint.line, {"link": _WORLD}), *joint.children]
    joint.children = _first_of_each(joint)
    root.children.insert(0, Element("link", joint.line, {"name": _WORLD}))
    while above in parent_of:
        above = parent_of[above]
    return above


def _below(name: str, parent_of: Mapping[str, str]) -> Collection[str]:
    """Return a link and all links below it."""
    children: dict[str, list[str]] = {}
    for child, parent in parent_of.items():
        children.setdefault(parent, []).append(child)
    tree, waiting = set(), [name]
    while waiting:
        link = waiting.pop()
        tree.add(link)
        waiting += children.get(link, [])
    return tree


def _check_counts(root: Element) -> None:
    links = sum(child.tag == "link" for child in root)
    if links > MAX_BODIES:
        raise DamagedFile(f"it has {links:,} links; a robot has at most {MAX_BODIES}")
    shapes = sum(1 for _ in root.all("geometry"))
    if shapes > MAX_GEOMS:
        raise DamagedFile(f"it has {shapes:,} shapes; a robot has at most {MAX_GEOMS:,}")


def _unique_names(elements: Sequence[Element]) -> set[str]:
    names: set[str] = set()
    for element in elements:
        name = element.attributes.get("name", "")
        if not name or name in names:
            raise DamagedFile(f"{element.place}: each {element.tag} needs a name of its own")
        names.add(name)
    return names


def _check_acyclic(joint_above: Mapping[str, Element]) -> None:
    """Check that no link is its own ancestor."""
    checked: set[str] = set()
    for name in joint_above:
        path: set[str] = set()
        link = name
        while link in joint_above and link not in checked:
            if link in path:
                raise DamagedFile("some links are their own ancestors; the links must be one tree")
            path.add(link)
            link = _link_at(joint_above[link], "parent")
        checked |= path


def _resolve_shapes(root: Element, meshes: MeshFiles) -> None:
    """Give meshes their names in the assets, and remove shapes that cannot be read."""
    meshes.expect(mesh.attributes.get("filename", "") for mesh in root.all("mesh"))
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
