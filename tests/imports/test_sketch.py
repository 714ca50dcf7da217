"""The sketch of a robot's file, compared with MuJoCo's own model of it."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from hexapods.domain.model_geometry import home_angles
from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.compiling import silence_mujoco
from hexapods.imports.imported import RobotReading
from hexapods.imports.reading import read_in_this_process
from hexapods.imports.surfaces import triangles_of
from tests.imports.robots import FOUR, HOME, bug, dog

SPOT = dog(keyframes={"home": HOME})


def look(text: str, choices: Choices = AS_FOUND) -> RobotReading:
    silence_mujoco()
    return read_in_this_process(text.encode(), "robot.xml", choices)


def own_points(text: str, reading: RobotReading) -> dict[str, NDArray[np.float64]]:
    """Return the vertices of each body as MuJoCo places them, in the frame of the file."""
    robot = reading.valid_robot()
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for number, angles in home_angles(robot.model).items():
        for name, angle in zip(robot.legs[number - 1].joints, angles, strict=True):
            data.joint(name).qpos = angle
    mujoco.mj_kinematics(model, data)
    points: dict[str, list[NDArray[np.float64]]] = {}
    for geom in range(model.ngeom):
        body = model.body(int(model.geom_bodyid[geom])).name
        if body != "world":
            vertices, _ = triangles_of(model, geom)
            rotation = data.geom_xmat[geom].reshape(3, 3)
            points.setdefault(body, []).append(vertices @ rotation.T + data.geom_xpos[geom])
    return {body: np.concatenate(vertices) for body, vertices in points.items()}


@pytest.mark.parametrize("choices", [AS_FOUND, Choices(forward="y"), Choices(forward="-x")])
def test_bodies_are_where_mujoco_has_them(choices: Choices) -> None:
    reading = look(SPOT, choices)

    own = own_points(SPOT, reading)

    turn = np.radians(90 - reading.valid_robot().forward_deg)
    rotation = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    parts = {part.name: part for part in reading.sketch.parts}
    assert set(own) <= set(parts)
    torso, own_torso = parts["trunk"].mesh, own["trunk"] @ rotation.T
    assert torso is not None
    moved = torso.arrays()[0].mean(axis=0) - own_torso.mean(axis=0)
    for name, vertices in own.items():
        mesh = parts[name].mesh
        assert mesh is not None
        np.testing.assert_allclose(mesh.arrays()[0], vertices @ rotation.T + moved, atol=2e-6)


def test_feet_stand_on_the_ground_and_parts_know_their_legs() -> None:
    sketch = look(SPOT).sketch

    assert [foot.leg for foot in sketch.feet] == [1, 2, 3, 4]
    assert [foot.at_m[2] for foot in sketch.feet] == pytest.approx([0.02] * 4, abs=1e-5)
    assert min(part.low_m[2] for part in sketch.parts) == pytest.approx(0, abs=5e-4)
    legs = {part.name: part.leg for part in sketch.parts}
    assert (legs["trunk"], legs["FR_hip"], legs["FR_calf"], legs["RR_calf"]) == (0, 1, 1, 4)
    feet = {part.name: part.foot for part in sketch.parts}
    assert (feet["trunk"], feet["FR_hip"], feet["FR_thigh"]) == (None, None, "FR_thigh")
    assert feet["FR_calf"] == "FR", "as the leg's foot is called"


def test_a_file_of_two_legs_stands_on_its_lowest_point() -> None:
    reading = look(dog({leg: FOUR[leg] for leg in ("FL", "FR")}))

    assert reading.robot is None
    assert "found 2 legs" in str(reading.problem)
    assert [(foot.name, foot.leg) for foot in reading.sketch.feet] == [("FL", 0), ("FR", 0)]
    assert min(part.low_m[2] for part in reading.sketch.parts) == pytest.approx(0, abs=5e-4)


def test_bodies_without_shapes_are_rods() -> None:
    reading = look(bug(torso="", femur="", tip=""))

    sizes = {part.name: part.mesh for part in reading.sketch.parts}
    femur = sizes["femur_rf"]
    assert femur is not None
    vertices = femur.arrays()[0]
    joint, tip = vertices[:4].mean(axis=0), vertices[4:].mean(axis=0)
    assert np.linalg.norm(tip - joint) > 0.05


def test_many_triangles_are_fewer_in_the_sketch() -> None:
    balls = "".join(
        f'<geom type="sphere" size="0.0{n:03}" pos="0 0 0.{n:02}"/>' for n in range(10, 99)
    )
    sketch = look(dog(on_torso=balls, keyframes={"home": HOME})).sketch

    assert sum(part.mesh.triangles for part in sketch.parts if part.mesh) <= 45_000
