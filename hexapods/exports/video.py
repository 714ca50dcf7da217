"""A recorded walk as a video, MP4 or GIF, rendered off screen by MuJoCo.

Nothing is simulated: each picture shows the recorded poses, interpolated as in a replay. OpenGL
draws in software where there is no graphics card (Mesa's llvmpipe), with EGL, or with OSMesa if the
environment has `MUJOCO_GL=osmesa`.
"""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import declared_fields
from hexapods.domain.types import FloatArray
from hexapods.exports.export_format import IN_PROCESS, NO_METADATA, Execution
from hexapods.exports.options import DEFAULT_CLOCK, VideoOptions
from hexapods.exports.recorded_walks import ExportedLane, RecordedWalks
from hexapods.extras import needs, no_opengl
from hexapods.runs.clocks import Clock
from hexapods.runs.config import WalkingProblem
from hexapods.runs.recording import pose_at

if TYPE_CHECKING:
    from hexapods.exports.video_pictures import RobotCamera

MAX_FRAMES = 9000
"""Pictures of one video; each takes about 0.1 s in software."""


@dataclass(frozen=True)
class ShownPoses:
    """Content of the pictures of a video; small, so that it can be sent to a process.

    Attributes:
        problem: the walking problem, with the robot.
        agents: names of the agents of the lanes.
        times_s: race or practice time of each picture [s].
        poses: (pictures, lanes, 7 + joints): position [m], quaternion, angles [rad].
        clock: by which the times are.
    """

    problem: WalkingProblem
    agents: tuple[str, ...]
    times_s: tuple[float, ...]
    poses: FloatArray
    clock: Clock = DEFAULT_CLOCK


def shown_poses(
    walks: RecordedWalks, options: VideoOptions, max_frames: int = MAX_FRAMES
) -> ShownPoses:
    """Return the times and poses that the pictures of a run's video show.

    Raises:
        InvalidInput: if there would be more pictures than `max_frames`.
    """
    tracks = [_Track(lane, walks.problem.robot.step_s, options.clock) for lane in walks.lanes]
    times_s = _times_s(tracks, options, max_frames)
    poses = np.array([[track.pose(time_s) for track in tracks] for time_s in times_s])
    agents = tuple(lane.agent for lane in walks.lanes)
    clock = walks.clock_of(options.clock)
    return ShownPoses(walks.problem, agents, tuple(times_s), poses, clock)


def render_video(
    walks: RecordedWalks,
    options: VideoOptions,
    ending: str,
    execution: Execution = IN_PROCESS,
    about: Mapping[str, str] = NO_METADATA,
) -> bytes:
    """Return the video of a run; raises as `shown_poses` and `write_video`.

    Args:
        walks: the recorded walks.
        options: settings of the video.
        ending: `mp4` or `gif`.
        execution: maximum number of pictures, and where they are drawn.
        about: what the metadata of an MP4 say.
    """
    shown = shown_poses(walks, options, execution.max_frames or MAX_FRAMES)
    write = partial(write_video, shown, options, about=dict(about))
    return execution.write_file(write, f"video.{ending}")


def write_video(
    shown: ShownPoses, options: VideoOptions, file: Path, about: Mapping[str, str] = NO_METADATA
) -> None:
    """Render the video of a run to a file, as its ending says.

    The caption tells the clock, and so do the metadata of an MP4.

    Raises:
        MissingExtra: if a package of the extra, or OpenGL, is not installed.
        OSError: if it cannot be encoded or written.
    """
    pictures = _drawing().pictures
    with needs("video", "a video"):
        import imageio_ffmpeg as ffmpeg  # noqa: PLC0415
    size, coding = (options.width, options.height), _coding(options.fps, file.suffix, about)
    writer = ffmpeg.write_frames(str(file), size, **coding)
    writer.send(None)
    try:
        for picture in pictures(shown, options):
            writer.send(np.ascontiguousarray(picture))
    finally:
        writer.close()


def robot_camera(
    problem: WalkingProblem,
    options: VideoOptions = VideoOptions(),  # noqa: B008  # immutable
) -> "RobotCamera":
    """Return a camera that draws one robot in any pose, as a video shows it.

    Args:
        problem: the walking problem, with the robot.
        options: size of the pictures.

    Raises:
        MissingExtra: if a package of the extra, or OpenGL, is not installed.
    """
    camera: RobotCamera = _drawing().RobotCamera(problem, options)
    return camera


def _drawing() -> ModuleType:
    try:
        from hexapods.exports import video_pictures  # noqa: PLC0415
    # MuJoCo loads the OpenGL of MUJOCO_GL when it is imported, and PyOpenGL fails in many ways.
    except (ImportError, AttributeError, RuntimeError) as error:
        raise no_opengl(error) from error
    return video_pictures


def _coding(fps: int, ending: str, about: Mapping[str, str]) -> dict[str, Any]:
    common = {"fps": fps, "macro_block_size": 2, "ffmpeg_log_level": "error"}
    if ending == ".mp4":
        return {
            **common,
            "codec": "libx264",
            "quality": 8,
            "output_params": ["-movflags", "+faststart", *_metadata(about)],
        }
    palette = "split[a][b];[a]palettegen[p];[b][p]paletteuse"
    return {
        **common,
        "codec": "gif",
        "pix_fmt_out": "pal8",
        "output_params": ["-filter_complex", palette],
    }


def _metadata(about: Mapping[str, str]) -> list[str]:
    """Return options of ffmpeg: MP4 has a title and a comment."""
    if not about:
        return []
    comment = "; ".join(f"{name}: {text}" for name, text in about.items())
    return ["-metadata", f"title={about.get('title', '')}", "-metadata", f"comment={comment}"]


def _times_s(tracks: Sequence["_Track"], options: VideoOptions, max_frames: int) -> list[float]:
    """Return the race or practice time of each picture [s]; gaps in a practice are left out."""
    end_s = max(track.end_s for track in tracks)
    first, speed = tracks[0], options.playback_speed or _fitting_speed(tracks, options, max_frames)
    shift_s, times_s = 0.0, list[float]()
    while True:
        time_s = len(times_s) * speed / options.fps + shift_s
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


def _fitting_speed(tracks: Sequence["_Track"], options: VideoOptions, max_frames: int) -> float:
    """Return 1, or the playback speed at which the whole run fits into a video."""
    length_s = tracks[0].recorded_s if len(tracks) == 1 else max(track.end_s for track in tracks)
    # A second less, since each recorded part is rounded up to a picture.
    frames = max(1, max_frames - options.fps)
    needed = math.ceil(10 * length_s * options.fps / frames) / 10
    return min(max(1.0, needed), declared_fields(VideoOptions)["playback_speed"].high or needed)


class _Track:
    """Poses of a lane's robot, interpolated over playback time."""

    def __init__(self, lane: ExportedLane, step_s: float, clock: Clock) -> None:
        self.lane = lane
        self._starts_s = lane.starts_s(step_s, clock)
        self._ends_s = lane.ends_s(step_s, clock)
        self.end_s = float(self._ends_s[-1]) if len(self._ends_s) else 0.0

    @property
    def recorded_s(self) -> float:
        """Total duration of the recorded motions [s]."""
        return float((self._ends_s - self._starts_s).sum())

    def gap_s(self, time_s: float) -> float:
        """Return the duration of the gap in the recording from a moment on [s]; 0 if none."""
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
