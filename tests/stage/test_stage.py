"""The stage: which run is shown, and playback commands."""

import asyncio
import json
import struct
from datetime import UTC, datetime, timedelta

import pytest

from app.stage.stage import ANNOUNCE_AFTER_S, NEXT_AFTER_S
from app.storage.errors import NotFound
from hexapods.domain.records import to_json
from hexapods.runs.clocks import Timetable
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.recording import LaneRecording
from tests.stage.stage_parts import GAIT, StageParts


def announced_id(parts: StageParts) -> str | None:
    announced = parts.stage.state().announced
    return None if announced is None else announced.run_id


def test_idle_stage_shows_the_three_agents_of_the_paper(parts: StageParts) -> None:
    frame = parts.next_frame()

    assert [lane_spec.name for lane_spec in frame.spec.lane_specs] == [
        "Q-learning",
        "Greedy",
        "Two-step",
    ]
    assert [lane_spec.color for lane_spec in frame.spec.lane_specs] == [
        "#E69F00",
        "#56B4E9",
        "#009E73",
    ]
    assert (frame.phase, frame.run_id) == ("start-line", None)
    assert all(lane.qpos[1] == 0 and lane.qpos[2] > 0.05 for lane in frame.lanes)


def test_offered_run_takes_an_idle_stage(parts: StageParts) -> None:
    run, _ = parts.running_race()

    assert parts.stage.offer(run.id)
    assert parts.stage.state().run_id == run.id
    assert parts.stage.state().live


def test_offer_is_rejected_only_while_a_live_run_is_on_stage(parts: StageParts) -> None:
    first, _ = parts.running_race()
    parts.stage.offer(first.id)
    second, _ = parts.running_race()

    assert not parts.stage.offer(second.id)
    assert parts.stage.state().run_id == first.id

    parts.set_state(first, "finished")
    assert parts.stage.offer(second.id)
    assert parts.stage.state().run_id == second.id


def test_set_replaces_a_live_run(parts: StageParts) -> None:
    first, _ = parts.running_race()
    parts.stage.offer(first.id)
    second = parts.finished_race()

    parts.stage.set(run_id=second.id)

    assert parts.next_frame().run_id == second.id


def test_race_is_shown_after_its_own_training(parts: StageParts) -> None:
    training, advance = parts.running_training(60)
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=5)
    race = parts.create(config, waiting_for=(training.id,))

    assert parts.stage.offer(race.id)
    assert parts.next_frame().spec.kind == "training"
    assert parts.stage.state().next_run_id == race.id
    assert parts.stage.offer(race.id), "it is on the bill already"
    while advance():
        pass
    assert parts.watch(0.5)[-1].spec.kind == "training"

    parts.set_state(training, "finished")
    frames = parts.watch(12.0)

    assert frames[-1].run_id == race.id
    assert max(frame.time_s for frame in frames if frame.run_id == training.id) > 18


def test_training_that_was_stopped_stays_although_a_race_was_queued_behind_it(
    parts: StageParts,
) -> None:
    training, advance = parts.running_training(60)
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=5)
    race = parts.create(config, waiting_for=(training.id,))
    parts.stage.offer(race.id)
    for _ in range(20):
        advance()
    parts.set_state(race, "stopped")
    parts.set_state(training, "stopped")
    frame = parts.watch_to_end()[-1]

    assert (frame.run_id, parts.stage.state().next_run_id) == (training.id, None)
    assert frame.label.endswith(", stopped at step 20 of 60")
    assert parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 5)[-1].run_id == training.id


def test_replay_of_the_newest_race_is_announced_and_begins_ten_seconds_later(
    parts: StageParts,
) -> None:
    parts.finished_race()
    newest, training = parts.finished_race(), parts.finished_training(5)
    assert parts.stage.offer(training.id)
    frames = parts.watch_to_end()

    assert not any(frame.replay for frame in frames)
    parts.watch(ANNOUNCE_AFTER_S - 1)
    assert parts.stage.state().announced is None
    parts.watch(2.0)
    announced = parts.stage.state().announced
    assert announced is not None
    assert announced.run_id == newest.id
    assert announced.in_s == pytest.approx(9, abs=0.2)
    assert parts.watch(NEXT_AFTER_S - 2)[-1].run_id == training.id
    frame = parts.watch(2.0)[-1]
    assert (frame.run_id, frame.replay) == (newest.id, True)

    started, _ = parts.running_race()
    assert parts.stage.offer(started.id), "a replay gives way"
    assert not parts.next_frame().replay


