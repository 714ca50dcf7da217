"""A recorded walk as an MCAP log, which tools for robots open (Foxglove, PlotJuggler, …).

Topics: `/lane0/joint_states` with the angle and, where it is recorded, the torque of each joint
(`foxglove.JointStates`), `/tf` with the frames of all links (`foxglove.FrameTransforms`): `world`,
`lane0` beside the other lanes, `lane0/torso` as it was recorded, `lane0/leg1_coxa`, …, and
`/robot_description` with the robot as URDF, whose links are these frames. Foxglove shows it by its
topic and its schema, `std_msgs/String`; those of further lanes are `/lane1/robot_description`, ….
"""

import heapq
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping
from operator import attrgetter
from typing import Any, NamedTuple

import mujoco
import numpy as np

from hexapods.agents.appearance import title_of
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray
from hexapods.exports.export_format import IN_PROCESS, NO_METADATA, Execution
from hexapods.exports.options import DEFAULT_CLOCK
from hexapods.exports.recorded_walks import ExportedLane, RecordedWalks
from hexapods.exports.urdf import robot_urdf
from hexapods.extras import needs
from hexapods.physics.mjcf import compile_visual_model
from hexapods.runs.clocks import CLOCK_SENTENCES, Clock

LANE_WIDTH_M = 1.0
"""Between the origins of the lanes."""
_CHUNK_BYTES = 1 << 16
_DESCRIPTION = "/robot_description"
_STRING_SCHEMA = {
    "title": "std_msgs/String",
    "type": "object",
    "properties": {"data": {"type": "string"}},
}
_TORSO, _WORLD = "torso", "world"


class _Frame(NamedTuple):
    """A recorded frame: its time, its lane, its place among the lane's frames, pose and torques."""

    time_s: float
    lane: int
    number: int
    qpos: FloatArray
    torque_nm: FloatArray | None


def mcap_log(
    walks: RecordedWalks,
    clock: Clock = DEFAULT_CLOCK,
    execution: Execution = IN_PROCESS,
    about: Mapping[str, str] = NO_METADATA,
) -> Iterator[bytes]:
    """Yield an MCAP file in chunks; time 0 of the run is the epoch.

    Args:
        walks: the recorded walks.
        clock: times a race.
        execution: the frames that it may have at most, and whether it is still needed.
        about: what the metadata `run` say beside the clock.

    Raises:
        InvalidInput: at the call, if it would have more frames.
        MissingExtra: at the call, if the Foxglove SDK is not installed.
    """
    with needs("mcap", "an MCAP file"):
        import foxglove  # noqa: PLC0415
        import foxglove.channels  # noqa: PLC0415
        import foxglove.messages  # noqa: PLC0415
    frames = sum(lane.frames for lane in walks.lanes)  # whole numbers
    if execution.max_frames is not None and frames > execution.max_frames:
        raise InvalidInput(
            f"the log would have {frames:,} frames, and may have {execution.max_frames:,}; export "
            "the trajectory, or use `hexapods runs mcap` on the server's machine"
        )
    file = tempfile.TemporaryFile()  # noqa: SIM115 - closed when all was read
    try:
        _write(foxglove, walks, walks.clock_of(clock), file, execution.check, about)
    except BaseException:
        file.close()
        raise
    return _chunks(file)


def _chunks(file: Any) -> Iterator[bytes]:
    with file:
        file.seek(0)
        while chunk := file.read(_CHUNK_BYTES):
            yield chunk


