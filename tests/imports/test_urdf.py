import base64
import math
import re

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot_model import MAX_TRIANGLES, ModelMesh
from hexapods.domain.types import FloatArray, IntArray
from hexapods.imports.choices import Choices
from hexapods.imports.drawing import MAX_BASE64
from tests.imports.robots import (
    INERTIAL,
    SIX,
    box_triangles,
    bug,
    inspect,
    read,
    stl,
    text_stl,
    zipped,
)
from tests.imports.same_motion import compare
from tests.imports.test_mjcf import mentions

MESH = '<visual><geometry><mesh filename="{file}" scale="0.5 0.5 0.5"/></geometry></visual>'
BOX = (0.4, 0.2, 0.08)


def decoded(mesh: ModelMesh | None) -> tuple[FloatArray, IntArray]:
    assert mesh is not None
    vertices = np.frombuffer(base64.b64decode(mesh.vertices), "<f4").reshape(-1, 3)
    faces = np.frombuffer(base64.b64decode(mesh.faces), "<u4").reshape(-1, 3)
    assert mesh.triangles == len(faces)
    assert faces.max() < len(vertices)
    return vertices.astype(float), faces.astype(np.int64)


def test_a_hexapod_is_read() -> None:
    robot = read(bug(), "bug.urdf")

    assert [leg.foot for leg in robot.legs] == [
        f"tibia_{leg}" for leg in ("rf", "lf", "lm", "lr", "rr", "rm")
    ]
    assert robot.gait == "tripod"
    assert (robot.name, robot.file_format) == ("bug", "urdf")
    assert robot.mass_kg == pytest.approx(1.5 + 18 * 0.1, rel=1e-6)
    assert [joint.name for joint in robot.model.joints_of(6)] == ["coxa", "femur", "tibia"]
    assert robot.model.joints_of(1)[0].servo_torque_nm == 2.5
    assert robot.reaches_grid
    assert mentions(robot.repairs, "base_link was fixed to the world")
    assert mentions(robot.repairs, "no joint had an actuator")
    assert mentions(robot.guesses, "with bent knees, as was searched")
    # Legs stretch outward at the angles 0, where the torso lies on the ground.
    assert robot.body_height_m > 0.04


def test_its_stance_is_symmetric() -> None:
    robot = read(bug())

    for joint in range(3):
        angles = [abs(robot.model.joints_of(leg)[joint].home_rad) for leg in range(1, 7)]
        assert np.ptp(angles) < 0.06


def test_it_moves_as_in_mujoco() -> None:
    # MuJoCo fuses the base with the world unless told otherwise.
    told_so = '<mujoco><compiler fusestatic="false"/></mujoco>'
    text = bug(
        tip='<collision name="tip"><origin xyz="0.12 0 0"/><geometry><sphere radius="0.008"/>'
        "</geometry></collision>"
    )
    robot = read(text)
    named = text.replace("</robot>", f"{told_so}</robot>")
    for leg in SIX:
        start = named.index(f'<link name="tibia_{leg}">')
        named = named[:start] + named[start:].replace('name="tip"', f'name="{leg}"', 1)

    worst = compare(
        robot,
        named,
        rng=np.random.default_rng(0),
        is_base="base_link",
        foot_of={f"tibia_{leg}": leg for leg in SIX},
    )

    assert worst < 1e-9


def test_links_without_inertia_get_some() -> None:
    robot = read(bug(inertial=""))
    masses = {link.name: link.mass_kg for link in robot.model.links}

    assert mentions(robot.guesses, "the file gives no mass for coxa_rf")
    assert min(masses.values()) > 1e-4
    # By its box, of which half is full.
    assert masses["femur_rf"] == pytest.approx(0.5 * 500 * 0.02 * 0.02 * 0.06, rel=0.1)
    assert masses["base_link"] == pytest.approx(1.5)


def test_a_robot_without_any_mass_or_shape_is_refused() -> None:
    with pytest.raises(InvalidInput, match="no link has a mass, nor a shape"):
        read(bug(inertial="", torso_inertial="", torso="", femur="", tip=""))


