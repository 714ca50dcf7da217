"""Which robot a viewer's camera goes along with.

Everything is drawn under one frame. Moving that frame, in one viewer's browser only, by minus the
robot's position keeps the robot in the middle while the viewer goes on orbiting as they like.
"""

from collections.abc import Callable
from typing import Literal

import msgspec
from viser import _messages

from app.viewer import wire

FREE = "free"
VIEWS = frozenset({FREE, "leader", *(str(lane) for lane in range(1, 9))})
"""The leader of the race, the robot on a lane, or none."""

Position = tuple[float, float, float]
FollowPosition = Callable[[str], Position | None]
"""From a view to where that robot is in the scene [m]; None where there is no such robot.
Called for each view in use at each frame, on the event loop."""

_CHOICE_LIMIT_BYTES = 64
"""Much less than the camera poses that every viser client sends, which are not even decoded."""


class _Choice(msgspec.Struct, forbid_unknown_fields=True):
    type: Literal["FollowMessage"]
    view: str


_decoder = msgspec.msgpack.Decoder(_Choice)


def chosen_view(data: bytes | None) -> str | None:
    """What a browser asks to follow, by msgpack of `{"type": "FollowMessage", "view": …}`.

    It is the one thing that the hub listens to. None for whatever else a browser says.
    """
    if data is None or len(data) > _CHOICE_LIMIT_BYTES:
        return None
    try:
        return valid_view(_decoder.decode(data).view)
    except msgspec.MsgspecError:
        return None


def valid_view(view: str | None) -> str | None:
    """The view itself, or None if there is no such view."""
    return view if view in VIEWS else None


def centring(frame: str, position: Position) -> wire.Message:
    """The message that moves the frame so that a position [m] comes to its parent's origin.

    The height stays: a robot that bounces would otherwise shake the ground.
    """
    x, y, _ = position
    return _messages.SetPositionMessage(frame, (-float(x), -float(y), 0.0)).as_serializable_dict()