def test_race_that_a_person_chose_stays_until_a_run_is_started(parts: StageParts) -> None:
    old = parts.finished_race()
    parts.finished_race()
    parts.stage.set(run_id=old.id)
    parts.watch_to_end()

    assert parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 10)[-1].run_id == old.id
    assert parts.stage.state().announced is None

    started, _ = parts.running_race()
    assert parts.stage.offer(started.id)


def test_announced_replay_does_not_begin_if_a_person_wants_the_run_to_stay(
    parts: StageParts,
) -> None:
    parts.finished_race()
    training = parts.finished_training(5)
    parts.stage.offer(training.id)
    parts.watch_to_end()
    parts.watch(ANNOUNCE_AFTER_S + 1)
    parts.stage.set(stay=True)

    assert parts.stage.state().announced is None
    assert parts.stage.state().origin == "chosen"
    assert parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 5)[-1].run_id == training.id


@pytest.mark.parametrize("state", ["stopped", "failed", "interrupted"])
def test_no_replay_follows_a_run_that_ended_early(parts: StageParts, state: str) -> None:
    parts.finished_race()
    run, advance = parts.running_race()
    parts.stage.offer(run.id)
    for _ in range(4):
        advance()
    parts.set_state(run, state)
    parts.watch_to_end()

    assert parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 5)[-1].run_id == run.id


def test_announced_race_that_is_deleted_gives_way_to_another(parts: StageParts) -> None:
    other, newest = parts.finished_race(), parts.finished_race()
    training = parts.finished_training(5)
    parts.stage.offer(training.id)
    parts.watch_to_end()
    parts.watch(ANNOUNCE_AFTER_S + 1)
    assert announced_id(parts) == newest.id
    parts.delete(newest)

    assert parts.watch(ANNOUNCE_AFTER_S + 2 * NEXT_AFTER_S + 1)[-1].run_id == other.id


def test_start_of_the_server_shows_where_the_newest_run_was_interrupted(parts: StageParts) -> None:
    parts.finished_race()
    run, advance = parts.running_race(steps=30)
    for _ in range(10):
        advance()
    parts.set_state(run, "interrupted")
    config = RaceConfig(gait=GAIT, lanes=(LaneConfig(agent="greedy"),))
    parts.create(config, id="race999", state="interrupted")
    parts.stage.restore()

    frame = parts.next_frame()
    assert (frame.run_id, frame.label) == (run.id, f"{run.name}, interrupted at step 5 of 30")
    assert parts.stage.state().phase == "ended"


def test_start_of_the_server_shows_the_run_that_was_last_at_work(parts: StageParts) -> None:
    """An older run that was resumed is interrupted after a newer one has finished."""
    old, advance = parts.running_race(steps=40)
    for _ in range(20):
        advance()
    newer = parts.finished_race()
    parts.store.update(newer.id, ended_at=newer.created_at + timedelta(seconds=5))
    parts.recordings.save(old.id)
    parts.store.interrupt_all()
    parts.store.update(old.id, ended_at=newer.created_at + timedelta(seconds=60))
    parts.stage.restore()

    assert parts.next_frame().run_id == old.id


def test_a_recording_that_cannot_be_decoded_does_not_keep_the_server_from_starting(
    parts: StageParts, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def undecodable(run_id: str) -> list[LaneRecording]:
        raise struct.error(f"the recording of {run_id} is too short")

    parts.finished_race()
    monkeypatch.setattr(parts.recordings, "race", undecodable)
    parts.stage.restore()

    assert parts.stage.state().phase == "empty"
    assert "the last run cannot be shown" in caplog.text


def test_no_replay_follows_a_run_that_was_interrupted_before_its_first_step(
    parts: StageParts,
) -> None:
    parts.finished_race()
    race, _ = parts.running_race()
    parts.store.interrupt_all()
    parts.stage.restore()

    frame = parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 2)[-1]
    assert (frame.run_id, frame.replay) == (race.id, False)


