"""A recorded walk as a video, MP4 or GIF, rendered off screen by MuJoCo.

Nothing is simulated: each picture shows the recorded poses, interpolated as in a replay. OpenGL
draws in software where there is no graphics card (Mesa's llvmpipe), with EGL, or with OSMesa if the
environment has `MUJOCO_GL=osmesa`.
"""

import importlib
import os
import tempfile
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from app.exports.extras import import_extra, no_opengl
from app.exports.recorded_lanes import ExportedLane, RecordedWalks
from hexapods.agents.appearance import colors_of, title_of
from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.physics.mjcf import VISIBLE_GROUP, is_painted, robot_spec
from hexapods.runs.clocks import FINISH_LINE_M, Clock
from hexapods.runs.config import WalkingProblem
from hexapods.runs.recording import pose_at

VIDEO_EXTRA = "video"
MIN_SIDE, MAX_WIDTH, MAX_HEIGHT, MAX_FPS = 64, 1920, 1080, 60
MIN_SPEED, MAX_SPEED = 0.05, 64
MAX_FRAMES = 9000
"""Pictures of one video; each takes about 0.1 s in software."""
_GAP_M = 0.25
_SMOOTHING_S = 0.25  # as in the live view (hexapods/drawing/scene.py)
_BACKGROUND, _GROUND, _GROUND_LINES = (0.05, 0.07, 0.1), (0.16, 0.2, 0.26), (0.3, 0.36, 0.44)
_CAPTION, _CAPTION_BOX = (236, 240, 245, 255), (13, 17, 23, 190)


@dataclass(frozen=True)
class VideoOptions:
    """Settings of a rendered video.

    Attributes:
        ending: `.mp4` or `.gif`.
        width, height: of the picture [px], even.
        fps: pictures a second of the video.
        speed: times the run's own time.
        clock: times a race.
    """

    ending: str = ".mp4"
    width: int = 640
    height: int = 360
    fps: int = 30
    speed: float = 1.0
    clock: Clock = "paper"

    def __post_init__(self) -> None:
        limits = {
            "width": (MIN_SIDE, MAX_WIDTH),
            "height": (MIN_SIDE, MAX_HEIGHT),
            "fps": (1, MAX_FPS),
            "speed": (MIN_SPEED, MAX_SPEED),
        }
        for name, (low, high) in limits.items():
            if not low <= getattr(self, name) <= high:
                raise InvalidInput(f"{name} must be from {low} to {high}")
        if self.width % 2 or self.height % 2:
            raise InvalidInput("width and height must be even")


@dataclass(frozen=True)
class ShownPoses:
    """What each picture of a video shows; small, so that a process can be sent it.

    Attributes:
        problem: the walking problem, with the robot.
        agents: of the lanes.
        times_s: moment of the run [s].
        poses: (pictures, lanes, 7 + joints): position [m], quaternion, angles [rad].
    """

    problem: WalkingProblem
    agents: tuple[str, ...]
    times_s: tuple[float, ...]
    poses: FloatArray


def shown_poses(
    walks: RecordedWalks, options: VideoOptions, max_frames: int = MAX_FRAMES
) -> ShownPoses:
    """Return what the pictures of a run's video show.

    Raises:
        InvalidInput: if there would be more of them than `max_frames`.
    """
    tracks = [_Track(lane, walks.problem.robot.step_s, options.clock) for lane in walks.lanes]
    times_s = _times_s(tracks, options, max_frames)
    poses = np.array([[track.pose(time_s) for track in tracks] for time_s in times_s])
    agents = tuple(lane.agent for lane in walks.lanes)
    return ShownPoses(walks.problem, agents, tuple(times_s), poses)


def render_video(walks: RecordedWalks, options: VideoOptions) -> bytes:
    """Return the video of a run; raises as `shown_poses` and `write_video`."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"video{options.ending}"
        write_video(shown_poses(walks, options), options, file)
        return file.read_bytes()


def write_video(shown: ShownPoses, options: VideoOptions, file: Path) -> None:
    """Render the video of a run to a file.

    Raises:
        MissingExtra: if a package of the extra, or OpenGL, is not installed.
        OSError: if it cannot be encoded or written.
    """
    ffmpeg = import_extra("imageio_ffmpeg", VIDEO_EXTRA, "a video")
    writer = ffmpeg.write_frames(str(file), (options.width, options.height), **_coding(options))
    writer.send(None)
    try:
        for picture in _pictures(shown, options):
            writer.send(np.ascontiguousarray(picture))
    finally:
        writer.close()


def _coding(options: VideoOptions) -> dict[str, Any]:
    common = {"fps": options.fps, "macro_block_size": 2, "ffmpeg_log_level": "error"}
    if options.ending == ".mp4":
        return {
            **common,
            "codec": "libx264",
            "quality": 8,
            "output_params": ["-movflags", "+faststart"],
        }
    palette = "split[a][b];[a]palettegen[p];[b][p]paletteuse"
    return {
        **common,
        "codec": "gif",
        "pix_fmt_out": "pal8",
        "output_params": ["-filter_complex", palette],
    }


def _times_s(tracks: Sequence["_Track"], options: VideoOptions, max_frames: int) -> list[float]:
    """Return the moment of the run that each picture shows; gaps in a practice are left out."""
    end_s = max(track.end_s for track in tracks)
    first = tracks[0]
    shift_s, times_s = 0.0, list[float]()
    while True:
        time_s = len(times_s) * options.speed / options.fps + shift_s
        if len(tracks) == 1:
            skipped = first.gap_s(time_s)
            shift_s, time_s = shift_s + skipped, time_s + skipped
        if time_s > end_s:
            return [*times_s, end_s]
        times_s.append(time_s)
        if len(times_s) >= max_frames:
            raise InvalidInput(
                f"the video would have more than {max_frames:,} frames; choose a higher speed, or "
                "fewer frames per second"
            )


class _Track:
    """Poses of a lane's robot, interpolated over playback time."""

    def __init__(self, lane: ExportedLane, step_s: float, clock: Clock) -> None:
        self.lane = lane
        self._starts_s = lane.starts_s(step_s, clock)
        self._ends_s = lane.ends_s(step_s, clock)
        self.end_s = float(self._ends_s[-1]) if len(self._ends_s) else 0.0

    def gap_s(self, time_s: float) -> float:
        """Return how long nothing is recorded from a moment on, where steps are missing."""
        index = bisect_right(self._starts_s, time_s) - 1
        if index < 0 or index + 1 >= len(self._starts_s) or time_s <= self._ends_s[index] + 1e-6:
            return 0.0
        return float(self._starts_s[index + 1]) - time_s

    def pose(self, time_s: float) -> FloatArray:
        index = bisect_right(self._starts_s, time_s) - 1
        if index < 0:
            return self.lane.start_qpos.astype(float)
        start = self.lane.pose_before(index)
        return pose_at(start, self.lane.motion(index), time_s - float(self._starts_s[index]))


