"""Advances a stage, and pushes the pieces of its picture to the pages that watch it."""

import base64
import logging
import math
import threading
from collections.abc import Callable, Iterator
from typing import NamedTuple

from app.answer import Answer, Count
from app.events.bus import Channel
from app.events.event_records import ViewersEvent
from app.stage.stage import Stage
from app.stage.stage_view import Picture
from app.viewer.replay_frames import ReplayFrames
from hexapods.domain.errors import HexapodError
from hexapods.runs.clocks import Clock
from hexapods.shows.playhead import Playhead
from hexapods.shows.replay import SEGMENT_FRAMES, interval_s, level_of

_ADVANCES_PER_S = 10
_LEAD_S = 1.5
"""Real time before a frame is shown at which pages have it [s], where it is recorded."""
_FIRST_FRAMES = 8
"""Number of frames that are pushed first after a jump, as they are encoded sooner."""
_FRAMES_AT_TAIL = 12
"""Least number of frames of a piece of a run that is still computed, unless they are due."""
_DUE_S = 0.35
"""Real time before a frame is shown at which it is due [s]."""
_VIEWERS_TOLD_S = 1.0
"""Least time between two events about the number of viewers [s]."""
_SAME_S = 1e-6

_logger = logging.getLogger(__name__)


class PieceEvent(Answer):
    """Frames of the run on stage, before they are shown; see `docs/replays.md`.

    Attributes:
        run_id: of the run.
        clock: that times a race.
        version: of the run's frames.
        level, first: level of the frames, and number of the first; null for a single frame.
        count: number of frames; the last ones may be missing at the end of the run.
        time_s: time of a single frame, which the stage holds; null for others.
        sent_s: time of the server's clock when this was written [s].
        playhead: of the stage.
        data: the frames, encoded as in a replay; base64.
    """

    run_id: str
    clock: Clock
    version: str
    level: int | None
    first: Count | None
    count: Count
    time_s: float | None
    sent_s: float
    playhead: Playhead
    data: str


class _Piece(NamedTuple):
    """Frames of a level; of a single frame, both are None."""

    level: int | None
    first: int | None
    frames: int
    time_s: float
    """Time of the first frame [s]."""

    @property
    def is_segment(self) -> bool:
        """Whether it is a segment as pages can fetch it."""
        return self.frames == SEGMENT_FRAMES

    @property
    def end_s(self) -> float:
        """Time of the run up to which it has frames [s]."""
        if self.level is None or self.first is None:
            return self.time_s
        return (self.first + self.frames) * interval_s(self.level)


