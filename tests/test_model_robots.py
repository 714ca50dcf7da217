"""Robots from files get through all that asks for legs: races, analysis, drawing and exports."""

import io

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

import hexapods as hx
from hexapods.assembly import build_learner
from hexapods.domain.disturbances import Lost, Stuck
from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_robot import model_robot
from hexapods.domain.robot_model import RobotModel
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.domain.world import World
from hexapods.drawing.robot_mesh import RobotMesh, antenna_m
from hexapods.exports.mcap_log import mcap_log
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.exports.servo_map import Servo, ServoMap
from hexapods.exports.servo_walk import servo_walk
from hexapods.exports.trajectory import trajectory_csv
from hexapods.runs.config import training_config
from hexapods.runs.gait_analysis import gait_figures
from hexapods.runs.recorded_walk import walk_of_lane
from hexapods.runs.training import train
from tests.model_robots import (
    four_joint_model,
    gait_of,
    mixed_model,
    quadruped_model,
    two_joint_model,
    with_meshes,
)

pytestmark = pytest.mark.test
STEPS = 8
MODELS = {
    "quadruped": (with_meshes(quadruped_model()), 12),
    "four joints": (four_joint_model(), 24),
    "mixed": (mixed_model(), 26),
    "two joints": (two_joint_model(), 8),
}


def raced(model: RobotModel, *agents: str, steps: int = STEPS) -> hx.Race:
    robot = model_robot(model, "own")
    gait = gait_of(robot)
    side_m = usual_grid_side_m(robot, gait)
    return hx.race(list(agents), gait=gait, robot=robot, steps=steps, grid_side_m=side_m)


@pytest.mark.test
@pytest.mark.parametrize("name", MODELS)
def test_they_are_recorded_analysed_drawn_and_exported(name: str) -> None:
    model, joints = MODELS[name]
    race = raced(model, "greedy")
    config, (lane,) = race.config, race.recording
    robot = config.robot
    legs, motion = legs_of(robot), lane.steps[STEPS - 1].motion
    labels = [joint.label for joint in legs.joints]

    assert lane.rest_qpos.shape == (legs.pose_size,) == (7 + joints,)
    assert motion.torque_nm is not None
    assert motion.torque_nm.shape == (len(motion.time_s), joints)

    figures = gait_figures(walk_of_lane(lane, config, config.world), 0, 10)
    assert figures is not None
    assert figures.effort is not None
    assert figures.effort.energy_j > 0
    assert figures.effort.largest_torque_nm <= figures.effort.torque_limit_nm * 1.001
    assert [leg.leg for leg in figures.legs] == list(range(1, len(legs) + 1))
    assert 0.3 < figures.duty_factor < 0.95
    assert figures.mass_kg == pytest.approx(sum(link.mass_kg for link in model.links))

    walks = RecordedWalks.of_race(config, [lane])
    head, first, *_ = "".join(trajectory_csv(lambda: walks, [0])).splitlines()
    row = dict(zip(head.split(","), first.split(","), strict=True))
    angles = np.array([float(row[f"{label}_rad"]) for label in labels])
    assert np.array_equal(angles.astype(np.float32), lane.rest_qpos[7:])
    foot_m = float(row[f"leg{len(legs)}_foot_z_m"])
    assert foot_m == pytest.approx(robot.foot_radius_m, abs=0.006)

    log = b"".join(mcap_log(RecordedWalks.of_race(config, [lane]), "free"))
    reader = make_reader(io.BytesIO(log), decoder_factories=[DecoderFactory()])
    *_, (_, _, _, last) = reader.iter_decoded_messages(["/lane0/joint_states"])
    assert [joint.name for joint in last.joints] == labels

    servos = (Servo(label, 0, number, 1500, 100) for number, label in enumerate(labels))
    walk = servo_walk(RecordedWalks.of_race(config, [lane]), ServoMap("own", tuple(servos)))
    assert walk.pulses_us.shape[1] == joints
    assert 'id="segment-paper-0"' in hx.view(race).page


def test_a_mesh_stands_for_its_link_and_the_torso_has_the_agents_colour() -> None:
    robot = model_robot(with_meshes(quadruped_model()), "own")
    mesh = RobotMesh(robot)
    names = [mesh.part_name(number) for number in range(len(mesh.parts))]

    torso = mesh.parts[0]
    assert names[0] == "0/torso"
    assert torso.painted
    assert len(torso.shape.faces) == 4, "its box is not drawn"
    assert len(torso.shape.vertices) == 12, "edges are sharp"
    assert np.ptp(torso.shape.vertices, axis=0) == pytest.approx([0.1, 0.3, 0.05], abs=1e-6)
    assert torso.shape.vertices.min(axis=0) == pytest.approx([0, 0, 0], abs=1e-6)
    wedges = [part for part in mesh.parts if len(part.shape.faces) == 4 and not part.painted]
    assert [len(part.links) for part in wedges] == [4], "equal meshes are instances of one"
    assert not any(part.painted for part in mesh.parts[1:-1])
    assert antenna_m(robot) == pytest.approx(0.15)
    assert mesh.parts[-1].shape.vertices[:, 2].max() > 0.15


def test_links_of_a_lost_leg_are_not_drawn_and_a_stuck_one_is_red() -> None:
    robot = model_robot(quadruped_model(), "own")
    mesh = RobotMesh(robot)
    world = World((Lost(legs=(2,)), Stuck(leg=3, joint="knee", angle_rad=0.1)))
    colors = {
        int(link): color
        for part in mesh.parts
        for link, color in zip(part.links, mesh.link_colors(part, (1, 2, 3), world), strict=True)
    }
    # Bodies: the world, the torso, and three of each leg.
    assert [colors[link] for link in (5, 6, 7)] == [None] * 3
    assert colors[10] == (226, 33, 52)
    assert colors[8] == colors[9] == (1, 2, 3)


def test_learners_and_searches_race_with_it_and_tell_why() -> None:
    race = raced(quadruped_model(), "greedy", "two-step", "linear-model", steps=6)

    assert [len(lane.steps) for lane in race.recording] == [6] * 3
    assert len(race.standings) == 3


@pytest.mark.test
def test_q_learning_practises_with_it() -> None:
    robot = model_robot(quadruped_model(), "own")
    side_m = usual_grid_side_m(robot, "trot")
    config = training_config(
        gait="trot", robot=robot, steps=60, seed=1, grid_side_m=side_m, evaluate_every=20
    )
    learner = build_learner(config)
    records = list(train(learner, config))

    assert len(records) >= 60
    assert learner.step == 60
