"""The wire format is viser's own, to the byte."""

import pytest

from app.viewer import wire
from app.viewer.in_process import InProcessViser
from tests.viewer.serving import Reader, Robots, array, says


@pytest.fixture
def replay(stage: InProcessViser, robots: Robots) -> list[wire.Frame]:
    """What viser itself sends to a newcomer."""
    robots.stand_at(3)
    with Reader(stage) as reader:
        return reader.frames_until(says("ReplayDoneMessage"))


def test_viser_s_frames_are_understood(replay: list[wire.Frame]) -> None:
    values = [array(frame, Robots.NAME, "batched_positions") for frame in replay]

    assert values[-1] is not None
    assert values[-1].tolist() == [3] * 12


def test_a_frame_packed_again_is_the_same_to_the_byte(replay: list[wire.Frame]) -> None:
    for frame in replay:
        packed = wire.pack(frame.messages, frame.buffers, frame.timestamp_s)

        assert packed.raw == frame.raw
        assert wire.parse(packed.raw) == frame


def test_a_frame_without_a_type_keeps_the_rest(replay: list[wire.Frame]) -> None:
    frame = next(frame for frame in replay if says("BatchedMeshesMessage")(frame))

    less = wire.parse(frame.without({"FrameMessage"}).raw)

    assert frame.without({"NoSuchMessage"}) is frame
    assert [m for m in frame.messages if m["type"] != "FrameMessage"] == list(less.messages)
    assert less.buffers == frame.buffers
    assert less.timestamp_s == frame.timestamp_s


def test_messages_move_between_frames_with_their_arrays() -> None:
    one, two, three = (memoryview(bytes([n] * n)) for n in (1, 2, 3))
    message = {"props": {"a": {"__binary_index": 2, "dtype": "<u1"}, "b": [1, None]}}
    target = [one]

    moved = wire.rewire(message, [one, two, three], target)

    assert moved == {"props": {"a": {"__binary_index": 1, "dtype": "<u1"}, "b": [1, None]}}
    assert target == [one, three]
    assert message["props"]["a"] == {"__binary_index": 2, "dtype": "<u1"}


@pytest.mark.parametrize("kept", [0, 15, 16, 40, -1])
def test_a_frame_cut_short_is_refused(replay: list[wire.Frame], kept: int) -> None:
    with pytest.raises(ValueError, match="not a frame"):
        wire.parse(replay[0].raw[:kept])
