"""The MuJoCo model of a robot: masses, servos, joint limits, contacts and names."""

from typing import Any

import mujoco
import numpy as np
import pytest

from hexapods.assets import models_dir
from hexapods.domain.gait import PAPER_GAITS, resolve
from hexapods.domain.kinematics import JOINT_LIMITS_RAD, legs_of
from hexapods.domain.robot import Robot, ring, robot
from hexapods.physics.mjcf import (
    VISIBLE_GROUP,
    compile_model,
    compile_visual_model,
    robot_spec,
)


@pytest.fixture(scope="module")
def model() -> Any:
    return compile_model(Robot())


def test_elements_are_named_by_leg_and_link(model: Any) -> None:
    joints = [f"leg{leg}_{link}" for leg in range(1, 7) for link in JOINT_LIMITS_RAD]

    assert [model.joint(i).name for i in range(model.njnt)] == ["torso", *joints]
    assert [model.actuator(i).name for i in range(model.nu)] == joints
    feet = [f"leg{leg}_foot" for leg in range(1, 7)]
    for name in ("torso", *joints, *feet):
        assert model.body(name).name == model.geom(name).name == name


def test_it_has_a_free_torso_and_eighteen_servos(model: Any) -> None:
    assert (model.nq, model.nv, model.nu) == (7 + 18, 6 + 18, 18)
    for servo in range(18):
        assert model.joint(model.actuator(servo).trnid[0]).name == model.actuator(servo).name


def test_masses_are_those_of_the_robot(model: Any) -> None:
    masses = {"torso": 1.2, "coxa": 0.06, "femur": 0.06, "tibia": 0.03, "foot": 0.01}

    assert model.body_mass.sum() == pytest.approx(2.16)
    assert model.body("torso").mass == pytest.approx(1.2)
    for leg in range(1, 7):
        for link in ("coxa", "femur", "tibia", "foot"):
            assert model.body(f"leg{leg}_{link}").mass == pytest.approx(masses[link])


def test_inertias_are_those_of_the_collision_shapes(model: Any) -> None:
    cylinder = 1.2 * np.array(
        [(3 * 0.1**2 + 0.04**2) / 12, (3 * 0.1**2 + 0.04**2) / 12, 0.1**2 / 2]
    )
    assert np.sort(model.body("torso").inertia) == pytest.approx(np.sort(cylinder))
    sphere = 0.4 * 0.01 * 0.012**2
    assert model.body("leg1_foot").inertia == pytest.approx(sphere)
    rod = 0.03 * 0.13**2 / 12  # of a thin rod, an approximation
    assert model.body("leg1_tibia").inertia.max() == pytest.approx(rod, rel=0.2)


def test_all_that_has_mass_touches_the_ground_alone(model: Any) -> None:
    ground = np.array([model.geom(i).name == "ground" for i in range(model.ngeom)])

    assert ground.sum() == 1
    assert (model.geom_contype[~ground] == 1).all()
    assert (model.geom_conaffinity[~ground] == 0).all()
    assert model.geom("ground").contype == 0
    assert model.geom("ground").conaffinity == 1
    assert (model.geom_priority[~ground] > model.geom("ground").priority).all()


def test_what_is_only_drawn_has_no_mass_and_is_not_simulated(model: Any) -> None:
    drawn = compile_visual_model(Robot())
    only_drawn = (drawn.geom_contype == 0) & (drawn.geom_conaffinity == 0)

    assert only_drawn.sum() > 6 * 8
    assert (drawn.geom_group[only_drawn] == VISIBLE_GROUP).all()
    assert model.ngeom == drawn.ngeom - only_drawn.sum() == 1 + 1 + 6 * 4
    for field in ("body_mass", "body_inertia", "body_ipos", "body_iquat"):
        assert (getattr(model, field) == getattr(drawn, field)).all(), field


@pytest.mark.parametrize("name", ["stiff", "compliant", "slippery"])
def test_servos_friction_and_time_are_the_robots(name: str) -> None:
    preset = robot(name)
    model = compile_model(preset)

    assert model.opt.timestep == 0.004
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert (model.actuator_gainprm[:, 0] == preset.servo_kp).all()
    assert (model.actuator_biasprm[:, 1] == -preset.servo_kp).all()
    assert (model.actuator_biasprm[:, 2] == -preset.servo_kv).all()
    assert (model.actuator_forcerange == (-1.5, 1.5)).all()
    assert model.actuator_forcelimited.all()
    assert (model.dof_armature[6:] == 0.002).all()
    assert (model.dof_damping[6:] == 0.05).all()
    assert model.geom("leg4_foot").friction[0] == preset.friction
    assert model.geom("leg4_foot").priority > model.geom("ground").priority


