"""Poses in encoded frames: each message is there, with the numbers that were drawn, rounded."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from app.stage.playback import Replays
from hexapods.drawing.pose_tracks import POSE_STEP, PoseTracks
from hexapods.drawing.replay_encoding import encode_frames
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.messages import Message
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import recorded_viser
from hexapods.shows.replay import Replay
from tests.drawing.replay_decoding import decoded, unpacked
from tests.stage.stage_parts import StageParts

POSES = ("batched_positions", "batched_wxyzs")


def rounded(values: Any) -> Any:
    return np.rint(np.asarray(values) / POSE_STEP) * POSE_STEP


def readable(message: Message, arrays: list[Any]) -> dict[str, Any]:
    """Return a message with its arrays, by path; poses rounded, −0 as 0."""
    values = {}
    for field, value in message.items():
        for name, item in value.items() if isinstance(value, dict) else [(None, value)]:
            plain = list(item) if isinstance(item, tuple) else item
            if isinstance(item, dict) and "__binary_index" in item:
                array = np.frombuffer(arrays[item["__binary_index"]], item["dtype"])
                plain = (rounded(array) + 0 if name in POSES else array).tolist()
            elif field in ("position", "wxyz") and message["type"].startswith("Set"):
                plain = rounded(item).tolist()
            values[f"{field}.{name}"] = plain
    return values


def drawn(replay: Replay, times_s: list[float]) -> list[list[dict[str, Any]]]:
    """Return the messages by which each frame is drawn, without an encoding."""
    with recorded_viser() as server, recorder(server) as recording:
        scene, frames = StageScene(server), []
        for frame in [replay.start_frame(), *map(replay.frame_at, times_s)]:
            scene.draw(frame)
            messages, arrays = recording.take()
            frames.append([readable(message, arrays) for message in messages])
    return frames[1:]


@pytest.mark.parametrize("kind", ["race", "training"])
def test_frames_have_the_messages_that_draw_them(parts: StageParts, kind: str) -> None:
    run = (
        parts.finished_race(("q-learning", "greedy", "two-step"))
        if kind == "race"
        else parts.finished_training(60, evaluate_every=20)
    )
    replay = Replays(parts.store, parts.recordings).get(run.id, "paper")
    times_s = [1.9 + n / 12 for n in range(40)]
    head, arrays = decoded(encode_frames(replay, times_s))

    expected = drawn(replay, times_s)
    assert sum(map(len, expected)) > 200
    for frame, messages in zip(head["frames"], expected, strict=True):
        assert [readable(message, arrays) for message in frame["messages"]] == messages


def packed_and_unpacked(kind: str, name: str, frames: list[Any]) -> tuple[int, NDArray[Any]]:
    """Return the number of byte planes for a node's poses, and the poses as they are read."""
    tracks = PoseTracks()
    for values in frames:
        message: Message = {"type": kind, "name": "/node", "owner": ""}
        if kind == "SceneNodeUpdateMessage":
            array = memoryview(np.asarray(values, np.float32).tobytes())
            message["updates"] = {name: {"__binary_index": 0, "dtype": "<f4"}}
            assert tracks.take(message, [array]) == 0
        else:
            assert tracks.take({**message, name: tuple(values)}, []) == 0
    description, planes = tracks.pack()
    data = b"".join(planes)
    (series,), place = unpacked(description, data, 0)
    assert place == len(data)
    return description["planes"], series * description["step"]


def test_a_quaternion_whose_sign_changes_is_no_jump() -> None:
    angles = np.linspace(0, 4 * math.pi, 200)
    wxyz = np.stack([np.cos(angles / 2), 0 * angles, 0 * angles, np.sin(angles / 2)], axis=1)
    wxyz *= np.where(wxyz[:, :1] < 0, -1, 1)  # so that w is never negative
    twice = np.concatenate([wxyz, wxyz[::-1]], axis=1)
    for kind, name, frames in (
        ("SetOrientationMessage", "wxyz", wxyz),
        ("SceneNodeUpdateMessage", "batched_wxyzs", twice),
    ):
        planes, poses = packed_and_unpacked(kind, name, frames.tolist())
        assert np.abs(np.diff(poses, axis=0)).max() < 0.04, "a jump"
        assert planes == 2, "for the first frame, which is the difference from 0"
        cosines = np.abs((poses * frames).reshape(200, -1, 4).sum(axis=2))
        assert cosines == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("start_m", [0.0, -37.5, 1000.0, 5000.0, 100_000.0])
def test_positions_are_those_drawn_at_any_distance(start_m: float) -> None:
    """Beyond 2,048 m float32 itself has coarser steps, and none is beyond 131 km."""
    frames = [[start_m + n / 64, n / 1000, -0.02] for n in range(70)]
    _, poses = packed_and_unpacked("SceneNodeUpdateMessage", "batched_positions", frames)

    expected = rounded(np.asarray(frames, np.float32))
    assert poses.astype(np.float32).tolist() == expected.tolist()


def test_positions_that_are_no_place_are_sent_as_the_limit() -> None:
    frames = [[0.0, 1e9, -math.inf], [0.5, 1e9, 0.25]]
    _, poses = packed_and_unpacked("SceneNodeUpdateMessage", "batched_positions", frames)

    assert poses[:, 0].tolist() == [0.0, 0.5]
    assert poses[0, 1] == poses[1, 1] == pytest.approx(131_072)
    assert (poses[0, 2], poses[1, 2]) == (-poses[0, 1], 0.25)


def test_nodes_that_move_together_share_their_poses() -> None:
    tracks = PoseTracks()
    for n in range(10):
        array = memoryview(np.full(3, n / 8, np.float32).tobytes())
        for node in ("/a", "/b"):
            updates = {"batched_positions": {"__binary_index": 0, "dtype": "<f4"}}
            message = {"type": "SceneNodeUpdateMessage", "name": node, "updates": updates}
            tracks.take(message, [array])
    description, planes = tracks.pack()

    assert description["series"] == [(3, 10)]
    assert [track["series"] for track in description["tracks"]] == [0, 0]
    assert [len(plane) for plane in planes] == [30] * description["planes"]


def test_a_message_that_is_not_just_a_pose_is_not_taken() -> None:
    colors = {"batched_colors": {"__binary_index": 0, "dtype": "|u1"}}
    array = memoryview(bytes(12))
    for message in (
        {"type": "SceneNodeUpdateMessage", "name": "/a", "updates": colors},
        {"type": "SceneNodeUpdateMessage", "name": "/a", "updates": {"text": "Greedy"}},
        {"type": "RemoveSceneNodeMessage", "name": "/a"},
    ):
        assert PoseTracks().take(message, [array]) is None
