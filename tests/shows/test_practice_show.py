"""Playback of a training: time-lapse, live pace, ghosts, gaps in the recording."""

import numpy as np
import pytest

from hexapods.domain.disturbances import Limp, Lost, SensorNoise
from hexapods.domain.world import World
from hexapods.shows.practice_show import SHOWN_GHOSTS
from hexapods.shows.stage_frame import rotated
from tests.stage.stage_parts import FRAME_S, StageParts


def test_time_lapse_accelerates_after_ten_slow_steps(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_training(500).id)
    frames = parts.watch_to_end()
    speeds = [frame.shown_speed for frame in frames]
    tenth = next(n for n, frame in enumerate(frames) if frame.lanes[0].step > 10)

    assert tenth * FRAME_S == pytest.approx(3.2, abs=0.1)
    assert set(speeds[:tenth]) == {1.0}
    assert speeds[tenth:] == sorted(speeds[tenth:])
    assert 10 < len(frames) * FRAME_S < 15
    assert frames[-1].lanes[0].step == 500
    assert frames[-1].phase == "finished"


def test_long_training_skips_steps_whose_motion_is_not_recorded(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_training(3000, evaluate_every=0).id)
    frames = parts.watch_to_end()
    steps = [frame.lanes[0].step for frame in frames]

    assert len(frames) * FRAME_S < 15
    assert steps == sorted(steps)
    assert not [step for step in steps if 21 < step < 2500]
    assert steps[-1] == 3000


def test_each_evaluation_adds_a_ghost(parts: StageParts) -> None:
    run = parts.finished_training(200)
    parts.stage.set(run_id=run.id)
    frames = parts.watch_to_end()
    recording = parts.recordings.training(run.id)
    assert recording is not None

    assert frames[0].ghosts == ()
    assert [ghost.step for ghost in frames[-1].ghosts] == [50, 100, 150, 200]
    assert [ghost.distance_m for ghost in frames[-1].ghosts] == [
        evaluated.distance_m for evaluated in recording.evaluations
    ]
    for frame in frames:
        assert all(ghost.step <= frame.lanes[0].step for ghost in frame.ghosts)
    assert {frame.phase for frame in frames} == {"practice", "evaluation", "finished"}


def test_number_of_ghosts_is_limited_to_the_newest(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_training(60, evaluate_every=3).id)

    ghosts = parts.watch_to_end()[-1].ghosts

    assert len(ghosts) == SHOWN_GHOSTS
    assert ghosts[-1].step == 60


def test_each_episode_is_drawn_from_the_start_line(parts: StageParts) -> None:
    run = parts.finished_training(400, steps_per_episode=20)
    recording = parts.recordings.training(run.id)
    assert recording is not None
    assert abs(recording.steps[-1].distance_m) > 0.1, "it has wandered off"
    parts.stage.set(run_id=run.id)
    parts.stage.set(playing=False)

    for episode in range(1, 20):
        parts.stage.set(time_s=(20 * episode + 0.01) * 0.32)
        lane = parts.next_frame().lanes[0]
        assert np.abs(lane.qpos[:2]).max() < 0.005
        assert lane.distance_m == pytest.approx(0, abs=0.005)


def test_poses_within_an_episode_are_continuous(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_training(60).id)
    parts.stage.set(speed=1)
    frames = parts.watch(10.0)
    poses = np.array([frame.lanes[0].qpos for frame in frames])

    assert np.abs(np.diff(poses[:, :3], axis=0)).max() < 0.01
    assert np.abs(np.diff(poses[:, 7:], axis=0)).max() < 0.4


def test_live_training_is_never_shown_beyond_its_newest_step(parts: StageParts) -> None:
    run, advance = parts.running_training(60)
    parts.stage.set(run_id=run.id)
    assert parts.next_frame().phase == "start-line"
    for _ in range(5):
        advance()
    frame = parts.watch(10.0)[-1]

    assert frame.lanes[0].step == 5
    assert frame.time_s == pytest.approx(5 * 0.32)
    assert not parts.stage.state().ended

    while advance():
        pass
    parts.set_state(run, "finished")
    assert parts.watch_to_end()[-1].lanes[0].step == 60


def test_training_at_a_numeric_pace_is_shown_live(parts: StageParts) -> None:
    run, advance = parts.running_training(400, pace=2)
    parts.stage.set(run_id=run.id)
    lag_steps = []
    for step in range(1, 60):
        advance()
        frame = parts.watch(0.16)[-1]
        if step > 20:
            lag_steps.append(step - frame.time_s / 0.32)

    assert max(lag_steps) < 6
    assert min(lag_steps) >= 0
    assert frame.shown_speed == pytest.approx(2, rel=0.3)


