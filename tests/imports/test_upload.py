import io
import re
import stat
import struct
import zipfile

import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.imports.upload import MAX_MEMBERS, MAX_UNPACKED_BYTES, Upload
from tests.imports.robots import zipped


def with_mode(name: str, mode: int) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        info = zipfile.ZipInfo(name)
        info.external_attr = mode << 16
        archive.writestr(info, "/etc/passwd")
    return buffer.getvalue()


def claiming(size: int) -> bytes:
    """Return a zip whose directory claims a size for its member."""
    data = bytearray(zipped({"robot.xml": "<mujoco/>"}))
    at = data.index(b"PK\1\2")
    data[at + 24 : at + 28] = struct.pack("<I", size)
    return bytes(data)


def encrypted() -> bytes:
    data = bytearray(zipped({"robot.xml": "<mujoco/>"}))
    data[data.index(b"PK\1\2") + 8] |= 1
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "the file is empty"),
        (zipped({"../robot.xml": ""}), "whose path leads out of it"),
        (zipped({"/robot.xml": ""}), "whose path leads out of it"),
        (zipped({"C:\\robot.xml": ""}), "whose path leads out of it"),
        (with_mode("robot.xml", stat.S_IFLNK | 0o777), "a link or no plain file"),
        (with_mode("robot.xml", stat.S_IFIFO | 0o777), "a link or no plain file"),
        (claiming(MAX_UNPACKED_BYTES + 1), "would unpack to"),
        (encrypted(), "is encrypted"),
        (zipped({f"{number}.stl": "" for number in range(MAX_MEMBERS + 1)}), "2,001 members"),
        (zipped({"robot.xml": ""})[:-30], "has no directory"),
        (b"PK\3\4", "has no directory"),
    ],
    # Files have the time at which they are made: as names they would differ between processes.
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_hostile_zips_are_refused(data: bytes, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        Upload(data, "robot.zip")


def test_members_with_one_path_are_refused() -> None:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("a/robot.xml", "")
        archive.writestr("a//robot.xml", "")

    with pytest.raises(DamagedFile, match="twice"):
        Upload(buffer.getvalue(), "robot.zip")


@pytest.mark.parametrize("size", [3, 4_000_000])
def test_a_member_of_another_size_than_claimed_is_refused(size: int) -> None:
    upload = Upload(claiming(size), "robot.zip")

    with pytest.raises(DamagedFile, match=r"robot\.xml in the zip is"):
        upload.read("robot.xml", 5_000_000)


@pytest.fixture
def files() -> Upload:
    names = ["pkg/urdf/a.urdf", "pkg/meshes/hip.stl", "meshes/hip.stl", "pkg/meshes/left/hip.stl"]
    return Upload(zipped(dict.fromkeys(names, "")), "robot.zip")


@pytest.mark.parametrize(
    ("wanted", "path"),
    [
        ("../meshes/hip.stl", "pkg/meshes/hip.stl"),
        ("package://pkg/meshes/hip.stl", "pkg/meshes/hip.stl"),
        ("package://other/meshes/hip.stl", "meshes/hip.stl"),
        ("package://pkg/meshes/left/hip.stl", "pkg/meshes/left/hip.stl"),
        ("hip.stl", "meshes/hip.stl"),
        ("..\\meshes\\hip.stl", "pkg/meshes/hip.stl"),
        ("knee.stl", None),
    ],
)
def test_a_mesh_is_found_by_the_most_of_its_path(
    files: Upload, wanted: str, path: str | None
) -> None:
    assert files.find(wanted, "pkg/urdf/a.urdf") == path


@pytest.mark.parametrize(
    "wanted",
    [
        "/etc/passwd",
        "../../../etc/passwd",
        "C:/hip.stl",
        "package://../../etc/passwd",
        "http://example.org/hip.stl",
    ],
)
def test_no_mesh_is_outside_the_zip(files: Upload, wanted: str) -> None:
    with pytest.raises(DamagedFile, match=r"leads out of the zip|no path in the zip"):
        files.find(wanted, "pkg/urdf/a.urdf")


def test_a_single_document_has_no_other_files() -> None:
    upload = Upload(b"<mujoco/>", "some/robot.xml")

    assert upload.documents == ["robot.xml"]
    assert upload.find("meshes/hip.stl", "robot.xml") is None


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (
            {"readme.txt": ""},
            "has no MJCF or URDF document (.xml, .urdf, .mjcf); it has: readme.txt",
        ),
        ({"robot.xacro": ""}, "xacro files, which are not expanded here"),
        ({}, "it has: nothing"),
    ],
)
def test_a_zip_without_a_document_is_refused(files: dict[str, str], said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        _ = Upload(zipped(files), "robot.zip").documents
