import io
import re
import stat
import struct
import zipfile

import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.upload import MAX_MEMBERS, MAX_UNPACKED_BYTES, Upload
from tests.imports.robots import dog, read, zipped


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
        (claiming(MAX_UNPACKED_BYTES + 1), "would unpack to"),
        (encrypted(), "is encrypted"),
        (
            zipped({f"{number}.stl": "" for number in range(MAX_MEMBERS + 1)}),
            "2,001 documents and meshes",
        ),
        (zipped({f"{number}.txt": "" for number in range(10_001)}), "10,001 members"),
        (zipped({"robot.xml": ""})[:-30], "has no directory"),
        (b"PK\3\4", "has no directory"),
    ],
    # Files have the time at which they are made: as names they would differ between processes.
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_hostile_zips_are_refused(data: bytes, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        Upload(data, "robot.zip")


@pytest.mark.parametrize("path", ["../robot.xml", "/robot.xml", "C:\\robot.xml", "a/../../b.xml"])
def test_a_member_whose_path_leads_out_is_left_out(path: str) -> None:
    upload = Upload(zipped({path: "", "robot.xml": ""}), "robot.zip")

    assert upload.documents == ["robot.xml"]
    assert upload.outside == [path.replace("\\", "/")]
    robot = read(zipped({path: "", "robot.xml": dog()}))
    assert any("leads out of the zip" in sentence for sentence in robot.repairs)


@pytest.mark.parametrize("mode", [stat.S_IFLNK | 0o777, stat.S_IFIFO | 0o777])
def test_links_and_devices_are_no_files(mode: int) -> None:
    upload = Upload(with_mode("hip.stl", mode), "robot.zip")

    assert upload.paths == []
    assert upload.find("hip.stl", "robot.xml") is None


def test_a_link_to_a_file_in_the_zip_is_followed() -> None:
    buffer = io.BytesIO(zipped({"a/hip.stl": "mesh"}))
    with zipfile.ZipFile(buffer, "a") as archive:
        for name, target in {"b/hip.stl": "../a/hip.stl", "b/knee.stl": "../../knee.stl"}.items():
            link = zipfile.ZipInfo(name)
            link.external_attr = (stat.S_IFLNK | 0o777) << 16
            archive.writestr(link, target)

    upload = Upload(buffer.getvalue(), "robot.zip")

    assert upload.find("package://x/b/hip.stl", "robot.xml") == "a/hip.stl"
    assert upload.find("knee.stl", "robot.xml") is None


def test_a_name_in_utf_8_that_does_not_say_so_is_read() -> None:
    data = zipped({"f\u00fc\u00dfe.stl": ""})
    without_flag = bytearray(data)
    for mark, offset in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
        at = data.index(mark) + offset
        without_flag[at : at + 2] = b"\0\0"

    assert Upload(bytes(without_flag), "robot.zip").paths == ["f\u00fc\u00dfe.stl"]


def test_what_is_no_document_nor_mesh_may_be_there_twice() -> None:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("a/readme.txt", "")
        archive.writestr("a//readme.txt", "")

    assert Upload(buffer.getvalue(), "robot.zip").paths == ["a/readme.txt"]


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
    names = [
        "pkg/urdf/a.urdf",
        "pkg/meshes/hip.stl",
        "meshes/hip.stl",
        "pkg/meshes/left/hip.stl",
        "pkg/meshes/my hip.stl",
        "pkg/meshes/a b.stl",
        "pkg/meshes/a%20b.stl",
        "pkg/meshes/f\u00fc\u00dfe.stl",
    ]
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
        ("/home/ada/pkg/meshes/left/hip.stl", "pkg/meshes/left/hip.stl"),
        ("C:\\Users\\ada\\pkg\\meshes\\hip.stl", "pkg/meshes/hip.stl"),
        ("file:///opt/pkg/meshes/hip.stl", "pkg/meshes/hip.stl"),
        ("https://example.org/pkg/meshes/hip.stl", "pkg/meshes/hip.stl"),
        ("../../../meshes/left/hip.stl", "pkg/meshes/left/hip.stl"),
        ("package://pkg/meshes/HIP.STL", "pkg/meshes/hip.stl"),
        ("Meshes/Left/Hip.Stl", "pkg/meshes/left/hip.stl"),
        ("meshes/my%20hip.stl", "pkg/meshes/my hip.stl"),
        ("meshes/My%20Hip.stl", "pkg/meshes/my hip.stl"),
        ("meshes/a%20b.stl", "pkg/meshes/a%20b.stl"),
        ("https://example.org/raw/pkg/meshes/hip.stl?raw=true#1", "pkg/meshes/hip.stl"),
        ("file:///C:/pkg/meshes/left/hip.stl", "pkg/meshes/left/hip.stl"),
        ("~/pkg/meshes/hip.stl", "pkg/meshes/hip.stl"),
        ("meshes/fu\u0308\u00dfe.stl", "pkg/meshes/f\u00fc\u00dfe.stl"),
    ],
)
def test_a_mesh_is_found_by_the_most_of_its_path(
    files: Upload, wanted: str, path: str | None
) -> None:
    assert files.find(wanted, "pkg/urdf/a.urdf") == path


@pytest.mark.parametrize(
    "wanted",
    ["/etc/passwd", "../../../etc/passwd", "C:/", "package://../../etc/passwd", "..", "", "a//"],
)
def test_what_is_not_in_the_zip_is_not_found(files: Upload, wanted: str) -> None:
    assert files.find(wanted, "pkg/urdf/a.urdf") is None


def test_a_package_is_the_folder_of_its_package_xml() -> None:
    upload = Upload(
        zipped(
            {
                "repo/dog-main/package.xml": "<package><name>dog</name></package>",
                "repo/dog-main/meshes/hip.stl": "",
                "cat/package.xml": "<package><name> cat </name></package>",
                "cat/meshes/hip.stl": "",
                "deep/er/tools/x.py": "",
            }
        ),
        "robot.zip",
    )

    assert upload.package_folder("dog") == "repo/dog-main"
    assert upload.package_folder("tools") == "deep/er/tools"
    assert upload.package_folder("mouse") == "mouse"
    assert upload.find("package://dog/meshes/hip.stl", "a.urdf") == "repo/dog-main/meshes/hip.stl"
    assert upload.find("package://cat/meshes/hip.stl", "a.urdf") == "cat/meshes/hip.stl"


def test_a_single_document_has_no_other_files() -> None:
    upload = Upload(b"<mujoco/>", "some/robot.xml")

    assert upload.documents == ["robot.xml"]
    assert upload.find("meshes/hip.stl", "robot.xml") is None


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (
            {"readme.txt": ""},
            "has no MJCF or URDF document (.urdf, .xml, .mjcf, .xacro); it has: readme.txt",
        ),
        ({}, "it has: nothing"),
    ],
)
def test_a_zip_without_a_document_is_refused(files: dict[str, str], said: str) -> None:
    assert Upload(zipped(files), "robot.zip").documents == []
    with pytest.raises(DamagedFile, match=re.escape(said)):
        read(zipped(files), "robot.zip")
