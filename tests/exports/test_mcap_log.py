"""The MCAP log of a recorded walk, opened by the reader of the format's authors."""

import io
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from app.jobs.stopping import Stopping
from app.storage.errors import Busy
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.domain.posture import rotation_matrices
from hexapods.exports.export_format import Execution
from hexapods.exports.mcap_log import mcap_log
from hexapods.exports.recorded_walks import RecordedWalks

Messages = dict[str, list[Any]]


@pytest.fixture(scope="module")
def data(raced: RecordedWalks) -> bytes:
    return b"".join(mcap_log(raced, "paper"))


@pytest.fixture(scope="module")
def messages(data: bytes) -> Messages:
    """Return the decoded messages by topic, in order of time."""
    reader = make_reader(io.BytesIO(data), decoder_factories=[DecoderFactory()])
    by_topic: Messages = {}
    for _, channel, _, message in reader.iter_decoded_messages():
        by_topic.setdefault(channel.topic, []).append(message)
    return by_topic


def seconds(timestamp: Any) -> float:
    value: float = timestamp.seconds + timestamp.nanos / 1e9
    return value


def test_schemas_are_those_that_foxglove_knows(data: bytes) -> None:
    reader = make_reader(io.BytesIO(data))
    summary = reader.get_summary()
    assert summary is not None
    names = {
        channel.topic: summary.schemas[channel.schema_id].name
        for channel in summary.channels.values()
    }
    assert names == {
        "/lane0/joint_states": "foxglove.JointStates",
        "/lane1/joint_states": "foxglove.JointStates",
        "/tf": "foxglove.FrameTransforms",
    }
    (agents,) = reader.iter_metadata()
    assert agents.metadata == {"lane0": "Greedy", "lane1": "Wave"}


def test_a_server_that_stops_writes_no_log(raced: RecordedWalks) -> None:
    stopping = Stopping()
    stopping.set()
    with pytest.raises(Busy, match="stopping"):
        mcap_log(raced, "paper", Execution(check=stopping.check))


def test_a_log_that_would_be_too_long_is_refused(raced: RecordedWalks) -> None:
    frames = sum(len(lane.motion(index).time_s) for lane in raced.lanes for index in range(6))
    assert b"".join(mcap_log(raced, "paper", Execution(max_frames=frames)))
    with pytest.raises(InvalidInput, match=f"would have {frames} frames"):
        mcap_log(raced, "paper", Execution(max_frames=frames - 1))


def test_joint_states_are_the_recorded_angles(raced: RecordedWalks, messages: Messages) -> None:
    names, step_s = (
        [joint.label for joint in legs_of(raced.problem.built_robot).joints],
        raced.problem.robot.step_s,
    )
    for number, lane in enumerate(raced.lanes):
        states = messages[f"/lane{number}/joint_states"]
        motions = [lane.motion(index) for index in range(6)]
        recorded = np.concatenate([lane.start_qpos[None], *(motion.qpos for motion in motions)])
        assert [joint.name for joint in states[0].joints] == names
        written = np.array([[joint.position for joint in state.joints] for state in states])
        assert np.array_equal(written, recorded[:, 7:].astype(float))
        times = [
            start + t
            for start, motion in zip(lane.starts_s(step_s, "paper"), motions, strict=True)
            for t in motion.time_s.tolist()
        ]
        assert [seconds(state.timestamp) for state in states] == pytest.approx([0, *times])


def test_frames_put_the_links_where_the_robot_was(raced: RecordedWalks, messages: Messages) -> None:
    lane = raced.lanes[1]
    last = [
        message
        for message in messages["/tf"]
        if message.transforms[0].child_frame_id.startswith("lane1/")
    ][-1]
    above = {transform.child_frame_id: transform for transform in last.transforms}
    pose = lane.motion(5).qpos[-1:].astype(float)

    def place_of(frame: str) -> tuple[Any, Any]:
        """Return position and rotation of a frame in that of its lane."""
        if frame == "lane1":
            return np.zeros(3), np.eye(3)
        transform = above[frame]
        position, rotation = place_of(transform.parent_frame_id)
        t, r = transform.translation, transform.rotation
        turn = rotation_matrices(np.array([[0, 0, 0, r.w, r.x, r.y, r.z]]))[0]
        return position + rotation @ [t.x, t.y, t.z], rotation @ turn

    assert place_of("lane1/torso")[0] == pytest.approx(pose[0, :3])
    feet = legs_of(raced.problem.built_robot).foot_positions(pose)[0]
    for leg in range(1, 7):
        assert place_of(f"lane1/leg{leg}_foot")[0] == pytest.approx(feet[leg - 1], abs=1e-6)
    (origin,) = [
        t for message in messages["/tf"] for t in message.transforms if t.child_frame_id == "lane1"
    ]
    assert (origin.parent_frame_id, origin.translation.x) == ("world", 1)