class PictureFeed:
    """Advances a stage ten times a second; `with feed:` runs it in a thread, once.

    While pages watch, it pushes the frames that the playhead comes to as `piece` events: whole
    segments, which are encoded once for everybody and are the same as those that pages fetch; at
    the tail of a run that is computed what is recorded so far; and of a picture that is held the
    very frame. What a page has missed, it fetches.

    Args:
        stage: the stage.
        frames: encodes the frames.
        channel: receives the events.
        count_viewers: returns the number of pages that want pieces.
    """

    def __init__(
        self,
        stage: Stage,
        frames: ReplayFrames,
        channel: Channel,
        count_viewers: Callable[[], int],
    ) -> None:
        self._stage, self._frames, self._channel = stage, frames, channel
        self._count_viewers = count_viewers
        self._told_viewers, self._told_viewers_s = 0, -math.inf
        """Number of viewers of which an event told, and when."""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stage", daemon=True)
        self._pushed_of: tuple[str | None, str | None, Clock] = (None, None, "paper")
        """Run, version and clock of the frames that were pushed last."""
        self._pushed_s = (0.0, 0.0)
        """Interval of the run's time that pages have [s]."""
        self._held_s: float | None = None
        """Time of the single frame that was pushed last [s]."""
        self._has_failed = False
        self.pieces = 0
        """Number of pieces that were pushed."""

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._stage.changed.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stop.is_set():
            self._stage.changed.clear()
            try:
                self.advance()
            except Exception:
                # An error at one moment must not end the thread; it is logged once.
                if not self._has_failed:
                    _logger.exception("the picture of the stage failed, continuing")
                self._has_failed = True
            else:
                self._has_failed = False
            self._stage.changed.wait(1 / _ADVANCES_PER_S)

    def advance(self) -> None:
        """Advance the stage to this moment, and push what the playhead comes to."""
        is_replanned = self._stage.advance()
        viewers = self._count_viewers()
        self._tell(viewers)
        if viewers:
            is_told = self._push()
        else:
            is_told, self._pushed_of = False, (None, None, "paper")
        if is_replanned and not is_told:
            self._stage.publish()

    def _tell(self, viewers: int) -> None:
        """Publish the number of viewers, though not for each of a class that joins."""
        now_s = self._stage.now()
        if viewers != self._told_viewers and now_s - self._told_viewers_s >= _VIEWERS_TOLD_S:
            self._told_viewers, self._told_viewers_s = viewers, now_s
            self._channel.publish("viewers", ViewersEvent(count=viewers))

    def _push(self) -> bool:
        """Push what the playhead comes to; return whether anything was."""
        picture = self._stage.picture()
        if picture.run_id is None or picture.version is None:
            return False
        pushed_of = picture.run_id, picture.version, picture.clock
        if pushed_of != self._pushed_of:
            self._pushed_of, self._pushed_s, self._held_s = pushed_of, (0.0, 0.0), None
        is_pushed = False
        try:
            for piece in self._pieces(picture):
                data = self._encoded(picture, piece)
                if self._stop.is_set():
                    break
                self._channel.publish("piece", self._event(picture, piece, data))
                is_pushed = True
                self.pieces += 1
                if self._stage.changed.is_set():
                    break
        except HexapodError:
            pass  # deleted meanwhile, or the server stops; events of the stage tell
        return is_pushed

    def _event(self, picture: Picture, piece: _Piece, data: bytes) -> PieceEvent:
        return PieceEvent(
            run_id=picture.run_id or "",
            clock=picture.clock,
            version=picture.version or "",
            level=piece.level,
            first=piece.first,
            count=piece.frames,
            time_s=piece.time_s if piece.level is None else None,
            sent_s=round(self._stage.now(), 4),
            playhead=self._stage.picture().playhead,
            data=base64.b64encode(data).decode(),
        )

    def _encoded(self, picture: Picture, piece: _Piece) -> bytes:
        run_id, clock = picture.run_id or "", picture.clock
        if piece.level is None or piece.first is None:
            return self._frames.moment(run_id, clock, piece.time_s)
        if piece.is_segment:
            number = piece.first // SEGMENT_FRAMES
            return self._frames.segment(run_id, clock, piece.level, number).data
        return self._frames.piece(run_id, clock, piece.level, piece.first, piece.frames)

    def _pieces(self, picture: Picture) -> Iterator[_Piece]:
        """Yield the pieces that pages need next and do not have."""
        playhead, now_s = picture.playhead, self._stage.now()
        time_s = playhead.time_at(now_s)
        if playhead.rate_at(now_s) == 0:
            if self._held_s != time_s:
                self._held_s = time_s
                yield _Piece(None, None, 1, time_s)
        else:
            self._held_s = None
        begin_s, end_s = self._pushed_s
        if not begin_s - _SAME_S <= time_s <= end_s + _SAME_S:
            begin_s = end_s = time_s
            self._pushed_s = begin_s, end_s
        is_jump = begin_s == end_s
        while (due_s := playhead.when(end_s + _SAME_S, now_s)) < now_s + _LEAD_S:
            piece = self._next(picture, end_s, due_s, is_due=due_s < now_s + _DUE_S)
            if piece is None:
                return
            if is_jump and piece.is_segment and not self._is_encoded(picture, piece):
                first_frames = self._first_frames(picture, piece, end_s)
                self._pushed_s = begin_s, max(end_s, first_frames.end_s)
                yield first_frames
            is_jump = False
            end_s = piece.end_s
            self._pushed_s = begin_s, end_s
            yield piece

    def _first_frames(self, picture: Picture, segment: _Piece, time_s: float) -> _Piece:
        """Return the first frames that are shown of a segment."""
        level = segment.level or 0
        first = int((time_s + _SAME_S) / interval_s(level))
        recorded = int((picture.playhead.computed_s + _SAME_S) / interval_s(level)) + 1
        count = min(_FIRST_FRAMES, recorded - first)
        return _Piece(level, first, max(1, count), first * interval_s(level))

    def _is_encoded(self, picture: Picture, segment: _Piece) -> bool:
        run_id, level = picture.run_id or "", segment.level or 0
        number = (segment.first or 0) // SEGMENT_FRAMES
        return self._frames.is_encoded(run_id, picture.clock, level, number)

    def _next(
        self, picture: Picture, time_s: float, due_s: float, *, is_due: bool
    ) -> _Piece | None:
        """Return the piece that begins at a time of the run; None if it is not recorded yet.

        Args:
            picture: of the stage.
            time_s: up to which pages have the frames [s].
            due_s: time of the clock at which the next frame is shown [s].
            is_due: whether few frames are better than none.
        """
        playhead = picture.playhead
        # Near the newest step of a run that is computed the picture slows down.
        rates = [playhead.rate_at(due_s)]
        if picture.is_computed:
            rates.append(playhead.rate_at(playhead.at_s))
        level = level_of(max(rates))
        step_s = interval_s(level)
        frame = int((time_s + _SAME_S) / step_s)
        if not picture.is_computed:
            segment = frame - frame % SEGMENT_FRAMES
            if segment * step_s > playhead.computed_s:
                return None
            return _Piece(level, segment, SEGMENT_FRAMES, segment * step_s)
        recorded = int((playhead.computed_s + _SAME_S) / step_s) + 1
        count = min(recorded - frame, SEGMENT_FRAMES - 1)
        if count < (2 if is_due else _FRAMES_AT_TAIL):
            return None
        return _Piece(level, frame, count, frame * step_s)