def _pictures(shown: ShownPoses, options: VideoOptions) -> Iterator[NDArray[np.uint8]]:
    """Yield the pictures, (height, width, 3)."""
    scene = _Scene(shown, options)
    followed, elapsed_s = 0.0, options.speed / options.fps
    caption = _Caption(shown.agents, options.height)
    with _gl_context(options.width, options.height):
        painter = scene.painter()
        for number, (time_s, poses) in enumerate(zip(shown.times_s, shown.poses, strict=True)):
            leader = max(pose[1] for pose in poses)
            if len(poses) == 1:
                scene.center_x(poses[0][0])
            lag = np.exp(-elapsed_s / options.speed / _SMOOTHING_S) if number else 0.0
            followed = leader + (followed - leader) * lag
            picture = painter(poses, followed)
            yield caption.drawn(picture, time_s, [pose[1] for pose in poses])


def _gl_context(width: int, height: int) -> Any:
    """Return an OpenGL context of this thread, to be used in a `with` block."""
    name = "osmesa" if os.environ.get("MUJOCO_GL", "").lower() == "osmesa" else "egl"
    import_extra("OpenGL", VIDEO_EXTRA, "a video")
    try:
        backend = importlib.import_module(f"mujoco.{name}")
        context = backend.GLContext(width, height)
        context.make_current()
    # PyOpenGL raises errors of many kinds where the library is missing.
    except Exception as error:
        raise no_opengl(error) from error
    return _Closing(context)


class _Closing:
    """Frees an OpenGL context at the end of a `with` block."""

    def __init__(self, context: Any) -> None:
        self._context = context

    def __enter__(self) -> None:
        """Do nothing: the context is current."""

    def __exit__(self, *_: object) -> None:
        self._context.free()


class _Scene:
    """All robots of a run on the track, as one model without physics."""

    def __init__(self, shown: ShownPoses, options: VideoOptions) -> None:
        robot = shown.problem.built_robot
        count = len(shown.agents)
        width = 2 * robot.home_radius_m + _GAP_M
        self._offsets_m = [(number - (count - 1) / 2) * width for number in range(count)]
        self._options, self._width_m = options, count * width
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
            self._camera.lookat[1:] = y_m, 0.08
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
    for name, y_m, rgba in (
        ("start", 0.0, [0.05, 0.5, 0.16, 1]),
        ("finish", FINISH_LINE_M, [0.75, 0.08, 0.1, 1]),
    ):
        world.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[0, y_m, 0.001],
            size=[width_m / 2, 0.006, 0.001],
            rgba=rgba,
        )
    colors = colors_of(shown.agents)
    for number, color in enumerate(colors):
        robot = robot_spec(shown.problem.built_robot)
        robot.delete(robot.geom("ground"))
        rgba = [*(int(color[at : at + 2], 16) / 255 for at in (1, 3, 5)), 1]
        dark = [0.3 * one + 0.22 for one in rgba[:3]] + [1]
        for geom in robot.geoms:
            geom.rgba = rgba if is_painted(geom.name) else dark
        # MuJoCo warns of options that differ; there is no physics here.
        robot.option.timestep, robot.option.integrator = (
            spec.option.timestep,
            spec.option.integrator,
        )
        robot.option.jacobian = spec.option.jacobian
        spec.attach(robot, prefix=f"lane{number}_", frame=world.add_frame())
    return spec.compile()


class _Caption:
    """Time, names and distances over the picture."""

    def __init__(self, agents: Sequence[str], height: int) -> None:
        self._titles, self._colors = [title_of(agent) for agent in agents], colors_of(agents)
        self._size = max(11, height // 26)
        self._font = ImageFont.load_default(self._size)

    def drawn(
        self, picture: NDArray[np.uint8], time_s: float, distances_m: Sequence[float]
    ) -> NDArray[np.uint8]:
        """Return the picture with its caption."""
        image = Image.fromarray(np.ascontiguousarray(picture))
        draw = ImageDraw.Draw(image, "RGBA")
        lines = [(f"{time_s:.1f} s", _CAPTION)] + [
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
