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
"""What both ends must offer. The format has no version of its own: it changes with viser's."""

Message = dict[str, Any]
"""One decoded message; its `type` is the name of viser's class."""

_SIZES = struct.Struct("<QQ")
_ALIGNMENT_BYTES = 8
_INDEX = "__binary_index"

_decoder = msgspec.msgpack.Decoder(dict[str, Any])
_encoder = msgspec.msgpack.Encoder()
_decompressor = zstandard.ZstdDecompressor()
_compressor = zstandard.ZstdCompressor(level=1)


@dataclass(frozen=True, slots=True)
class Frame:
    """One websocket frame, encoded and decoded."""

    raw: bytes
    """The bytes on the wire."""
    messages: tuple[Message, ...]
    """What they say, in order. Shared by all who hold the frame: never changed."""
    buffers: tuple[memoryview, ...]
    """The arrays that the messages name by index."""
    timestamp_s: float
    """When viser sent it, by its own clock; browsers pace what they show by the differences."""

    def without(self, types: Collection[str]) -> "Frame":
        """The frame less the messages of these types; itself if there is none of them."""
        kept = tuple(message for message in self.messages if message["type"] not in types)
        if len(kept) == len(self.messages):
            return self
        return pack(kept, self.buffers, self.timestamp_s)

    def extended(self, *messages: Message) -> "Frame":
        """The frame with messages without arrays at its end; itself if there are none."""
        if not messages:
            return self
        return pack((*self.messages, *messages), self.buffers, self.timestamp_s)


def parse(raw: bytes) -> Frame:
    """Decode a frame.

    Raises:
        ValueError: It is cut short, or not in the format.
    """
    try:
        inner_size, packed_size = _SIZES.unpack_from(raw)
        packed = raw[_SIZES.size : _SIZES.size + packed_size]
        body = _decoder.decode(_decompressor.decompress(packed, max_output_size=inner_size))
        lengths = body["binaryBufferLengths"]
        buffers = _split(raw, _SIZES.size + packed_size, lengths)
        return Frame(raw, tuple(body["messages"]), buffers, body["timestampSec"])
    except (struct.error, zstandard.ZstdError, msgspec.DecodeError, KeyError) as error:
        raise ValueError(f"not a frame of {SUBPROTOCOL}: {error}") from error


def pack(messages: Iterable[Message], buffers: Sequence[memoryview], timestamp_s: float) -> Frame:
    """Encode messages and the arrays they name."""
    messages = tuple(messages)
    inner = _encoder.encode(
        {
            "messages": messages,
            "timestampSec": timestamp_s,
            "binaryBufferLengths": [buffer.nbytes for buffer in buffers],
        }
    )
    packed = _compressor.compress(inner)
    raw = bytearray(_SIZES.pack(len(inner), len(packed)) + packed)
    for buffer in buffers:
        raw += bytes(-len(raw) % _ALIGNMENT_BYTES)
        raw += buffer
    return Frame(bytes(raw), messages, tuple(buffers), timestamp_s)


def rewire(value: Any, source: Sequence[memoryview], target: list[memoryview]) -> Any:
    """A copy of a message, or of a part of one, whose arrays lie in another list.

    Args:
        value: It names arrays in `source`. It is not changed.
        source: The arrays that it names.
        target: Grows by each array that it names, to whose place there the copy's index points.
    """
    if isinstance(value, dict):
        if _INDEX in value:
            target.append(source[value[_INDEX]])
            return {**value, _INDEX: len(target) - 1}
        return {key: rewire(item, source, target) for key, item in value.items()}
    if isinstance(value, list):
        return [rewire(item, source, target) for item in value]
    return value


def _split(raw: bytes, start: int, lengths: Iterable[int]) -> tuple[memoryview, ...]:
    whole = memoryview(raw)
    buffers = []
    for length in lengths:
        start += -start % _ALIGNMENT_BYTES
        buffers.append(whole[start : start + length])
        start += length
    if start > len(raw):
        raise ValueError(f"not a frame of {SUBPROTOCOL}: its arrays are cut short")
    return tuple(buffers)
