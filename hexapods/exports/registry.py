"""The export formats, each declared once.

From an entry follow its route, its command under `hexapods runs`, its place in the page's menu, its
slots and limits on a server. The functions import what they need when they are called, since
commands that export nothing should start fast.
"""

from collections.abc import Iterable

from hexapods.exports.export_format import Execution, ExportFormat, ExportSource, FileType
from hexapods.exports.options import ClockOptions, TrajectoryOptions, VideoOptions


def _trajectory(
    source: ExportSource, file: FileType, options: TrajectoryOptions, execution: Execution
) -> Iterable[bytes] | Iterable[str]:
    from hexapods.exports import trajectory  # noqa: PLC0415
    from hexapods.exports.recorded_walks import checked_lane  # noqa: PLC0415

    del execution  # each chunk is computed only when it is read
    lanes = checked_lane(source.walks(), options.lane)
    if file.ending == "parquet":
        about = source.about(options.clock)
        return trajectory.trajectory_parquet(source.walks, lanes, options.clock, about)
    return trajectory.trajectory_csv(source.walks, lanes, options.clock)


def _page(
    source: ExportSource, file: FileType, options: ClockOptions, execution: Execution
) -> Iterable[bytes]:
    from hexapods.exports.replay_page import replay_page  # noqa: PLC0415
    from hexapods.runs.clocks import CLOCKS  # noqa: PLC0415

    del file, execution  # `replay_page` has its own limit, and encoding a frame checks by itself
    replays = [source.replay(options.clock)]
    if replays[0].plan.kind == "race":
        others = (clock for clock in CLOCKS if clock != options.clock)
        replays += [source.replay(clock) for clock in others]
    return replay_page(replays, source.title)


def _video(
    source: ExportSource, file: FileType, options: VideoOptions, execution: Execution
) -> Iterable[bytes]:
    from hexapods.exports.video import render_video  # noqa: PLC0415

    about = source.about(options.clock)
    return [render_video(source.walks(), options, file.ending, execution, about)]


def _mcap(
    source: ExportSource, file: FileType, options: ClockOptions, execution: Execution
) -> Iterable[bytes]:
    from hexapods.exports.mcap_log import mcap_log  # noqa: PLC0415

    del file
    return mcap_log(source.walks(), options.clock, execution, source.about(options.clock))


EXPORTS: dict[str, ExportFormat] = {
    "trajectory": ExportFormat(
        title="joint angles, feet and torques over time",
        files=(
            FileType("csv", "Joints and feet (CSV)", "text/csv; charset=utf-8"),
            FileType(
                "parquet",
                "Joints and feet (Parquet)",
                "application/vnd.apache.parquet",
                extra="parquet",
            ),
        ),
        write=_trajectory,
        note="A row is a recorded frame; the columns have their units in their names.",
        options=TrajectoryOptions,
    ),
    "page": ExportFormat(
        title="an HTML page that replays the run without a server",
        files=(FileType("html", "Offline replay (HTML)", "text/html; charset=utf-8"),),
        write=_page,
        note="It plays offline, and in an iframe of any page.",
        options=ClockOptions,
        load="encode",
    ),
    "video": ExportFormat(
        title="a video of the run",
        files=(
            FileType("mp4", "Video (MP4)", "video/mp4", extra="video"),
            FileType("gif", "Video (GIF)", "image/gif", extra="video"),
        ),
        write=_video,
        note="It is rendered off screen, which takes up to minutes, and needs OpenGL.",
        options=VideoOptions,
        flags={"playback_speed": "--speed"},
        load="render",
        # Half a minute at 30 a second.
        max_served_frames=900,
    ),
    "mcap": ExportFormat(
        title="joint states and frames, for robotics tools",
        files=(FileType("mcap", "Robot log (MCAP)", "application/octet-stream", extra="mcap"),),
        write=_mcap,
        note="It has `foxglove.JointStates` of each lane, `foxglove.FrameTransforms` of all links, "
        "and the robot as URDF on `/robot_description`.",
        options=ClockOptions,
        load="encode",
        # The longest race has 4,800,000, which takes an hour and a gigabyte.
        max_served_frames=200_000,
    ),
}
"""Export formats by name, which is the command, and a part of the route's path."""
