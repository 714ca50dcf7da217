"""A picture of the sketch of a robot's file, drawn off screen by MuJoCo, as a PNG.

It shows what the page shows before a robot is stored: bodies in the colours of their groups, the
legs numbered, the feet marked, and an arrow forward.
"""

import io
import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from hexapods.domain.types import FloatArray
from hexapods.drawing.colormap import Rgb
from hexapods.drawing.sketch import FOOT, TABLE_MARGIN, part_color, radius_of
from hexapods.exports.video_pictures import gl_context
from hexapods.imports.imported import Sketch

_FOV_DEG, _AZIMUTH_DEG, _ELEVATION_DEG = 35.0, -118.0, -30.0
_BACKGROUND, _TABLE, _ARROW = (0.93, 0.94, 0.96), (0.72, 0.76, 0.83), (0.10, 0.12, 0.16)
_TEXT, _PLATE = (255, 255, 255, 255), (26, 31, 41, 225)
_FILLED = 1.04
"""Distance of the camera relative to that at which the turntable just fits."""


def sketch_png(
    sketch: Sketch,
    groups: Sequence[Sequence[int]] = (),
    *,
    width: int = 1280,
    height: int = 800,
) -> bytes:
    """Return a picture of a sketch; an arrow shows forward if it has legs.

    Args:
        sketch: bodies and feet.
        groups: legs of each group, from 1.
        width: in pixels.
        height: in pixels.

    Raises:
        MissingExtra: if a package of the extra `video`, or OpenGL, is not installed.
    """
    context = gl_context(width, height)
    try:
        picture = _Picture(sketch, groups, width, height)
        image = Image.fromarray(picture.pixels())
    finally:
        context.free()
    picture.draw_numbers(image)
    buffer = io.BytesIO()
    image.save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


