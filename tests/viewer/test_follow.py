"""The one thing that a browser may say, and nothing beside it."""

import msgspec
import pytest
from viser import _messages

from app.viewer import follow


def said(message: object) -> str | None:
    return follow.chosen_view(msgspec.msgpack.encode(message))


@pytest.mark.parametrize("view", ["leader", "free", "1", "8"])
def test_a_view_is_chosen_by_name(view: str) -> None:
    assert said({"type": "FollowMessage", "view": view}) == view
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
def test_anything_else_is_nothing(message: object) -> None:
    assert said(message) is None


@pytest.mark.parametrize("data", [None, b"", b"\xc1", b"\x81", b"\xff" * 30, b"\0" * 100_000])
def test_bytes_that_say_nothing_are_nothing(data: bytes | None) -> None:
    assert follow.chosen_view(data) is None


def test_following_moves_the_ground_under_the_robot() -> None:
    message = follow.centring("/world", (2.0, -1.0, 0.4))

    assert message["type"] == _messages.SetPositionMessage.__name__
    assert (message["name"], message["position"]) == ("/world", (-2.0, 1.0, 0.0))
