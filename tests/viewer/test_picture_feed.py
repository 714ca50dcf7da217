"""The feed of the picture: pushes pieces of the run on stage ahead of their time, once for all."""

import base64
import itertools
import json
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from app.events.bus import Event
from app.stage.playback import Replays
from app.storage.database.store import RunStore
from app.viewer.picture_feed import PictureFeed
from app.viewer.replay_frames import ReplayFrames
from hexapods.shows.playhead import Playhead
from hexapods.shows.replay import SEGMENT_FRAMES, interval_s
from tests.stage.stage_parts import StageParts
from tests.storage.stores import temporary_store
from tests.timeouts import LONG_S

ADVANCE_S = 0.1
"""Time between two advances of a feed [s]."""


class FedParts(StageParts):
    """A stage with a fake clock that is fed, and the events of a page that watches it."""

    def __init__(self, store: RunStore) -> None:
        super().__init__(store)
        frames = ReplayFrames(Replays(self.store, self.recordings))
        self.frames = frames
        self.viewers = 1
        self.feed = PictureFeed(self.stage, frames, self.channel, lambda: self.viewers)
        self._events = self.channel.subscribe(has_picture=True)
        self.received: list[Event] = []

    def drain(self) -> None:
        """Receive the events so far; of some names a slow page has the newest only."""
        self.received += self._events.drain()

    def data(self, name: str) -> list[dict[str, Any]]:
        """Return the data of all events of a name so far."""
        self.drain()
        return [json.loads(event.data) for event in self.received if event.event == name]

    def feed_for(self, seconds: float) -> None:
        """Let time pass while the feed advances the stage."""
        for _ in range(round(seconds / ADVANCE_S)):
            self.now += ADVANCE_S
            self.feed.advance()
            self.drain()

    def pieces(
        self, is_enough: Callable[[list[dict[str, Any]]], bool], at_most_s: float = 60.0
    ) -> list[dict[str, Any]]:
        """Let time pass until enough pieces have come, and return them."""
        until_s = self.now + at_most_s
        self.feed.advance()
        while not is_enough(pieces := self.data("piece")):
            assert self.now < until_s, f"only {len(pieces)} pieces came"
            self.feed_for(ADVANCE_S)
        return pieces


@pytest.fixture
def parts() -> Iterator[FedParts]:
    with temporary_store() as store:
        yield FedParts(store)


def test_a_feed_that_runs_advances_by_itself_and_at_once_after_a_command() -> None:
    with temporary_store() as store:
        parts = FedParts(store)
        run, other = parts.finished_race(), parts.finished_race()
        with parts.feed:
            for run_id in (run.id, other.id):
                parts.stage.set(run_id=run_id, speed=1)
                until_s = time.monotonic() + LONG_S
                while run_id not in {piece["run_id"] for piece in parts.data("piece")}:
                    assert time.monotonic() < until_s, "no piece came"
                    time.sleep(0.01)


def test_segments_come_before_they_are_shown_without_a_gap_and_once(parts: FedParts) -> None:
    run = parts.finished_race(steps=30)
    parts.stage.set(run_id=run.id, speed=1)
    pieces = parts.pieces(lambda pieces: sum(is_segment(piece) for piece in pieces) == 3)

    segments = [piece for piece in pieces if is_segment(piece)]
    assert [segment["first"] for segment in segments] == [0, 64, 128]
    assert {segment["level"] for segment in segments} == {0}
    for before, segment in itertools.pairwise(segments):
        begins_s = segment["first"] * interval_s(0)
        assert time_at(segment["playhead"], segment["sent_s"]) < begins_s
        assert before["first"] + before["count"] == segment["first"]


def test_a_pushed_segment_is_the_same_bytes_as_a_fetched_one(parts: FedParts) -> None:
    run = parts.finished_race()
    parts.stage.set(run_id=run.id, speed=1)
    segment = next(filter(is_segment, parts.pieces(lambda pieces: any(map(is_segment, pieces)))))
    fetched = parts.frames.segment(run.id, segment["clock"], segment["level"], 0)
    assert base64.b64decode(segment["data"]) == fetched.data
    assert (segment["run_id"], segment["version"]) == (run.id, fetched.version)


def test_after_a_jump_a_few_frames_come_before_their_segment(parts: FedParts) -> None:
    run = parts.finished_race(steps=30)
    parts.stage.set(run_id=run.id, speed=1, time_s=3.0)
    pieces = parts.pieces(lambda pieces: any(map(is_segment, pieces)))
    first_piece, segment = pieces
    assert first_piece["count"] < 10
    assert segment["first"] <= first_piece["first"] < segment["first"] + segment["count"]
    begins_s = first_piece["first"] * interval_s(0)
    shown_s = time_at(first_piece["playhead"], first_piece["sent_s"])
    assert begins_s == pytest.approx(shown_s, abs=interval_s(0))


def test_of_a_picture_that_is_held_the_very_frame_comes_once(parts: FedParts) -> None:
    run = parts.finished_race()
    parts.stage.set(run_id=run.id, time_s=1.2345, playing=False)
    [moment] = parts.pieces(lambda pieces: len(pieces) == 1)
    assert (moment["level"], moment["first"], moment["time_s"]) == (None, None, 1.2345)
    parts.feed_for(0.5)
    assert len(parts.data("piece")) == 1


def test_at_the_tail_of_a_running_run_frames_come_as_they_are_computed(parts: FedParts) -> None:
    run, advance = parts.running_training(steps=40, pace=1)
    parts.stage.set(run_id=run.id)
    for _ in range(3):
        advance()
        parts.feed_for(0.32)
    pieces = parts.pieces(
        lambda pieces: bool(pieces) and pieces[-1]["playhead"]["computed_s"] > 0.9
    )
    pieces = [piece for piece in pieces if piece["level"] is not None]
    assert len(pieces) >= 2
    for before, piece in itertools.pairwise(pieces):
        assert piece["first"] * interval_s(piece["level"]) == pytest.approx(
            (before["first"] + before["count"]) * interval_s(before["level"]), abs=interval_s(0)
        )
    assert pieces[-1]["playhead"]["computed_s"] == pytest.approx(0.96)


def test_a_stage_that_nobody_watches_encodes_nothing(parts: FedParts) -> None:
    parts.viewers = 0
    parts.stage.set(run_id=parts.finished_race().id)
    parts.feed_for(0.5)
    assert parts.data("piece") == []
    parts.viewers = 1
    assert parts.pieces(bool)


def test_viewers_that_join_together_are_told_at_once(parts: FedParts) -> None:
    for number in range(2, 60):
        parts.viewers = number
        parts.now += 0.01
        parts.feed.advance()
        parts.drain()
    parts.feed_for(1.5)
    assert [data["count"] for data in parts.data("viewers")] == [2, 59]


def test_a_run_that_is_deleted_ends_its_pieces_and_not_the_feed(parts: FedParts) -> None:
    run, other = parts.finished_race(), parts.finished_race()
    parts.stage.set(run_id=run.id, speed=0.25)
    parts.pieces(bool)
    parts.delete(run)
    parts.stage.set(run_id=other.id)
    assert parts.pieces(lambda pieces: pieces[-1]["run_id"] == other.id)


def is_segment(piece: dict[str, Any]) -> bool:
    return bool(piece["count"] == SEGMENT_FRAMES)


def time_at(playhead: dict[str, Any], now_s: float) -> float:
    return Playhead(**playhead).time_at(now_s)
