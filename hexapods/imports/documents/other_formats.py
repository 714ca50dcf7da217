"""Recognise files that are no documents of robots by how they begin, and say what to do instead."""

import posixpath
from collections.abc import Collection, Iterable

from hexapods.imports.notes import quoted

_UNPACK = "unpack it, and give its folder, or a zip of it"
_EXPORT = "export the robot as URDF or MJCF"
_MESH = (
    "shapes without joints: give the URDF or MJCF document of the robot, in a zip with its meshes"
)
_CAD = (
    "it has no joints that can be read: export the robot as URDF, such as by the exporters for "
    "SolidWorks, Fusion 360 and Onshape, and give that folder"
)
_KINDS = {
    "gzip": ("a .gz archive", _UNPACK),
    "xz": ("an .xz archive", _UNPACK),
    "bzip2": ("a .bz2 archive", _UNPACK),
    "zstd": ("a .zst archive", _UNPACK),
    "tar": ("a .tar archive", _UNPACK),
    "7z": ("a 7z archive", _UNPACK),
    "rar": ("a RAR archive", _UNPACK),
    "zip": ("a zip in the zip", _UNPACK),
    "usd": ("USD", f"{_EXPORT}, such as by Isaac Sim's URDF exporter"),
    "sdf": ("SDF of Gazebo", f"give the URDF or xacro from which it was made, or {_EXPORT}"),
    "webots": ("a file of Webots", "export the robot as URDF (`getUrdf()` in its controller)"),
    "coppelia": ("a file of CoppeliaSim", "export the robot as URDF (Modules, Exporters)"),
    "vrml": ("VRML", _MESH),
    "step": ("a STEP file of CAD", _CAD),
    "iges": ("an IGES file of CAD", _CAD),
    "cad": ("a file of a CAD program", _CAD),
    "gltf": ("glTF", _MESH),
    "stl": ("a mesh", _MESH),
    "obj": ("an OBJ mesh", _MESH),
    "ply": ("a PLY mesh", _MESH),
    "fbx": ("FBX", _MESH),
    "collada": ("COLLADA", _MESH),
    "blender": ("a file of Blender", f"{_EXPORT}, such as by its add-on Phobos"),
    "mjb": (
        "a compiled model of MuJoCo",
        "give the XML from which it was compiled, or that which `mujoco.mj_saveLastXML` writes",
    ),
    "mujocoinclude": (
        "a part of an MJCF file",
        "give the file that includes it, in a zip with this one",
    ),
    "lfs": ("a pointer of Git LFS, not the file itself", "run `git lfs pull`, and give it again"),
    "html": (
        "a web page, not the file that it shows",
        "download the file itself; GitHub has *Download raw file*, and *Download ZIP* for all",
    ),
    "pdf": ("a PDF", "give the robot's URDF or MJCF"),
    "picture": ("a picture", "give the robot's URDF or MJCF"),
    "json": (
        "JSON of another program",
        "give the robot's URDF or MJCF, or enter its lengths in the editor of bodies",
    ),
    "launch": ("a launch file of ROS", "give the folder with the URDF or xacro that it loads"),
    "package": ("the description of a ROS package", "give the whole folder of the package"),
    "config": ("the description of a Gazebo model", "give the folder with the robot's URDF"),
    "openrave": ("a robot of OpenRAVE", _EXPORT),
    "bullet": ("a file of Bullet", "give the URDF from which it was made"),
    "srdf": ("SRDF of MoveIt, which has no links", "give the folder with the robot's URDF"),
    "log": ("a recording", "give the robot's URDF or MJCF"),
    "other": ("no XML", "give the robot's MJCF, URDF or xacro, or the folder with it"),
    "matlab": ("a file of MATLAB", "export the robot as URDF (`exportrobot` writes it)"),
}
"""What each kind is called, and what to do."""
_BEGINNINGS: tuple[tuple[int, bytes, str], ...] = (
    (0, b"\x1f\x8b", "gzip"),
    (0, b"\xfd7zXZ\0", "xz"),
    (0, b"BZh", "bzip2"),
    (0, b"\x28\xb5\x2f\xfd", "zstd"),
    (257, b"ustar", "tar"),
    (0, b"7z\xbc\xaf\x27\x1c", "7z"),
    (0, b"Rar!\x1a\x07", "rar"),
    (0, b"#usda", "usd"),
    (0, b"PXR-USDC", "usd"),
    (0, b"#VRML_SIM", "webots"),
    (0, b"#VRML", "vrml"),
    (0, b"ISO-10303-21", "step"),
    (0, b"glTF", "gltf"),
    (0, b"ply\n", "ply"),
    (0, b"ply\r", "ply"),
    (0, b"Kaydara FBX", "fbx"),
    (0, b"BLENDER", "blender"),
    (0, b"version https://git-lfs", "lfs"),
    (0, b"%PDF", "pdf"),
    (0, b"\x89PNG", "picture"),
    (0, b"\xff\xd8\xff", "picture"),
    (0, b"GIF8", "picture"),
    (0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "cad"),
    (0, b"AC10", "cad"),
    (0, b"BULLET", "bullet"),
    (0, b"MATLAB 5", "matlab"),
    (0, b"#ROSBAG", "log"),
    (0, b"\x89MCAP", "log"),
)
"""Offset, bytes and kind."""
_ENDINGS = {
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), "usd"),
    **dict.fromkeys((".sdf", ".world"), "sdf"),
    **dict.fromkeys((".wbt", ".proto"), "webots"),
    **dict.fromkeys((".ttt", ".ttm"), "coppelia"),
    **dict.fromkeys((".step", ".stp"), "step"),
    **dict.fromkeys((".iges", ".igs"), "iges"),
    **dict.fromkeys((".gltf", ".glb"), "gltf"),
    **dict.fromkeys(
        (".sldprt", ".sldasm", ".ipt", ".iam", ".f3d", ".fcstd", ".dwg", ".dxf"), "cad"
    ),
    **dict.fromkeys((".gz", ".tgz"), "gzip"),
    **dict.fromkeys((".mat", ".slx"), "matlab"),
    **dict.fromkeys((".x_t", ".sat", ".skp", ".scad"), "cad"),
    **dict.fromkeys((".bag", ".db3", ".mcap"), "log"),
    **dict.fromkeys((".stl", ".3mf"), "stl"),
    ".7z": "7z",
    ".rar": "rar",
    ".obj": "obj",
    ".ply": "ply",
    ".fbx": "fbx",
    ".dae": "collada",
    ".blend": "blender",
    ".mjb": "mjb",
    ".pdf": "pdf",
    ".wrl": "vrml",
}
_ROOTS = {
    **dict.fromkeys(("sdf", "gazebo"), "sdf"),
    **dict.fromkeys(("html", "HTML"), "html"),
    **dict.fromkeys(("Robot", "KinBody", "Environment"), "openrave"),
    "mujocoinclude": "mujocoinclude",
    "COLLADA": "collada",
    "launch": "launch",
    "package": "package",
    "model": "config",
    "svg": "picture",
    "X3D": "vrml",
}


