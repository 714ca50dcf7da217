"""Frames of a replay as viser messages, which each page plays, seeks and repeats by itself.

A segment (`stage.playback`) is encoded once, and is the same for everybody who watches the run.

The first frame of a segment says all that differs from the scene at the start of the run, the next
ones what changed since the one before. So a page that has the scene (`scene`) needs one segment to
be at any moment of it, and the server keeps nothing for it.
"""

import gzip
import struct
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import msgspec

from app.cache import BytesCache
from app.domain.errors import InvalidInput
from app.domain.types import Cells
from app.jobs.stopping import Stopping
from app.runs.clocks import Clock
from app.stage.playback import FRAMES_PER_S, SEGMENT_FRAMES, Replay, Replays
from app.stage.stage_frame import StageFrame
from app.viewer.posture import draw_posture
from app.viewer.scene import StageScene, grid_root
from app.viewer.stage_loop import SCENES_PER_S
from app.viewer.track import WORLD
from app.viewer.viser_internals.recorder import Recorded, recorder
from app.viewer.viser_internals.server import in_process_viser
from app.viewer.viser_internals.stream import LIFECYCLES, remap_buffers

_CACHE_BYTES = 64 << 20
_FRAMES_PER_SCENE = round(FRAMES_PER_S / SCENES_PER_S)
_ALIGNMENT_BYTES = 8
_HEADER = struct.Struct("<I")
_COMPRESSION = 1


class ReplayFrames:
    """Encodes replays, one request at a time, and keeps the newest segments. Thread-safe.

    An encoding, compressed with gzip, is `u32 size of the JSON, little-endian | JSON | arrays`,
    each array aligned to 8 bytes. The JSON has `lengths` of the arrays [bytes] and `frames`, each
    with its `time_s`, its viser `messages`, which name an array as viser does
    (`{"__binary_index": 3, "dtype": "<f4"}`), `follow`, the position of each view [m], and now and
    then `scene`, as the event of this name.

    Args:
        replays: makes the replays.
        stopping: whether the server stops, which encodes no more then.
    """

    def __init__(self, replays: Replays, stopping: Stopping | None = None) -> None:
        self._replays = replays
        self._stopping = stopping or Stopping()
        self._lock = threading.Lock()
        self._segments = BytesCache(_CACHE_BYTES)

    def plan(self, run_id: str, clock: Clock, ghost_id: str | None = None) -> dict[str, Any]:
        """Return what a page needs to play a run, in plain types: see `ReplayView` of the API.

        Raises:
            NotFound, InvalidInput, Conflict: see `Replays.get`.
        """
        return self._replays.get(run_id, clock, ghost_id).plan()

    def scene(self, run_id: str, ghost_id: str | None = None) -> bytes:
        """Return the scene at the start of a run, on which all frames are based.

        It also has `lifecycles`, by type of message what it does to a scene node, and `world`, the
        node that a page moves to follow a robot.

        Raises:
            NotFound, InvalidInput, Conflict: see `Replays.get`.
            Busy: if the server stops, as in the methods below.
        """
        replay = self._replays.get(run_id, "paper", ghost_id)
        with self._encoding():
            return _encode(_frames(replay, ()), lifecycles=LIFECYCLES, world=WORLD)

    def moment(
        self, run_id: str, clock: Clock, time_s: float, ghost_id: str | None = None
    ) -> bytes:
        """Return one frame, at a time [s] or the nearest that is recorded.

        Raises:
            NotFound, InvalidInput, Conflict: see `Replays.get`.
        """
        replay = self._replays.get(run_id, clock, ghost_id)
        with self._encoding():
            return _encode(_after_scene(replay, [time_s]))

    def posture(self, run_id: str, clock: Clock, time_s: float, lane: int, cells: Cells) -> bytes:
        """Return a ghost of a lane's robot in a state, as messages without `scene` and `follow`.

        It is drawn in the node of the lane's foot grid, which carries it along with the robot.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            time_s: whose conditions it is drawn in [s]: legs that are lost are left out.
            lane: the lane, counted from 0.
            cells: the cell of each pair.

        Raises:
            NotFound, Conflict: see `Replays.get`.
            InvalidInput: likewise; or if there is no such lane, or no such state.
            Unreachable: if the robot cannot stand in it.
        """
        frame = self._replays.get(run_id, clock).frame_at(time_s)
        if not 0 <= lane < len(frame.lanes):
            raise InvalidInput(f"lane must be from 0 to {len(frame.lanes) - 1}, not {lane}")
        spec = replace(frame.spec, lane_specs=frame.spec.lane_specs[lane : lane + 1], ghosts=None)
        root = f"{grid_root(lane)}/posture"
        with self._encoding(), in_process_viser() as server, recorder(server) as recording:
            draw_posture(server, root, spec, cells, frame.lanes[lane].conditions)
            messages, arrays = recording.take()
            own = [
                message for message in messages if f"{message.get('name')}/".startswith(f"{root}/")
            ]
            return _encode(iter([(Recorded(own, arrays), {"time_s": frame.time_s})]))

    def segment(
        self, run_id: str, clock: Clock, level: int, number: int, ghost_id: str | None = None
    ) -> bytes:
        """Return a segment; of a run that is still computed only the frames so far.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            level: see `stage.playback`.
            number: number of the segment, from 0.
            ghost_id: id of the run whose lanes are shown as ghosts, as in every method.

        Raises:
            NotFound: if there is no such run, or the segment is past its end.
            InvalidInput, Conflict: see `Replays.get`.
        """
        version = self._replays.version(run_id, ghost_id)
        if (kept := self._segments.get((version, clock, level, number))) is not None:
            return kept
        replay = self._replays.get(run_id, clock, ghost_id)
        key = (replay.version, clock, level, number)
        times_s = replay.segment_times_s(level, number)
        with self._encoding():
            # Another request for it may have been encoded while this one waited.
            if (kept := self._segments.get(key)) is not None:
                return kept
            encoded = _encode(_after_scene(replay, times_s))
            if replay.is_complete or len(times_s) == SEGMENT_FRAMES:
                self._segments.put(key, encoded)
        return encoded

    @contextmanager
    def _encoding(self) -> Iterator[None]:
        with self._lock:
            self._stopping.check()
            yield