def _write(  # noqa: PLR0917 - all that the file depends on
    foxglove: Any,
    walks: RecordedWalks,
    clock: Clock,
    file: Any,
    check: Callable[[], None],
    about: Mapping[str, str],
) -> None:
    step_s, robot = walks.problem.robot.step_s, walks.problem.built_robot
    names = [joint.label for joint in legs_of(robot).joints]
    links = _Links(compile_visual_model(robot))
    messages, context = foxglove.messages, foxglove.Context()
    with foxglove.open_mcap(file, context=context) as writer:
        tf = foxglove.channels.FrameTransformsChannel("/tf", context=context)
        joints = [
            foxglove.channels.JointStatesChannel(f"/lane{lane}/joint_states", context=context)
            for lane in range(len(walks.lanes))
        ]
        agents = {f"lane{n}": title_of(lane.agent) for n, lane in enumerate(walks.lanes)}
        writer.write_metadata("agents", agents)
        writer.write_metadata("run", {**about, "clock": clock, "time": CLOCK_SENTENCES[clock]})
        _describe(foxglove, context, robot, len(walks.lanes))
        tracks = [_frames(lane, n, step_s, clock) for n, lane in enumerate(walks.lanes)]
        for frame in heapq.merge(*tracks, key=attrgetter("time_s")):
            check()
            time = _timestamp(messages, frame.time_s)
            nanoseconds = time.sec * 1_000_000_000 + time.nsec
            efforts = [None] * len(names)
            if frame.torque_nm is not None:
                efforts = frame.torque_nm.tolist()
            states = [
                messages.JointState(name=name, position=angle, effort=effort)
                for name, angle, effort in zip(names, frame.qpos[7:].tolist(), efforts, strict=True)
            ]
            joints[frame.lane].log(
                messages.JointStates(timestamp=time, joints=states), log_time=nanoseconds
            )
            transforms = links.transforms(messages, time, frame)
            if frame.number == 0:
                lane = f"lane{frame.lane}"
                origin, turn = (frame.lane * LANE_WIDTH_M, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
                transforms.append(
                    _transform(messages, time, parent=_WORLD, child=lane, place=origin, turn=turn)
                )
            tf.log(messages.FrameTransforms(transforms=transforms), log_time=nanoseconds)


def _describe(foxglove: Any, context: Any, robot: Robot, lanes: int) -> None:
    """Log the robot of each lane as URDF at time 0; its links are the frames of the lane."""
    schema = foxglove.Schema(
        name="std_msgs/String", encoding="jsonschema", data=json.dumps(_STRING_SCHEMA).encode()
    )
    for lane in range(lanes):
        topic = f"/lane{lane}{_DESCRIPTION}" if lane else _DESCRIPTION
        channel = foxglove.Channel(topic, message_encoding="json", schema=schema, context=context)
        channel.log({"data": robot_urdf(robot, prefix=f"lane{lane}/")}, log_time=0)


def _frames(lane: ExportedLane, number: int, step_s: float, clock: Clock) -> Iterator[_Frame]:
    """Yield the pose at rest, and each recorded frame of a lane."""
    yield _Frame(0.0, number, 0, lane.start_qpos.astype(float), None)
    count = 0
    for index, start_s in enumerate(lane.starts_s(step_s, clock).tolist()):
        motion = lane.motion(index)
        for place, time_s in enumerate(motion.time_s.tolist()):
            count += 1
            torque = None if motion.torque_nm is None else motion.torque_nm[place].astype(float)
            yield _Frame(start_s + time_s, number, count, motion.qpos[place].astype(float), torque)


class _Links:
    """Forward kinematics of a robot's links, each in the frame of the one that it hangs on."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model, self._data = model, mujoco.MjData(model)

    def transforms(self, messages: Any, time: Any, frame: _Frame) -> list[Any]:
        """Return the transforms of all links of a recorded frame."""
        model, data, prefix = self._model, self._data, f"lane{frame.lane}"
        data.qpos[:] = frame.qpos
        mujoco.mj_kinematics(model, data)
        inverse, rotation = np.empty(4), np.empty(4)
        transforms = []
        for body in range(1, model.nbody):
            name, parent = model.body(body).name, int(model.body_parentid[body])
            position = data.xpos[body] - data.xpos[parent]
            place = data.xmat[parent].reshape(3, 3).T @ position
            mujoco.mju_negQuat(inverse, data.xquat[parent])
            mujoco.mju_mulQuat(rotation, inverse, data.xquat[body])
            above = prefix if name == _TORSO else f"{prefix}/{model.body(parent).name}"
            transforms.append(
                _transform(
                    messages,
                    time,
                    parent=above,
                    child=f"{prefix}/{name}",
                    place=place.tolist(),
                    turn=rotation.tolist(),
                )
            )
        return transforms


def _transform(messages: Any, time: Any, *, parent: str, child: str, place: Any, turn: Any) -> Any:
    """Return a transform message; `turn` is a quaternion wxyz."""
    x, y, z = place
    w, *vector = turn
    return messages.FrameTransform(
        timestamp=time,
        parent_frame_id=parent,
        child_frame_id=child,
        translation=messages.Vector3(x=x, y=y, z=z),
        rotation=messages.Quaternion(x=vector[0], y=vector[1], z=vector[2], w=w),
    )


def _timestamp(messages: Any, time_s: float) -> Any:
    seconds, nanoseconds = divmod(round(time_s * 1e9), 1_000_000_000)
    return messages.Timestamp(seconds, nanoseconds)
