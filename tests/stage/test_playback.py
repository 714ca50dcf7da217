"""Replays: any moment of a run, whatever was looked at before, and the marks of its timeline."""

import numpy as np
import pytest

from app.stage.playback import Replays
from app.storage.errors import Conflict, NotFound
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import InvalidInput
from hexapods.domain.world import World
from hexapods.runs.clocks import CLOCKS
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import finish_s
from hexapods.shows.replay import (
    FRAMES_PER_S,
    SEGMENT_FRAMES,
    NoSuchSegment,
    Replay,
    interval_s,
)
from hexapods.shows.scene_view import scene_view
from tests.stage.stage_parts import StageParts

LANES = ("q-learning", "greedy", "two-step")


def replays_of(parts: StageParts) -> Replays:
    return Replays(parts.store, parts.recordings)


def test_a_moment_does_not_depend_on_those_before(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    watched = replays_of(parts).get(run.id, "paper")
    for time_s in (9.0, 0.5, 3.0):
        watched.frame_at(time_s)
    seen, fresh = watched.frame_at(2.5), replays_of(parts).get(run.id, "paper").frame_at(2.5)

    assert scene_view(seen) == scene_view(fresh)
    for seen_lane, fresh_lane in zip(seen.lanes, fresh.lanes, strict=True):
        assert np.array_equal(seen_lane.qpos, fresh_lane.qpos)


def test_poses_at_the_ends_of_steps_are_those_that_were_simulated(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    replay = replays_of(parts).get(run.id, "free")
    recorded = parts.recordings.race(run.id) or []

    for step, end_s in enumerate(replay.show.step_ends_s[1]):
        shown = replay.frame_at(end_s).lanes[1].qpos
        assert shown == pytest.approx(recorded[1].steps[step].motion.qpos[-1], abs=1e-6)


def test_marks_of_a_race_are_in_order_and_where_it_says(parts: StageParts) -> None:
    world = World((SensorNoise(at_step=4, sd_m=0.002),))
    run = parts.finished_race(LANES, world=world)
    for clock in CLOCKS:
        replay = replays_of(parts).get(run.id, clock)
        marks = replay.show.marks()
        ends = replay.show.step_ends_s

        assert [mark.time_s for mark in marks] == sorted(mark.time_s for mark in marks)
        changes = {mark.lane: mark for mark in marks if mark.kind == "disturbance"}
        assert {lane: mark.time_s for lane, mark in changes.items()} == {
            lane: ends[lane][3] for lane in range(3)
        }
        time_out = next(mark for mark in marks if mark.kind == "time-out")
        assert time_out.time_s == finish_s(parts.recordings.race(run.id) or [], 12, clock)


def test_a_practice_has_its_evaluations_and_the_steps_that_are_kept(parts: StageParts) -> None:
    run = parts.finished_training(600)
    replay = replays_of(parts).get(run.id, "paper")
    step_s = run.config.robot.step_s
    recording = parts.recordings.training(run.id)
    assert recording is not None

    first, newest = replay.recorded
    assert first == pytest.approx((0.0, 20 * step_s))
    assert newest == pytest.approx((100 * step_s, 600 * step_s))
    assert [mark.step for mark in replay.show.marks() if mark.kind == "evaluation"] == [
        evaluation.step for evaluation in recording.evaluations
    ]
    in_gap = replay.frame_at(50 * step_s)
    assert in_gap.time_s == pytest.approx(100 * step_s), "the next that is recorded"


def test_replays_are_kept_up_to_the_size_of_their_recordings(parts: StageParts) -> None:
    runs = [parts.finished_training(40, evaluate_every=20) for _ in range(3)]
    runs += [parts.finished_race(LANES, steps=10) for _ in range(3)]
    for run in runs:
        parts.recordings.finish(run.id)
    recording = parts.recordings.training(runs[0].id)
    assert recording is not None
    replays = replays_of(parts)
    cached = [replays.get(run.id, "paper") for run in runs]
    assert [replays.get(run.id, "paper") for run in runs] == cached
    assert 40 * 25 * 4 < cached[0].size < recording.size, "it shows no evaluation's motion"
    with_ghost = replays.get(runs[0].id, "paper", runs[1].id)
    assert with_ghost.size == cached[0].size + cached[1].size

    two = Replays(parts.store, parts.recordings, sum(replay.size for replay in cached[-2:]))
    first, *newer = (two.get(run.id, "paper") for run in (runs[0], *runs[-2:]))
    assert [two.get(run.id, "paper") for run in runs[-2:]] == newer
    assert two.get(runs[0].id, "paper") is not first
    smallest = Replays(parts.store, parts.recordings, 1)
    newest = smallest.get(runs[1].id, "paper")
    assert smallest.get(runs[1].id, "paper") is newest


def test_a_renamed_run_is_replayed_under_its_new_name(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    replays = replays_of(parts)
    assert replays.get(run.id, "paper") is replays.get(run.id, "paper")
    assert run.name in replays.get(run.id, "paper").frame_at(0.0).label


def test_a_race_that_is_computed_is_replayed_as_far_as_it_is(parts: StageParts) -> None:
    run, advance = parts.running_race(LANES)
    replays = replays_of(parts)
    for _ in range(9):
        advance()
    first = replays.get(run.id, "paper").recorded[-1][1]
    for _ in range(9):
        advance()
    later = replays.get(run.id, "paper")

    assert 0 < first < later.recorded[-1][1]
    assert not later.is_complete
    assert later.plan().duration_s is None


def test_a_run_that_ended_without_recording_has_no_replay(parts: StageParts) -> None:
    replays = replays_of(parts)
    with pytest.raises(NotFound):
        replays.get("nothing", "paper")
    lanes = (LaneConfig(agent="greedy"),)
    run = parts.create(RaceConfig(gait="left-right-origin", lanes=lanes))
    assert replays.get(run.id, "paper").plan().recorded_s == []

    parts.set_state(run, "stopped")
    with pytest.raises(Conflict, match=f"{run.id} is stopped and has no recording"):
        replays.get(run.id, "paper")
    on_start_line = replays.get(run.id, "paper", needs_recording=False).frame_at(1.0)
    assert on_start_line.phase == "start-line"


def test_segments_cover_the_recording_to_its_last_moment(parts: StageParts) -> None:
    replay = replays_of(parts).get(parts.finished_race(LANES).id, "paper")
    end_s = replay.recorded[-1][1]
    for level in (-1, 0, 2):
        times_s: list[float] = []
        interval_s, number = 2**level / FRAMES_PER_S, 0
        while not times_s or times_s[-1] < end_s:
            times_s += replay.segment_times_s(level, number)
            number += 1
        assert times_s[-1] == end_s
        assert np.diff(times_s[:-1]) == pytest.approx(interval_s)
        with pytest.raises(NoSuchSegment, match=f"its last segment is {number - 1}"):
            replay.segment_times_s(level, number)


@pytest.mark.parametrize("is_complete", [True, False])
def test_a_segment_that_begins_at_the_end_as_it_is_told_has_the_end(
    parts: StageParts, monkeypatch: pytest.MonkeyPatch, *, is_complete: bool
) -> None:
    stored = replays_of(parts).get(parts.finished_race(LANES).id, "paper")
    replay = Replay(stored.show, stored.label, is_complete=is_complete)
    begin_s = 30 * SEGMENT_FRAMES * interval_s(-2)
    for end_s in (begin_s - 0.0005, begin_s - 1e-9, begin_s):
        monkeypatch.setattr(Replay, "recorded", ((0.0, end_s),))
        assert replay.segment_times_s(-2, 30)[0] == end_s
    monkeypatch.setattr(Replay, "recorded", ((0.0, begin_s - 0.0006),))
    with pytest.raises(NoSuchSegment, match="its last segment is 29"):
        replay.segment_times_s(-2, 30)


def test_lanes_of_another_run_walk_along_as_ghosts_at_their_own_time(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    other = parts.finished_race(("two-step", "greedy"), 8)
    replays = replays_of(parts)
    alone = replays.get(other.id, "paper")
    with_ghosts = replays.get(run.id, "paper", other.id)

    for time_s in (0.0, 1.7, 3.0, with_ghosts.recorded[-1][1]):
        frame, expected = with_ghosts.frame_at(time_s), alone.frame_at(time_s)
        assert (
            frame.lanes[0].distance_m
            == replays.get(run.id, "paper").frame_at(time_s).lanes[0].distance_m
        )
        shown = [ghost for ghost in frame.ghost_lanes if ghost is not None]
        for ghost, lane in zip(shown, expected.lanes, strict=True):
            assert np.array_equal(ghost.qpos, lane.qpos)
        named = [(ghost.name, ghost.step) for ghost in scene_view(frame).ghost_lanes]
        assert named == [("Two-step", shown[0].step), ("Greedy", shown[1].step)]
    assert with_ghosts.plan().ghost_id == other.id
    assert with_ghosts.version != replays.get(run.id, "paper").version


def test_two_practices_walk_side_by_side(parts: StageParts) -> None:
    run, other = parts.finished_training(30), parts.finished_training(20, agent="sarsa")
    with_ghosts, alone = (
        replays_of(parts).get(*ids) for ids in ((run.id, "paper", other.id), (other.id, "paper"))
    )

    frame = with_ghosts.frame_at(4.0)
    (ghost,) = frame.ghost_lanes
    assert ghost is not None
    assert np.array_equal(ghost.qpos, alone.frame_at(4.0).lanes[0].qpos)
    late = with_ghosts.frame_at(with_ghosts.recorded[-1][1])
    assert (late.lanes[0].step, scene_view(late).ghost_lanes[0].step) == (30, 20), "it waits"


def test_a_ghost_is_another_run_of_the_kind_that_has_ended(parts: StageParts) -> None:
    race, training = parts.finished_race(LANES), parts.finished_training(20)
    replays = replays_of(parts)
    with pytest.raises(NotFound):
        replays.get(race.id, "paper", "gone")
    with pytest.raises(InvalidInput, match=f"race {race.id} cannot be its own ghost"):
        replays.get(race.id, "paper", race.id)
    with pytest.raises(InvalidInput, match=r"cannot be the ghost of race .* choose another race"):
        replays.get(race.id, "paper", training.id)
    running, advance = parts.running_race(LANES)
    advance()
    with pytest.raises(Conflict, match="it can be a ghost once it has ended"):
        replays.get(race.id, "paper", running.id)
    lanes = (LaneConfig(agent="greedy"),)
    failed = parts.create(RaceConfig(gait="left-right-origin", lanes=lanes), state="failed")
    with pytest.raises(Conflict, match=f"{failed.id} is failed and has no recording"):
        replays.get(race.id, "paper", failed.id)
