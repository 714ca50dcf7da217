"""The pictures of a video, drawn off screen by MuJoCo; importing it loads OpenGL."""

import importlib
import os
from collections.abc import Iterator, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from hexapods.agents.appearance import colors_of, title_of
from hexapods.domain.types import FloatArray
from hexapods.exports.options import VideoOptions
from hexapods.exports.video import ShownPoses
from hexapods.extras import needs, no_opengl
from hexapods.physics.mjcf import VISIBLE_GROUP, is_painted, robot_spec
from hexapods.runs.clocks import CLOCK_TITLES, FINISH_LINE_M
from hexapods.runs.config import WalkingProblem

_GAP_M = 0.25
_SMOOTHING_S = 0.25  # as in the live view (hexapods/drawing/scene.py)
_BACKGROUND, _GROUND, _GROUND_LINES = (0.05, 0.07, 0.1), (0.16, 0.2, 0.26), (0.3, 0.36, 0.44)
_SQUARE_M = 0.031
"""Side of a square of the finish line [m]."""
_CAPTION, _CAPTION_BOX = (236, 240, 245, 255), (13, 17, 23, 190)


def pictures(shown: ShownPoses, options: VideoOptions) -> Iterator[NDArray[np.uint8]]:
    """Yield the pictures, (height, width, 3)."""
    scene = _Scene(shown, options)
    followed = 0.0
    caption = _Caption(shown.agents, options.height, CLOCK_TITLES[shown.clock])
    context = gl_context(options.width, options.height)
    try:
        painter = scene.painter()
        for number, (time_s, poses) in enumerate(zip(shown.times_s, shown.poses, strict=True)):
            leader = max(pose[1] for pose in poses)
            if len(poses) == 1:
                scene.center_x(poses[0][0])
            lag = np.exp(-1 / options.fps / _SMOOTHING_S) if number else 0.0
            followed = leader + (followed - leader) * lag
            picture = painter(poses, followed)
            yield caption.drawn(picture, time_s, [pose[1] for pose in poses])
    finally:
        context.free()


class RobotCamera:
    """Pictures of one robot on the track, drawn off screen like those of a video, from behind it.

    Several cameras may be used in turn in one thread: each has an OpenGL context of its own.
    """

    def __init__(self, problem: WalkingProblem, options: VideoOptions) -> None:
        """Draw the robot that a problem's seed builds; raises MissingExtra without OpenGL."""
        shown = ShownPoses(problem, ("",), (), np.empty((0, 1, 0)))
        self._scene = _Scene(shown, options)
        self._context = gl_context(options.width, options.height)
        self._paint = self._scene.painter()

    def picture(self, pose: FloatArray) -> NDArray[np.uint8]:
        """Return the picture of a pose, (height, width, 3).

        Args:
            pose: position [m], quaternion, angles [rad], (7 + joints,).
        """
        self._context.make_current()
        self._scene.center_x(float(pose[0]))
        picture: NDArray[np.uint8] = self._paint(pose[None], float(pose[1])).copy()
        return picture

    def close(self) -> None:
        """Free the OpenGL context and the resources of MuJoCo in it."""
        self._context.make_current()
        del self._paint  # with it what MuJoCo keeps in the context
        self._context.free()


def gl_context(width: int, height: int) -> Any:
    """Return a new OpenGL context for drawing off screen, the current one of this thread.

    Raises:
        MissingExtra: if a package of the extra `video`, or OpenGL, is not installed.
    """
    name = "osmesa" if os.environ.get("MUJOCO_GL", "").lower() == "osmesa" else "egl"
    with needs("video", "a video"):
        import OpenGL  # noqa: F401, PLC0415  # which MuJoCo imports next
    try:
        backend = importlib.import_module(f"mujoco.{name}")
        context = backend.GLContext(width, height)
        context.make_current()
    # PyOpenGL raises errors of many kinds where the library is missing.
    except Exception as error:
        raise no_opengl(error) from error
    return context


class _Scene:
    """All robots of a run on the track, as one model without physics."""

    def __init__(self, shown: ShownPoses, options: VideoOptions) -> None:
        robot = shown.problem.built_robot
        count = len(shown.agents)
        width = 2 * robot.span_m + _GAP_M
        self._offsets_m = [(number - (count - 1) / 2) * width for number in range(count)]
        self._options, self._width_m = options, count * width
        self._height_m = max(0.08, robot.body_height_m / 2)
        self.model = _model(shown, self._width_m, options)
        self._data = mujoco.MjData(self.model)
        self._camera = mujoco.MjvCamera()
        aspect = options.width / options.height
        self._camera.distance = max(0.9, 0.4 + 1.0 * self._width_m / min(aspect, 2.0))
        self._camera.azimuth, self._camera.elevation = 90, -28

    def center_x(self, x_m: float) -> None:
        """Look at this x [m], for a robot that is alone and walks in curves."""
        self._camera.lookat[0] = x_m

    def painter(self) -> Any:
        """Return a function that draws poses, seen from behind a place on the track."""
        model, data, options = self.model, self._data, self._options
        context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
        scene, view = mujoco.MjvScene(model, maxgeom=5000), mujoco.MjvOption()
        view.geomgroup[:] = 0
        view.geomgroup[[0, VISIBLE_GROUP]] = 1
        area = mujoco.MjrRect(0, 0, options.width, options.height)
        pixels = np.empty((options.height, options.width, 3), np.uint8)

        def paint(poses: FloatArray, y_m: float) -> NDArray[np.uint8]:
            placed = poses.copy()
            placed[:, 0] += self._offsets_m
            data.qpos[:] = placed.ravel()
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            self._camera.lookat[1:] = y_m, self._height_m
            mujoco.mjv_updateScene(
                model, data, view, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL, scene
            )
            mujoco.mjr_render(area, scene, context)
            mujoco.mjr_readPixels(pixels, None, area, context)
            return pixels[::-1]

        return paint


