"""Rough ground, patches, friction and slopes as they are drawn on a lane."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.disturbances import Disturbance, Friction, Patch, Rough, Slope
from hexapods.domain.terrain import ROUGH_PERIOD_M, rough_heights
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World
from hexapods.drawing.condition_colors import GRIP, ICE
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.server import RecordedViser
from hexapods.shows.stage_frame import AT_ORIGIN, Origin
from tests.drawing.drawn_scene import frame_at_rest, frame_of, race_of, scene_nodes

GROUND = "/world/run/lane0/ground"


def drawn(
    server: RecordedViser, *disturbances: Disturbance, origin: Origin = AT_ORIGIN
) -> dict[str, dict[str, object]]:
    """Return the nodes of the first lane's ground, by the last part of their names."""
    spec = race_of(1)
    lane = frame_at_rest(spec).lanes[0]
    StageScene(server).draw(
        frame_of(spec, replace(lane, conditions=World(disturbances), origin=origin))
    )
    nodes = scene_nodes(server).items()
    return {name.rpartition("/")[2]: node for name, node in nodes if name.startswith(f"{GROUND}/")}


def points(node: dict[str, object]) -> FloatArray:
    return np.asarray(node["vertices"], float).reshape(-1, 3)


@pytest.mark.parametrize("origin", [AT_ORIGIN, Origin(3.1, -2.2, 0.7)])
def test_bumps_are_as_high_as_those_that_the_feet_touch(
    server: RecordedViser, origin: Origin
) -> None:
    rough = Rough(amplitude_m=0.02, seed=5)
    heights = rough_heights(rough)
    cell_m = ROUGH_PERIOD_M / len(heights)
    bands = drawn(server, rough, origin=origin)
    surface = np.concatenate([points(band) for band in bands.values()])
    cos, sin = math.cos(origin.turn_rad), math.sin(origin.turn_rad)
    column = (cos * surface[:, 0] - sin * surface[:, 1] + origin.x_m) / cell_m
    row = (sin * surface[:, 0] + cos * surface[:, 1] + origin.y_m) / cell_m
    nearest = heights[
        row.round().astype(int) % len(heights), column.round().astype(int) % len(heights)
    ]

    assert len(bands) > 3
    assert np.ptp(surface[:, 1]) == pytest.approx(2.5)
    assert np.abs(surface[:, 2] - nearest).max() < 0.3 * rough.amplitude_m, "within a cell"
    assert np.corrcoef(surface[:, 2], nearest)[0, 1] > 0.97


def test_higher_ground_is_lighter(server: RecordedViser) -> None:
    bands = drawn(server, Rough(amplitude_m=0.02)).values()
    in_order = sorted(bands, key=lambda band: points(band)[:, 2].mean())
    reds = [band["color"][0] for band in in_order]  # type: ignore[index]

    assert reds == sorted(reds)
    assert reds[0] < reds[-1]


def test_lines_lie_over_the_bumps(server: RecordedViser) -> None:
    drawn(server, Rough(amplitude_m=0.02))

    assert scene_nodes(server)["/world/run/track/finish"]["position"][2] > 0.02


def test_patch_lies_where_it_is_slippery(server: RecordedViser) -> None:
    (patch,) = drawn(server, Patch(from_m=0.1, to_m=0.25, friction=0.05)).values()
    corners = points(patch)

    assert tuple(patch["color"]) == ICE  # type: ignore[arg-type]
    assert (corners[:, 1].min(), corners[:, 1].max()) == pytest.approx((0.1, 0.25))
    assert corners[:, 0].min() == pytest.approx(-corners[:, 0].max())


def test_patch_is_turned_under_a_robot_that_is_drawn_straight_ahead(
    server: RecordedViser,
) -> None:
    """The robot has walked to (0, 0.2) and looks to the left, so the strip runs along its lane."""
    origin = Origin(0.0, 0.2, math.pi / 2)
    (patch,) = drawn(server, Patch(from_m=0.1, to_m=0.25, friction=0.05), origin=origin).values()
    corners = points(patch)

    assert (corners[:, 0].min(), corners[:, 0].max()) == pytest.approx((-0.1, 0.05))
    assert np.ptp(corners[:, 1]) == pytest.approx(2.5)


def test_patch_out_of_sight_is_not_drawn(server: RecordedViser) -> None:
    assert drawn(server, Patch(from_m=10, to_m=11, friction=0.05)) == {}


def test_colour_says_whether_the_ground_grips_less_or_more(server: RecordedViser) -> None:
    ice = drawn(server, Friction(value=0.1), Patch(from_m=0.1, to_m=0.25, friction=0.2))
    rubber = drawn(server, Friction(value=2.0))

    assert tuple(ice["friction"]["color"]) == ICE  # type: ignore[arg-type]
    assert tuple(ice["patch0"]["color"]) == GRIP, "more than the ice around it"  # type: ignore[arg-type]
    assert tuple(rubber["friction"]["color"]) == GRIP  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("direction_deg", "turn_rad", "uphill_deg"), [(0, 0, 0), (90, 0, 90), (0, math.pi / 2, -90)]
)
def test_arrows_point_uphill(
    server: RecordedViser, direction_deg: float, turn_rad: float, uphill_deg: float
) -> None:
    slope = Slope(degrees=8, direction_deg=direction_deg)
    nodes = drawn(server, slope, origin=Origin(0, 0, turn_rad))
    w, _, _, z = np.asarray(nodes["slope"]["batched_wxyzs"]).reshape(-1, 4)[0]

    assert math.degrees(2 * math.atan2(z, w)) == pytest.approx(uphill_deg)
    assert {node["text"] for node in nodes.values() if "text" in node} == {"8° uphill"}


def test_each_lane_has_its_own_ground_and_nothing_is_left_of_it(server: RecordedViser) -> None:
    spec, scene = race_of(2), StageScene(server)
    lane = frame_at_rest(spec).lanes[0]
    scene.draw(frame_of(spec, lane, lane))
    before = scene_nodes(server).keys()
    rough = replace(lane, conditions=World((Rough(amplitude_m=0.02),)))

    scene.draw(frame_of(spec, lane, rough))
    added = scene_nodes(server).keys() - before
    scene.draw(frame_of(spec, lane, lane))

    assert added
    assert all(name.startswith("/world/run/lane1/ground") for name in added)
    assert scene_nodes(server).keys() == before
