"""Shadows under robots: hidden until a page moves them, and those of a robot on the turntable."""

from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.robot import Robot, ring
from hexapods.drawing.contact_shadows import GHOST_SHADOWS, SHADOWS
from hexapods.drawing.scene import StageScene
from hexapods.drawing.sketch import draw_sketch, sketch_body
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import RecordedViser
from hexapods.shows.stage_frame import LaneFrame
from tests.drawing.drawn_scene import frame_at_rest, race_of, scene_nodes
from tests.drawing.test_glb import array, read


@pytest.mark.parametrize("legs", [4, 6])
def test_each_torso_and_each_leg_has_a_shadow(server: RecordedViser, legs: int) -> None:
    StageScene(server).draw(frame_at_rest(race_of(3, Robot(legs=ring(legs)))))
    node = scene_nodes(server)[f"/world/run/robots/{SHADOWS}"]

    scales = node["batched_scales"].reshape(-1, 3)
    assert len(scales) == 3 * (1 + legs)
    assert (scales[:, :2] == 0).all(), "the page knows where they are"


def test_a_shadow_is_black_and_fades_out_to_its_rim(server: RecordedViser) -> None:
    StageScene(server).draw(frame_at_rest(race_of(1)))
    file = scene_nodes(server)[f"/world/run/robots/{SHADOWS}"]["glb_data"]
    description, binary = read(file)
    vertices, colors = array(description, binary, 0), array(description, binary, 1)
    radii = np.linalg.norm(vertices, axis=1)
    outwards = radii.argsort()

    assert (colors[:, :3] == 0).all()
    assert (np.diff(colors[outwards, 3].astype(int)) <= 0).all()
    assert (colors[0, 3], colors[outwards[-1], 3]) == (255, 0)
    assert radii.max() == pytest.approx(1)


def test_frames_of_a_walk_say_nothing_of_shadows(server: RecordedViser) -> None:
    spec, scene = race_of(1), StageScene(server)
    frame = frame_at_rest(spec)
    ahead = frame.lanes[0].qpos.copy()
    ahead[1] += 0.1
    with recorder(server) as recording:
        scene.draw(frame)
        recording.take()
        scene.draw(replace(frame, lanes=(LaneFrame(ahead, 4, 50, 0.1),)))
        names = {message.get("name", "") for message in recording.take().messages}

    assert any(name.startswith("/world/run/robots/") for name in names)
    assert not [name for name in names if name.endswith(SHADOWS)]


def test_ghosts_of_evaluations_have_shadows_of_their_own(server: RecordedViser) -> None:
    StageScene(server).draw(frame_at_rest(replace(race_of(1), kind="training")))

    node = scene_nodes(server)[f"/world/run/robots-evaluated/{GHOST_SHADOWS}"]
    assert len(node["batched_positions"].reshape(-1, 3)) == 1 + 6


def test_a_robot_on_the_turntable_stands_in_its_shadows(server: RecordedViser) -> None:
    spec = race_of(1)
    sketch = sketch_body(spec.robot, spec.gait)
    draw_sketch(server, sketch)
    node = scene_nodes(server)[f"/world/sketch/{SHADOWS}"]
    positions = node["batched_positions"].reshape(-1, 3)
    scales = node["batched_scales"].reshape(-1, 3)

    assert positions[0, :2] == pytest.approx([0, 0], abs=1e-6)
    assert scales[0, 0] > max(spec.robot.torso_half_sides_m), "it reaches out from under the torso"
    for foot, place in zip(sketch.feet, positions[1:], strict=True):
        assert place[:2] == pytest.approx(foot.at_m[:2], abs=1e-6)
    assert (positions[:, 2] > 0).all()
    assert (scales[1:, 0] > spec.robot.foot_radius_m).all()