def test_a_robot_without_any_mass_is_weighed_by_its_shapes() -> None:
    robot = read(bug(inertial="", torso_inertial=""))

    assert robot.model.links[0].mass_kg == pytest.approx(0.5 * 500 * 0.2 * 0.1 * 0.04)
    assert mentions(robot.guesses, "the file gives no mass for")


@pytest.mark.parametrize("ixx", ["-1e-4", "0"])
def test_inertias_that_are_not_positive_are_replaced(ixx: str) -> None:
    robot = read(bug(inertial=INERTIAL.replace('ixx="1e-4"', f'ixx="{ixx}"')))

    assert mentions(robot.repairs, "was not positive")
    assert robot.mass_kg == pytest.approx(3.3, rel=1e-6)


@pytest.mark.parametrize(("effort", "is_guessed"), [("0", True), ("1000", True), ("3", False)])
def test_an_effort_that_is_none_is_guessed(effort: str, is_guessed: bool) -> None:
    robot = read(bug(effort=effort))

    assert mentions(robot.guesses, "largest torque of all joints") is is_guessed
    assert 0.1 < robot.model.joints_of(1)[0].servo_torque_nm < 10


def test_joints_that_turn_without_end_get_limits() -> None:
    robot = read(bug(kind="continuous"))

    assert mentions(
        robot.guesses, "all joints have no limits in the file: 90° to each side of home"
    )


def test_meshes_of_a_package_are_drawn_where_they_are() -> None:
    files = {
        "bug/urdf/bug.urdf": bug(
            torso=MESH.format(file="package://bug_description/meshes/hull.stl")
        ),
        "bug/meshes/hull.stl": stl(box_triangles(BOX)),
        "other/hull.stl": stl(box_triangles((9, 9, 9))),
    }

    robot = read(zipped(files), "bug.zip")
    vertices, faces = decoded(robot.model.links[0].mesh)

    assert robot.file == "bug/urdf/bug.urdf"
    # Body x is to the right, so that the length of the box lies along y.
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], abs=1e-6)
    assert len(faces) == 12
    assert not mentions(robot.repairs, "mesh")


def test_text_meshes_are_read() -> None:
    files = {
        "bug.urdf": bug(torso=MESH.format(file="hull.stl")),
        "hull.stl": text_stl(box_triangles(BOX)),
    }

    vertices, _ = decoded(read(zipped(files)).model.links[0].mesh)

    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], abs=1e-6)


def test_missing_and_unreadable_meshes_are_noted() -> None:
    torso = "".join(MESH.format(file=f"package://bug/meshes/{name}") for name in ("a.stl", "b.3ds"))

    robot = read(zipped({"bug.urdf": bug(torso=torso), "b.3ds": "MM"}))

    assert mentions(robot.repairs, "1 mesh is missing from the upload")
    assert mentions(robot.repairs, "1 mesh is left out, since only .stl, .obj, .dae, .gltf,")


def test_a_link_of_which_a_mesh_is_missing_is_drawn_by_its_simple_shapes_too() -> None:
    box = '<collision><geometry><box size="0.2 0.1 0.04"/></geometry></collision>'
    small = '<visual><geometry><sphere radius="0.01"/></geometry></visual>'

    whole, lacking = (
        read(bug(torso=box + small + more)) for more in ("", MESH.format(file="hull.stl"))
    )

    assert np.ptp(decoded(whole.model.links[0].mesh)[0], axis=0).max() < 0.03
    vertices, _ = decoded(lacking.model.links[0].mesh)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], abs=1e-6)


@pytest.mark.test
def test_large_meshes_are_simplified() -> None:
    files = {
        "bug.urdf": bug(torso=MESH.format(file="hull.stl")),
        "hull.stl": stl(box_triangles(BOX, cells=120)),
    }

    robot = read(zipped(files))
    meshes = [link.mesh for link in robot.model.links if link.mesh is not None]

    assert sum(mesh.triangles for mesh in meshes) <= MAX_TRIANGLES
    assert sum(len(mesh.vertices) + len(mesh.faces) for mesh in meshes) <= MAX_BASE64
    assert mentions(robot.repairs, "mesh hull.stl was simplified from 172,800 to")
    vertices, _ = decoded(robot.model.links[0].mesh)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], rel=0.05)


