"""The recorded walk of a stored run: there is none before the run has ended."""

from typing import Any

import pytest

from app.features.exports.stored_walks import recorded_walks, source_of
from app.stage.playback import Replays
from app.storage.errors import Conflict
from app.viewer.replay_frames import ReplayFrames
from tests.stage.stage_parts import StageParts

AGENTS = ("greedy", "wave")


def test_what_runs_or_has_no_recording_is_refused(parts: StageParts) -> None:
    run, advance = parts.running_race(AGENTS)
    advance()
    with pytest.raises(Conflict, match="is running; its walk can be had as a file once it ended"):
        recorded_walks(parts.store.find(run.id), parts.recordings)
    config: Any = parts.store.get(run.id).config
    ended = parts.create(config, state="finished")
    with pytest.raises(Conflict, match="is finished and has no recording"):
        recorded_walks(parts.store.find(ended.id), parts.recordings)


def test_a_race_under_way_has_no_page(parts: StageParts) -> None:
    run, advance = parts.running_race(AGENTS)
    advance()
    frames = ReplayFrames(Replays(parts.store, parts.recordings))
    with pytest.raises(Conflict, match="can be had as a file once it ended"):
        source_of(parts.store.find(run.id), parts.recordings, frames.encoded)