def _model(shown: ShownPoses, width_m: float, options: VideoOptions) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.visual.global_.offwidth, spec.visual.global_.offheight = options.width, options.height
    # Most of the time in software goes to shadows and smooth edges.
    spec.visual.quality.shadowsize, spec.visual.quality.offsamples = 1024, 2
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.35] * 3, [0.35] * 3
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=_BACKGROUND,
        rgb2=_BACKGROUND,
        width=16,
        height=96,
    )
    spec.add_texture(
        name="grid",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=_GROUND,
        rgb2=_GROUND,
        markrgb=_GROUND_LINES,
        width=256,
        height=256,
    )
    grid = spec.add_material(name="grid", texrepeat=[2, 2], texuniform=True)
    grid.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "grid"
    world = spec.worldbody
    world.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.1], material="grid"
    )
    world.add_light(pos=[-1.5, -1.5, 3.2], dir=[0.4, 0.4, -0.8], diffuse=[0.6] * 3)
    world.add_geom(
        name="start",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=[0, 0, 0.001],
        size=[width_m / 2, 0.006, 0.001],
        rgba=[0.05, 0.5, 0.16, 1],
    )
    _add_finish(spec, width_m)
    colors = colors_of(shown.agents)
    for number, color in enumerate(colors):
        built = shown.problem.built_robot
        robot = robot_spec(built)
        robot.delete(robot.geom("ground"))
        rgba = [*(int(color[at : at + 2], 16) / 255 for at in (1, 3, 5)), 1]
        dark = [0.3 * component + 0.22 for component in rgba[:3]] + [1]
        for geom in robot.geoms:
            geom.rgba = rgba if is_painted(built, geom.name) else dark
        # MuJoCo warns of options that differ; there is no physics here.
        robot.option.timestep, robot.option.integrator = (
            spec.option.timestep,
            spec.option.integrator,
        )
        robot.option.jacobian = spec.option.jacobian
        spec.attach(robot, prefix=f"lane{number}_", frame=world.add_frame())
    return spec.compile()


def _add_finish(spec: mujoco.MjSpec, width_m: float) -> None:
    """Add a chequered line in two rows."""
    spec.add_texture(
        name="chequers",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.06, 0.07, 0.09],
        rgb2=[1, 1, 1],
        width=64,
        height=64,
    )
    repeats = width_m / (2 * _SQUARE_M)
    chequered = spec.add_material(name="chequered", texrepeat=[repeats, 1])
    chequered.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "chequers"
    spec.worldbody.add_geom(
        name="finish",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=[0, FINISH_LINE_M, 0.002],
        size=[width_m / 2, _SQUARE_M, 0.1],
        material="chequered",
    )


class _Caption:
    """Time, names and distances over the picture."""

    def __init__(self, agents: Sequence[str], height: int, clock: str) -> None:
        self._clock = clock
        self._titles, self._colors = [title_of(agent) for agent in agents], colors_of(agents)
        self._size = max(11, height // 26)
        self._font = ImageFont.load_default(self._size)

    def drawn(
        self, picture: NDArray[np.uint8], time_s: float, distances_m: Sequence[float]
    ) -> NDArray[np.uint8]:
        """Return the picture with its caption."""
        image = Image.fromarray(np.ascontiguousarray(picture))
        draw = ImageDraw.Draw(image, "RGBA")
        lines = [(f"{time_s:.1f} s, {self._clock}", _CAPTION)] + [
            (f"{title}  {distance:.2f} m", color)
            for title, color, distance in zip(self._titles, self._colors, distances_m, strict=True)
        ]
        row, edge = round(1.35 * self._size), self._size // 2
        width = max(draw.textlength(text, font=self._font) for text, _ in lines)
        box = (edge, edge, 3 * edge + width, 2 * edge + row * len(lines))
        draw.rounded_rectangle(box, edge, fill=_CAPTION_BOX)
        for number, (text, color) in enumerate(lines):
            draw.text((2 * edge, 1.5 * edge + number * row), text, fill=color, font=self._font)
        return np.asarray(image)
