"""The stage drawn in a real viser, as a real client is told it."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.domain.grid import FootGrid
from app.domain.robot import Robot, ring
from app.runs.config import LaneConfig, RaceConfig, TrainingConfig
from app.stage.scene_spec import idle_scene, race_scene, rest_pose, training_scene
from app.stage.stage_frame import ActionValuesView, Ghost, LaneView, SceneSpec, StageFrame
from app.viewer import wire
from app.viewer.in_process import InProcessViser, in_process_viser
from app.viewer.robot_mesh import RobotMesh
from app.viewer.scene import StageScene
from app.viewer.snapshot import Snapshot
from app.viewer.update_cost import measure_stage_update
from tests.viewer.serving import Reader

GAIT = "left-right-vertical"


@pytest.fixture
def server() -> Iterator[InProcessViser]:
    with in_process_viser() as started:
        yield started


def told(server: InProcessViser) -> dict[str, dict[str, Any]]:
    """Every node of the scene with its properties, as a newcomer is told them."""
    snapshot = Snapshot()
    with Reader(server) as reader:
        while not snapshot.complete:
            snapshot.apply(reader.frame())
    frame, nodes = snapshot.pack(), dict[str, dict[str, Any]]()
    for message in frame.messages:
        if not message.get("name", "").startswith("/world"):
            continue
        node = nodes.setdefault(message["name"], {})
        properties = message.get("props") or message.get("updates") or message
        node.update({name: plain(value, frame) for name, value in properties.items()})
    return nodes


def plain(value: Any, frame: wire.Frame) -> Any:
    """A property, or the array that it names."""
    if isinstance(value, dict) and "__binary_index" in value:
        return np.frombuffer(frame.buffers[value["__binary_index"]], value["dtype"])
    return value


def race_of(lanes: int, robot: Robot | None = None) -> SceneSpec:
    agents = ("q-learning", "greedy", "two-step", "greedy", "greedy", "greedy")[:lanes]
    config = RaceConfig(
        gait=GAIT, robot=robot or Robot(), lanes=tuple(LaneConfig(agent=a) for a in agents)
    )
    return race_scene(config)


def standing(spec: SceneSpec) -> StageFrame:
    lane = LaneView(rest_pose(spec), 3, 50, 0.0)
    return StageFrame(spec, "run", "race", "Race", (lane,) * len(spec.lane_specs))


def knowing(spec: SceneSpec, current: tuple[int, ...] = (0, 1, 2)) -> ActionValuesView:
    values = np.linspace(-0.01, 0.06, 3 * len(spec.grid)).reshape(3, -1)
    values[range(3), current] = np.nan
    return ActionValuesView(values, values, current, None, -0.01, 0.06)


def test_everything_is_under_one_frame_and_no_robot_is_many_nodes(
    server: InProcessViser,
) -> None:
    StageScene(server).draw(standing(race_of(3)))
    three = {name for name in told(server) if "/robots/" in name}

    StageScene(server).draw(standing(race_of(6)))
    six = {name for name in told(server) if "/robots/" in name}

    assert three == six
    assert len(three) < 12


@pytest.mark.parametrize("legs", [4, 6, 8])
def test_a_robot_of_any_number_of_legs_stands_where_its_pose_says(legs: int) -> None:
    robot = Robot(legs=ring(legs))
    mesh = RobotMesh(robot)
    pose = mesh.standing.copy()
    pose[:3] = 0.3, 0.4, 0.1

    places, attitudes = mesh.place(pose)

    assert sum(len(part.links) for part in mesh.parts) < 2 + 1 + 6 * legs
    links = np.unique(np.concatenate([part.links for part in mesh.parts]))
    assert len(links) == 1 + 3 * legs, "torso, and coxa, femur and tibia of every leg"
    assert places[links[0]] == pytest.approx([0.3, 0.4, 0.1])
    assert np.linalg.norm(attitudes[links], axis=1) == pytest.approx(np.ones(len(links)))
    for part in mesh.parts:
        assert np.isfinite(part.shape.vertices).all()
        assert part.shape.faces.max() < len(part.shape.vertices)


def test_lanes_stand_side_by_side_in_their_agents_colours(server: InProcessViser) -> None:
    spec = race_of(3)
    scene = StageScene(server)
    scene.draw(standing(spec))
    xs = [(scene.follow_position(view) or (np.nan,))[0] for view in ("1", "2", "3")]

    assert np.diff(xs) == pytest.approx([xs[2], xs[2]])
    assert xs[0] == -xs[2]
    assert xs[2] > 2 * spec.robot.home_radius_m, "they cannot touch"
    assert scene.follow_position("4") is None
    plates = [m["text"] for n, m in told(server).items() if n.endswith("/plate")]
    assert plates == [f"{lane_spec.name}\n0.00 m, step 3" for lane_spec in spec.lane_specs]


def test_start_and_finish_have_a_word(server: InProcessViser) -> None:
    StageScene(server).draw(standing(race_of(1)))
    nodes = told(server)
    words = {m["text"] for n, m in nodes.items() if n.endswith("/word")}

    assert words == {"Start", "Finish"}
    red, green = nodes["/world/cast/track/finish"], nodes["/world/cast/track/start"]
    assert np.argmax(red["color"]) == 0
    assert np.argmax(green["color"]) == 1


def test_the_view_goes_along_with_the_leader(server: InProcessViser) -> None:
    spec, scene = race_of(2), StageScene(server)
    ahead = rest_pose(spec).copy()
    ahead[1] = 0.4
    first = standing(spec)
    moved = replace(first, lanes=(first.lanes[0], LaneView(ahead, 9, 50, 0.4)))

    scene.draw(first, now=0.0)
    assert scene.follow_position("leader") == (0.0, 0.0, 0.0)
    ys = []
    for number in range(1, 60):
        scene.draw(moved, now=number / 30)
        ys.append((scene.follow_position("leader") or (0, np.nan, 0))[1])

    assert ys == sorted(ys), "smoothly"
    assert ys[0] < 0.1
    assert ys[-1] == pytest.approx(0.4, abs=0.01)


def test_nothing_is_sent_while_nothing_moves(server: InProcessViser) -> None:
    scene, frame = StageScene(server), standing(race_of(3))
    serializer = server.get_scene_serializer()
    assert scene.draw(frame, now=0.0)
    once = len(serializer._messages)

    assert not scene.draw(replace(frame, time_s=5.0), now=1.0)
    assert len(serializer._messages) == once


def test_a_new_cast_leaves_nothing_of_the_old(server: InProcessViser) -> None:
    scene = StageScene(server)
    practice = training_scene(TrainingConfig(gait=GAIT, divisions=3))
    ghosts = (Ghost(50, 0.1), Ghost(100, 0.3))

    def show_all() -> None:
        scene.draw(standing(idle_scene()))
        scene.draw(replace(standing(practice), ghosts=ghosts))
        scene.draw(replace(standing(race_of(3)), phase="photo-finish"))
        scene.draw(standing(race_of(6, Robot(legs=ring(8)))))
        scene.draw(standing(race_of(2)))

    show_all()
    nodes = told(server)
    for _ in range(3):
        show_all()

    assert told(server).keys() == nodes.keys()
    assert len(nodes) < 40


def test_cells_take_the_colour_of_their_value_and_the_present_one_none(
    server: InProcessViser,
) -> None:
    spec, scene = race_of(1), StageScene(server)
    lane = replace(standing(spec).lanes[0], knowledge=knowing(spec))
    scene.draw(replace(standing(spec), lanes=(lane,)))
    fills = told(server)["/world/cast/lane0/grid/others/fills"]
    colors = fills["batched_colors"].reshape(6, 4, 3)

    leader, partner = spec.gait.pairs[2]
    assert (colors[leader - 1] == colors[partner - 1]).all(), "a pair is of one mind"
    best, present = colors[leader - 1, 3], colors[leader - 1, 1]
    assert best[0] > 120
    assert best[2] < 40
    assert present.max() < 20


@pytest.mark.parametrize("divisions", [2, 3, 8])
def test_cells_of_every_grid_can_be_drawn(server: InProcessViser, divisions: int) -> None:
    spec = replace(race_of(1), grid=FootGrid(0.04, divisions))
    lane = replace(standing(spec).lanes[0], knowledge=knowing(spec))

    StageScene(server).draw(replace(standing(spec), lanes=(lane,)))

    assert sum(name.endswith("/fills") for name in told(server)) == 2


def test_a_photo_finish_draws_every_distance_and_goes_again(server: InProcessViser) -> None:
    spec, scene = race_of(2), StageScene(server)
    far = replace(standing(spec).lanes[0], distance_m=0.375, rank=1)
    frame = replace(standing(spec), lanes=(far, replace(far, distance_m=-0.01, rank=2)))

    scene.draw(replace(frame, phase="photo-finish"))
    said = [m["text"] for n, m in told(server).items() if "/photo/far" in n]
    assert said == ["1.  0.38 m", "2.  -0.01 m"]

    scene.draw(frame)
    assert not [name for name in told(server) if "/photo" in name]


def test_a_photo_finish_under_another_clock_is_another_photo(server: InProcessViser) -> None:
    scene, frame = StageScene(server), standing(race_of(3))
    scene.draw(replace(frame, phase="photo-finish"))
    retimed = tuple(replace(lane, distance_m=0.25, rank=2) for lane in frame.lanes)
    scene.draw(replace(frame, phase="photo-finish", lanes=retimed))

    said = [m["text"] for n, m in told(server).items() if "/photo/far" in n]
    assert said == ["2.  0.25 m"] * 3


def test_a_finished_lane_shows_its_flag(server: InProcessViser) -> None:
    spec, scene = race_of(1), StageScene(server)
    frame = standing(spec)
    scene.draw(frame)
    assert not told(server)["/world/cast/lane0/flag"]["visible"]

    scene.draw(replace(frame, lanes=(replace(frame.lanes[0], done=True),)))
    assert told(server)["/world/cast/lane0/flag"]["visible"]


def test_an_update_of_three_walking_robots_is_small() -> None:
    spent_ms, size = measure_stage_update(updates=30)

    assert spent_ms > 0
    assert 500 < size <= 4096
