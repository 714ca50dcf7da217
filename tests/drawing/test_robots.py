"""Legs to which something has happened, ghosts of the original race, and what name labels say."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hexapods.domain.disturbances import Disturbance, Limp, Lost, Stuck, Weak
from hexapods.domain.world import World
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.robots import label_text
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.server import RecordedViser
from hexapods.shows.stage_frame import Ghost, LaneFrame, SceneSpec
from tests.drawing.drawn_scene import frame_at_rest, frame_of, race_of, scene_nodes

Look = tuple[tuple[int, int, int], float]
"""Colour of a link and its scale."""


def lane_in(spec: SceneSpec, *disturbances: Disturbance) -> LaneFrame:
    return replace(frame_at_rest(spec).lanes[0], conditions=World(disturbances))


def looks(
    server: RecordedViser, spec: SceneSpec, lane: int = 0, root: str = "robots"
) -> dict[int, list[Look]]:
    """Return the looks of the parts of each leg of a lane's robot; leg 0 is the torso."""
    nodes, by_leg = scene_nodes(server), dict[int, list[Look]]()
    mesh = RobotMesh(spec.robot)
    for number, part in enumerate(mesh.parts):
        name = mesh.part_name(number, is_ghost=root != "robots")
        node, count = nodes[f"/world/run/{root}/{name}"], len(part.links)
        colors = node["batched_colors"].reshape(-1, 3)[lane * count :][:count]
        scales = node["batched_scales"]
        lane_scales = np.ones(count) if scales is None else scales[lane * count :][:count]
        for link, color, scale in zip(
            part.links, colors.tolist(), lane_scales.tolist(), strict=True
        ):
            # Bodies: the world, the torso, and of each leg coxa, femur, tibia and foot.
            leg = 0 if link == 1 else 1 + (int(link) - 2) // 4
            by_leg.setdefault(leg, []).append((tuple(color), scale))
    return by_leg


def torsos(server: RecordedViser) -> dict[str, Any]:
    """Return the properties of the first batch of the robots."""
    node: dict[str, Any] = scene_nodes(server)["/world/run/robots/0/torso"]
    return node


def test_batches_are_named_by_whose_links_their_instances_are() -> None:
    mesh = RobotMesh(race_of(1).robot)
    names = [mesh.part_name(number) for number in range(len(mesh.parts))]

    assert names[0] == "0/torso"
    assert [name.partition("/")[0] for name in names] == [str(n) for n in range(len(names))]
    for name, part in zip(names, mesh.parts, strict=True):
        # The page finds by it which leg was picked: instance n is a link of the nth leg named.
        legs = name.partition("/legs-")[2].split("-") if "/legs-" in name else []
        assert len(legs) in (0, len(part.links)), name
    assert any("/legs-1-2-3-4-5-6" in name for name in names)


def test_limp_leg_is_grey_and_a_lost_one_is_not_drawn(server: RecordedViser) -> None:
    spec, scene = race_of(2), StageScene(server)
    whole = lane_in(spec)
    scene.draw(frame_of(spec, whole, whole))
    before = looks(server, spec)

    scene.draw(frame_of(spec, lane_in(spec, Limp(legs=(3,)), Lost(legs=(2,))), whole))
    after = looks(server, spec)

    assert {color for color, _ in after[3]} == {color for color, _ in after[3][:1]}
    assert all(max(color) - min(color) < 20 for color, _ in after[3]), "grey"
    assert {scale for _, scale in after[2]} == {0.0}
    assert all(after[leg] == before[leg] for leg in (0, 1, 4, 5, 6))
    assert {scale for parts in looks(server, spec, lane=1).values() for _, scale in parts} == {1.0}

    scene.draw(frame_of(spec, whole, whole))
    assert looks(server, spec) == before, "repaired"


def test_weaker_legs_are_greyer_and_only_the_link_of_a_stuck_joint_is_red(
    server: RecordedViser,
) -> None:
    spec, scene = race_of(1), StageScene(server)
    scene.draw(frame_of(spec, lane_in(spec)))
    before = looks(server, spec)
    weak = Weak(legs=(1,), torque_share=0.7), Weak(legs=(2,), torque_share=0.1)
    stuck = Stuck(leg=4, joint="femur", angle_rad=0.9)
    scene.draw(frame_of(spec, lane_in(spec, *weak, stuck)))
    after = looks(server, spec)

    saturation = [max(max(color) - min(color) for color, _ in after[leg]) for leg in (3, 1, 2)]
    assert saturation == sorted(saturation, reverse=True)
    assert len(set(saturation)) == 3
    changed = [color for color, _ in set(after[4]) - set(before[4])]
    assert len(changed) == 1
    assert changed[0][0] > 3 * max(changed[0][1:])


