"""The picture of a robot on the page, compared pixel by pixel with MuJoCo's own of the file."""

import io
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from hexapods.exports.video_pictures import gl_context
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.features.robots.browser.files import hand
from tests.features.robots.browser.test_readings import opened
from tests.imports.robots import HOME, dog

pytestmark = [pytest.mark.promises, pytest.mark.looks_at_3d, pytest.mark.timeout(300)]

SPOT = dog(keyframes={"home": HOME})
_CAMERA = """() => {
  const { camera, canvas, nodeRefFromName } = window.__viserMutable;
  camera.updateMatrixWorld();
  const node = nodeRefFromName["/world/sketch"].matrixWorld.clone().invert();
  return {
    matrix: node.multiply(camera.matrixWorld).elements,
    fov_deg: camera.fov, width: canvas.clientWidth, height: canvas.clientHeight,
  };
}"""
_COLORFUL = 0.3
"""Saturation of what has a colour: neither the torso nor the ground."""
_FROM_BLUE = 140
"""Hue of legs: violet and pink, while feet are orange, and marked by more than their size."""


def test_legs_are_where_mujoco_draws_them(dashboard: Dashboard, server: Serving) -> None:
    opened(dashboard, server)
    hand(dashboard, {"spot.xml": SPOT})
    page = dashboard.page
    page.wait_for_timeout(2000)
    camera = dashboard.view.locator("body").evaluate(_CAMERA)
    page.add_style_tag(content=".reading-overlay { visibility: hidden !important }")
    frame = page.locator("iframe").first.bounding_box()
    assert frame is not None

    shown = colorful(page.screenshot(clip=frame), camera)
    expected = legs_by_mujoco(camera)

    both, either = (shown & expected).sum(), (shown | expected).sum()
    assert expected.mean() > 0.015, "the robot fills the picture"
    assert both / either > 0.93, f"{both} of {either} pixels"


def colorful(screenshot: bytes, camera: dict[str, Any]) -> NDArray[np.bool_]:
    """Return where the picture has strong colours, (height, width)."""
    size = (round(camera["width"]), round(camera["height"]))
    image = Image.open(io.BytesIO(screenshot)).convert("HSV").resize(size)
    hue, saturation, _ = np.moveaxis(np.asarray(image), -1, 0)
    has_color: NDArray[np.bool_] = (saturation > 255 * _COLORFUL) & (hue > _FROM_BLUE)
    return has_color


def legs_by_mujoco(camera: dict[str, Any]) -> NDArray[np.bool_]:
    """Return where MuJoCo draws the links of the legs in the file for this camera, (height, width).

    The robot stands as in its keyframe, turned so that x of the file is y of the sketch, with its
    feet on the ground.
    """
    width, height = round(camera["width"]), round(camera["height"])
    spec = mujoco.MjSpec.from_string(SPOT)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.map.znear = 0.001
    columns = np.array(camera["matrix"]).reshape(4, 4).T
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, columns[:3, :3].ravel())
    view = spec.worldbody.add_camera(
        name="page", pos=columns[:3, 3], quat=quaternion, fovy=camera["fov_deg"]
    )
    view.mode = mujoco.mjtCamLight.mjCAMLIGHT_FIXED
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = model.key("home").qpos
    data.qpos[:2], data.qpos[3:7] = 0, (np.sqrt(0.5), 0, 0, np.sqrt(0.5))
    mujoco.mj_kinematics(model, data)
    feet = [model.geom(name).id for name in ("FL", "FR", "RL", "RR")]
    data.qpos[2] -= float(data.geom_xpos[feet, 2].min() - model.geom("FL").size[0])
    mujoco.mj_forward(model, data)
    ids = _segmented(model, data, width, height)
    torso = model.body("trunk").id
    links = {geom for geom in range(model.ngeom) if model.geom_bodyid[geom] not in (0, torso)}
    return np.isin(ids, sorted(links - {*feet}))


def _segmented(
    model: mujoco.MjModel, data: mujoco.MjData, width: int, height: int
) -> NDArray[np.int64]:
    """Return the id of the geom in each pixel, −1 for none."""
    gl = gl_context(width, height)
    try:
        context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
        scene, camera = mujoco.MjvScene(model, maxgeom=1000), mujoco.MjvCamera()
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
        mujoco.mjv_updateScene(
            model, data, mujoco.MjvOption(), None, camera, mujoco.mjtCatBit.mjCAT_ALL, scene
        )
        scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        area, pixels = mujoco.MjrRect(0, 0, width, height), np.empty((height, width, 3), np.uint8)
        mujoco.mjr_render(area, scene, context)
        mujoco.mjr_readPixels(pixels, None, area, context)
    finally:
        gl.free()
    numbers = pixels[::-1].astype(np.int64) @ (1, 256, 65_536)
    geoms = np.full(scene.ngeom + 1, -1, dtype=np.int64)
    for drawn in scene.geoms[: scene.ngeom]:
        if drawn.objtype == mujoco.mjtObj.mjOBJ_GEOM and drawn.segid >= 0:
            geoms[drawn.segid + 1] = drawn.objid
    seen: NDArray[np.int64] = geoms[np.clip(numbers, 0, scene.ngeom)]
    return seen
