"""viser's wire format: one websocket frame carries a window of messages and their arrays.

A frame is `u64 size of the msgpack | u64 size of its zstd | zstd(msgpack) | arrays`, little-endian,
each array padded to 8 bytes. The msgpack is `{messages, timestampSec, binaryBufferLengths}`, and a
message names an array by its index in the frame: `{"__binary_index": 3, "dtype": "<f4"}`.
"""

import struct
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import viser
import zstandard

SUBPROTOCOL = f"viser-v{viser.__version__}"
"""Websocket subprotocol of both ends. The format is versioned only by viser's own version."""

Message = dict[str, Any]
"""One decoded message; its `type` is the name of viser's class."""

_SIZES = struct.Struct("<QQ")
_ALIGNMENT_BYTES = 8
_INDEX_KEY = "__binary_index"

_decoder = msgspec.msgpack.Decoder(dict[str, Any])
_encoder = msgspec.msgpack.Encoder()
_decompressor = zstandard.ZstdDecompressor()
_compressor = zstandard.ZstdCompressor(level=1)


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

    def without_types(self, types: Collection[str]) -> "Frame":
        """Return the frame without messages of these types; itself if it has none of them."""
        remaining = tuple(message for message in self.messages if message["type"] not in types)
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
        body = _decoder.decode(_decompressor.decompress(packed, max_output_size=inner_size))
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
    packed = _compressor.compress(body)
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