def test_scene_without_disturbances_sends_no_scales(server: RecordedViser) -> None:
    spec = race_of(1)
    StageScene(server).draw(frame_of(spec, lane_in(spec)))

    assert torsos(server)["batched_scales"] is None


def test_original_is_a_ghost_on_the_lane_of_the_fork(server: RecordedViser) -> None:
    spec, scene = race_of(2), StageScene(server)
    lane = lane_in(spec)
    ahead = lane.qpos.copy()
    ahead[1] = 0.4
    scene.draw(frame_of(spec, lane, lane))
    assert not [name for name in scene_nodes(server) if "ghost-robots" in name]

    original = replace(lane, qpos=ahead, distance_m=0.4)
    forked = frame_of(spec, lane_in(spec, Lost(legs=(2,))), lane)
    scene.draw(replace(forked, ghost_lanes=(original, None)))
    node = scene_nodes(server)["/world/run/ghost-robots/0/ghost-torso"]

    assert 0 < node["opacity"] < 1
    y = node["batched_positions"].reshape(2, -1, 3)[0, 0, 1]
    robot = torsos(server)["batched_positions"].reshape(2, -1, 3)
    assert y - robot[0, 0, 1] == pytest.approx(0.4, abs=1e-6)
    parts = looks(server, spec, root="ghost-robots")
    assert {scale for leg in parts.values() for _, scale in leg} == {1.0}, "it has all its legs"
    other = looks(server, spec, lane=1, root="ghost-robots")
    assert {scale for leg in other.values() for _, scale in leg} == {0.0}, "that lane has none"


def test_ghost_of_an_evaluation_has_the_legs_of_its_time(server: RecordedViser) -> None:
    spec = replace(race_of(1), kind="training")
    ghost, scene = Ghost(50, 0.1), StageScene(server)

    def links_of_ghosts() -> int:
        nodes = scene_nodes(server).items()
        parts = [node for name, node in nodes if re.search(r"-evaluated/\d+/", name)]
        # A link that is lost is drawn with the size 0.
        return sum(int((node["batched_scales"] > 0).sum()) for node in parts)

    frame = frame_of(spec, lane_in(spec))
    scene.draw(frame)
    assert links_of_ghosts() == 0, "nothing was evaluated"
    scene.draw(replace(frame, ghosts=(ghost,)))
    whole = links_of_ghosts()
    scene.draw(replace(frame, ghosts=(replace(ghost, conditions=World((Lost(legs=(2,)),))),)))

    assert 0 < links_of_ghosts() < whole
    scene.draw(frame)
    assert links_of_ghosts() == 0, "before the first evaluation"


def test_label_names_the_step_of_a_fall_counted_from_one() -> None:
    spec = race_of(1)
    lane = replace(lane_in(spec), step=14, distance_m=0.1, fell_at_step=11, marching=True)

    lines = label_text(spec.lane_specs[0], lane).split("\n")
    assert lines == [spec.lane_specs[0].name, "0.10\u00a0m, fell at step 12"]


def test_label_has_the_time_of_the_crossing_from_then_on() -> None:
    spec = race_of(1)
    before = replace(lane_in(spec), step=14, distance_m=0.44, thinking=True, futures_total=12)
    after = replace(before, distance_m=0.46, crossed_s=12.34)

    assert label_text(spec.lane_specs[0], before).split("\n")[2:] == ["thinking…"]
    assert label_text(spec.lane_specs[0], after).split("\n")[2:] == ["crossed at 12.3\u00a0s"]


def test_label_of_a_fork_has_the_distance_of_the_original() -> None:
    spec = race_of(1)
    lane, original = lane_in(spec), replace(lane_in(spec), distance_m=0.31)
    label = label_text(spec.lane_specs[0], lane, original, "original")

    assert label.split("\n")[2] == "original 0.31\u00a0m"