def _after_scene(replay: Replay, times_s: Sequence[float]) -> Iterator[tuple[Recorded, Any]]:
    """Yield the frames of a replay at some times, based on its scene."""
    frames = _frames(replay, times_s)
    next(frames)
    return frames


def _frames(replay: Replay, times_s: Sequence[float]) -> Iterator[tuple[Recorded, Any]]:
    """Yield the scene at the start, then what each frame changes; each with its other fields."""
    with in_process_viser() as server, recorder(server) as recording:
        stage_scene = StageScene(server)
        for number, time_s in enumerate([0.0, *times_s], start=-1):
            frame = replay.frame_at(time_s)
            stage_scene.draw(frame)
            yield (
                recording.take(),
                {
                    "time_s": frame.time_s,
                    "follow": _follow_points(frame, stage_scene),
                    "scene": None if number % _FRAMES_PER_SCENE else frame.scene(),
                },
            )


def _follow_points(frame: StageFrame, scene: StageScene) -> dict[str, tuple[float, float]]:
    """Return the position of each view on the ground [m]."""
    views = ["leader", *(str(number) for number in range(1, len(frame.lanes) + 1))]
    points = ((view, scene.follow_position(view)) for view in views)
    return {view: (round(at[0], 4), round(at[1], 4)) for view, at in points if at is not None}


def _encode(frames: Iterator[tuple[Recorded, Any]], **more: Any) -> bytes:
    arrays: list[memoryview] = []
    encoded_frames = [
        {
            **fields,
            "messages": [
                remap_buffers(message, recorded.arrays, arrays) for message in recorded.messages
            ],
        }
        for recorded, fields in frames
    ]
    lengths = [array.nbytes for array in arrays]
    header = msgspec.json.encode({**more, "lengths": lengths, "frames": encoded_frames})
    encoded = bytearray(_HEADER.pack(len(header)) + header)
    for array in arrays:
        encoded += bytes(-len(encoded) % _ALIGNMENT_BYTES)
        encoded += array
    return gzip.compress(bytes(encoded), compresslevel=_COMPRESSION, mtime=0)
