"""Robots from files in MuJoCo: their numbers, what happens to them, and how far they walk."""

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

import hexapods as hx
from hexapods.domain.disturbances import (
    DeadBand,
    Delay,
    Disturbance,
    Friction,
    Limp,
    Lost,
    Patch,
    Payload,
    Push,
    Rough,
    SensorNoise,
    Slope,
    Stuck,
    Weak,
)
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_robot import ModelRobot, model_robot
from hexapods.domain.robot import PRESETS, Robot, changed_model
from hexapods.domain.robot_model import RobotModel
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.domain.tolerance import build_tolerance
from hexapods.domain.types import Action
from hexapods.domain.world import World
from hexapods.exports.robot_model import robot_mjcf
from hexapods.physics.mjcf import compile_model, compile_visual_model
from hexapods.physics.mujoco_simulator import MujocoSimulator
from tests.model_robots import (
    four_joint_model,
    gait_of,
    mixed_model,
    model_of,
    quadruped_model,
    two_joint_model,
    with_meshes,
)

AS_BUILT_IN = {"step_height_m": 0.03, "swing_s": 0.2, "shift_s": 0.12}


def simulator_of(robot: ModelRobot, *disturbances: Disturbance, **more: Any) -> MujocoSimulator:
    gait = gait_of(robot)
    grid = FootGrid(usual_grid_side_m(robot, gait))
    world = World(disturbances)
    return MujocoSimulator(robot, resolve(gait, robot.azimuths_deg), grid, world=world, **more)


def walked_m(simulator: MujocoSimulator, steps: int = 4) -> float:
    state = simulator.rest()
    for number in range(steps):
        state = simulator.step(state, Action(number % 2, 1 + number % 2)).state
    return state.distance_m


@pytest.mark.parametrize("name", ["stiff", "dog", "compliant"])
def test_the_model_of_a_built_in_robot_is_built_alike(name: str) -> None:
    built_in = compile_model(PRESETS[name])
    from_file = compile_model(model_robot(model_of(PRESETS[name]), name))
    for field in (
        "body_mass", "body_inertia", "body_pos", "dof_armature", "dof_damping", "jnt_range",
        "jnt_axis", "actuator_gainprm", "actuator_biasprm", "actuator_forcerange", "geom_friction",
        "geom_solref", "geom_solimp", "geom_margin", "geom_condim", "geom_priority",
    ):  # fmt: skip
        built_in_values, values = (
            np.sort(getattr(model, field).ravel()) for model in (built_in, from_file)
        )
        assert values == pytest.approx(built_in_values, abs=1e-9), field
    assert from_file.opt.integrator == built_in.opt.integrator
    labels = {from_file.joint(number).name for number in range(1, from_file.njnt)}
    assert labels == {
        joint.label for joint in legs_of(model_robot(model_of(PRESETS[name]), name)).joints
    }


@pytest.mark.test
@pytest.mark.parametrize("gait", ["left-right-origin", "tripod"])
def test_it_walks_as_far_as_the_built_in_one(gait: str) -> None:
    robot_of_model = model_robot(model_of(Robot()), "own", **AS_BUILT_IN)
    own_m, built_in_m = (
        hx.race(["greedy"], gait=gait, robot=robot, steps=12).recording[0].distance_m
        for robot in (robot_of_model, Robot())
    )

    assert built_in_m > 0.1
    assert own_m == pytest.approx(built_in_m, rel=0.01)


@pytest.mark.test
@pytest.mark.parametrize(
    ("model", "least_m"),
    [
        pytest.param(quadruped_model(), 0.6, id="quadruped"),
        pytest.param(four_joint_model(), 0.35, id="four joints"),
        pytest.param(mixed_model(), 0.35, id="mixed"),
        pytest.param(two_joint_model(), 0.15, id="two joints"),
    ],
)
def test_robots_of_any_chains_walk(model: RobotModel, least_m: float) -> None:
    robot = model_robot(model, "own")
    gait = gait_of(robot)
    side_m = usual_grid_side_m(robot, gait)
    race = hx.race(["greedy", "linear-model"], gait=gait, robot=robot, steps=30, grid_side_m=side_m)
    greedy, learner = race.recording

    assert greedy.distance_m > least_m
    assert learner.distance_m > 0.3 * least_m
    heights = [step.motion.qpos[:, 2].min() for step in greedy.steps]
    assert min(heights) > 0.7 * (robot.body_height_m + robot.foot_radius_m), "it stands"


@pytest.mark.parametrize("model", [quadruped_model(), mixed_model()], ids=["quadruped", "mixed"])
def test_one_step_equals_many_to_the_last_bit(model: RobotModel) -> None:
    simulator = simulator_of(model_robot(model, "own"), threads=2)
    start = simulator.step(simulator.rest(), Action(0, 1)).state
    actions = [Action(group, cell) for group in (0, 1) for cell in range(1, 5)]
    expansion = simulator.expand([start] * len(actions), actions)

    for number, action in enumerate(actions):
        step = simulator.step(start, action)
        assert step.reward_m == expansion.rewards_m[number]
        assert step.state.row.tobytes() == expansion.states[number].row.tobytes()