def test_race_that_was_resumed_and_computed_between_two_frames_is_shown_anew(
    parts: StageParts,
) -> None:
    whole = parts.recordings.race(parts.finished_race(steps=12).id) or []
    race, advance = parts.running_race(steps=12)
    parts.stage.offer(race.id)
    for _ in range(8):
        advance()
    parts.recordings.finish(race.id)
    parts.set_state(race, "interrupted")
    parts.watch_to_end()
    for state in ("queued", "running"):
        parts.set_state(race, state)
    parts.recordings.begin_race(
        race.id, [LaneRecording(lane.agent, lane.rest_qpos) for lane in whole]
    )
    for number in range(12):
        for lane in whole:
            parts.recordings.add(race.id, lane.steps[number])
    parts.recordings.finish(race.id)
    parts.set_state(race, "finished")
    parts.next_frame()
    parts.stage.set(end_at_time_out=False)

    assert [lane.step for lane in parts.watch_to_end()[-1].lanes] == [12, 12]


def test_pages_learn_that_the_announced_race_was_deleted(parts: StageParts) -> None:
    training, _ = parts.running_training(60)
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=(LaneConfig(agent="greedy"),))
    race = parts.create(config, waiting_for=(training.id,), started_at=datetime.now(UTC))
    parts.stage.offer(race.id)
    parts.set_state(race, "stopped")
    parts.next_frame()
    events = parts.bus.subscribe(names=frozenset({"stage"}))
    parts.delete(race)
    parts.next_frame()

    assert [json.loads(event.data)["next_run_id"] for event in events.drain()] == [None]


def test_replay_of_the_run_on_stage_plays_although_it_was_paused_at_its_end(
    parts: StageParts,
) -> None:
    parts.stage.offer(parts.finished_race().id)
    parts.watch_to_end()
    parts.stage.set(playing=False)
    frame = parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 5)[-1]

    assert (frame.replay, frame.playing) == (True, True)
    assert frame.time_s > 0


def test_announcement_ends_when_its_race_is_deleted(parts: StageParts) -> None:
    race, training = parts.finished_race(), parts.finished_training(5)
    parts.stage.offer(training.id)
    parts.watch_to_end()
    parts.watch(ANNOUNCE_AFTER_S + 1)
    assert announced_id(parts) == race.id
    parts.delete(race)

    assert parts.stage.state().announced is None


def test_run_on_stage_has_its_new_name_when_it_is_renamed(parts: StageParts) -> None:
    race = parts.finished_race()
    parts.stage.offer(race.id)
    parts.publish(parts.store.update(race.id, name="Other"))

    assert parts.next_frame().label.startswith("Other")


def test_resumed_race_takes_the_stage_back_with_its_training(parts: StageParts) -> None:
    training, advance = parts.running_training(60)
    for _ in range(20):
        advance()
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=5)
    race = parts.create(config, state="interrupted")
    parts.set_state(training, "interrupted")
    parts.stage.restore()
    assert parts.next_frame().run_id == training.id

    parts.set_state(training, "queued")
    parts.store.update(race.id, waiting_for=(training.id,))
    parts.set_state(race, "queued")
    assert parts.stage.offer(race.id)

    assert parts.next_frame().run_id == training.id
    assert parts.stage.state().next_run_id == race.id


def test_idle_stage_without_a_finished_race_does_not_change(parts: StageParts) -> None:
    assert parts.watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 5)[-1].phase == "start-line"


def test_deleted_run_is_removed_from_the_stage(parts: StageParts) -> None:
    run = parts.finished_race()
    parts.stage.set(run_id=run.id)
    parts.next_frame()
    parts.delete(run)

    frame = parts.next_frame()

    assert (frame.run_id, frame.phase) == (None, "start-line")


