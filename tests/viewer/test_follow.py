"""Decoding of follow messages, the only ones accepted from browsers."""

import msgspec
import pytest
from viser import _messages

from app.viewer import follow


def decode(message: object) -> str | None:
    return follow.decode_view(msgspec.msgpack.encode(message))


@pytest.mark.parametrize("view", ["leader", "free", "1", "8"])
def test_valid_view_is_decoded(view: str) -> None:
    assert decode({"type": "FollowMessage", "view": view}) == view
    assert follow.valid_view(view) == view


@pytest.mark.parametrize(
    "message",
    [
        {"type": "FollowMessage", "view": "9"},
        {"type": "FollowMessage", "view": 1},
        {"type": "FollowMessage", "view": None},
        {"type": "FollowMessage", "view": ["leader"]},
        {"type": "FollowMessage"},
        {"type": "FollowMessage", "view": "leader", "name": "/world"},
        {"type": "FollowMessage", "view": "leader" + " " * 100},
        {"type": "RunJavascriptMessage", "view": "leader"},
        {"view": "leader"},
        "leader",
        None,
    ],
)
def test_other_messages_are_ignored(message: object) -> None:
    assert decode(message) is None


@pytest.mark.parametrize("data", [None, b"", b"\xc1", b"\x81", b"\xff" * 30, b"\0" * 100_000])
def test_invalid_bytes_are_ignored(data: bytes | None) -> None:
    assert follow.decode_view(data) is None


def test_centring_message_translates_the_world() -> None:
    message = follow.centring_message("/world", (2.0, -1.0, 0.4))

    assert message["type"] == _messages.SetPositionMessage.__name__
    assert (message["name"], message["position"]) == ("/world", (-2.0, 1.0, 0.0))