@pytest.mark.parametrize(
    "happens",
    [
        Limp(legs=(2,)),
        Lost(legs=(1, 3)),
        Weak(legs=(1,), torque_share=0.5),
        Stuck(leg=2, joint="knee", angle_rad=0.1),
        Slope(degrees=5),
        Rough(amplitude_m=0.01),
        Friction(value=0.3),
        Patch(from_m=0.05, to_m=0.2, friction=0.1),
        Payload(kg=2, x_m=0.05),
        Push(impulse_ns=4),
        Delay(seconds=0.02),
        DeadBand(radians=0.02),
    ],
    ids=lambda disturbance: disturbance.kind,
)
def test_what_happens_changes_its_walk(happens: Disturbance) -> None:
    robot = model_robot(quadruped_model(), "own")
    changed_m = walked_m(simulator_of(robot, happens))

    assert np.isfinite(changed_m)
    assert changed_m != walked_m(simulator_of(robot))


def test_noise_of_sensors_moves_what_is_measured() -> None:
    robot = model_robot(quadruped_model(), "own")
    simulator = simulator_of(robot, SensorNoise(sd_m=0.01))
    state = simulator.rest()
    moved = simulator.estimate(state, np.array([[0.01, 0.0], [0.0, -0.02]]))
    before, after = (np.array(simulator.group_offsets(start)) for start in (state, moved))

    assert after - before == pytest.approx(np.array([[0.01, 0.0], [0.0, -0.02]]), abs=1e-6)
    assert simulator.estimate(state, np.zeros((2, 2))).row.tobytes() == state.row.tobytes()


def test_a_lost_leg_weighs_nothing_and_a_stuck_joint_holds_its_angle() -> None:
    robot = model_robot(quadruped_model(), "own")
    whole, lacks = compile_model(robot), compile_model(robot, World((Lost(legs=(2,)),)))
    gone = float(whole.body_mass.sum() - lacks.body_mass.sum())
    assert gone == pytest.approx(legs_of(robot).masses_kg[1], abs=1e-4)
    assert not any(lacks.geom(f"leg2_{link}").contype for link in ("hip", "thigh", "foot"))
    assert whole.nq == lacks.nq

    simulator = simulator_of(robot, Stuck(leg=3, joint="thigh", angle_rad=0.2))
    state = simulator.step(simulator.rest(), Action(0, 1)).state
    joint = legs_of(robot).index(3, "thigh")
    assert simulator.pose(state)[7 + joint] == pytest.approx(0.2, abs=0.05)

    with pytest.raises(InvalidInput, match="leg 2 has no joint tibia; its joints are: hip, thigh"):
        simulator_of(robot, Stuck(leg=2, joint="tibia", angle_rad=0.0))
    with pytest.raises(InvalidInput, match=r"the hip of leg 2 turns from -2.5 to 2.5 rad"):
        simulator_of(robot, Stuck(leg=2, joint="hip", angle_rad=3.0))


def test_every_joint_has_its_own_torque() -> None:
    model = quadruped_model()
    links = tuple(
        replace(link, joint=replace(link.joint, servo_torque_nm=7.0))
        if link.joint is not None and link.joint.name == "hip"
        else link
        for link in model.links
    )
    robot = changed_model(
        model_robot(replace(model, links=links), "own"), {"servo_torque_nm": 50.0}
    )
    compiled = compile_model(robot)

    limits = {
        compiled.actuator(number).name: compiled.actuator_forcerange[number, 1]
        for number in range(compiled.nu)
    }
    assert limits["leg1_hip"] == pytest.approx(14.0)
    assert limits["leg1_knee"] == pytest.approx(50.0)


def test_a_robot_that_was_built_with_tolerance_walks_like_the_designed_one() -> None:
    robot = model_robot(quadruped_model(), "own")
    built = build_tolerance(robot, 0.05, np.random.default_rng(1))
    built_m, designed_m = walked_m(simulator_of(robot, built=built)), walked_m(simulator_of(robot))

    assert built_m != designed_m
    assert built_m == pytest.approx(designed_m, abs=0.05)


def test_meshes_are_drawn_and_not_simulated() -> None:
    plain, meshed = quadruped_model(), with_meshes(quadruped_model())
    drawn, simulated = (
        compile_visual_model(model_robot(meshed, "a")),
        compile_model(model_robot(meshed, "a")),
    )

    assert drawn.nmesh == 2  # those of the legs are equal
    assert drawn.geom("torso_mesh").group == 1
    assert drawn.geom("torso").group == 3, "its geoms are not drawn"
    assert drawn.geom("leg1_hip").group == 1, "a link without a mesh shows its geoms"
    assert simulated.nmesh == 0
    assert walked_m(simulator_of(model_robot(meshed, "a"))) == walked_m(
        simulator_of(model_robot(plain, "b"))
    )


def test_its_mjcf_has_all_in_one_text() -> None:
    robot = model_robot(with_meshes(quadruped_model()), "own")
    loaded = mujoco.MjModel.from_xml_string(robot_mjcf(robot))
    data = mujoco.MjData(loaded)
    mujoco.mj_resetDataKeyframe(loaded, data, 0)
    for _ in range(300):
        mujoco.mj_step(loaded, data)

    assert loaded.nmesh == 2
    assert float(loaded.body_mass.sum()) == pytest.approx(6 + 12 * 0.3)
    assert data.qpos[2] == pytest.approx(0.38, abs=0.01), "it stands in plain MuJoCo"
