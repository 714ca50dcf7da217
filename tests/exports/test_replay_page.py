"""The page that replays a run without a server: its frames are those of the recording."""

import base64
import json
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.jobs.stopping import Stopping
from app.stage.playback import Replays
from app.storage.errors import Busy
from app.viewer.replay_frames import ReplayFrames
from hexapods.domain.errors import TooLong
from hexapods.drawing.pose_tracks import POSE_STEP
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.scene import SCENE_ROOT
from hexapods.exports.replay_page import (
    MAX_BYTES,
    MAX_SEGMENTS,
    _notes,
    _recorded_segments,
    replay_page,
)
from hexapods.offline_page import import_map
from hexapods.runs.clocks import Clock
from hexapods.shows.replay import FRAMES_PER_S, SEGMENT_FRAMES
from tests.drawing.replay_decoding import decoded
from tests.stage.stage_parts import StageParts
from tests.viewer.test_replay_frames import LANES, frames_of, shown

PLAYER = "js/offline/player.js"
_BLOCK = re.compile(r'<script type="text/plain" id="([\w-]+)">([^<]*)</script>')


def page_of(
    frames: ReplayFrames,
    run_id: str,
    max_bytes: int = MAX_BYTES,
    clocks: Sequence[Clock] = ("paper",),
) -> str:
    replays = [frames.encoded(run_id, clock) for clock in clocks]
    return b"".join(replay_page(replays, "A <race> & more", max_bytes)).decode()


def blocks_of(page: str) -> dict[str, str]:
    return dict(_BLOCK.findall(page))


def test_frames_of_the_page_are_the_joint_positions_that_were_simulated(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    replay = Replays(parts.store, parts.recordings).get(run.id, "paper")
    page = page_of(frames_of(parts), run.id, clocks=("paper", "free"))
    blocks = blocks_of(page)
    about = json.loads(blocks["replay"])
    mesh = RobotMesh(replay.show.spec.robot)

    assert about["level"] == 0
    assert about["notes"] == []
    assert [plan["clock"] for plan in about["plans"]] == ["paper", "free"]
    names = []
    for plan in about["plans"]:
        end_s = plan["recorded_s"][-1][1]
        count = int(end_s * FRAMES_PER_S / SEGMENT_FRAMES) + 1
        names += [f"segment-{plan['clock']}-{number}" for number in range(count)]
    assert list(blocks) == ["viewer", "replay", "scene", *names]
    end_s = about["plans"][0]["recorded_s"][-1][1]
    for name in (name for name in names if "paper" in name):
        segment, arrays = decoded(base64.b64decode(blocks[name]))
        time_s = segment["frames"][-1]["time_s"]
        state = shown(segment["frames"], arrays)
        moved = f"{SCENE_ROOT}/robots/{mesh.part_name(0)} batched_positions"
        drawn = np.frombuffer(state[moved], np.float32).reshape(len(LANES), -1, 3)
        for lane, view in enumerate(replay.frame_at(time_s).lanes):
            expected = mesh.body_poses(view.qpos).positions[mesh.parts[0].links]
            offset = drawn[lane] - expected
            assert np.ptp(offset, axis=0) == pytest.approx(0, abs=POSE_STEP + 1e-5)
            assert offset[:, 1:] == pytest.approx(0, abs=POSE_STEP / 2 + 1e-5), "lanes differ in x"
    assert segment["frames"][-1]["time_s"] == pytest.approx(end_s)


def test_the_page_has_its_modules_and_its_title_as_text(parts: StageParts) -> None:
    frames, run = frames_of(parts), parts.finished_race(LANES)
    page = page_of(frames, run.id)

    assert "<title>A &lt;race&gt; &amp; more</title>" in page
    assert "A <race>" not in page
    ((nonce, code),) = re.findall(r'<script type="module" nonce="([^"]+)">(.*?)</script>', page)
    assert code == f'import "{PLAYER}";'
    assert f'<script type="importmap" nonce="{nonce}">{import_map(PLAYER)}</script>' in page
    policy = page.split("</head>")[0].split("<script")[0]
    assert f"'nonce-{nonce}'" in policy
    assert "frame-ancestors" not in policy
    assert page == page_of(frames, run.id)
    assert nonce not in page_of(frames, parts.finished_race(LANES, steps=3).id)


@pytest.mark.promises
def test_a_page_that_would_be_too_large_has_fewer_frames(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES), frames_of(parts)
    whole = len(page_of(frames, run.id).encode())
    small = page_of(frames, run.id, max_bytes=whole - 20_000)
    about = json.loads(blocks_of(small)["replay"])

    assert len(small.encode()) < whole - 20_000
    assert about["level"] >= 1
    assert "pictures a second of the run's time" in about["notes"][0]
    with pytest.raises(TooLong, match="the race is too long for a page of"):
        page_of(frames, run.id, max_bytes=100_000)


def test_another_clock_that_does_not_fit_is_left_out(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES, steps=3), frames_of(parts)
    both = page_of(frames, run.id, clocks=("paper", "free"))
    fitting = page_of(frames, run.id, len(both.encode()) - 1000, clocks=("paper", "free"))

    plans = [json.loads(blocks_of(page)["replay"])["plans"] for page in (both, fitting)]
    assert [[plan["clock"] for plan in of_page] for of_page in plans] == [
        ["paper", "free"],
        ["paper"],
    ]
    assert "segment-free-0" not in blocks_of(fitting)


def test_a_long_practice_has_the_segments_of_its_recorded_steps(parts: StageParts) -> None:
    run = parts.finished_training(steps=700)
    plan = frames_of(parts).plan(run.id, "paper")
    # At level 4 a segment has 34.1 s; of 224 s in all, 6.4 to 64 s are not recorded.
    assert _recorded_segments(plan, 4) == [0, 1, 2, 3, 4, 5, 6]
    assert _recorded_segments(plan, 2) == [0, *range(7, 27)]
    assert "Only the first 20 and the newest 500 steps" in _notes(plan, 0)[0]


def test_a_run_of_years_is_not_enumerated(parts: StageParts) -> None:
    """Of an imported run, whose decisions may have taken any time: its segments fill memory."""
    plan = frames_of(parts).plan(parts.finished_race(LANES).id, "paper")
    years = replace(plan, recorded_s=[(0.0, 1.0), (5.0, 1e11)])
    assert len(_recorded_segments(years, 0)) == MAX_SEGMENTS + 1
    hour = replace(plan, recorded_s=[(0.0, 3600.0)])
    assert len(_recorded_segments(hour, 0)) > MAX_SEGMENTS
    assert _recorded_segments(hour, 1) == list(range(844))


def test_a_server_that_stops_encodes_no_more(parts: StageParts) -> None:
    run, stopping = parts.finished_race(LANES), Stopping()
    frames = ReplayFrames(Replays(parts.store, parts.recordings), stopping)
    first_segment = frames.segment(run.id, "paper", 0, 0).data
    stopping.set()
    with pytest.raises(Busy, match="stopping"):
        page_of(frames, run.id)
    assert frames.segment(run.id, "paper", 0, 0).data == first_segment
