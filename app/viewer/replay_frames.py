"""Replays of stored runs as frames, encoded once for everybody who watches them."""

import threading
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from app.cache import BytesCache
from app.jobs.stopping import Stopping
from app.stage.playback import Replays
from app.storage.errors import NotFound
from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import Cells
from hexapods.drawing.replay_encoding import encode_frames, encode_posture, encode_scene
from hexapods.exports.export_format import EncodedReplay
from hexapods.exports.stage_picture import stage_picture
from hexapods.runs.clocks import Clock
from hexapods.shows.replay import NoSuchSegment, Replay, ReplayView, interval_s
from hexapods.shows.show import IdleShow, RunLabel

_CACHE_BYTES = 32 << 20
_SCENE, _START_LINE = "scene", "start-line"


class Segment(NamedTuple):
    """Encoded frames of a segment.

    Attributes:
        data: encoding of the frames.
        version: version of the replay's frames.
        is_final: whether the run is complete, so that this version of the segment never changes.
    """

    data: bytes
    version: str
    is_final: bool


class ReplayFrames:
    """Encodes replays one at a time, and keeps the newest scenes and segments. Thread-safe.

    `hexapods.drawing.replay_encoding` has the form of an encoding.

    Args:
        replays: makes the replays.
        stopping: whether the server stops, or the client has left, for whom no more is encoded.
    """

    def __init__(self, replays: Replays, stopping: Stopping | None = None) -> None:
        self._replays = replays
        self._stopping = stopping or Stopping()
        self._lock = threading.Lock()
        self._encodings = BytesCache(_CACHE_BYTES)

    def plan(self, run_id: str, clock: Clock, ghost_id: str | None = None) -> ReplayView:
        """Return the plan by which a page plays a run: duration, recorded intervals, segments.

        Raises:
            NotFound, InvalidInput, Conflict: see `Replays.get`.
        """
        return self._replays.get(run_id, clock, ghost_id).plan()

    def scene(self, run_id: str, ghost_id: str | None = None) -> bytes:
        """Return the scene at the start of a run, on which all frames are based.

        It also has `lifecycles`, by type of message what it does to a scene node, and `world`, the
        node that a page moves to follow a robot.

        Raises:
            NotFound, InvalidInput: see `Replays.get`.
            Busy: if the server stops, as in the methods below.
        """
        version = self._replays.version(run_id, ghost_id)
        if (cached := self._encodings.get((version, _SCENE))) is not None:
            return cached
        replay = self._replays.get(run_id, "paper", ghost_id, needs_recording=False)
        return self._encoded_once(
            (replay.version, _SCENE), lambda: encode_scene(replay, self._stopping.check)
        )

    def start_line(self) -> bytes:
        """Return the scene of a stage without a run: robots on the start line; see `scene`."""
        replay = Replay(IdleShow(), RunLabel(None, "On the start line"))
        return self._encoded_once(_START_LINE, lambda: encode_scene(replay, self._stopping.check))

    def moment(
        self, run_id: str, clock: Clock, time_s: float, ghost_id: str | None = None
    ) -> bytes:
        """Return one frame, at a time [s] or the nearest that is recorded.

        Raises:
            NotFound, InvalidInput, Conflict: see `Replays.get`.
        """
        replay = self._replays.get(run_id, clock, ghost_id)
        key: Hashable = (replay.version, clock, time_s)
        if not replay.is_complete:
            key = (key, replay.recording_number, replay.recorded)
        return self._encoded_once(
            key, lambda: encode_frames(replay, [time_s], self._stopping.check)
        )

    def posture(self, run_id: str, clock: Clock, time_s: float, lane: int, cells: Cells) -> bytes:
        """Return a ghost of a lane's robot in a state, as messages without `scene` and `follow`.

        It is drawn in the node of the lane's foot grid, which carries it along with the robot.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            time_s: time of the world in which it is drawn [s]: legs that are lost are left out.
            lane: the lane, counted from 0.
            cells: the cell of each group.

        Raises:
            NotFound, Conflict: see `Replays.get`.
            InvalidInput: likewise; or if there is no such lane, or no such state.
            Unreachable: if the robot cannot stand in it.
        """
        frame = self._replays.get(run_id, clock).frame_at(time_s)
        if not 0 <= lane < len(frame.lanes):
            raise InvalidInput(f"lane must be from 0 to {len(frame.lanes) - 1}, not {lane}")
        with self._encoding():
            return encode_posture(frame, lane, cells)

    def segment(
        self, run_id: str, clock: Clock, level: int, number: int, ghost_id: str | None = None
    ) -> Segment:
        """Return a segment; of a run that is still computed only the frames so far.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            level: see `hexapods.shows.replay`.
            number: number of the segment, from 0.
            ghost_id: id of the run whose lanes are shown as ghosts, as in every method.

        Raises:
            NotFound: if there is no such run, or the segment is past its end.
            InvalidInput, Conflict: see `Replays.get`.
        """
        version = self._replays.version(run_id, ghost_id)
        if (cached := self._encodings.get((version, clock, level, number))) is not None:
            return Segment(cached, version, is_final=True)
        replay = self._replays.get(run_id, clock, ghost_id)
        try:
            times_s = replay.segment_times_s(level, number)
        except NoSuchSegment as error:
            raise NotFound(str(error)) from error
        key: Hashable = (replay.version, clock, level, number)
        if not replay.is_complete:
            # A race that is resumed is recorded anew, and may take other times to decide.
            key = (key, replay.recording_number, len(times_s))
        data = self._encoded_once(key, lambda: encode_frames(replay, times_s, self._stopping.check))
        return Segment(data, replay.version, replay.is_complete)

    def is_encoded(self, run_id: str, clock: Clock, level: int, number: int) -> bool:
        """Whether a segment of a complete run is encoded already.

        Raises:
            NotFound: if there is no such run.
        """
        return (
            self._encodings.get((self._replays.version(run_id), clock, level, number)) is not None
        )

    def piece(self, run_id: str, clock: Clock, level: int, first: int, count: int) -> bytes:
        """Return consecutive frames of a level, or those of them that are recorded.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            level: see `hexapods.shows.replay`.
            first: number of the first frame.
            count: number of frames.

        Raises:
            NotFound, InvalidInput, Conflict: see `Replays.get`.
        """
        replay = self._replays.get(run_id, clock)
        step_s = interval_s(level)
        times_s = [number * step_s for number in range(first, first + count)]
        with self._encoding():
            return encode_frames(replay, times_s, self._stopping.check)

    def encoded(self, run_id: str, clock: Clock) -> EncodedReplay:
        """Return all frames of a run, each encoded when it is asked for.

        Args:
            run_id: id of a training or race.
            clock: times a race.

        Raises:
            NotFound, InvalidInput, Conflict: at the call, see `Replays.get`.
        """
        return EncodedReplay(
            self.plan(run_id, clock),
            lambda: self.scene(run_id),
            lambda level, number: self.segment(run_id, clock, level, number).data,
            lambda: stage_picture(self._replays.get(run_id, clock)),
        )

    def _encoded_once(self, key: Hashable, encode: Callable[[], bytes]) -> bytes:
        """Return a cached encoding, or encode."""
        if (cached := self._encodings.get(key)) is not None:
            return cached
        with self._encoding():
            # Another request for it may have been encoded while this one waited.
            if (cached := self._encodings.get(key)) is not None:
                return cached
            encoded = encode()
            self._encodings.put(key, encoded)
        return encoded

    @contextmanager
    def _encoding(self) -> Iterator[None]:
        with self._stopping.holding(self._lock):
            yield
