"""viser's stream: its wire format, and which messages make earlier ones redundant.

One websocket frame carries a window of messages and their arrays.

A frame is `u64 size of the msgpack | u64 size of its zstd | zstd(msgpack) | arrays`, little-endian,
each array padded to 8 bytes. The msgpack is `{messages, timestampSec, binaryBufferLengths}`, and a
message names an array by its index in the frame: `{"__binary_index": 3, "dtype": "<f4"}`.
"""

import struct
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import msgspec
import viser
import zstandard
from viser import _messages

SUBPROTOCOL = f"viser-v{viser.__version__}"
"""Websocket subprotocol of both ends. The format is versioned only by viser's own version."""

Message = dict[str, Any]
"""One decoded message; its `type` is the name of viser's class."""

Entity = tuple[str, str, str]
"""Subject of a message: kind (`scene`, `gui`, …), name or UUID, and owner."""

Key = tuple[str, ...]

REPLAY_DONE = _messages.ReplayDoneMessage.__name__
"""Type of the message after the backlog, until which viser's client waits."""

BLOCKED_TYPES = frozenset(
    cls.__name__
    for cls in (
        # Runs as a script in every browser; nothing we draw needs it.
        _messages.RunJavascriptMessage,
        # Request a reply from the browser, which the hub would not relay.
        _messages.GetRenderRequestMessage,
        _messages.LocalStorageGetItemRequestMessage,
    )
)
"""Message types that are not relayed to browsers."""

_SIZES = struct.Struct("<QQ")
_ALIGNMENT_BYTES = 8
_INDEX_KEY = "__binary_index"

_decoder = msgspec.msgpack.Decoder(dict[str, Any])
_encoder = msgspec.msgpack.Encoder()


class _Zstd(threading.local):
    """Coders of a thread: two threads in one of them at once garble each other's data."""

    def __init__(self) -> None:
        self.compressor = zstandard.ZstdCompressor(level=1)
        self.decompressor = zstandard.ZstdDecompressor()


_zstd = _Zstd()


@dataclass(frozen=True, slots=True)
class Frame:
    """One websocket frame, in encoded and in decoded form."""

    raw: bytes
    """The bytes on the wire."""
    messages: tuple[Message, ...]
    """The decoded messages in order. Shared, so they must not be mutated."""
    buffers: tuple[memoryview, ...]
    """The arrays that the messages reference by index."""
    timestamp_s: float
    """When viser sent it, by viser's clock [s]; browsers schedule frames by the differences."""

    def without_blocked(self) -> "Frame":
        """Return the frame without messages of `BLOCKED_TYPES`; itself if it has none of them."""
        remaining = tuple(
            message for message in self.messages if message["type"] not in BLOCKED_TYPES
        )
        if len(remaining) == len(self.messages):
            return self
        return pack(remaining, self.buffers, self.timestamp_s)

    def with_messages(self, *messages: Message) -> "Frame":
        """Return the frame with messages (without arrays) appended; itself if there are none."""
        if not messages:
            return self
        return pack((*self.messages, *messages), self.buffers, self.timestamp_s)


def parse(raw: bytes) -> Frame:
    """Decode a frame.

    Raises:
        ValueError: The frame is truncated or malformed.
    """
    try:
        inner_size, packed_size = _SIZES.unpack_from(raw)
        packed = raw[_SIZES.size : _SIZES.size + packed_size]
        body = _decoder.decode(_zstd.decompressor.decompress(packed, max_output_size=inner_size))
        lengths = body["binaryBufferLengths"]
        buffers = _split_buffers(raw, _SIZES.size + packed_size, lengths)
        return Frame(raw, tuple(body["messages"]), buffers, body["timestampSec"])
    except (struct.error, zstandard.ZstdError, msgspec.DecodeError, KeyError) as error:
        raise ValueError(f"not a frame of {SUBPROTOCOL}: {error}") from error


def pack(messages: Iterable[Message], buffers: Sequence[memoryview], timestamp_s: float) -> Frame:
    """Encode messages and the arrays they reference.

    Args:
        messages: with array indices into `buffers`.
        buffers: the arrays.
        timestamp_s: time of the frame by viser's clock [s].
    """
    messages = tuple(messages)
    body = _encoder.encode(
        {
            "messages": messages,
            "timestampSec": timestamp_s,
            "binaryBufferLengths": [buffer.nbytes for buffer in buffers],
        }
    )
    packed = _zstd.compressor.compress(body)
    raw = bytearray(_SIZES.pack(len(body), len(packed)) + packed)
    for buffer in buffers:
        raw += bytes(-len(raw) % _ALIGNMENT_BYTES)
        raw += buffer
    return Frame(bytes(raw), messages, tuple(buffers), timestamp_s)


def remap_buffers(value: Any, source: Sequence[memoryview], target: list[memoryview]) -> Any:
    """Copy a message, or a part of one, with its array indices remapped to another list.

    Args:
        value: References arrays in `source` by index; not mutated.
        source: The arrays that it references.
        target: Each referenced array is appended; the copy's index points to it there.
    """
    if isinstance(value, dict):
        if _INDEX_KEY in value:
            target.append(source[value[_INDEX_KEY]])
            return {**value, _INDEX_KEY: len(target) - 1}
        return {key: remap_buffers(item, source, target) for key, item in value.items()}
    if isinstance(value, list):
        return [remap_buffers(item, source, target) for item in value]
    return value


def array_index(value: dict[str, Any]) -> int:
    """Return the index of the array that a value of a message names."""
    index: int = value[_INDEX_KEY]
    return index


class Slot(NamedTuple):
    """The place of a message in the state of the scene: a newer one with the same key replaces it.

    Creating or removing an entity also replaces all that was sent about it before.
    """

    entity: Entity | None
    """None if the message is about no entity."""
    phase: str | None
    """`create`, `update_dict`, `update_simple` or `remove`, if the entity has such a lifecycle."""
    key: Key


def slot_of(message: Message) -> Slot:
    """Return the slot of a message, by the rule that viser's message classes declare."""
    kind, phase, id_field = LIFECYCLES.get(message["type"], (None, None, None))
    entity: Entity | None = None
    if kind is not None and id_field is not None:
        entity = (kind, message[id_field], message.get("owner", ""))
    elif "name" in message:
        # A message on a scene node outside its lifecycle, such as whether it can be clicked.
        entity = ("scene", message["name"], message.get("owner", ""))
    subject = entity or (message["type"], str(message.get("uuid", "")), "")
    if phase == "create":
        return Slot(entity, phase, (*subject, phase))
    if phase == "update_dict":
        return Slot(entity, phase, (*subject, message["type"], *sorted(message["updates"])))
    return Slot(entity, phase, (*subject, message["type"], str(message.get("bone_index", ""))))


LIFECYCLES = {
    cls.__name__: (cls.entity_type, cls.lifecycle_phase, cls.entity_id_field)
    for cls in _messages.Message.get_subclasses()
}


def position_message(node: str, position: tuple[float, float, float]) -> Message:
    """Return the message that moves a scene node to a position [m]."""
    return _messages.SetPositionMessage(node, position).as_serializable_dict()


def _split_buffers(raw: bytes, start: int, lengths: Iterable[int]) -> tuple[memoryview, ...]:
    whole = memoryview(raw)
    buffers = []
    for length in lengths:
        start += -start % _ALIGNMENT_BYTES
        buffers.append(whole[start : start + length])
        start += length
    if start > len(raw):
        raise ValueError(f"not a frame of {SUBPROTOCOL}: its arrays are cut short")
    return tuple(buffers)
