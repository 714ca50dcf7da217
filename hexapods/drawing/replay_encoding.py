"""Encode a replay as viser messages, which a page plays, seeks and repeats by itself.

The first frame of a segment says all that differs from the scene at the start of the run, the next
ones what changed since the one before. So a page that has the scene (`encode_scene`) needs one
segment to be at any moment of it.

An encoding, compressed with gzip, is `u32 size of the JSON, little-endian | JSON | arrays`, each
array aligned to 8 bytes. Poses of links are rounded to `POSE_STEP`. The JSON has `lengths` of the
arrays [bytes] and `frames`, each with its `time_s`, its viser `messages`, which name an array as
viser does (`{"__binary_index": 3, "dtype": "<f4"}`), `follow`, the position of each view [m], and
now and then `scene`, the figures of the moment.
"""

import gzip
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np

from hexapods.domain.records import to_json
from hexapods.domain.types import Cells
from hexapods.drawing.posture import draw_posture
from hexapods.drawing.scene import StageScene, grid_root
from hexapods.drawing.track import WORLD
from hexapods.drawing.viser_internals.recorder import Recorded, recorder
from hexapods.drawing.viser_internals.server import in_process_viser
from hexapods.drawing.viser_internals.stream import LIFECYCLES, array_index, remap_buffers
from hexapods.shows.replay import FRAMES_PER_S, SCENES_PER_S, Replay
from hexapods.shows.scene_view import scene_view
from hexapods.shows.stage_frame import StageFrame

_FRAMES_PER_SCENE = round(FRAMES_PER_S / SCENES_PER_S)
_ALIGNMENT_BYTES = 8
_HEADER = struct.Struct("<I")
_COMPRESSION = 6
POSE_STEP = 2.0**-13
"""Poses of links are multiples of this: positions [m] and components of unit quaternions.

Rounded numbers have few significant bits, so that they compress to half. No position is off by more
than 0.062 mm in a coordinate, nor a rotation by more than 0.014°: a pixel of a robot that fills a
screen of 4,000 pixels is 0.1 mm.
"""
_POSES = ("batched_positions", "batched_wxyzs")
_Frame = tuple[Recorded, dict[str, Any]]
"""Changes of a frame, and its other fields."""
Check = Callable[[], None]
"""Raises if the encoding is not needed any more; called before each frame."""


def encode_scene(replay: Replay, check: Check = lambda: None) -> bytes:
    """Return the scene at the start of a run, on which all frames are based.

    It also has `lifecycles`, by type of message what it does to a scene node, and `world`, the
    node that a page moves to follow a robot.
    """
    return _encode(_frames(replay, (), check), lifecycles=LIFECYCLES, world=WORLD)


def encode_frames(replay: Replay, times_s: Sequence[float], check: Check = lambda: None) -> bytes:
    """Return the frames at some times [s], or at the nearest that are recorded."""
    frames = _frames(replay, times_s, check)
    next(frames)  # the scene, on which they are based
    return _encode(frames)


def encode_posture(frame: StageFrame, lane: int, cells: Cells) -> bytes:
    """Return a ghost of a lane's robot in a state, as messages without `scene` and `follow`.

    It is drawn in the node of the lane's foot grid, which carries it along with the robot.

    Args:
        frame: in whose conditions it is drawn: legs that are lost are left out.
        lane: the lane, counted from 0.
        cells: the cell of each group.

    Raises:
        InvalidInput: if there is no such state.
        Unreachable: if the robot cannot stand in it.
    """
    spec = replace(frame.spec, lane_specs=frame.spec.lane_specs[lane : lane + 1], ghosts=None)
    root = f"{grid_root(lane)}/posture"
    with in_process_viser() as server, recorder(server) as recording:
        draw_posture(server, root, spec, cells, frame.lanes[lane].conditions)
        messages, arrays = recording.take()
        messages_of_ghost = [
            message for message in messages if f"{message.get('name')}/".startswith(f"{root}/")
        ]
        return _encode(iter([(Recorded(messages_of_ghost, arrays), {"time_s": frame.time_s})]))


def _frames(replay: Replay, times_s: Sequence[float], check: Check) -> Iterator[_Frame]:
    """Yield the scene at the start, then what each frame changes; each with its other fields."""
    with in_process_viser() as server, recorder(server) as recording:
        stage_scene = StageScene(server)
        for number, time_s in enumerate([0.0, *times_s], start=-1):
            check()
            frame = replay.frame_at(time_s)
            stage_scene.draw(frame)
            yield (
                recording.take(),
                {
                    "time_s": frame.time_s,
                    "follow": _follow_points(frame, stage_scene),
                    "scene": None if number % _FRAMES_PER_SCENE else to_json(scene_view(frame)),
                },
            )


def _follow_points(frame: StageFrame, scene: StageScene) -> dict[str, tuple[float, float]]:
    """Return the position of each view on the ground [m]."""
    views = ["leader", *(str(number) for number in range(1, len(frame.lanes) + 1))]
    points = ((view, scene.follow_position(view)) for view in views)
    return {view: (round(at[0], 4), round(at[1], 4)) for view, at in points if at is not None}


def _encode(frames: Iterator[_Frame], **more: Any) -> bytes:
    arrays: list[memoryview] = []
    encoded_frames = []
    for recorded, fields in frames:
        sources = _with_rounded_poses(recorded)
        messages = [remap_buffers(message, sources, arrays) for message in recorded.messages]
        encoded_frames.append({**fields, "messages": messages})
    lengths = [array.nbytes for array in arrays]
    header = msgspec.json.encode({**more, "lengths": lengths, "frames": encoded_frames})
    encoded = bytearray(_HEADER.pack(len(header)) + header)
    for array in arrays:
        encoded += bytes(-len(encoded) % _ALIGNMENT_BYTES)
        encoded += array
    return gzip.compress(bytes(encoded), compresslevel=_COMPRESSION, mtime=0)


def _with_rounded_poses(recorded: Recorded) -> list[memoryview]:
    """Return the arrays of messages, those of poses rounded to `POSE_STEP`."""
    arrays = list(recorded.arrays)
    for message in recorded.messages:
        values = message.get("updates") or message.get("props") or {}
        for index in (array_index(values[name]) for name in _POSES if name in values):
            poses = np.frombuffer(arrays[index], np.float32)
            rounded = np.round(poses / POSE_STEP) * POSE_STEP
            arrays[index] = memoryview(rounded.astype("<f4").tobytes())
    return arrays
