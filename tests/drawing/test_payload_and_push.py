"""The payload on a robot, and the arrow of a push."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.disturbances import Payload, Push
from hexapods.domain.world import World
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.server import RecordedViser
from hexapods.physics.mjcf import compile_model
from hexapods.shows.stage_frame import Origin
from tests.drawing.drawn_scene import frame_at_rest, frame_of, race_of, scene_nodes

CUBE, ARROW = "/world/run/lane0/payload/cube", "/world/run/lane0/push/arrow0"


def test_payload_is_drawn_where_it_is_simulated(server: RecordedViser) -> None:
    """On a torso that was tilted sideways by 90° and stands at (0.1, 0.3, 0.2)."""
    spec, payload = race_of(1), Payload(kg=1.0, x_m=0.08, y_m=-0.03)
    world = World((payload,))
    geom = compile_model(spec.robot, world, spec.gait.forward_deg).geom("payload")
    lane = frame_at_rest(spec).lanes[0]
    qpos = lane.qpos.copy()
    qpos[:7] = 0.1, 0.3, 0.2, math.sqrt(0.5), 0, math.sqrt(0.5), 0  # x to −z, z to x

    StageScene(server).draw(frame_of(spec, replace(lane, qpos=qpos, conditions=world)))
    cube = scene_nodes(server)[CUBE]

    x, y, z = geom.pos
    assert cube["dimensions"] == pytest.approx(2 * geom.size)
    assert cube["position"] == pytest.approx((0.1 + z, 0.3 + y, 0.2 - x))
    assert cube["wxyz"] == pytest.approx(qpos[3:7])


@pytest.mark.parametrize(
    ("direction_deg", "turn_rad", "from_side"),
    [(0, 0, (0, -1)), (90, 0, (1, 0)), (180, 0, (0, 1)), (90, math.pi / 2, (0, -1))],
)
def test_push_is_an_arrow_from_where_it_comes(
    server: RecordedViser, direction_deg: float, turn_rad: float, from_side: tuple[float, float]
) -> None:
    spec, push = race_of(1), Push(impulse_ns=2.0, direction_deg=direction_deg)
    lane = replace(frame_at_rest(spec).lanes[0], pushes=(push,), origin=Origin(0, 0, turn_rad))

    StageScene(server).draw(frame_of(spec, lane))
    arrow = scene_nodes(server)[ARROW]

    offset = np.array(arrow["position"][:2]) - lane.qpos[:2]
    assert offset / np.linalg.norm(offset) == pytest.approx(np.array(from_side), abs=1e-6)
    w, _, _, z = arrow.get("wxyz", (1.0, 0.0, 0.0, 0.0))
    turn = 2 * math.atan2(z, w)
    assert (math.sin(turn), -math.cos(turn)) == pytest.approx(from_side, abs=1e-6), "its tail"


def test_payload_and_push_are_removed_when_they_end(server: RecordedViser) -> None:
    spec, scene = race_of(1), StageScene(server)
    lane = frame_at_rest(spec).lanes[0]
    world = World((Payload(kg=1.0),))
    scene.draw(frame_of(spec, replace(lane, conditions=world, pushes=(Push(impulse_ns=2.0),))))
    assert {CUBE, ARROW} <= scene_nodes(server).keys()

    scene.draw(frame_of(spec, lane))

    assert not [name for name in scene_nodes(server) if "payload" in name or "push" in name]
