"""The MCAP log of a recorded walk, opened by the reader of the format's authors."""

import io
import json
from typing import Any
from xml.etree import ElementTree

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
from tests.imports.robots import read

Messages = dict[str, list[Any]]


@pytest.fixture(scope="module")
def data(raced: RecordedWalks) -> bytes:
    return b"".join(mcap_log(raced, "paper"))


@pytest.fixture(scope="module")
def messages(data: bytes) -> Messages:
    """Return the decoded messages by topic, in order of time."""
    reader = make_reader(io.BytesIO(data), decoder_factories=[DecoderFactory()])
    by_topic: Messages = {}
    topics = ["/lane0/joint_states", "/lane1/joint_states", "/tf"]
    for _, channel, _, message in reader.iter_decoded_messages(topics):
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
        "/robot_description": "std_msgs/String",
        "/lane1/robot_description": "std_msgs/String",
    }
    metadata = {entry.name: entry.metadata for entry in reader.iter_metadata()}
    assert metadata["agents"] == {"lane0": "Greedy", "lane1": "Wave"}
    assert metadata["run"]["clock"] == "paper"
    assert metadata["run"]["time"].startswith("Times by the paper clock")


def test_the_robot_is_described_as_urdf_with_the_frames_of_its_lane(
    raced: RecordedWalks, data: bytes, messages: Messages
) -> None:
    reader = make_reader(io.BytesIO(data))
    topics = ["/robot_description", "/lane1/robot_description"]
    described = {
        channel.topic: (message.log_time, json.loads(message.data)["data"])
        for _, channel, message in reader.iter_messages(topics)
    }
    frames = {t.child_frame_id for message in messages["/tf"] for t in message.transforms}
    joints = [joint.name for joint in messages["/lane0/joint_states"][0].joints]
    for lane, topic in enumerate(topics):
        time, text = described[topic]
        root = ElementTree.fromstring(text)
        assert time == 0
        assert {link.get("name") for link in root.iter("link")} <= frames
        assert root[1].get("name") == f"lane{lane}/torso"
        turning = [joint for joint in root.findall("joint") if joint.get("type") == "revolute"]
        assert [joint.get("name") for joint in turning] == joints
        imported = read(text, "robot.urdf")
        assert len(imported.legs) == len(raced.problem.robot.legs)
        assert imported.numbers["swing_s"] == raced.problem.robot.swing_s


def test_a_log_is_in_robot_time_by_default(raced: RecordedWalks) -> None:
    reader = make_reader(io.BytesIO(b"".join(mcap_log(raced))))
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    last_s = summary.statistics.message_end_time / 1e9
    ends = [lane.ends_s(raced.problem.robot.step_s, "free")[-1] for lane in raced.lanes]
    assert last_s == pytest.approx(max(ends))
    assert {entry.name: entry.metadata for entry in reader.iter_metadata()}["run"][
        "clock"
    ] == "free"


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
