"""Light and shadows in a real browser: they follow the robots that are drawn, and the theme."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Frame, Page

from hexapods.domain.disturbances import Disturbance, Lost, Rough
from hexapods.domain.terrain import rough_heights_at
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World
from hexapods.drawing.contact_shadows import ABOVE_M
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import recorded_viser
from hexapods.shows.scene_spec import rest_pose
from hexapods.shows.stage_frame import LaneFrame, StageFrame
from tests.drawing.drawn_scene import frame_at_rest, race_of
from tests.running_app import wait_until
from tests.viewer.viewer_host import draw, hosted_viewer, open_host, wait_for_node

SHADOWS = "/world/run/robots/shadows"
PROPS = """name => {
    const { props } = window.__viserSceneTree.getState()[name].message;
    const rows = (values, size) => Array.from({ length: values.length / size },
        (_, n) => [...values.slice(size * n, size * (n + 1))]);
    const floats = (bytes) => bytes instanceof Float32Array ? bytes
        : new Float32Array(bytes.slice().buffer);
    const { batched_positions, batched_scales } = props;
    return [rows(floats(batched_positions), 3), rows(floats(batched_scales), 3)];
}"""
"""Returns positions and scales of a batch."""
MATERIAL = """async name => {
    window.__viserMutable.requestRender();
    await new Promise(requestAnimationFrame);
    await new Promise(requestAnimationFrame);
    let found = null;
    window.__viserMutable.nodeRefFromName[name]?.traverse((part) => (found ??= part.material));
    const { opacity, roughness, toneMapped } = found ?? {};
    return { opacity, roughness, toneMapped, color: found?.color?.getHexString() };
}"""
"""Returns what the mesh of a node is made of, after a frame is drawn."""
SHOWN = """names => names.filter((name) => {
    let isShown = false;
    window.__viserMutable.nodeRefFromName[`/world/run/track/${name}`]?.traverse((part) => {
        isShown ||= Boolean(part.material && part.visible);
    });
    return isShown;
})"""
"""Returns those of the parts of the track that are drawn."""
BRIGHTNESS = """() => {
    const intensities = [];
    window.__viserMutable.nodeRefFromName["/lamp"].traverse((part) => {
        if (part.isLight) intensities.push(part.intensity);
    });
    return intensities[0];
}"""
"""Returns the intensity of the lamp."""


class Drawn:
    """A host that draws frames of a stage."""

    def __init__(self, page: Page, viewer: Frame, scene: StageScene, recording: Any) -> None:
        self.page, self.viewer = page, viewer
        self._scene, self._recording = scene, recording

    def frame(self, frame: StageFrame) -> None:
        self._scene.draw(frame)
        draw(self.page, self._recording.take())

    def shadows(self, name: str = SHADOWS) -> tuple[FloatArray, FloatArray]:
        """Return positions, (n, 3), and scales, (n, 3)."""
        positions, scales = self.viewer.evaluate(PROPS, name)
        return np.array(positions), np.array(scales)

    def material(self, name: str) -> dict[str, Any]:
        return dict(self.viewer.evaluate(MATERIAL, name))


@contextmanager
def drawn_on(browser: Browser, address: str) -> Iterator[Drawn]:
    with (
        recorded_viser() as server,
        recorder(server) as recording,
        browser.new_context(device_scale_factor=0.5) as context,
    ):
        page = context.new_page()
        yield Drawn(page, open_host(page, address), StageScene(server), recording)


@pytest.fixture(scope="module")
def stage(browser: Browser) -> Iterator[Drawn]:
    with hosted_viewer() as address, drawn_on(browser, address) as drawn:
        drawn.frame(frame_at_rest(race_of(2)))
        wait_for_node(drawn.viewer, SHADOWS)
        yield drawn


def in_world(lane: LaneFrame, *disturbances: Disturbance) -> LaneFrame:
    return replace(lane, conditions=World(disturbances))


def test_shadows_are_below_torsos_and_feet_and_smaller_where_a_foot_is_lifted(
    stage: Drawn,
) -> None:
    frame = frame_at_rest(race_of(2))
    stage.frame(frame)
    wait_until(lambda: bool(stage.shadows()[1][0, 0] > 0))
    positions, scales = stage.shadows()
    xs = positions[[0, 7], 0]
    stands = scales[1:7, 0]
    radii = np.linalg.norm(positions[1:7, :2] - positions[0, :2], axis=1)

    assert xs[0] == pytest.approx(-xs[1], abs=1e-4)
    assert positions[:, 2] == pytest.approx(ABOVE_M, abs=1e-6)
    assert scales[0, 0] > 0.15
    assert radii == pytest.approx(frame.spec.robot.home_radius_m, abs=0.03)
    assert np.ptp(stands) < 0.001

    raised = frame.lanes[0].qpos.copy()
    raised[1] += 0.3
    raised[2] += 0.05
    stage.frame(replace(frame, lanes=(replace(frame.lanes[0], qpos=raised), frame.lanes[1])))
    wait_until(lambda: abs(stage.shadows()[0][0, 1] - 0.3) < 0.01)
    positions, scales = stage.shadows()
    assert (scales[1:7, 0] < 0.6 * stands).all(), "off the ground"
    assert scales[8:14, 0] == pytest.approx(stands), "the other robot stands"
    assert positions[0, 2] == pytest.approx(ABOVE_M, abs=1e-6), "shadows stay on the ground"


def test_a_lost_leg_has_no_shadow(stage: Drawn) -> None:
    frame = frame_at_rest(race_of(2))
    lost = in_world(frame.lanes[0], Lost(legs=(2, 5)))
    stage.frame(replace(frame, lanes=(lost, frame.lanes[1])))

    wait_until(lambda: bool(stage.shadows()[1][2, 0] == 0))
    _, scales = stage.shadows()
    assert (scales[1:7, 0] > 0).tolist() == [True, False, True, True, False, True]
    assert (scales[8:14, 0] > 0).all()


def test_shadows_lie_on_the_bumps_of_rough_ground(stage: Drawn) -> None:
    frame = frame_at_rest(race_of(2))
    rough = Rough(amplitude_m=0.03, seed=3)
    stage.frame(frame)
    stage.frame(replace(frame, lanes=tuple(in_world(lane, rough) for lane in frame.lanes)))
    # A later pose: the ground is drawn with the conditions, before or after the robot.
    moved = frame.lanes[0].qpos.copy()
    moved[1] += 0.2
    moved[2] += 0.02
    lanes = tuple(replace(in_world(lane, rough), qpos=moved) for lane in frame.lanes)
    stage.frame(replace(frame, lanes=lanes))

    wait_until(lambda: abs(stage.shadows()[0][0, 1] - 0.2) < 0.01)
    positions, _ = stage.shadows()
    feet = positions[1:7]
    on_lane = feet[:, :2] - [positions[0, 0], 0]
    expected = rough_heights_at(rough, on_lane)
    assert feet[:, 2] - ABOVE_M == pytest.approx(expected, abs=0.006), "those of the drawn grid"
    assert np.ptp(feet[:, 2]) > 0.004
    assert positions[0, 2] > feet[:, 2].max() - 1e-6, "that of the torso lies over all bumps"


def test_a_robot_that_is_not_the_usual_one_casts_shadows_too(browser: Browser) -> None:
    from hexapods.domain.robot import Robot, ring

    spec = race_of(1, Robot(legs=ring(8)))
    with hosted_viewer() as address, drawn_on(browser, address) as drawn:
        drawn.frame(frame_at_rest(spec))
        wait_for_node(drawn.viewer, SHADOWS)
        wait_until(lambda: bool(drawn.shadows()[1][0, 0] > 0))
        positions, scales = drawn.shadows()

    mesh = RobotMesh(spec.robot)
    torso = mesh.body_poses(rest_pose(spec)).positions[1]
    assert len(positions) == 1 + 8
    assert (scales > 0).all()
    assert positions[0, :2] == pytest.approx(torso[:2], abs=1e-3)


def test_materials_lights_and_shadows_are_those_of_the_theme(stage: Drawn) -> None:
    stage.frame(frame_at_rest(race_of(2)))
    stage.page.evaluate("show({theme: 'light'})")
    wait_until(lambda: stage.material(SHADOWS).get("opacity") == pytest.approx(0.42))
    light = stage.material("/world/run/track/marks")
    stage.page.evaluate("show({theme: 'dark'})")
    wait_until(lambda: stage.material(SHADOWS)["opacity"] == pytest.approx(0.75))
    dark = stage.material("/world/run/track/marks")

    assert light["color"] != dark["color"]
    assert light["toneMapped"] is dark["toneMapped"] is False
    assert stage.material("/world/run/robots/0/torso")["roughness"] < 1
    in_dark = stage.viewer.evaluate(BRIGHTNESS)
    stage.page.evaluate("show({theme: 'light'})")
    wait_until(lambda: stage.viewer.evaluate(BRIGHTNESS) != in_dark)


LOOK_FROM = """([y, z]) => {
    const { camera, cameraControl, nodeRefFromName } = window.__viserMutable;
    const { matrixWorld } = nodeRefFromName["/world"];
    const [at, to] = [[y, z], [0, 0.1]].map(([along, up]) =>
        camera.position.clone().set(0, along, up).applyMatrix4(matrixWorld));
    cameraControl.setLookAt(at.x, at.y, at.z, to.x, to.y, to.z, false);
    window.__viserMutable.requestRender();
}"""
"""Moves the camera to a place along the track and over it [m], from which it looks at the start."""


def test_distances_are_upright_for_the_camera_from_behind_and_from_the_front(stage: Drawn) -> None:
    stage.frame(frame_at_rest(race_of(2)))
    names = ["distances", "distances-from-front"]

    def readable() -> list[str]:
        return list(stage.viewer.evaluate(SHOWN, names))

    stage.viewer.evaluate(LOOK_FROM, [-2.0, 0.8])
    wait_until(lambda: readable() == ["distances"])
    stage.viewer.evaluate(LOOK_FROM, [2.0, 0.8])
    wait_until(lambda: readable() == ["distances-from-front"])
    assert stage.material("/world/run/track/distances")["toneMapped"] is False


def test_the_horizon_is_where_a_level_view_meets_the_sky(stage: Drawn) -> None:
    stage.frame(frame_at_rest(race_of(2)))

    def horizon() -> float:
        text = stage.viewer.evaluate(
            "window.__viserMutable.requestRender(),"
            "getComputedStyle(document.documentElement).getPropertyValue('--horizon')"
        )
        return float(str(text).rstrip("%") or "nan")

    for z, condition in (
        (0.1, lambda: abs(horizon() - 50) < 1),
        (0.5, lambda: 5 < horizon() < 45),
        (4.0, lambda: horizon() == 0),
    ):
        stage.viewer.evaluate(LOOK_FROM, [-2.0, z])
        wait_until(condition)
