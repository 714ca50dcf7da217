"""Encode a replay as viser messages, which a page plays, seeks and repeats by itself.

The first frame of a segment says all that differs from the scene at the start of the run, the next
ones what changed since the one before. So a page that has the scene (`encode_scene`) needs one
segment to be at any moment of it.

An encoding, compressed with gzip, is `u32 size of the JSON, little-endian | JSON | poses | arrays`;
`docs/replays.md` describes it. The JSON has `frames`, each with its `time_s`, its viser `messages`,
`follow`, the position of each view [m], and now and then `scene`, the figures of the moment. A
message that is just a pose is the number of its track, see `hexapods.drawing.pose_tracks`; others
name an array as viser does (`{"__binary_index": 3, "dtype": "<f4"}`).
"""

import struct
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import msgspec

from hexapods.domain.records import to_json
from hexapods.domain.types import Cells
from hexapods.drawing.pose_tracks import PoseTracks, pose_arrays, rounded_poses
from hexapods.drawing.posture import draw_posture
from hexapods.drawing.scene import StageScene, grid_root
from hexapods.drawing.sketch import draw_sketch
from hexapods.drawing.track import WORLD
from hexapods.drawing.viser_internals.messages import LIFECYCLES, Message, remap_buffers
from hexapods.drawing.viser_internals.recorder import Recorded, recorder
from hexapods.drawing.viser_internals.server import recorded_viser
from hexapods.imports.imported import Sketch
from hexapods.shows.replay import FRAMES_PER_S, SCENES_PER_S, Replay
from hexapods.shows.scene_view import scene_view
from hexapods.shows.stage_frame import StageFrame

_FRAMES_PER_SCENE = round(FRAMES_PER_S / SCENES_PER_S)
_ALIGNMENT_BYTES = 8
_HEADER = struct.Struct("<I")
_COMPRESSION, _GZIP = 6, 16
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
    with recorded_viser() as server, recorder(server) as recording:
        draw_posture(server, root, spec, cells, frame.lanes[lane].conditions)
        messages, arrays = recording.take()
        messages_of_ghost = [
            message for message in messages if f"{message.get('name')}/".startswith(f"{root}/")
        ]
        return _encode(iter([(Recorded(messages_of_ghost, arrays), {"time_s": frame.time_s})]))


def encode_sketch(sketch: Sketch, groups: Sequence[Sequence[int]]) -> bytes:
    """Return a robot on a turntable as a scene alone; arguments as those of `draw_sketch`."""
    with recorded_viser() as server, recorder(server) as recording:
        draw_sketch(server, sketch, groups)
        frame = (recording.take(), {"time_s": 0.0, "follow": {}, "scene": None})
        return _encode(iter([frame]), lifecycles=LIFECYCLES, world=WORLD)


def _frames(replay: Replay, times_s: Sequence[float], check: Check) -> Iterator[_Frame]:
    """Yield the scene at the start, then what each frame changes; each with its other fields."""
    with recorded_viser() as server, recorder(server) as recording:
        stage_scene = StageScene(server)
        for number, time_s in enumerate([None, *times_s], start=-1):
            check()
            # Pages keep the scene while the run records on, so that it must not depend on that.
            frame = replay.start_frame() if time_s is None else replay.frame_at(time_s)
            stage_scene.draw(frame)
            has_figures = number < 0 or number % _FRAMES_PER_SCENE == 0
            yield (
                recording.take(),
                {
                    "time_s": frame.time_s,
                    "follow": _follow_points(frame, stage_scene),
                    "scene": to_json(scene_view(frame)) if has_figures else None,
                },
            )


def _follow_points(frame: StageFrame, scene: StageScene) -> dict[str, tuple[float, float]]:
    """Return the position of each view on the ground [m]."""
    views = ["leader", *(str(number) for number in range(1, len(frame.lanes) + 1))]
    points = ((view, scene.follow_position(view)) for view in views)
    return {view: (round(at[0], 4), round(at[1], 4)) for view, at in points if at is not None}


def _encode(frames: Iterator[_Frame], **more: Any) -> bytes:
    arrays: list[memoryview] = []
    tracks = PoseTracks()
    encoded_frames = []
    for recorded, fields in frames:
        messages: list[Message | int] = []
        for message in recorded.messages:
            track = tracks.take(message, recorded.arrays)
            if track is None:
                for index in pose_arrays(message):
                    recorded.arrays[index] = rounded_poses(recorded.arrays[index])
                messages.append(remap_buffers(message, recorded.arrays, arrays))
            else:
                messages.append(track)
        encoded_frames.append({**fields, "messages": messages})
    poses, planes = tracks.pack()
    # Meshes are often the same.
    blocks: dict[bytes, int] = {}
    numbers = [blocks.setdefault(bytes(array), len(blocks)) for array in arrays]
    header = msgspec.json.encode(
        {
            **more,
            **({"poses": poses} if poses["tracks"] else {}),
            "lengths": [len(block) for block in blocks],
            "arrays": numbers,
            "frames": encoded_frames,
        }
    )
    arrays_at = _HEADER.size + len(header) + sum(map(len, planes))
    aligned = bytearray(arrays_at)
    for block in blocks:
        aligned += bytes(-len(aligned) % _ALIGNMENT_BYTES)
        aligned += block
    return _compressed([_HEADER.pack(len(header)) + header, *planes, bytes(aligned[arrays_at:])])


def _compressed(sections: Iterable[bytes]) -> bytes:
    """Return the gzip of sections, each with codes of its own for its bytes: 3 % smaller."""
    gzip = zlib.compressobj(_COMPRESSION, wbits=zlib.MAX_WBITS | _GZIP)
    return b"".join(
        [*(gzip.compress(s) + gzip.flush(zlib.Z_BLOCK) for s in sections), gzip.flush()]
    )
