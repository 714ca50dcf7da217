"""A folder of a robot, as it lies on a disk: what is taken of it."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

import hexapods as hx
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.imports.documents import folder as folder_module
from hexapods.imports.documents.folder import names_in, pack_folder, pack_zip, read_robot_path
from tests.imports.robots import box_triangles, bug, read, stl, zipped

MESH = '<visual><geometry><mesh filename="{}"/></geometry></visual>'


def written(folder: Path, files: dict[str, str | bytes]) -> Path:
    for path, content in files.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content.encode() if isinstance(content, str) else content)
    return folder


def members(data: bytes) -> set[str]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {*archive.namelist()}


def test_documents_and_the_meshes_that_they_name_are_taken(tmp_path: Path) -> None:
    folder = written(
        tmp_path / "robot",
        {
            "urdf/bug.urdf": bug(torso=MESH.format("package://bug/meshes/My%20Hull.STL")),
            "urdf/leg.xacro": '<a filename="${side}_leg.stl"/>',
            "package.xml": "<package><name>bug</name></package>",
            "config/legs.yaml": "mesh: tip.gltf",
            "meshes/my hull.stl": stl(box_triangles((1, 1, 1))),
            "meshes/left_leg.stl": "x",
            "meshes/other.stl": "x",
            "meshes/tip.gltf": "{}",
            "meshes/tip0.bin": "x",
            "model/tip.bin": "x",
            "src/main.cpp": '#include "my hull.stl"',
            "photo.png": "x",
            ".git/config.xml": "<a/>",
            "node_modules/a.xml": "<a/>",
        },
    )

    data = pack_folder(folder)

    assert members(data) == {
        "package.xml",
        "config/legs.yaml",
        "urdf/bug.urdf",
        "urdf/leg.xacro",
        "meshes/my hull.stl",
        "meshes/left_leg.stl",
        "meshes/tip.gltf",
        "meshes/tip0.bin",
    }
    robot = read(data, "robot.zip")
    assert not any("missing" in sentence for sentence in robot.repairs)
    assert pack_zip(written(tmp_path, {"all.zip": data}) / "all.zip") == data


def test_names_are_the_last_parts_of_texts_and_words() -> None:
    text = """<a file="C:\\x\\One.STL" b='p/two words.stl'>three.obj four.obj</a>
      k: pkg/${a.b}_$(arg c).dae"""

    assert {
        "one.stl",
        "two words.stl",
        "words.stl",
        "three.obj",
        "four.obj",
        "*_*.dae",
    } <= names_in(text)
    assert "*" not in names_in('rpy="0 ${pi/2} 0"')


def test_links_lead_nowhere(tmp_path: Path) -> None:
    written(tmp_path / "outside", {"hull.stl": "x", "secret.xml": "<mujoco/>"})
    folder = written(tmp_path / "robot", {"bug.urdf": bug(torso=MESH.format("hull.stl"))})
    (folder / "meshes").symlink_to(tmp_path / "outside")
    (folder / "hull.stl").symlink_to(tmp_path / "outside" / "hull.stl")
    (folder / "loop").symlink_to(folder)

    assert members(pack_folder(folder)) == {"bug.urdf"}


def test_a_folder_that_is_no_robots_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InvalidInput, match=r"no document of a robot .*it has: a\.txt"):
        pack_folder(written(tmp_path / "texts", {"a.txt": "x"}))
    with pytest.raises(InvalidInput, match="cannot read"):
        read_robot_path(tmp_path / "none")
    (tmp_path / "bad.zip").write_bytes(b"PK\3\4")
    with pytest.raises(DamagedFile, match="the zip is damaged"):
        pack_zip(tmp_path / "bad.zip")
    monkeypatch.setattr(folder_module, "MAX_FILES", 10)
    many = written(tmp_path / "many", {f"{number}/{number}.txt": "" for number in range(11)})
    with pytest.raises(InvalidInput, match="more than 10 files; give the folder of one robot"):
        pack_folder(many)
    monkeypatch.setattr(folder_module, "MAX_UNPACKED_BYTES", 10)
    with pytest.raises(InvalidInput, match=r"give the folder of one robot; documents are in a, b"):
        pack_folder(written(tmp_path / "two", {"a/a.urdf": bug(), "b/b.urdf": bug()}))


def test_a_program_loads_a_folder_and_a_large_zip(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = written(tmp_path / "My bug", {"urdf/bug.urdf": bug(), "movie.bin": bytes(1000)})

    assert hx.load_robot(folder).name == "My bug"
    (tmp_path / "bug.zip").write_bytes(
        zipped({"bug.urdf": bug(), "a.mp4": np.random.default_rng(0).bytes(9000)})
    )
    monkeypatch.setattr(folder_module, "MAX_UPLOAD_BYTES", 3000)
    data, name = read_robot_path(tmp_path / "bug.zip")
    assert (members(data), name) == ({"bug.urdf"}, "bug.zip")
