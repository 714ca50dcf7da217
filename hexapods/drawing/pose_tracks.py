"""Compress the poses in messages: differences from frame to frame, in byte planes.

A *track* is the pose of one scene node, or of its batch of links, in the frames in which it
changes. Its values are rounded to multiples of `POSE_STEP`, and each is replaced by its difference
from the value before (delta coding), which is small and often 0; zigzag coding makes it unsigned.
All of them are written as byte planes, low bytes first, so that gzip finds equal bytes next to each
other. Nodes that always move together share their values.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.drawing.viser_internals.messages import Message, array_index

POSE_STEP = 2.0**-13
"""Poses are multiples of this: positions [m] and components of unit quaternions.

No position is off by more than 0.062 mm in a coordinate, nor a rotation by more than 0.014°: a
pixel of a robot that fills a screen of 4,000 pixels is 0.1 mm.
"""
_BATCHED = ("batched_positions", "batched_wxyzs")
_POSE_OF_NODE = {"SetPositionMessage": "position", "SetOrientationMessage": "wxyz"}
_ROTATIONS = ("batched_wxyzs", "wxyz")
_MAX_STEPS = 2.0**30
"""Limit of positions, 131 km, so that differences have 32 bits."""
_Values = NDArray[np.float32] | NDArray[np.float64]
_Steps = NDArray[np.int32]
"""Values in multiples of `POSE_STEP`, (frames, values)."""
_Track = tuple[str, str, int]
"""Name of the node, property, and number of values in a frame."""


class PoseTracks:
    """Takes poses out of messages, and packs them into one block of bytes."""

    def __init__(self) -> None:
        self._numbers: dict[_Track, int] = {}
        self._messages: list[dict[str, Any]] = []
        """A message of each track, without its pose."""
        self._values: list[list[_Values]] = []

    def take(self, message: Message, arrays: Sequence[memoryview]) -> int | None:
        """Take the pose out of a message, and return the number of its track.

        Args:
            message: any message.
            arrays: those that it references by index.

        Returns:
            None if the message is not just a pose, so that it has to be sent itself.
        """
        pose = _pose_of(message, arrays)
        if pose is None:
            return None
        name, values = pose
        track = (message["name"], name, len(values))
        number = self._numbers.get(track)
        if number is None:
            number = self._numbers[track] = len(self._numbers)
            fields = {field: value for field, value in message.items() if field != name}
            self._messages.append({**fields, "updates": {}} if "updates" in fields else fields)
            self._values.append([])
        self._values[number].append(values)
        return number

    def pack(self) -> tuple[dict[str, Any], list[bytes]]:
        """Return the description of the tracks, as JSON has it, and the planes of their poses."""
        numbers: dict[tuple[int, bytes], int] = {}
        series, blocks, tracks = [], [], []
        for (_, name, size), message, values in zip(
            self._numbers, self._messages, self._values, strict=True
        ):
            steps = np.rint(np.stack(values).astype(float) / POSE_STEP)
            steps = steps.clip(-_MAX_STEPS, _MAX_STEPS).astype(np.int32)
            if name in _ROTATIONS:
                steps = _with_continuous_signs(steps)
            key = size, steps.tobytes()
            if key not in numbers:
                numbers[key] = len(numbers)
                series.append((size, len(values)))
                blocks.append(_zigzag(np.diff(steps, axis=0, prepend=np.int32(0))).T.ravel())
            tracks.append({"message": message, "property": name, "series": numbers[key]})
        codes = np.concatenate(blocks) if blocks else np.zeros(0, np.uint32)
        planes = (int(codes.max(initial=0)).bit_length() + 7) // 8
        by_byte = codes.astype("<u4").view(np.uint8).reshape(-1, 4)
        description = {"step": POSE_STEP, "planes": planes, "series": series, "tracks": tracks}
        return description, [by_byte[:, plane].tobytes() for plane in range(planes)]


def rounded_poses(array: memoryview) -> memoryview:
    """Return an array of float32 rounded to multiples of `POSE_STEP`."""
    values = np.frombuffer(array, np.float32)
    return memoryview((np.rint(values / POSE_STEP) * POSE_STEP).astype("<f4").tobytes())


def pose_arrays(message: Message) -> list[int]:
    """Return the indices of the arrays of poses in a message that creates a scene node."""
    props = message.get("props") or {}
    return [array_index(props[name]) for name in _BATCHED if name in props]


def _pose_of(message: Message, arrays: Sequence[memoryview]) -> tuple[str, _Values] | None:
    """Return the property that has the pose, and its values; None if the message is no pose."""
    if message["type"] == "SceneNodeUpdateMessage":
        updates = message["updates"]
        for name in _BATCHED:
            if name in updates and len(updates) == 1:
                return name, np.frombuffer(arrays[array_index(updates[name])], np.float32)
    elif pose := _POSE_OF_NODE.get(message["type"]):
        return pose, np.array(message[pose])
    return None


def _with_continuous_signs(steps: _Steps) -> _Steps:
    """Return quaternions, (frames, 4 · n), of which none is nearer to minus the one before.

    q and −q are the same rotation.
    """
    quaternions = steps.reshape(len(steps), -1, 4)
    cosines = np.einsum("fnc,fnc->fn", quaternions[1:].astype(float), quaternions[:-1])
    if (cosines >= 0).all():
        return steps
    signs = np.cumprod(np.where(cosines < 0, -1, 1).astype(np.int32), axis=0, dtype=np.int32)
    aligned = quaternions.copy()
    aligned[1:] *= signs[:, :, None]
    return aligned.reshape(len(steps), -1)


def _zigzag(differences: _Steps) -> NDArray[np.uint32]:
    """Map 0, −1, 1, −2, … to 0, 1, 2, 3, …; int32 to uint32."""
    return ((differences << 1) ^ (differences >> 31)).view(np.uint32)
