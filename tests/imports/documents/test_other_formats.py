"""Files that are no documents of robots: what they are, and what to do."""

import gzip
import io
import re
import tarfile

import pytest

from hexapods.domain.errors import DamagedFile
from tests.imports.robots import box_triangles, bug, read, stl, zipped


def tar(mode: str) -> bytes:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode=mode) as archive:  # type: ignore[call-overload]
        info = tarfile.TarInfo("robot.urdf")
        info.size = 4
        archive.addfile(info, io.BytesIO(b"<a/>"))
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.tar.gz", tar("w:gz"), "a.tar.gz is a .gz archive: unpack it, and give its folder"),
        ("a.tar.xz", tar("w:xz"), "an .xz archive: unpack it"),
        ("a.tar.bz2", tar("w:bz2"), "a .bz2 archive: unpack it"),
        ("a.tar", tar("w"), "a .tar archive: unpack it"),
        ("a.urdf.gz", gzip.compress(bug().encode()), "a .gz archive"),
        ("a.7z", b"7z\xbc\xaf\x27\x1c\0\4", "a 7z archive: unpack it"),
        ("a.rar", b"Rar!\x1a\x07\1\0", "a RAR archive: unpack it"),
        ("a.usda", b"#usda 1.0\n", "is USD: export the robot as URDF or MJCF"),
        ("a.usd", b"PXR-USDC\0\0", "is USD"),
        ("a.usdz", zipped({"a.usdc": "PXR-USDC"}), "a.usdz is USD"),
        ("a.sdf", b'<?xml version="1.0"?><sdf version="1.6"/>', "is SDF of Gazebo"),
        ("a.wbt", b"#VRML_SIM R2023b utf8\n", "a file of Webots: export the robot as URDF"),
        ("a.ttt", b"VREP\0\1\2" * 1_000_000, "a file of CoppeliaSim: export the robot"),
        ("a.step", b"ISO-10303-21;\nHEADER;", "a STEP file of CAD"),
        ("a.SLDASM", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a file of a CAD program"),
        ("a.FCStd", zipped({"Document.xml": "<Document/>"}), "a file of a CAD program"),
        ("a.stl", stl(box_triangles((1, 1, 1))), "a mesh: shapes without joints"),
        ("a.obj", b"v 0 0 0\n", "an OBJ mesh: shapes without joints"),
        ("a.dae", b"<COLLADA/>", "is COLLADA: shapes without joints"),
        ("a.glb", b"glTF\2\0\0\0", "is glTF: shapes without joints"),
        ("a.gltf", b'{"asset": {}}', "is glTF: shapes without joints"),
        ("a.blend", b"BLENDER-v300", "a file of Blender"),
        ("a.mjb", b"\x31\xd4\0\0\1\2", "a compiled model of MuJoCo"),
        ("a.json", b'{"front": 100, "coxia": 100}', "JSON of another program"),
        ("a.urdf", b"version https://git-lfs.github.com/spec/v1\noid", "run `git lfs pull`"),
        ("a.urdf", b"\n\n<!DOCTYPE html>\n<html>", "a web page, not the file that it shows"),
        ("a.xml", b"<html><body/></html>", "a web page"),
        ("a.xml", b"%PDF-1.7", "a PDF"),
        ("a.xml", b"\x89PNG\r\n", "a picture"),
        ("a.launch", b"<launch/>", "a launch file of ROS"),
        ("package.xml", b"<package/>", "give the whole folder of the package"),
        ("a.xml", b"<mujocoinclude/>", "a part of an MJCF file: give the file that includes it"),
        ("a.xml", b"<svg/>", "a picture"),
        ("a.xml", b"<scxml/>", "begins with <scxml>; an MJCF file begins with <mujoco>"),
        ("a.zip", zipped({"a/b.zip": zipped({"robot.xml": ""})}), "b.zip is a zip in the zip"),
        ("a.zip", zipped({"robot.usd": "x"}), "robot.usd is USD"),
        ("a.zip", zipped({"a.txt": "x"}), "the zip has no MJCF or URDF document"),
        ("a.py", b"import numpy", "a.py is no XML: give the robot's MJCF, URDF or xacro"),
        ("a.urdf", bytes(1000), "a.urdf is no XML"),
        ("a.3mf", zipped({"3D/3dmodel.model": "<model/>"}), "a.3mf is a mesh"),
        ("a.bag", b"#ROSBAG V2.0\n", "is a recording"),
        (
            "a.srdf",
            b"<robot><disable_collisions/></robot>",
            "is SRDF of MoveIt, which has no links",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) and " " not in value else "",
)
def test_other_files_are_named_with_what_to_do(name: str, data: bytes, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        read(data, name)


def test_a_damaged_document_does_not_hide_a_robot() -> None:
    files = {"bug.urdf": bug(), "a.xml": "version https://git-lfs.github.com/spec/v1\noid"}

    assert len(read(zipped(files), "robot.zip").legs) == 6
