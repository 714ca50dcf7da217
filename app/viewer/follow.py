"""Follow camera: which robot is centred in a browser, and the messages for it.

All is drawn under one scene node. Translating that node by minus the robot's position, in one
browser only, keeps the robot centred while the user can still orbit the camera.
"""

from collections.abc import Callable
from typing import Literal

import msgspec
from viser import _messages

from app.viewer import wire

FREE = "free"
VIEWS = frozenset({FREE, "leader", *(str(lane) for lane in range(1, 9))})
"""Valid views: the leader of the race, the robot on a lane from 1, or none."""

Position = tuple[float, float, float]
FollowPosition = Callable[[str], Position | None]
"""Returns the position in the scene [m] of a view's robot, None if there is no such robot.
Called for each view in use at each frame, on the event loop."""

_MAX_MESSAGE_BYTES = 64
"""Far smaller than the camera poses that every viser client sends, which need no decoding then."""


class _FollowMessage(msgspec.Struct, forbid_unknown_fields=True):
    type: Literal["FollowMessage"]
    view: str


_decoder = msgspec.msgpack.Decoder(_FollowMessage)


def decode_view(data: bytes | None) -> str | None:
    """Decode a `{"type": "FollowMessage", "view": …}` message (msgpack) of a browser.

    The only message that the hub accepts: returns None for any other input.
    """
    if data is None or len(data) > _MAX_MESSAGE_BYTES:
        return None
    try:
        return valid_view(_decoder.decode(data).view)
    except msgspec.MsgspecError:
        return None


def valid_view(view: str | None) -> str | None:
    """Return the view if it is valid, else None."""
    return view if view in VIEWS else None


def centring_message(frame: str, position: Position) -> wire.Message:
    """Return the message that translates a scene node by minus a position [m], but not in height.

    A bouncing robot would otherwise shake the ground.
    """
    x, y, _ = position
    return _messages.SetPositionMessage(frame, (-float(x), -float(y), 0.0)).as_serializable_dict()
