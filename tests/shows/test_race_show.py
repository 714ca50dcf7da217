"""Playback of a race: speed, photo finish, clocks, races that are still computed."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from hexapods.domain.creatures import CREATURES
from hexapods.domain.disturbances import Limp, Lost, Push
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.world import World
from hexapods.runs.clocks import Timetable
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import fell_at_step, finish_s, lane_figures
from hexapods.shows.race_show import LAST_LANE_SPEED, PHOTO_FINISH_S, SPEED
from hexapods.shows.scene_view import scene_view
from hexapods.shows.stage_frame import StageFrame
from tests.stage.stage_parts import FRAME_S, StageParts

LANES = ("q-learning", "greedy", "two-step")


def show_to_end(parts: StageParts) -> list[StageFrame]:
    parts.stage.set(run_id=parts.finished_race(LANES).id)
    parts.stage.set(end_at_time_out=False)
    return parts.watch_to_end()


def test_show_ends_with_the_photo_finish_unless_somebody_keeps_watching(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    lanes = parts.recordings.race(run.id) or []
    parts.stage.set(run_id=run.id)
    frame = parts.watch_to_end()[-1]

    assert (frame.phase, frame.ended) == ("photo-finish", True)
    assert frame.time_s == finish_s(lanes, 12, "paper")
    assert [lane.done for lane in frame.lanes] == [True, False, False]
    assert parts.watch(2.0)[-1].time_s == frame.time_s

    parts.stage.set(end_at_time_out=False)
    assert not parts.stage.state().ended
    assert parts.watch_to_end()[-1].lanes[2].done

    parts.stage.set(time_s=0, end_at_time_out=True)
    assert parts.watch_to_end()[-1].phase == "photo-finish"
    parts.stage.set(run_id=parts.finished_race(LANES).id, end_at_time_out=False)
    parts.stage.set(run_id=run.id)
    assert parts.stage.state().end_at_time_out, "of a new show"


def test_decided_race_that_is_still_computed_is_live(parts: StageParts) -> None:
    """Greedy has used its steps when two-step has used few: the picture is at its end."""
    run, advance = parts.running_race(("greedy", "two-step"))
    parts.stage.set(run_id=run.id)
    while parts.stage.state().phase != "decided":
        advance()
        parts.next_frame()

    assert parts.stage.state().live
    assert parts.watch(30.0)[-1].run_id == run.id
    while advance():
        pass
    parts.set_state(run, "finished")
    parts.next_frame()
    assert parts.stage.state().phase == "ended"


@pytest.mark.parametrize("state", ["stopped", "interrupted", "failed"])
def test_race_that_ended_early_says_so_and_is_not_decided(parts: StageParts, state: str) -> None:
    run, advance = parts.running_race(LANES, steps=30)
    for _ in range(3 * 8):
        advance()
    parts.set_state(run, state)
    parts.stage.set(run_id=run.id)
    frames = parts.watch_to_end()

    assert frames[-1].label == f"{run.name}, {state} at step 8 of 30"
    assert not any(frame.phase == "photo-finish" for frame in frames)
    lanes = scene_view(frames[-1]).lanes
    assert [(lane.step, lane.done, lane.halted) for lane in lanes] == [(8, False, True)] * 3
    assert frames[-1].computed_s == frames[-1].duration_s == frames[-1].time_s


def test_race_that_is_resumed_is_played_anew(parts: StageParts) -> None:
    run, advance = parts.running_race(steps=30)
    for _ in range(20):
        advance()
    parts.set_state(run, "interrupted")
    parts.stage.set(run_id=run.id)
    parts.watch_to_end()
    parts.set_state(run, "queued")
    assert parts.next_frame().time_s > 0, "a picture stays until it goes on"

    again = [
        LaneRecording(lane.agent, lane.rest_qpos) for lane in parts.recordings.race(run.id) or []
    ]
    parts.recordings.begin_race(run.id, again)
    parts.set_state(run, "running")
    frame = parts.next_frame()

    assert frame.time_s == 0
    assert [lane.step for lane in frame.lanes] == [1, 1]
    assert parts.stage.state().phase == "live"


def test_automatic_speed_is_two_and_eight_for_the_last_lane(parts: StageParts) -> None:
    frames = show_to_end(parts)
    speeds = [b.time_s - a.time_s for a, b in pairwise(frames)]

    assert frames[5].shown_speed == SPEED
    assert speeds[5] == pytest.approx(SPEED * FRAME_S)
    assert frames[-10].shown_speed == LAST_LANE_SPEED
    assert speeds[-10] == pytest.approx(LAST_LANE_SPEED * FRAME_S)


def test_photo_finish_freezes_the_first_finish_for_three_seconds(parts: StageParts) -> None:
    frames = show_to_end(parts)
    frozen = [frame for frame in frames if frame.phase == "photo-finish"]
    lanes = parts.recordings.race(frozen[0].run_id or "") or []

    assert len(frozen) * FRAME_S == pytest.approx(PHOTO_FINISH_S, abs=2 * FRAME_S)
    assert {frame.time_s for frame in frozen} == {finish_s(lanes, 12, "paper")}
    by_lane = lane_figures(lanes, 12, "paper")
    assert [lane.distance_m for lane in frozen[0].lanes] == pytest.approx(
        [lane.finished_distance_m for lane in by_lane]
    )
    assert [lane.rank for lane in frames[-1].lanes] == [lane.rank for lane in by_lane]


def test_poses_are_continuous_from_rest_to_the_end_of_the_recording(parts: StageParts) -> None:
    frames = show_to_end(parts)
    lanes = parts.recordings.race(frames[0].run_id or "") or []

    for number, lane in enumerate(lanes):
        places = np.array([frame.lanes[number].qpos[:3] for frame in frames])
        assert np.abs(places[0] - lane.rest_qpos[:3]).max() < 0.005
        assert places[-1] == pytest.approx(lane.steps[-1].motion.qpos[-1, :3], abs=1e-6)
        assert np.abs(np.diff(places, axis=0)).max() < 0.05
    assert [lane.done for lane in frames[-1].lanes] == [True, True, True]
    assert frames[-1].phase == "finished"


def test_thinking_lane_counts_its_simulated_transitions(parts: StageParts) -> None:
    frames = show_to_end(parts)
    thinking = [frame.lanes[2] for frame in frames if frame.lanes[2].thinking]

    assert {lane.futures_total for lane in thinking} == {156}
    first = [lane.futures for lane in thinking if lane.step == 1]
    assert first == sorted(first)
    assert first[0] < 20
    assert first[-1] > 140
    assert not any(frame.lanes[0].thinking for frame in frames), "a table needs no thought"


def test_change_of_clock_keeps_the_moment_of_the_leader(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race(LANES).id)
    before = parts.watch(1.5)[-1]
    parts.stage.set(playing=False, clock="free")
    after = parts.next_frame()

    assert after.clock == "free"
    assert after.time_s == before.time_s, "the leader does not think"
    assert after.lanes[2].step == after.lanes[0].step > before.lanes[2].step
    assert not any(lane.thinking for lane in after.lanes)

    parts.stage.set(clock="paper")
    assert parts.next_frame().time_s == pytest.approx(before.time_s)


def test_change_of_clock_at_the_photo_finish_and_at_the_end(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    lanes = parts.recordings.race(run.id) or []
    parts.stage.set(run_id=run.id)
    while parts.next_frame().phase != "photo-finish":
        pass
    parts.stage.set(clock="free")
    assert parts.next_frame().phase == "photo-finish"
    assert parts.next_frame().time_s == finish_s(lanes, 12, "free")

    parts.stage.set(end_at_time_out=False)
    parts.watch_to_end()
    parts.stage.set(clock="wall")
    assert parts.stage.state().ended


def test_label_tells_of_the_lanes_that_still_walk(parts: StageParts) -> None:
    labels = [frame.label.partition(", ")[2] for frame in show_to_end(parts)]
    in_order = [label for label, before in pairwise([*labels, ""]) if label != before]

    assert in_order[0] == "step 1 of 12"
    after = in_order.index("2 robots still walk")
    assert in_order[after - 1] == "step 12 of 12"
    assert in_order[after + 1].startswith("Two-step at step ")
    assert in_order[-1] == "step 12 of 12", "every lane has used its steps"


def test_seek_to_the_duration_ends_the_race(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race(LANES).id)
    duration = parts.next_frame().duration_s
    assert duration is not None
    parts.stage.set(time_s=duration)

    assert parts.next_frame().phase == "finished"


def test_chosen_speed_applies_to_the_whole_race(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race(LANES).id)
    parts.stage.set(speed=16)
    frames = parts.watch_to_end()

    assert {frame.shown_speed for frame in frames} == {16.0, 0.0}

    parts.stage.set(time_s=0, speed="time-lapse")
    assert parts.next_frame().shown_speed == SPEED


def test_playback_waits_for_a_lane_that_is_still_computed(parts: StageParts) -> None:
    run, advance = parts.running_race(("greedy", "two-step"))
    parts.stage.set(run_id=run.id)
    assert parts.next_frame().phase == "waiting"
    for _ in range(3):  # greedy has two steps, two-step one
        advance()
    frame = parts.watch(10.0)[-1]
    lanes = parts.recordings.race(run.id) or []

    assert frame.phase == "waiting"
    assert frame.duration_s is None
    assert frame.lanes[0].qpos == pytest.approx(lanes[0].steps[-1].motion.qpos[-1])
    assert frame.lanes[0].thinking
    assert not parts.stage.state().ended

    while advance():
        pass
    parts.set_state(run, "finished")
    parts.stage.set(end_at_time_out=False)
    assert parts.watch_to_end()[-1].lanes[1].step == 12


def test_robots_stand_on_the_start_line_before_anything_is_recorded(parts: StageParts) -> None:
    config = parts.finished_race().config
    assert isinstance(config, RaceConfig)
    parts.stage.set(run_id=parts.create(config).id)

    frame = parts.next_frame()

    assert frame.phase == "start-line"
    assert [lane.step for lane in frame.lanes] == [0, 0]
    assert not parts.stage.state().ended


def test_failed_race_is_shown_up_to_its_last_step(parts: StageParts) -> None:
    run, advance = parts.running_race()
    parts.stage.set(run_id=run.id)
    for _ in range(4):
        advance()
    parts.set_state(run, "failed")

    frame = parts.watch_to_end()[-1]

    assert [lane.step for lane in frame.lanes] == [2, 2]
    assert [lane.halted for lane in frame.lanes] == [True, True]


def test_lane_without_progress_is_marked_as_marching(parts: StageParts) -> None:
    """An untrained agent, whose action values are all equal, makes hardly any progress."""
    parts.stage.set(run_id=parts.finished_race(LANES, steps=40).id)
    frames = parts.watch_to_end(400)
    greedy = [frame.lanes[1] for frame in frames]
    idle = [frame.lanes[0] for frame in frames]

    assert not any(lane.marching for lane in greedy)
    assert any(lane.marching for lane in idle)
    assert not any(lane.marching for lane in idle if lane.step <= 10)


def test_slowly_computed_race_is_played_without_stops(
    parts: StageParts,
) -> None:
    run, advance = parts.running_race(("greedy",), steps=40)
    parts.stage.set(run_id=run.id)
    frames = []
    for _ in range(30):
        advance()
        frames += parts.watch(0.4)
    progress = np.diff([frame.time_s for frame in frames])[100:]

    assert progress.min() > 0
    assert progress.max() < 4 * progress.mean()


def test_race_with_an_unreachable_stance_is_shown(parts: StageParts) -> None:
    config = RaceConfig(
        gait="left-right-origin", robot=Robot(tibia_m=0.001), lanes=(LaneConfig(agent="greedy"),)
    )
    run = parts.create(config, state="failed")
    parts.stage.set(run_id=run.id)

    assert parts.next_frame().lanes[0].qpos.shape == (25,)
    assert parts.stage.state().ended


def test_each_lane_is_shown_in_the_conditions_of_its_own_step(parts: StageParts) -> None:
    world = World((Limp(legs=(1, 4), at_step=2, until_step=4), Push(impulse_ns=1.0, at_step=3)))
    run = parts.finished_race(("q-learning", "greedy"), 6, simulator="mujoco", world=world)
    parts.stage.set(run_id=run.id)
    frames = parts.watch_to_end()
    walking = [lane for frame in frames for lane in frame.lanes if not lane.done]

    assert {lane.step for lane in walking} == {1, 2, 3, 4, 5, 6}
    for lane in walking:
        assert lane.conditions == world.as_of(lane.step - 1)
        assert bool(lane.pushes) == (lane.step == 4)
    assert any(len({lane.conditions for lane in frame.lanes}) == 2 for frame in frames)


def test_fall_is_shown_from_its_step_on(parts: StageParts) -> None:
    world = World((Lost(legs=(1, 2, 3), at_step=1),))
    run = parts.finished_race(("q-learning",), 5, simulator="mujoco", world=world)
    assert isinstance(run.config, RaceConfig)
    recorded = parts.recordings.race(run.id) or []
    fell = fell_at_step(recorded[0], run.config.robot, world)
    parts.stage.set(run_id=run.id)

    lanes = [frame.lanes[0] for frame in parts.watch_to_end()]

    assert fell in (1, 2)
    assert {lane.fell_at_step for lane in lanes if lane.step <= fell + 1} == {None}
    assert {lane.fell_at_step for lane in lanes if lane.step > fell + 1} == {fell}


def test_original_lanes_run_along_from_the_branch_on(parts: StageParts) -> None:
    original = parts.finished_race(("greedy",), 8)
    fork = parts.finished_race(("q-learning",), 8, branch_from=Branch(original.id, 3))
    recording = (parts.recordings.race(original.id) or [])[0]
    parts.stage.set(run_id=fork.id)
    parts.stage.set(clock="free")

    pairs = [(frame.lanes[0], frame.ghost_lanes[0]) for frame in parts.watch_to_end()]

    assert {ghost is None for lane, ghost in pairs if lane.step <= 3} == {True}
    after_branch = [(lane, ghost) for lane, ghost in pairs if lane.step > 3]
    assert {ghost.step == lane.step for lane, ghost in after_branch if ghost} == {True}
    last = after_branch[-1][1]
    assert last is not None
    assert last.qpos == pytest.approx(recording.steps[-1].motion.qpos[-1])
    assert last.distance_m == recording.distance_m


def test_fork_is_shown_without_its_original_if_that_is_deleted(parts: StageParts) -> None:
    original = parts.finished_race(("greedy",), 4)
    fork = parts.finished_race(("greedy",), 4, branch_from=Branch(original.id, 1))
    parts.delete(original)
    parts.stage.set(run_id=fork.id)

    assert {frame.ghost_lanes for frame in parts.watch_to_end()} == {()}


@pytest.mark.parametrize("robot", ["stiff", "compliant", "dog", "centipede"])
def test_moment_that_pages_know_by_milliseconds_is_that_of_a_step(
    parts: StageParts, robot: str
) -> None:
    """Sums of odd durations of steps end a hair above or below what a page is told and names."""
    walk: dict[str, Any] = {"robot": PRESETS[robot], "gait": CREATURES[robot].gait}
    race = parts.finished_race(("greedy", "random-walk"), **walk)
    parts.stage.set(run_id=race.id, playing=False)
    parts.next_frame()
    recorded = parts.recordings.race(race.id)
    assert recorded is not None
    for number, lane in enumerate(recorded):
        for step, end_s in enumerate(Timetable.of(lane.steps, "paper").ends.tolist(), 1):
            for told_s in (round(end_s, 3), round(end_s, 5), end_s):
                parts.stage.set(time_s=told_s)
                assert parts.next_frame().lanes[number].steps_made == step
            parts.stage.set(time_s=end_s - 0.01)
            assert parts.next_frame().lanes[number].steps_made == step - 1
    time_out_s = finish_s(recorded, 12, "paper")
    assert time_out_s is not None
    figures = lane_figures(recorded, 12, "paper")
    parts.stage.set(time_s=round(time_out_s, 3))
    frame = parts.next_frame()
    assert frame.phase == "photo-finish"
    assert [lane.rank for lane in frame.lanes] == [figure.rank for figure in figures]
    assert [lane.distance_m for lane in frame.lanes] == [
        figure.finished_distance_m for figure in figures
    ]


def test_a_crossing_has_its_time_from_then_on_and_that_of_the_shown_clock(
    parts: StageParts,
) -> None:
    run = parts.finished_race(("q-learning", "greedy"), 70)
    parts.stage.set(run_id=run.id, end_at_time_out=False)
    lanes = parts.recordings.race(run.id) or []

    def crossed_s(time_s: float) -> float | None:
        parts.stage.set(time_s=time_s, playing=False)
        return parts.next_frame().lanes[1].crossed_s

    for clock in ("paper", "wall"):
        parts.stage.set(clock=clock)
        figures = lane_figures(lanes, 70, clock)[1]
        assert figures.crossed_s is not None
        assert crossed_s(figures.crossed_s - 0.1) is None
        assert crossed_s(figures.crossed_s + 0.1) == pytest.approx(figures.crossed_s, abs=1e-3)