def test_playback_can_be_paused_and_continued(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    parts.watch(1.0)
    parts.stage.set(playing=False)
    frames = parts.watch(1.0)

    assert frames[0].time_s == frames[-1].time_s
    assert not frames[-1].playing

    parts.stage.set(playing=True)
    assert parts.watch(1.0)[-1].time_s > frames[-1].time_s


def test_play_after_the_end_restarts_the_show(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    parts.watch_to_end()

    parts.stage.set(playing=True)

    assert parts.next_frame().time_s < 1


def test_a_live_training_stays_where_it_is_paused_or_sought(parts: StageParts) -> None:
    run, advance = parts.running_training(steps=60, pace=1)
    parts.stage.set(run_id=run.id)
    for _ in range(10):
        advance()
    parts.stage.frame()
    parts.stage.set(playing=False, time_s=1.0)
    for _ in range(30):
        advance()
    assert parts.watch(5)[-1].time_s == 1.0

    parts.stage.set(playing=True, time_s=2.0)
    assert parts.watch(1)[-1].time_s == pytest.approx(3.0, abs=0.05)


def test_after_a_stall_the_picture_follows_the_clock_as_pages_do(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id, speed=1)
    before_s = parts.next_frame().time_s
    parts.now += 1.5

    assert parts.stage.frame().time_s == pytest.approx(before_s + 1.5, abs=0.01)


def test_a_machine_that_was_suspended_goes_on_where_it_was(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id, speed=1)
    before_s = parts.next_frame().time_s
    parts.now += 60

    assert parts.stage.frame().time_s < before_s + 2.1


def test_unknown_run_is_refused_and_changes_nothing(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    before = parts.stage.state()

    with pytest.raises(NotFound):
        parts.stage.set(run_id="nobody", playing=False)

    assert parts.stage.state() == before


def test_changes_are_published_on_the_bus(parts: StageParts) -> None:
    run = parts.finished_race()

    async def next_stage_event() -> dict[str, object]:
        events = parts.bus.subscribe()
        parts.stage.set(run_id=run.id)
        async for event in events:
            if event.event == "stage":
                state: dict[str, object] = json.loads(event.data)
                return state
        raise AssertionError("nothing was told")

    assert asyncio.run(next_stage_event()) == to_json(parts.stage.state())


def test_scene_is_plain_json(parts: StageParts) -> None:
    for run in (parts.finished_race(("q-learning", "greedy")), parts.finished_training(30)):
        parts.stage.set(run_id=run.id)
        parts.watch(1.0)
        scene = json.loads(json.dumps(to_json(parts.stage.scene()), allow_nan=False))

        assert scene["run_id"] == run.id
        assert scene["lanes"][0]["color"] == "#E69F00"
        view = scene["action_values"]
        assert len(view["values_m"]) == len(view["pairs"]) == 3
        for pair, current in enumerate(view["current"]):
            assert view["values_m"][pair][current] is None
        assert view["cell_names"][0] == "home"
        assert view["next"]["cell"] != view["current"][view["next"]["pair"]]


def test_a_race_that_branches_off_keeps_the_moment_in_the_picture(parts: StageParts) -> None:
    original = parts.finished_race(steps=8)
    parts.stage.set(run_id=original.id, playing=False)
    ends = step_ends(parts, original.id)
    parts.stage.set(time_s=ends[4] + 0.1, playing=False)
    before = parts.next_frame()

    fork, advance = parts.running_race(steps=8, branch_from=Branch(original.id, 5))
    assert parts.stage.offer(fork.id)
    frame = parts.next_frame()

    assert frame.run_id == fork.id
    assert frame.time_s == pytest.approx(ends[4], abs=0.1), (
        "where both part, one step at most before"
    )
    assert frame.lanes[0].qpos[1] == pytest.approx(before.lanes[0].qpos[1], abs=0.02)
    shown = [parts.next_frame().time_s]
    while advance():
        shown.append(parts.next_frame().time_s)
    assert min(shown) >= ends[4], "while it is computed the picture does not go back"
    parts.set_state(fork, "finished")
    last = parts.watch_to_end()[-1]
    assert (last.run_id, last.lanes[0].step) == (fork.id, 8)
    assert last.ghost_lanes[0] is not None


def test_a_race_that_branches_off_a_race_elsewhere_is_shown_from_its_start(
    parts: StageParts,
) -> None:
    original, other = parts.finished_race(steps=8), parts.finished_race(steps=8)
    parts.stage.set(run_id=other.id, time_s=2.0, playing=False)

    fork, _ = parts.running_race(steps=8, branch_from=Branch(original.id, 5))
    parts.stage.offer(fork.id)

    assert parts.stage.state().time_s == 0


def step_ends(parts: StageParts, race_id: str) -> list[float]:
    """Return the times at which the steps of a race's first lane end on the paper clock [s]."""
    lane = (parts.recordings.race(race_id) or [])[0]
    timetable = Timetable("paper")
    timetable.extend(lane.steps)
    return [float(end) for end in timetable.ends]
