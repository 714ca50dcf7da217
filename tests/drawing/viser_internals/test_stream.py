"""Encoding and decoding of viser's wire format, byte for byte."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser
from tests.viewer.serving import Reader, Robots, array, has_message


@pytest.fixture
def replay(viser_server: InProcessViser, robots: Robots) -> list[stream.Frame]:
    """Return the frames that viser sends to a new client."""
    robots.move_to(3)
    with Reader(viser_server) as reader:
        return reader.frames_until(has_message("ReplayDoneMessage"))


def test_frames_of_viser_are_parsed(replay: list[stream.Frame]) -> None:
    values = [array(frame, Robots.NAME, "batched_positions") for frame in replay]

    assert values[-1] is not None
    assert values[-1].tolist() == [3] * 12


def test_pack_reproduces_the_bytes_of_viser(replay: list[stream.Frame]) -> None:
    for frame in replay:
        packed = stream.pack(frame.messages, frame.buffers, frame.timestamp_s)

        assert packed.raw == frame.raw
        assert stream.parse(packed.raw) == frame


def test_threads_pack_and_parse_at_once() -> None:
    def repeated(number: int) -> None:
        message = {"type": "Text", "texts": [f"{number} {n}" for n in range(4_000)]}
        for _ in range(40):
            packed = stream.pack([message], (), 0.0)
            assert stream.parse(packed.raw).messages == (message,)

    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(repeated, range(4))) == [None] * 4


def test_without_blocked_keeps_all_other_messages(replay: list[stream.Frame]) -> None:
    frame = next(frame for frame in replay if has_message("BatchedMeshesMessage")(frame))
    script = frame.with_messages({"type": "RunJavascriptMessage", "source": "1"})

    remaining = stream.parse(script.without_blocked().raw)

    assert frame.without_blocked() is frame
    assert remaining.messages == frame.messages
    assert remaining.buffers == frame.buffers
    assert remaining.timestamp_s == frame.timestamp_s


def test_remap_buffers_copies_messages_with_their_arrays() -> None:
    first, second, third = (memoryview(bytes([n] * n)) for n in (1, 2, 3))
    message = {"props": {"a": {"__binary_index": 2, "dtype": "<u1"}, "b": [1, None]}}
    target = [first]

    moved = stream.remap_buffers(message, [first, second, third], target)

    assert moved == {"props": {"a": {"__binary_index": 1, "dtype": "<u1"}, "b": [1, None]}}
    assert target == [first, third]
    assert message["props"]["a"] == {"__binary_index": 2, "dtype": "<u1"}


@pytest.mark.parametrize("length", [0, 15, 16, 40, -1])
def test_truncated_frame_is_rejected(replay: list[stream.Frame], length: int) -> None:
    with pytest.raises(ValueError, match="not a frame"):
        stream.parse(replay[0].raw[:length])