def test_meshes_that_touch_become_simple_shapes() -> None:
    collision = MESH.format(file="rod.stl").replace("visual", "collision")
    files = {"bug.urdf": bug(femur=collision), "rod.stl": stl(box_triangles((0.16, 0.02, 0.02)))}

    robot = read(zipped(files))
    (femur,) = (link for link in robot.model.links if link.name == "femur_rf")

    (capsule,) = femur.geoms
    assert capsule.kind == "capsule"
    # Along the link, which points to the front right at the angles 0.
    w, x, y, z = capsule.wxyz
    along = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    mount = np.array([0.06, 0.12, 0]) / math.hypot(0.06, 0.12)
    assert abs(along @ mount) == pytest.approx(1, abs=1e-4)


def test_of_several_documents_the_robot_is_found_or_chosen() -> None:
    files = {
        "package.xml": "<package/>",
        "small.urdf": bug({leg: SIX[leg] for leg in ("lf", "rf", "lr", "rr")}),
        "bug.urdf": bug(),
        "scene.xml": '<mujoco><include file="bug.urdf"/></mujoco>',
        "broken.xml": "<mujoco>",
    }

    chosen_file = Choices(file="small.urdf")
    best, chosen = read(zipped(files)), read(zipped(files), choices=chosen_file)

    assert (best.file, len(best.legs)) == ("bug.urdf", 6)
    assert mentions(best.guesses, "the robot is bug.urdf, not: small.urdf")
    assert inspect(zipped(files)).documents == ("bug.urdf", "small.urdf")
    assert (chosen.file, len(chosen.legs)) == ("small.urdf", 4)
    documents = inspect(zipped(files), choices=chosen_file).documents
    assert documents == ("small.urdf", "bug.urdf")
    with pytest.raises(InvalidInput, match=r"the zip has no 'big\.urdf'"):
        read(zipped(files), choices=Choices(file="big.urdf"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<robot/>", "the URDF has no <link>"),
        ('<robot><link name="${prefix}base"/></robot>', "in line 1: 'prefix' is not defined"),
        ('<robot><link name="a"/><link/></robot>', "each link needs a name of its own"),
        (bug().replace('name="j_coxa_lf"', 'name="j_coxa_rf"'), "each joint needs a name of its"),
        ('<robot><link name="a"/><link name="b"/></robot>', "2 have no parent: a, b"),
        (bug().replace('child link="coxa_lf"', 'child link="leg"'), "its child is no link: 'leg'"),
        (bug().replace('type="revolute"', 'type="magic"', 1), "its type must be one of revolute"),
        (bug().replace("1.5", "nan"), "value must be finite numbers, not nan"),
        (bug().replace("1.5", "1e308"), "value must be finite numbers, not 1e308"),
        (bug().replace("1.5", "heavy"), "value must be numbers, not 'heavy'"),
        (bug().replace('"0 0 1"', '"0 0 0"', 1), "axis too small"),
        (re.sub(r'xyz="0\.08', 'xyz="80', bug()), "m long; a leg has from"),
    ],
)
def test_what_is_no_robot_is_refused_with_a_sentence(text: str, said: str) -> None:
    with pytest.raises(InvalidInput, match=re.escape(said)):
        read(text, "bug.urdf")


def test_links_in_a_circle_are_refused() -> None:
    text = (
        '<robot><link name="r"/><link name="a"/><link name="b"/>'
        '<joint name="1" type="fixed"><parent link="a"/><child link="b"/></joint>'
        '<joint name="2" type="fixed"><parent link="b"/><child link="a"/></joint></robot>'
    )

    with pytest.raises(InvalidInput, match="their own ancestors"):
        read(text)
