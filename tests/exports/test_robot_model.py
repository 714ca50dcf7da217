"""A robot as MJCF: plain MuJoCo loads the one file, and the robot stands in it."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from hexapods.domain.creatures import CREATURES, PRESETS
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot, robot
from hexapods.exports.robot_model import robot_mjcf
from hexapods.physics.mjcf import compile_visual_model

OWN = robot({"n_legs": 5, "mount_radius_m": 0.12, "torso_kg": 2.5, "servo_kp": 60})
STANDS_S = 1.0


def loaded(robot: Robot, folder: Path) -> mujoco.MjModel:
    """Return the model, from a folder with nothing else in it."""
    file = folder / "robot.xml"
    file.write_text(robot_mjcf(robot))
    return mujoco.MjModel.from_xml_path(str(file))


@pytest.mark.parametrize("name", CREATURES)
def test_each_creature_stands_in_its_home_stance(name: str, tmp_path: Path) -> None:
    robot = PRESETS[name]
    model = loaded(robot, tmp_path)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)

    feet = np.array([data.geom(f"leg{leg}_foot").xpos for leg in range(1, len(robot.legs) + 1)])
    homes = [(*home, robot.foot_radius_m) for home in robot.homes_m]
    assert feet == pytest.approx(np.array(homes), abs=1e-5)

    begin_m = data.qpos[2]
    mujoco.mj_step(model, data, round(STANDS_S / robot.dt_s))

    upright = data.body("torso").xmat[8]
    assert upright > 0.98
    assert data.qpos[2] > 0.7 * begin_m
    assert np.abs(data.qpos[:2]).max() < 0.01, "it did not slide away"


@pytest.mark.parametrize("robot", [PRESETS["spider"], OWN], ids=lambda robot: robot.name)
def test_it_is_the_robot_that_is_simulated(robot: Robot, tmp_path: Path) -> None:
    model, visual = loaded(robot, tmp_path), compile_visual_model(robot)
    joints = [joint.label for joint in legs_of(robot).joints]

    assert [model.actuator(number).name for number in range(model.nu)] == joints
    assert model.opt.timestep == robot.dt_s
    for name in ("body_mass", "jnt_range", "dof_damping", "dof_armature", "geom_friction"):
        assert getattr(model, name) == pytest.approx(getattr(visual, name), rel=1e-5), name
    for name in ("actuator_gainprm", "actuator_biasprm", "actuator_forcerange", "geom_size"):
        assert getattr(model, name) == pytest.approx(getattr(visual, name), rel=1e-5), name


def test_a_robot_that_no_named_gait_suits_has_a_model_too(tmp_path: Path) -> None:
    legs = [{"x_m": 0.1, "y_m": y} for y in (0.1, 0.0, -0.1)] + [{"x_m": -0.1, "y_m": 0.02}]
    assert loaded(robot({"legs": legs}), tmp_path).nu == 12
