"""MJCF as other programs read it: elements that all have, every digit, the same motion."""

from collections.abc import Mapping
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from hexapods.domain.creatures import PRESETS
from hexapods.domain.model_robot import model_robot
from hexapods.domain.robot import Robot
from hexapods.exports.mjcf_text import with_depth
from hexapods.exports.robot_model import robot_mjcf
from hexapods.physics.mjcf import robot_spec
from tests.model_robots import (
    mesh_of,
    mixed_model,
    quadruped_model,
    two_joint_model,
    with_meshes,
)

PLACED = frozenset({"pos", "quat"})
READ_BY_ALL: Mapping[str, frozenset[str]] = {
    "mujoco": frozenset({"model"}),
    "compiler": frozenset({"angle"}),
    "option": frozenset({"timestep", "integrator", "jacobian"}),
    "custom": frozenset(),
    "numeric": frozenset({"name", "data"}),
    "text": frozenset({"name", "data"}),
    "asset": frozenset(),
    "mesh": frozenset({"name", "vertex", "face"}),
    "worldbody": frozenset(),
    "body": PLACED | {"name"},
    "inertial": PLACED | {"mass", "diaginertia"},
    "freejoint": frozenset({"name"}),
    "joint": frozenset(
        ["name", "pos", "axis", "limited", "range", "armature", "damping", "frictionloss"]
    ),
    "geom": PLACED
    | frozenset(["name", "type", "size", "mesh", "contype", "conaffinity", "condim", "group"])
    | frozenset(["priority", "friction", "solref", "solimp", "margin", "gap"]),
    "actuator": frozenset(),
    "position": frozenset({"name", "joint", "kp", "kv", "forcelimited", "forcerange"}),
    "keyframe": frozenset(),
    "key": frozenset({"name", "qpos", "ctrl"}),
}
"""What MuJoCo 3.2.0 to 4.0, its build for WebAssembly and dm_control.mjcf 1.0.50 read."""
MESHED = model_robot(with_meshes(quadruped_model()), "with meshes")
ROBOTS: dict[str, Robot] = {
    **PRESETS,
    "two joints": model_robot(two_joint_model(), "two joints"),
    "mixed": model_robot(mixed_model(), "a <name> / with & signs"),
    "meshes": MESHED,
}
STANDS_S = 2.0


@pytest.mark.parametrize("name", ROBOTS)
def test_it_has_what_every_reader_reads(name: str) -> None:
    for element in ElementTree.fromstring(robot_mjcf(ROBOTS[name])).iter():
        assert element.tag in READ_BY_ALL
        assert {*element.attrib} <= READ_BY_ALL[element.tag], element.tag


@pytest.mark.parametrize("name", ROBOTS)
def test_it_moves_to_the_last_bit_as_the_robot_that_is_simulated(name: str) -> None:
    robot = ROBOTS[name]
    read = mujoco.MjModel.from_xml_string(robot_mjcf(robot))
    simulated = robot_spec(robot).compile()
    states = []
    for model in (read, simulated):
        data = mujoco.MjData(model)
        data.qpos[:], data.ctrl[:] = read.key("home").qpos, read.key("home").ctrl
        mujoco.mj_step(model, data, round(STANDS_S / robot.dt_s))
        states.append(np.concatenate([data.qpos, data.qvel]))
    assert np.array_equal(states[0], states[1])
    for array in ("body_inertia", "body_iquat", "geom_pos", "geom_size", "geom_friction"):
        # Of a mesh they depend on how its inertia is computed, which MuJoCo does not need.
        if name != "meshes" or not array.startswith("geom"):
            assert np.array_equal(getattr(read, array), getattr(simulated, array)), array


def test_flat_meshes_have_a_depth_that_is_not_seen() -> None:
    flat = mesh_of(
        [(0, 0, 0), (0.1, 0, 0.1), (0, 0.1, 0.1), (0.1, 0.1, 0.2)], [(0, 1, 2), (1, 3, 2)]
    )
    vertices, faces = flat.arrays()
    deep, its_faces = with_depth(vertices, faces.astype(np.int32))
    assert np.array_equal(deep[:4], vertices)
    assert np.array_equal(its_faces[:2], faces)
    assert len(its_faces) == 3
    text = " ".join(map(str, deep.ravel())), " ".join(map(str, its_faces.ravel()))
    mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="flat" vertex="{text[0]}" face="{text[1]}"/></asset>'
        '<worldbody><geom type="mesh" mesh="flat" contype="0" conaffinity="0"/></worldbody>'
        "</mujoco>"
    )
    wedge = MESHED.model.links[0].mesh
    assert wedge is not None
    unchanged, _ = with_depth(wedge.arrays()[0], wedge.arrays()[1].astype(np.int32))
    assert len(unchanged) == 4
