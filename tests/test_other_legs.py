"""The interface of legs holds: other legs and larger groups get through all that asks it.

A robot of these tests has a fourth joint in each leg but the first: a tarsus that is held straight.
Nothing but its kinematics and its MuJoCo model knows that.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

import hexapods as hx
from hexapods.domain.creatures import own_gait
from hexapods.domain.disturbances import Limp, Lost, Stuck
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import Gait, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.kinematics import legs_of
from hexapods.domain.legs import FootKinematics, Joint, Legs
from hexapods.domain.observation import legal_actions, observe
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.simulator import Simulator
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.exports.mcap_log import mcap_log
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.exports.robot_model import robot_mjcf
from hexapods.exports.servo_map import Servo, ServoMap
from hexapods.exports.servo_walk import servo_walk
from hexapods.exports.trajectory import trajectory_csv
from hexapods.physics.mjcf import robot_spec
from hexapods.physics.mujoco_simulator import MujocoSimulator
from hexapods.runs.gait_analysis import gait_figures
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recorded_walk import walk_of_lane
from hexapods.runs.recording import LaneRecording

STEPS = 6
TARSUS_M, TARSUS_KG = 0.05, 0.01


@dataclass(frozen=True)
class WithTarsi(Robot):
    """The stiff robot with tarsi between tibia and foot; `tibia_m` is the length of both."""


class _LegsWithTarsi(Legs):
    def __init__(self, robot: WithTarsi) -> None:
        self._three = legs_of(Robot())
        joints: list[Joint] = []
        for leg in range(1, len(robot.legs) + 1):
            joints += self._three.of_leg(leg)
            joints += [Joint(leg, "tarsus", (-1.0, 1.0))] if leg > 1 else []
        tarsi_kg = [0.0, *[TARSUS_KG] * (len(robot.legs) - 1)]
        super().__init__(joints, np.add(self._three.masses_kg, tarsi_kg).tolist())
        self.others = [n for n, joint in enumerate(joints) if joint.name != "tarsus"]

    def feet_in_body(self, angles: FloatArray) -> FloatArray:
        return self._three.feet_in_body(angles[:, self.others])

    def links_in_body(self, angles: Sequence[float]) -> list[FloatArray]:
        links = self._three.links_in_body([angles[number] for number in self.others])
        share = TARSUS_M / Robot().tibia_m
        return [links[0]] + [
            np.insert(leg, 3, leg[3] + share * (leg[2] - leg[3]), axis=0) for leg in links[1:]
        ]

    def under(self, gait: Gait) -> FootKinematics:
        return _KinematicsWithTarsi(self, self._three.under(gait))


class _KinematicsWithTarsi(FootKinematics):
    def __init__(self, legs: _LegsWithTarsi, three: FootKinematics) -> None:
        self.legs, self._three, self._others = legs, three, legs.others
        self.homes_m, self.frames = three.homes_m, three.frames

    def mirrored(self, signs: FloatArray) -> FloatArray:
        return self._three.mirrored(signs)

    def solve(self, places: FloatArray, heights: FloatArray, frames: FloatArray) -> FloatArray:
        angles = self._three.solve(places, heights, frames)
        return np.concatenate((angles, np.zeros((*angles.shape[:-1], 1))), axis=-1)

    def foot_offsets(self, angles: Sequence[float]) -> list[tuple[float, float, float]]:
        return self._three.foot_offsets([angles[number] for number in self._others])


@legs_of.register
def _(robot: WithTarsi) -> Legs:
    return _LegsWithTarsi(robot)


@robot_spec.register
def _(robot: WithTarsi) -> mujoco.MjSpec:
    masses_kg = robot.coxa_kg, robot.femur_kg, robot.tibia_kg, TARSUS_KG
    legs = legs_of(robot)
    bodies = []
    for leg, mount in enumerate(robot.legs, start=1):
        reach, nested = mount.radius_m, f'<frame euler="0 0 {np.deg2rad(mount.azimuth_deg)}">'
        joints = legs.of_leg(leg)
        ends_m = [robot.tibia_m - TARSUS_M, TARSUS_M] if len(joints) == 4 else [robot.tibia_m]
        lengths_m = robot.coxa_m, robot.femur_m, *ends_m
        for joint, length, kg in zip(joints, lengths_m, masses_kg, strict=False):
            name, axis = joint.label, "0 0 1" if joint.name == "coxa" else "0 -1 0"
            low, high = joint.limits_rad
            nested += f"""<body name="{name}" pos="{reach} 0 0">
                <joint name="{name}" axis="{axis}" range="{low} {high}"/>
                <geom name="{name}" type="capsule" size=".008" fromto="0 0 0 {length} 0 0"
                    mass="{kg}"/>"""
            reach = length
        bodies.append(f"""{nested}<body name="leg{leg}_foot" pos="{reach} 0 0">
            <geom name="leg{leg}_foot" size="{robot.foot_radius_m}" mass="{robot.foot_kg}"
                friction="{robot.friction}"/></body>{"</body>" * len(joints)}</frame>""")
    servos = [f'<position name="{joint.label}" joint="{joint.label}"/>' for joint in legs.joints]
    limit = robot.servo_torque_nm
    return mujoco.MjSpec.from_string(f"""<mujoco>
        <compiler angle="radian" autolimits="true"/>
        <option timestep="{robot.dt_s}" integrator="implicitfast" jacobian="dense"/>
        <default>
            <joint armature="{robot.joint_armature}" damping="{robot.joint_damping}"/>
            <position kp="{robot.servo_kp}" kv="{robot.servo_kv}" forcerange="{-limit} {limit}"/>
            <geom group="1" priority="1" contype="1" conaffinity="0"/>
        </default>
        <worldbody>
            <geom name="ground" type="plane" size="0 0 1" group="0" priority="0"
                contype="0" conaffinity="1"/>
            <body name="torso" pos="0 0 {robot.body_height_m + robot.foot_radius_m}">
                <freejoint name="torso"/>
                <geom name="torso" type="cylinder" mass="{robot.torso_kg}"
                    size="{robot.torso_radius_m} {robot.torso_half_height_m}"/>
                {"".join(bodies)}
            </body>
        </worldbody>
        <actuator>{"".join(servos)}</actuator>
    </mujoco>""")


def raced(robot: Robot) -> hx.Race:
    """Return a race of greedy alone, with physics and torques."""
    gait = own_gait(robot) if robot.name in PRESETS else "left-right-origin"
    return hx.race(["greedy"], gait=gait, robot=robot, steps=STEPS)


def table_of(config: RaceConfig, lane: LaneRecording) -> tuple[list[str], FloatArray]:
    """Return the columns of the trajectory, and its numbers."""
    walks = RecordedWalks.of_race(config, [lane])
    head, *rows = "".join(trajectory_csv(lambda: walks, [0])).splitlines()
    cells = [row.split(",") for row in rows]
    assert {row.pop() for row in cells} == {"free"}, "the last column names the clock"
    numbers = np.array([[float(number or "nan") for number in row] for row in cells])
    return head.split(",")[:-1], numbers


@pytest.mark.test
@pytest.mark.parametrize(
    ("robot", "joints"),
    [
        pytest.param(robot({"n_legs": 8}), 24, id="eight legs"),
        pytest.param(robot("starfish"), 15, id="five legs in groups of two and one"),
        pytest.param(robot("ant"), 18, id="legs of different lengths on a long body"),
        pytest.param(robot("centipede"), 36, id="twelve legs"),
        pytest.param(WithTarsi(), 23, id="four joints in all legs but one"),
    ],
)
def test_other_legs_are_recorded_analysed_drawn_and_exported(robot: Robot, joints: int) -> None:
    race = raced(robot)
    config, (lane,) = race.config, race.recording
    legs, motion = legs_of(robot), lane.steps[STEPS - 1].motion
    labels = [joint.label for joint in legs.joints]

    assert lane.distance_m > 0.03
    assert lane.rest_qpos.shape == (legs.pose_size,) == (7 + joints,)
    assert motion.torque_nm is not None
    assert motion.torque_nm.shape == (len(motion.time_s), joints)

    figures = gait_figures(walk_of_lane(lane, config, config.world), 0, 10)
    assert figures is not None
    assert figures.effort is not None
    assert figures.effort.energy_j > 0
    assert [leg.leg for leg in figures.legs] == list(range(1, len(legs) + 1))
    assert 0.5 < figures.duty_factor < 0.95
    assert figures.mass_kg == pytest.approx(float(robot_spec(robot).compile().body_mass.sum()))

    columns, rows = table_of(config, lane)
    angles = rows[:, [columns.index(f"{label}_rad") for label in labels]]
    assert np.array_equal(angles[0].astype(np.float32), lane.rest_qpos[7:])
    foot_m = rows[:, columns.index(f"leg{len(legs)}_foot_z_m")]
    assert foot_m[0] == pytest.approx(robot.foot_radius_m, abs=0.004)

    log = b"".join(mcap_log(RecordedWalks.of_race(config, [lane]), "free"))
    reader = make_reader(io.BytesIO(log), decoder_factories=[DecoderFactory()])
    topics = ["/lane0/joint_states"]
    *_, (_, _, _, last) = reader.iter_decoded_messages(topics)
    assert [joint.name for joint in last.joints] == labels
    assert [joint.position for joint in last.joints] == motion.qpos[-1, 7:].tolist()

    servos = (Servo(label, 0, number, 1500, 100) for number, label in enumerate(labels))
    walk = servo_walk(RecordedWalks.of_race(config, [lane]), ServoMap("own", tuple(servos)))
    assert walk.pulses_us[-1].tolist() == np.rint(1500 + 100 * motion.qpos[-1, 7:]).tolist()
    assert mujoco.MjModel.from_xml_string(robot_mjcf(robot)).nu == joints

    drawn = RobotMesh(robot).body_poses(lane.rest_qpos).positions
    assert len(drawn) == 2 + joints + len(legs)  # world and torso, links, feet
    assert 'id="segment-paper-0"' in hx.view(race).page


def test_joints_that_are_held_straight_change_little() -> None:
    (more,), (three,) = raced(WithTarsi()).recording, raced(Robot()).recording

    assert more.distance_m == pytest.approx(three.distance_m, rel=0.1)


def test_what_happens_to_legs_happens_to_all_of_their_joints() -> None:
    robot = WithTarsi()
    world = World((Limp(legs=(1,)), Lost(legs=(2,)), Stuck(leg=3, joint="tibia", angle_rad=-1.5)))
    gait = resolve("left-right-origin", robot.azimuths_deg)
    model = MujocoSimulator(robot, gait, FootGrid(), world=world).model

    is_powered = model.actuator_gainprm[:, 0] > 0
    assert np.array_equal(is_powered, legs_of(robot).leg_of_joint >= 2)
    assert not any(model.geom(f"leg2_{link}").contype for link in ("coxa", "tarsus", "foot"))


@dataclass(frozen=True)
class TwoJoints(Robot):
    """A robot whose legs have a hip and a knee."""


class _TwoJointLegs(_LegsWithTarsi):
    def __init__(self, robot: TwoJoints) -> None:
        joints = [Joint(leg, name, (-1, 1)) for leg in range(1, 7) for name in ("hip", "knee")]
        Legs.__init__(self, joints, [0.1] * len(robot.legs))


@legs_of.register
def _(robot: TwoJoints) -> Legs:
    return _TwoJointLegs(robot)


def test_a_joint_that_a_robot_does_not_have_cannot_be_stuck() -> None:
    world = World((Stuck(leg=2, joint="tibia", angle_rad=-1.0),))
    with pytest.raises(InvalidInput, match="leg 2 has no joint tibia; its joints are: hip, knee"):
        world.check(TwoJoints(), "mujoco")


@pytest.mark.parametrize(
    ("build", "tolerance"), [(KinematicSimulator, 1e-3), (MujocoSimulator, 0.05)]
)
def test_groups_of_three_walk_by_the_law(
    build: type[KinematicSimulator | MujocoSimulator], tolerance: float
) -> None:
    grid = FootGrid()
    simulator: Simulator[Any] = build(Robot(), resolve("tripod", Robot().azimuths_deg), grid)
    state, advances_m = simulator.rest(), []
    for _ in range(12):
        legal = legal_actions(observe(simulator, state, "measured"), len(grid))
        expansion = simulator.expand([state] * len(legal), legal)
        assert len(legal) == 2 * (len(grid) - 1)
        best = int(expansion.rewards_m.argmax())
        state = expansion.states[best]
        advances_m.append(float(expansion.rewards_m[best]))

    # Two groups of equal size: 2h / (G + 1) a step.
    assert np.mean(advances_m[6:]) == pytest.approx(grid.side_m / 3, rel=tolerance)
