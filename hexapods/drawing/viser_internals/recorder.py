"""Records the messages by which a viser server draws, without sending them."""

import contextlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import viser
from viser import _messages
from viser.infra import Message as ViserMessage
from viser.infra import StateSerializer

from hexapods.drawing.viser_internals.messages import BLOCKED_TYPES, Message


class Recorded(NamedTuple):
    """Messages in order, and the arrays that they reference by index."""

    messages: list[Message]
    arrays: list[memoryview]


class _Recorder(StateSerializer):
    """Takes the place of a serializer of a whole file, but can be emptied again and again."""

    def _insert_message(self, message: ViserMessage) -> None:
        """Add a message; changes of one array, as most are, without looking up annotations."""
        if type(message) is _messages.SceneNodeUpdateMessage and len(message.updates) == 1:
            ((name, value),) = message.updates.items()
            if isinstance(value, np.ndarray) and value.flags.c_contiguous:
                reference = {"__binary_index": len(self._binary_buffers), "dtype": value.dtype.str}
                self._binary_buffers.append(value.data)
                recorded = {
                    "name": message.name,
                    "updates": {name: reference},
                    "owner": message.owner,
                    "type": "SceneNodeUpdateMessage",
                }
                self._messages.append((self._time, recorded))
                return
        super()._insert_message(message)

    def take(self) -> Recorded:
        """Return the messages recorded since the last call, and clear the record."""
        with self._handler._record_lock:
            taken = Recorded([message for _, message in self._messages], self._binary_buffers)
            self._messages, self._binary_buffers = [], []
        return taken


@contextlib.contextmanager
def recorder(server: viser.ViserServer) -> Iterator[Any]:
    """Record within a `with` block; `take()` of the yielded recorder returns the new messages.

    The first `take()` returns the whole scene. Messages of `BLOCKED_TYPES` and those that are no
    part of the scene are left out.
    """
    handler = server._websock_server
    recording = _Recorder(
        handler,
        lambda message: (
            message.include_in_scene_serialization and type(message).__name__ not in BLOCKED_TYPES
        ),
    )
    # As `ViserServer.get_scene_serializer` does it.
    buffer = handler.get_message_buffer()
    with handler._record_lock:
        handler._record_handles.append(recording)
        with buffer.buffer_lock:
            messages = list(buffer.message_from_id.values())
        for message in messages:
            recording._insert_message(message)
    try:
        yield recording
    finally:
        with handler._record_lock:
            handler._record_handles.remove(recording)