def other_format(data: bytes, file_name: str) -> str | None:
    """Return what a file is that is no XML, and what to do; None if it may be XML."""
    start = data[:300]
    for offset, beginning, kind in _BEGINNINGS:
        if start.startswith(beginning, offset):
            return _sentence(file_name, kind)
    text = start.lstrip(b"\xef\xbb\xbf \t\r\n")
    if text[:9].lower() == b"<!doctype" and b"html" in text[:20].lower():
        return _sentence(file_name, "html")
    if text.startswith(b"<") or b"<\0" in start[:8] or b"\0<" in start[:8]:
        return None
    if text.startswith((b"{", b"[")):
        return _sentence(file_name, "gltf" if _ending(file_name) == ".gltf" else "json")
    if kind_of_ending := _ENDINGS.get(_ending(file_name)):
        return _sentence(file_name, kind_of_ending)
    return _sentence(file_name, "other") if text else None


def other_document(root: str, children: Collection[str], file_name: str) -> str | None:
    """Return what an XML document is, and what to do; None if it may be a robot or is unknown.

    Args:
        root: tag of its root.
        children: tags of the root's children.
        file_name: its name.
    """
    kind = _ROOTS.get(root)
    if root == "robot" and "link" not in children and "disable_collisions" in children:
        kind = "srdf"
    return _sentence(file_name, kind) if kind else None


def other_zip(file_name: str, paths: Iterable[str]) -> str | None:
    """Return what a zip is that has no document of a robot, by its name and those of its files."""
    for path in (file_name, *paths):
        ending = _ending(path)
        if kind := "zip" if ending == ".zip" and path != file_name else _ENDINGS.get(ending):
            return _sentence(path, kind)
    return None


def _ending(path: str) -> str:
    return posixpath.splitext(path)[1].lower()


def _sentence(file_name: str, kind: str) -> str:
    name, advice = _KINDS[kind]
    return f"{quoted(posixpath.basename(file_name))} is {name}: {advice}"
