"""The stage drawn in a real viser, checked by the scene nodes that are there."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from hexapods.domain.disturbances import Lost
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import Robot, ring
from hexapods.domain.world import UNDISTURBED, World
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import RecordedViser
from hexapods.runs.clocks import FINISH_LINE_M
from hexapods.runs.config import training_config
from hexapods.shows.scene_spec import idle_scene, rest_pose, training_scene
from hexapods.shows.stage_frame import ActionValuesView, Ghost, LaneFrame, SceneSpec
from tests.drawing.drawn_scene import GAIT, frame_at_rest, race_of, scene_nodes


def action_values(spec: SceneSpec, current: tuple[int, ...] = (0, 1, 2)) -> ActionValuesView:
    values = np.linspace(-0.01, 0.06, 3 * len(spec.grid)).reshape(3, -1)
    values[range(3), current] = np.nan
    return ActionValuesView(values, np.ones_like(values), current, None, -0.01, 0.06)


def robot_batches(server: RecordedViser) -> set[str]:
    """Return the names of the scene nodes that draw the robots."""
    nodes = scene_nodes(server).items()
    return {name for name, node in nodes if "/robots" in name and "batched_positions" in node}


def test_number_of_robot_nodes_does_not_depend_on_the_lanes(
    server: RecordedViser,
) -> None:
    StageScene(server).draw(frame_at_rest(race_of(3)))
    three = robot_batches(server)

    StageScene(server).draw(frame_at_rest(race_of(6)))
    six = robot_batches(server)

    assert three == six
    assert len(three) < 12


@pytest.mark.parametrize("legs", [4, 6, 8])
def test_robot_with_any_number_of_legs_follows_its_pose(legs: int) -> None:
    robot = Robot(legs=ring(legs))
    mesh = RobotMesh(robot)
    pose = mesh.default_qpos.copy()
    pose[:3] = 0.3, 0.4, 0.1

    positions, rotations = mesh.body_poses(pose)

    assert sum(len(part.links) for part in mesh.parts) < 2 + 1 + 6 * legs
    links = np.unique(np.concatenate([part.links for part in mesh.parts]))
    assert len(links) == 1 + 3 * legs, "torso, and coxa, femur and tibia of every leg"
    assert positions[links[0]] == pytest.approx([0.3, 0.4, 0.1])
    assert np.linalg.norm(rotations[links], axis=1) == pytest.approx(np.ones(len(links)))
    for part in mesh.parts:
        assert np.isfinite(part.shape.vertices).all()
        assert part.shape.faces.max() < len(part.shape.vertices)


def test_lanes_are_side_by_side_with_their_labels(server: RecordedViser) -> None:
    spec = race_of(3)
    scene = StageScene(server)
    scene.draw(frame_at_rest(spec))
    xs = [(scene.follow_position(view) or (np.nan,))[0] for view in ("1", "2", "3")]

    assert np.diff(xs) == pytest.approx([xs[2], xs[2]])
    assert xs[0] == -xs[2]
    assert xs[2] > 2 * spec.robot.home_radius_m, "they cannot touch"
    assert scene.follow_position("4") is None
    labels = [m["text"] for n, m in scene_nodes(server).items() if n.endswith("/label")]
    assert labels == [f"{lane_spec.name}\n0.00\u00a0m, step 3" for lane_spec in spec.lane_specs]


def test_start_and_finish_lines_are_labelled_beside_the_track(server: RecordedViser) -> None:
    scene = StageScene(server)
    scene.draw(frame_at_rest(race_of(2)))
    nodes = scene_nodes(server)
    words = {name: node for name, node in nodes.items() if name.endswith("/word")}

    assert {node["text"] for node in words.values()} == {"Start", "Finish"}
    (first,) = {node["position"] for node in words.values()}
    lanes = nodes["/world/run/track/finish"]["batched_positions"].reshape(-1, 3)
    width = lanes[1, 0] - lanes[0, 0]
    assert first[0] < lanes[0, 0] - width / 2, "where no robot walks"
    assert nodes["/world/run/track/start"]["position"][1] == 0
    assert nodes["/world/run/track/finish"]["position"][1] == FINISH_LINE_M


def test_each_lane_is_tinted_also_that_of_evaluations(server: RecordedViser) -> None:
    scene = StageScene(server)

    def tints() -> list[bytes]:
        nodes = scene_nodes(server)
        names = sorted(name for name in nodes if "/track/tint" in name)
        return [nodes[name]["glb_data"].tobytes() for name in names]

    scene.draw(frame_at_rest(race_of(3)))
    assert len(set(tints())) == 3
    scene.draw(frame_at_rest(training_scene(training_config(gait=GAIT, divisions=3))))
    assert len(tints()) == 2
    assert len(set(tints())) == 1, "the ghost is of the same agent"


def test_follow_point_of_the_leader_is_beside_the_robot_that_is_ahead(
    server: RecordedViser,
) -> None:
    spec, scene = race_of(2), StageScene(server)
    ahead = rest_pose(spec).copy()
    ahead[1] = 0.4
    first = frame_at_rest(spec)

    scene.draw(first)
    assert scene.follow_position("leader") == (0.0, 0.0, 0.0)
    scene.draw(replace(first, lanes=(first.lanes[0], LaneFrame(ahead, 9, 50, 0.4))))
    assert scene.follow_position("leader") == pytest.approx((0.0, 0.4, 0.0))


def test_unchanged_frame_sends_no_messages(server: RecordedViser) -> None:
    scene, frame = StageScene(server), frame_at_rest(race_of(3))
    with recorder(server) as recording:
        scene.draw(frame)
        assert recording.take().messages

        scene.draw(replace(frame, time_s=5.0))
        assert not recording.take().messages


def test_change_of_scene_removes_all_old_nodes(server: RecordedViser) -> None:
    scene = StageScene(server)
    practice = training_scene(training_config(gait=GAIT, divisions=3))
    ghosts = (Ghost(50, 0.1), Ghost(100, 0.3))

    def show_all() -> None:
        scene.draw(frame_at_rest(idle_scene()))
        scene.draw(replace(frame_at_rest(practice), ghosts=ghosts))
        scene.draw(replace(frame_at_rest(race_of(3)), phase="photo-finish"))
        scene.draw(frame_at_rest(race_of(6, Robot(legs=ring(8)))))
        scene.draw(frame_at_rest(race_of(2)))

    show_all()
    nodes = scene_nodes(server)
    for _ in range(4):  # an even number of scenes later the robots have the same names
        show_all()

    assert scene_nodes(server).keys() == nodes.keys()
    assert len(nodes) < 40


def test_robots_of_consecutive_scenes_share_no_node(server: RecordedViser) -> None:
    """A node that returns in the same window keeps the buffers of its batched meshes."""
    scene = StageScene(server)
    drawn: list[set[str]] = []
    for spec in (idle_scene(), race_of(3), race_of(3, Robot(legs=ring(8))), race_of(1)):
        scene.draw(frame_at_rest(spec))
        drawn.append(robot_batches(server))

    for before, after in pairwise(drawn):
        assert before
        assert not before & after
    assert drawn[0] & drawn[2], "names return, so that they stay few"


def test_cells_are_coloured_by_value_but_for_the_current_one(
    server: RecordedViser,
) -> None:
    spec, scene = race_of(1), StageScene(server)
    lane = replace(frame_at_rest(spec).lanes[0], action_values=action_values(spec))
    scene.draw(replace(frame_at_rest(spec), lanes=(lane,)))
    fills = scene_nodes(server)["/world/run/lane0/grid/others/fills"]
    colors = fills["batched_colors"].reshape(6, 4, 3)

    leader, partner = spec.gait.groups[2]
    assert (colors[leader - 1] == colors[partner - 1]).all(), "a pair is of one mind"
    best, present = colors[leader - 1, 3], colors[leader - 1, 1]
    assert best[0] > 120
    assert best[2] < 40
    assert present.max() < 20


def test_a_cell_that_was_never_tried_is_grey_whatever_its_value(server: RecordedViser) -> None:
    spec, scene = race_of(1), StageScene(server)
    values = action_values(spec)
    values.visits[2, 3:] = 0
    lane = replace(frame_at_rest(spec).lanes[0], action_values=values)
    scene.draw(replace(frame_at_rest(spec), lanes=(lane,)))
    fills = scene_nodes(server)["/world/run/lane0/grid/others/fills"]
    colors = fills["batched_colors"].reshape(6, 4, 3).astype(int)

    leader = spec.gait.groups[2][0] - 1
    is_grey = np.ptp(colors[leader], axis=1) < 20
    assert is_grey.tolist() == [False, True, True, True], "the present cell, and two of three"


def test_a_lost_leg_has_no_cells_until_it_is_repaired(server: RecordedViser) -> None:
    spec, scene = race_of(1), StageScene(server)

    def sizes(world: World) -> list[bool]:
        lane = replace(
            frame_at_rest(spec).lanes[0], action_values=action_values(spec), conditions=world
        )
        scene.draw(replace(frame_at_rest(spec), lanes=(lane,)))
        scales = scene_nodes(server)["/world/run/lane0/grid/others/fills"]["batched_scales"]
        shown = np.ones(24) if scales is None else np.asarray(scales)
        return [bool(leg.all()) for leg in np.split(shown, 6)]

    assert sizes(UNDISTURBED) == [True] * 6
    assert sizes(World((Lost(legs=(2, 5)),))) == [True, False, True, True, False, True]
    assert sizes(UNDISTURBED) == [True] * 6


@pytest.mark.parametrize("divisions", [2, 3, 8])
def test_grids_of_all_sizes_can_be_drawn(server: RecordedViser, divisions: int) -> None:
    spec = replace(race_of(1), grid=FootGrid(0.04, divisions))
    lane = replace(frame_at_rest(spec).lanes[0], action_values=action_values(spec))

    StageScene(server).draw(replace(frame_at_rest(spec), lanes=(lane,)))

    assert sum(name.endswith("/fills") for name in scene_nodes(server)) == 2


def lane_labels(server: RecordedViser) -> list[str]:
    """Return the texts of the robots' labels."""
    nodes = scene_nodes(server).items()
    return [node["text"] for name, node in nodes if re.search(r"/lane\d/label$", name)]