def test_playback_follows_a_change_of_pace(parts: StageParts) -> None:
    run, advance = parts.running_training(400)
    for _ in range(200):
        advance()
    parts.stage.set(run_id=run.id)
    parts.watch(1.0)
    parts.publish(parts.store.update(run.id, changes=({"step": 200, "pace": 1.0},)))

    frame = parts.watch(0.5)[-1]

    assert frame.lanes[0].step >= 198, "it goes to where the training is"
    assert frame.shown_speed <= 2.5


def test_seek_into_a_gap_goes_to_the_next_recorded_step(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_training(1000, evaluate_every=0).id)
    parts.stage.set(playing=False, time_s=200 * 0.32)

    assert parts.next_frame().lanes[0].step == 501


def test_colour_scale_only_grows(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_training(200).id)
    views = [frame.lanes[0].action_values for frame in parts.watch_to_end()]
    highs = [view.high_m for view in views if view]

    assert highs == sorted(highs)
    assert all(view is None or view.low_m <= 0 <= view.high_m for view in views)


def test_step_and_evaluations_are_shown_in_the_world_as_it_was_then(parts: StageParts) -> None:
    world = World((SensorNoise(sd_m=0.002, at_step=30, until_step=70),))
    parts.stage.set(run_id=parts.finished_training(100, world=world).id)
    frames = parts.watch_to_end()

    for lane in (frame.lanes[0] for frame in frames):
        assert bool(lane.conditions) == (30 < lane.step <= 70)
    shown = [(ghost.step, bool(ghost.conditions)) for ghost in frames[-1].ghosts]
    assert shown == [(30, True), (50, True), (70, False), (100, False)]


def test_what_happens_while_it_runs_is_shown(parts: StageParts) -> None:
    run, advance = parts.running_training(60)
    parts.stage.set(run_id=run.id)
    for _ in range(20):
        advance()
    assert not parts.watch(0.5)[-1].lanes[0].conditions
    limp = {"kind": "limp", "legs": [2], "at_step": 10}
    parts.publish(parts.store.update(run.id, changes=({"step": 10, "disturbance": limp},)))

    frame = parts.watch(10.0)[-1]

    assert frame.lanes[0].step == 20
    assert frame.lanes[0].conditions == World((Limp(legs=(2,)),))


def test_origin_tells_where_the_robot_is_on_the_ground(parts: StageParts) -> None:
    run = parts.finished_training(100, steps_per_episode=20)
    recording = parts.recordings.training(run.id)
    assert recording is not None
    parts.stage.set(run_id=run.id)
    parts.stage.set(playing=False)

    for step in (15, 35, 95):
        parts.stage.set(time_s=(step - 1e-6) * 0.32)
        lane = parts.next_frame().lanes[0]
        motion = recording.steps[step - 1].motion
        assert motion is not None
        x_m, y_m, turn_rad = lane.origin
        on_ground = rotated(lane.qpos.astype(float), np.zeros(2), turn_rad)
        on_ground[:2] += x_m, y_m
        assert on_ground == pytest.approx(motion.qpos[-1], abs=1e-4)


def test_fall_in_practice_is_shown_from_its_step_on(parts: StageParts) -> None:
    world = World((Lost(legs=(1, 2, 3), at_step=12),))
    run = parts.finished_training(20, simulator="mujoco", evaluate_every=0, world=world)
    parts.stage.set(run_id=run.id)

    lanes = [frame.lanes[0] for frame in parts.watch_to_end()]

    fell = lanes[-1].fell_at_step
    assert fell in (12, 13)
    assert {lane.fell_at_step for lane in lanes if lane.step <= fell + 1} == {None}


def test_fall_that_is_no_longer_recorded_is_known_from_the_result(parts: StageParts) -> None:
    result = {"distance_m": 0.1, "fell_at_step": 100}
    run = parts.finished_training(1000, evaluate_every=0)
    parts.store.update(run.id, result=result)
    parts.stage.set(run_id=run.id)

    lanes = [frame.lanes[0] for frame in parts.watch_to_end()]

    assert {lane.fell_at_step for lane in lanes if lane.step <= 20} == {None}
    assert {lane.fell_at_step for lane in lanes if lane.step > 500} == {100}


def test_end_of_a_step_that_a_page_names_by_milliseconds_is_that_of_the_step(
    parts: StageParts,
) -> None:
    run = parts.finished_training(60, evaluate_every=6)
    parts.stage.set(run_id=run.id, playing=False)
    duration_s = parts.next_frame().duration_s
    assert duration_s is not None
    # As the page computes a moment on its bar.
    step_s = round(duration_s, 3) / 60
    for step in range(1, 61):
        parts.stage.set(time_s=step * step_s)
        frame = parts.next_frame()
        assert frame.lanes[0].steps_made == step
        assert [ghost.step for ghost in frame.ghosts][-1:] == [step - step % 6][: step // 6]
        parts.stage.set(time_s=(step - 0.4) * step_s)
        assert parts.next_frame().lanes[0].steps_made == step - 1