class _Picture:
    def __init__(
        self, sketch: Sketch, groups: Sequence[Sequence[int]], width: int, height: int
    ) -> None:
        self._sketch, self._width, self._height = sketch, width, height
        self._radius_m = radius_of(sketch)
        self._groups = groups
        top_m = max((part.at_m[2] for part in sketch.parts), default=0.0)
        self._look_at: FloatArray = np.array([0.0, 0.0, top_m / 2])
        half_rad = math.radians(_FOV_DEG / 2)
        across_rad = math.atan(math.tan(half_rad) * width / height)
        room_m = max(self._radius_m * TABLE_MARGIN, top_m)
        self._distance_m = _FILLED * room_m / math.sin(min(half_rad, across_rad))
        self._model = self._built()

    def pixels(self) -> NDArray[np.uint8]:
        """Return the picture without numbers, (height, width, 3)."""
        model, data = self._model, mujoco.MjData(self._model)
        mujoco.mj_forward(model, data)
        camera, view = mujoco.MjvCamera(), mujoco.MjvOption()
        camera.lookat[:] = self._look_at
        camera.distance = self._distance_m
        camera.azimuth, camera.elevation = _AZIMUTH_DEG, _ELEVATION_DEG
        context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
        scene = mujoco.MjvScene(model, maxgeom=5000)
        mujoco.mjv_updateScene(model, data, view, None, camera, mujoco.mjtCatBit.mjCAT_ALL, scene)
        area = mujoco.MjrRect(0, 0, self._width, self._height)
        pixels = np.empty((self._height, self._width, 3), np.uint8)
        mujoco.mjr_render(area, scene, context)
        mujoco.mjr_readPixels(pixels, None, area, context)
        return pixels[::-1].copy()

    def draw_numbers(self, image: Image.Image) -> None:
        """Draw the number of each leg beside its foot."""
        canvas = ImageDraw.Draw(image, "RGBA")
        size = max(14, self._height // 34)
        font = ImageFont.load_default(size)
        for foot in self._sketch.feet:
            x, y, z = foot.at_m
            at = self._projected(np.array([1.13 * x, 1.13 * y, z]))
            text = str(foot.leg) if foot.leg else "?"
            canvas.ellipse([at[0] - size, at[1] - size, at[0] + size, at[1] + size], fill=_PLATE)
            canvas.text(at, text, font=font, fill=_TEXT, anchor="mm")

    def _projected(self, point: FloatArray) -> tuple[float, float]:
        """Return where a point is in the picture, in pixels from the top left."""
        azimuth, elevation = math.radians(_AZIMUTH_DEG), math.radians(_ELEVATION_DEG)
        forward = np.array(
            [
                math.cos(elevation) * math.cos(azimuth),
                math.cos(elevation) * math.sin(azimuth),
                math.sin(elevation),
            ]
        )
        right = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
        up = np.cross(right, forward)
        seen = point - (self._look_at - self._distance_m * forward)
        depth = float(seen @ forward)
        scale = self._height / 2 / math.tan(math.radians(_FOV_DEG / 2)) / depth
        return (
            self._width / 2 + scale * float(seen @ right),
            self._height / 2 - scale * float(seen @ up),
        )

    def _built(self) -> mujoco.MjModel:
        spec = mujoco.MjSpec()
        spec.visual.global_.offwidth, spec.visual.global_.offheight = self._width, self._height
        spec.visual.global_.fovy = _FOV_DEG
        spec.visual.map.znear = 0.01
        spec.visual.quality.shadowsize, spec.visual.quality.offsamples = 2048, 4
        spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.45] * 3, [0.4] * 3
        spec.stat.extent, spec.stat.center = 2 * self._radius_m, self._look_at
        # MuJoCo has the colours of a sky for what is behind everything.
        spec.add_texture(
            name="sky",
            type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
            builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
            rgb1=_BACKGROUND,
            rgb2=_BACKGROUND,
            width=16,
            height=96,
        )
        world, size = spec.worldbody, self._radius_m
        world.add_light(
            pos=[-1.2 * size, -0.8 * size, 4 * size],
            dir=[0.27, 0.18, -0.95],
            diffuse=[0.5] * 3,
            castshadow=True,
        )
        thick = 0.01 * size
        world.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[TABLE_MARGIN * size, thick, 0],
            pos=[0, 0, -thick],
            rgba=[*_TABLE, 1],
        )
        self._add_parts(spec)
        if any(foot.leg for foot in self._sketch.feet):
            start, end = 1.0 * size, 1.32 * size
            world.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=[0, start, 2 * thick, 0, end, 2 * thick],
                size=[0.02 * size, 0, 0],
                rgba=[*_ARROW, 1],
            )
            for side in (-1, 1):
                world.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                    fromto=[0, end, 2 * thick, side * 0.1 * size, end - 0.12 * size, 2 * thick],
                    size=[0.02 * size, 0, 0],
                    rgba=[*_ARROW, 1],
                )
        return spec.compile()

    def _add_parts(self, spec: mujoco.MjSpec) -> None:
        for number, part in enumerate(self._sketch.parts):
            if part.mesh is None:
                continue
            vertices, faces = part.mesh.arrays()
            if not _has_volume(vertices):
                continue
            # A shell has an inertia even where the mesh is open.
            spec.add_mesh(
                name=f"part {number}",
                uservert=vertices.ravel(),
                userface=faces.astype(np.int32).ravel(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=f"part {number}",
                rgba=_rgba(part_color(part.leg, self._groups)),
                contype=0,
                conaffinity=0,
            )
        for foot in self._sketch.feet:
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                size=[1.25 * foot.radius_m + 0.012 * self._radius_m, 0, 0],
                pos=foot.at_m,
                rgba=_rgba(FOOT, 0.8),
            )


def _has_volume(vertices: NDArray[np.float32]) -> bool:
    """Whether a surface is no plane: MuJoCo makes no mesh of one."""
    centred = vertices - vertices.mean(axis=0)
    spread = np.linalg.svd(centred, compute_uv=False)
    return bool(len(vertices) >= 4 and spread[-1] > 1e-5 * spread[0])


def _rgba(color: Rgb, opacity: float = 1.0) -> list[float]:
    return [*(channel / 255 for channel in color), opacity]