def test_joint_ranges_are_the_limits_of_the_kinematics(model: Any) -> None:
    for leg in range(1, 7):
        for link, limits in JOINT_LIMITS_RAD.items():
            joint = model.joint(f"leg{leg}_{link}")
            assert tuple(joint.range) == limits
            assert joint.limited


def test_the_xml_files_describe_the_default_robot() -> None:
    """The parameters that `mjcf` sets equal those of the files for the default robot."""
    spec = mujoco.MjSpec.from_file(str(models_dir() / "torso.xml"))
    for number, mount in enumerate(ring(6), start=1):
        turn = np.deg2rad(mount.azimuth_deg)
        frame = spec.body("torso").add_frame(
            pos=[0.1 * np.cos(turn), 0.1 * np.sin(turn), 0],
            quat=[np.cos(turn / 2), 0, 0, np.sin(turn / 2)],
        )
        leg = mujoco.MjSpec.from_file(str(models_dir() / "leg.xml"))
        spec.attach(leg, prefix=f"leg{number}_", frame=frame)
    drawn, built = spec.compile(), robot_spec(Robot()).compile()

    for field in (
        "body_mass",
        "body_inertia",
        "body_pos",
        "body_quat",
        "geom_size",
        "geom_pos",
        "geom_friction",
        "jnt_range",
        "jnt_axis",
        "dof_armature",
        "dof_damping",
        "actuator_gainprm",
        "actuator_biasprm",
        "actuator_forcerange",
    ):
        assert np.allclose(getattr(drawn, field), getattr(built, field), atol=1e-12), field
    assert drawn.opt.timestep == built.opt.timestep


@pytest.mark.parametrize("legs", [4, 6, 8, 10, 12])
def test_the_number_of_legs_is_a_parameter(legs: int) -> None:
    model = compile_model(robot({"n_legs": legs}))

    assert model.nu == 3 * legs
    assert model.body_mass.sum() == pytest.approx(1.2 + 0.16 * legs)


def test_links_masses_and_torso_scale_with_the_robot() -> None:
    scaled = robot(
        {
            "coxa_m": 0.04,
            "femur_m": 0.1,
            "tibia_m": 0.15,
            "femur_kg": 0.09,
            "torso_radius_m": 0.12,
            "torso_half_height_m": 0.03,
            "foot_radius_m": 0.015,
            "mount_radius_m": 0.12,
        }
    )
    model = compile_model(scaled)

    assert model.body("leg2_femur").pos == pytest.approx((0.04, 0, 0))
    assert model.body("leg2_tibia").pos == pytest.approx((0.1, 0, 0))
    assert model.body("leg2_foot").pos == pytest.approx((0.15, 0, 0))
    assert model.body("leg2_coxa").pos == pytest.approx((0.06, 0.12 * np.sqrt(3) / 2, 0))
    assert model.body_mass.sum() == pytest.approx(2.16 + 6 * 0.03)
    assert model.geom("torso").size[:2] == pytest.approx((0.12, 0.03))
    assert model.geom("leg3_foot").size[0] == 0.015
    # A capsule's size is (radius, half-length).
    assert model.geom("leg5_tibia").size[:2] == pytest.approx((0.006, 0.075))


@pytest.mark.parametrize("gait", PAPER_GAITS)
def test_inverse_kinematics_and_the_model_agree_on_the_feet(gait: str) -> None:
    model, resolved = compile_model(Robot()), resolve(gait, Robot().azimuths_deg)
    offsets = np.random.default_rng(0).uniform(-0.03, 0.03, (6, 3))
    data = mujoco.MjData(model)
    data.qpos[:7] = 0, 0, 0, 1, 0, 0, 0
    data.qpos[7:] = legs_of(Robot()).under(resolved).joint_angles(offsets)
    mujoco.mj_kinematics(model, data)

    turn = np.deg2rad(resolved.forward_deg)
    forward = np.array([np.cos(turn), np.sin(turn), 0])
    right = np.array([np.sin(turn), -np.cos(turn), 0])
    for leg, azimuth in enumerate(Robot().azimuths_deg):
        away = np.deg2rad(azimuth)
        home = np.array([0.25 * np.cos(away), 0.25 * np.sin(away), -0.09])
        x, y, z = offsets[leg]
        foot = home + x * right + y * forward + (0, 0, z)
        assert data.body(f"leg{leg + 1}_foot").xpos == pytest.approx(foot, abs=1e-12)