def test_photo_finish_shows_distances_and_is_removed(server: RecordedViser) -> None:
    spec, scene = race_of(2), StageScene(server)
    far = replace(frame_at_rest(spec).lanes[0], distance_m=0.375, rank=1)
    frame = replace(frame_at_rest(spec), lanes=(far, replace(far, distance_m=-0.01, rank=2)))

    scene.draw(replace(frame, phase="photo-finish"))
    bars = [name for name in scene_nodes(server) if "/photo/bar" in name]
    assert (len(bars), lane_labels(server)) == (
        2,
        ["1. Q-learning\n0.38\u00a0m", "2. Greedy\n−0.01\u00a0m"],
    )

    scene.draw(frame)
    assert not [name for name in scene_nodes(server) if "/photo" in name]
    assert lane_labels(server)[0] == "Q-learning\n0.38\u00a0m, step 3"


def test_photo_finish_is_redrawn_under_another_clock(server: RecordedViser) -> None:
    scene, frame = StageScene(server), frame_at_rest(race_of(3))
    scene.draw(replace(frame, phase="photo-finish"))
    retimed = tuple(replace(lane, distance_m=0.25, rank=2) for lane in frame.lanes)
    scene.draw(replace(frame, phase="photo-finish", lanes=retimed))

    assert [text.split("\n")[1] for text in lane_labels(server)] == ["0.25\u00a0m"] * 3


def test_a_flag_at_the_finish_line_shows_who_crossed_it(server: RecordedViser) -> None:
    spec, scene = race_of(1), StageScene(server)
    frame = frame_at_rest(spec)
    scene.draw(frame)
    scene.draw(replace(frame, lanes=(replace(frame.lanes[0], done=True),)))
    assert not scene_nodes(server)["/world/run/lane0/flag"]["visible"], "time-out is no crossing"

    scene.draw(replace(frame, lanes=(replace(frame.lanes[0], crossed_s=4.875),)))
    shown = scene_nodes(server)["/world/run/lane0/flag"]
    assert shown["visible"]
    assert shown["position"][1] == pytest.approx(FINISH_LINE_M)
