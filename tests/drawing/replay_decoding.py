"""Decodes frames of a replay as the page does, from the format in `docs/replays.md`."""

import gzip
import json
import struct
from typing import Any

import numpy as np


def decoded(encoded: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """Return the JSON of an encoding, with all messages written out, and the arrays they name."""
    data = gzip.decompress(encoded)
    (size,) = struct.unpack_from("<I", data)
    head, place = json.loads(data[4 : 4 + size]), 4 + size
    poses, blocks = head.get("poses", {"planes": 0, "series": [], "tracks": []}), []
    series, place = unpacked(poses, data, place)
    for length in head["lengths"]:
        place += -place % 8
        blocks.append(data[place : place + length])
        place += length
    assert place == len(data)
    arrays = [blocks[number] for number in head["arrays"]]
    taken = [0] * len(poses["tracks"])

    def message_of(number: int) -> dict[str, Any]:
        track = poses["tracks"][number]
        pose = series[track["series"]][taken[number]] * poses["step"]
        taken[number] += 1
        if "updates" not in track["message"]:
            return {**track["message"], track["property"]: pose.tolist()}
        arrays.append(pose.astype("<f4").tobytes())
        name = {"__binary_index": len(arrays) - 1, "dtype": "<f4"}
        return {**track["message"], "updates": {track["property"]: name}}

    for frame in head["frames"]:
        frame["messages"] = [
            message_of(message) if isinstance(message, int) else message
            for message in frame["messages"]
        ]
    frames_of_series = [len(frames) for frames in series]
    assert taken == [frames_of_series[track["series"]] for track in poses["tracks"]]
    return head, arrays


def unpacked(poses: dict[str, Any], data: bytes, place: int) -> tuple[list[Any], int]:
    """Return the values of each series by frame, in steps, and where what follows them begins."""
    planes, count = poses["planes"], sum(size * frames for size, frames in poses["series"])
    codes = np.zeros(count, np.int64)
    for plane in range(planes):
        values = np.frombuffer(data, np.uint8, count, place + plane * count)
        codes += values.astype(np.int64) << (8 * plane)
    differences, series = np.where(codes % 2, -(codes + 1) // 2, codes // 2), []
    for size, frames in poses["series"]:
        values, differences = differences[: size * frames], differences[size * frames :]
        series.append(np.cumsum(values.reshape(size, frames), axis=1).T)
    return series, place + planes * count
