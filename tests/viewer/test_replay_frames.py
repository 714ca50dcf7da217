"""Frames of a replay: what a page that applies them shows, and what is kept of them."""

from typing import Any

import numpy as np
import pytest

from app.stage.playback import Replays
from app.viewer.replay_frames import ReplayFrames
from hexapods.drawing.pose_tracks import POSE_STEP
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.scene import SCENE_ROOT
from hexapods.shows.replay import FRAMES_PER_S, SEGMENT_FRAMES
from tests.drawing.replay_decoding import decoded
from tests.stage.stage_parts import StageParts

LANES = ("q-learning", "greedy", "two-step")


def frames_of(parts: StageParts) -> ReplayFrames:
    return ReplayFrames(Replays(parts.store, parts.recordings))


def shown(frames: list[dict[str, Any]], arrays: list[bytes]) -> dict[str, Any]:
    """Return the newest value of each property of the scene's nodes after these frames."""
    state: dict[str, Any] = {}
    for message in (message for frame in frames for message in frame["messages"]):
        values = message.get("updates") or message.get("props") or {}
        for name, value in values.items():
            is_array = isinstance(value, dict) and "__binary_index" in value
            plain = arrays[value["__binary_index"]] if is_array else value
            state[f"{message['name']} {name}"] = plain
    return state


def test_a_segment_shows_the_joint_positions_that_were_simulated(parts: StageParts) -> None:
    run = parts.finished_race(LANES)
    replay = Replays(parts.store, parts.recordings).get(run.id, "paper")
    segment, arrays = decoded(frames_of(parts).segment(run.id, "paper", 0, 1).data)
    mesh = RobotMesh(replay.show.spec.robot)

    assert len(segment["frames"]) == SEGMENT_FRAMES
    for number in (0, 1, 40):
        time_s = segment["frames"][number]["time_s"]
        assert time_s == pytest.approx((SEGMENT_FRAMES + number) / FRAMES_PER_S)
        state = shown(segment["frames"][: number + 1], arrays)
        for number_of_part, links in enumerate(
            number_of_part.links for number_of_part in mesh.parts
        ):
            name = f"{SCENE_ROOT}/robots/{mesh.part_name(number_of_part)} batched_positions"
            drawn = np.frombuffer(state[name], np.float32).reshape(len(LANES), len(links), 3)
            for lane, view in enumerate(replay.frame_at(time_s).lanes):
                expected = mesh.body_poses(view.qpos).positions[links]
                offset = drawn[lane] - expected
                assert np.ptp(offset, axis=0) == pytest.approx(0, abs=POSE_STEP + 1e-5)
                assert offset[:, 1:] == pytest.approx(0, abs=POSE_STEP / 2 + 1e-5), (
                    "lanes differ in x"
                )


def test_poses_are_rounded_by_less_than_one_sees(parts: StageParts) -> None:
    """By less than 0.1 mm and 0.02 degrees, of robots that are half a metre wide."""
    run = parts.finished_race(LANES)
    replay = Replays(parts.store, parts.recordings).get(run.id, "paper")
    segment, arrays = decoded(frames_of(parts).segment(run.id, "paper", 0, 1).data)
    mesh, frame = RobotMesh(replay.show.spec.robot), replay.frame_at(segment["frames"][0]["time_s"])
    state = shown(segment["frames"][:1], arrays)

    names = [
        f"{SCENE_ROOT}/robots/{mesh.part_name(n)} batched_wxyzs" for n in range(len(mesh.parts))
    ]
    assert sum(name in state for name in names) >= 3
    for name, part in zip(names, mesh.parts, strict=True):
        if name not in state:  # as at the start of the run
            continue
        drawn = (
            np.frombuffer(state[name], np.float32)
            .astype(float)
            .reshape(len(LANES), len(part.links), 4)
        )
        for lane, view in enumerate(frame.lanes):
            expected = mesh.body_poses(view.qpos).rotations[part.links]
            cosine = np.abs(np.sum(drawn[lane] * expected, axis=1)) / np.linalg.norm(
                drawn[lane], axis=1
            )
            assert np.degrees(2 * np.arccos(np.minimum(cosine, 1))).max() < 0.02
    assert POSE_STEP / 2 * np.sqrt(3) < 1.1e-4


def test_a_moment_is_as_the_segment_that_has_it(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES), frames_of(parts)
    segment, segment_arrays = decoded(frames.segment(run.id, "paper", 0, 1).data)
    moment, arrays = decoded(frames.moment(run.id, "paper", segment["frames"][30]["time_s"]))

    state = shown(moment["frames"], arrays)
    played = shown(segment["frames"][:31], segment_arrays)
    assert {name: played[name] for name in state} == state
    assert moment["frames"][0]["scene"]["time_s"] == segment["frames"][30]["scene"]["time_s"]
    assert moment["frames"][0]["follow"] == segment["frames"][30]["follow"]


def test_the_scene_comes_with_what_its_messages_do(parts: StageParts) -> None:
    scene, arrays = decoded(frames_of(parts).scene(parts.finished_race(LANES).id))

    (start,) = scene["frames"]
    assert start["time_s"] == 0
    kinds = {message["type"] for message in start["messages"]}
    assert {"BatchedMeshesMessage", "LabelMessage"} <= kinds
    assert scene["lifecycles"]["BatchedMeshesMessage"] == ["scene", "create", "name"]
    assert len(arrays) > 20


def test_segments_are_encoded_once_until_the_run_changes(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES), frames_of(parts)
    first = frames.segment(run.id, "paper", 0, 0).data

    assert frames.segment(run.id, "paper", 0, 0).data is first
    assert frames.segment(run.id, "free", 0, 0).data != first
    parts.store.change(run.id, ["finished"], "stopped")
    assert frames.segment(run.id, "paper", 0, 0).data is not first


def test_a_moment_that_is_asked_for_twice_is_encoded_once(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES), frames_of(parts)
    first = frames.moment(run.id, "paper", 1.0)
    assert frames.moment(run.id, "paper", 1.0) is first
    assert frames.moment(run.id, "free", 1.0) is not first

    race, advance = parts.running_race(LANES)
    for _ in range(4):
        advance()
    newest = decoded(frames.moment(race.id, "paper", 100.0))[0]["frames"][0]["time_s"]
    for _ in range(4):
        advance()
    assert decoded(frames.moment(race.id, "paper", 100.0))[0]["frames"][0]["time_s"] > newest


def test_a_scene_is_encoded_once_until_the_run_changes(parts: StageParts) -> None:
    run, frames = parts.finished_race(LANES), frames_of(parts)
    first = frames.scene(run.id)

    assert frames.scene(run.id) is first
    parts.store.change(run.id, ["finished"], "stopped")
    assert frames.scene(run.id) is not first


def test_the_scene_is_the_same_before_and_after_a_run_has_recorded(parts: StageParts) -> None:
    training, advance_training = parts.running_training(steps=20)
    race, advance_race = parts.running_race(LANES)
    runs = (training, race)
    before = [frames_of(parts).scene(run.id) for run in runs]
    for _ in range(12):
        advance_training()
        advance_race()
    assert [frames_of(parts).scene(run.id) for run in runs] == before

    # What it lacks, such as the foot grid of a learner, each piece brings.
    frames = decoded(frames_of(parts).piece(training.id, "paper", 0, 30, 4))[0]["frames"]
    assert any("/grid/" in message.get("name", "") for message in frames[0]["messages"])


def test_a_race_under_way_is_encoded_as_far_as_it_is(parts: StageParts) -> None:
    run, advance = parts.running_race(LANES)
    for _ in range(12):
        advance()
    frames = frames_of(parts)
    early, _ = decoded(frames.segment(run.id, "paper", 0, 0).data)
    while advance():
        pass
    later, _ = decoded(frames.segment(run.id, "paper", 0, 0).data)

    assert 0 < len(early["frames"]) < len(later["frames"])


def test_ghosts_are_drawn_over_their_lanes_and_beside_with_the_name_of_their_own(
    parts: StageParts,
) -> None:
    run, other = parts.finished_race(("q-learning",)), parts.finished_race(("greedy", "two-step"))
    frames, replays = frames_of(parts), Replays(parts.store, parts.recordings)
    segment, arrays = decoded(frames.segment(run.id, "paper", 0, 1, other.id).data)
    state = shown(segment["frames"], arrays)
    mesh = RobotMesh(replays.get(other.id, "paper").show.spec.robot)
    ghosts = replays.get(other.id, "paper").frame_at(segment["frames"][-1]["time_s"]).lanes
    links = mesh.parts[0].links
    name = f"{SCENE_ROOT}/ghost-robots/0/ghost-torso batched_positions"
    drawn = np.frombuffer(state[name], np.float32).reshape(2, len(links), 3)

    for ghost, positions in zip(ghosts, drawn, strict=True):
        offset = positions - mesh.body_poses(ghost.qpos).positions[links]
        assert offset[:, 1:] == pytest.approx(0, abs=POSE_STEP / 2 + 1e-5)
    assert "ghost Greedy 0." in state[f"{SCENE_ROOT}/lane0/label text"]
    assert state[f"{SCENE_ROOT}/lane1/label text"].startswith("Two-step")
    assert (
        frames.segment(run.id, "paper", 0, 1, other.id).data
        != frames.segment(run.id, "paper", 0, 1).data
    )
    first = frames.segment(run.id, "paper", 0, 1, other.id).data
    assert frames.segment(run.id, "paper", 0, 1, other.id).data is first


def test_frames_with_an_evaluation_send_no_meshes_of_its_ghost(parts: StageParts) -> None:
    run, frames = parts.finished_training(20, evaluate_every=10), frames_of(parts)
    start, _ = decoded(frames.scene(run.id))
    meshes = {m["name"] for m in start["frames"][0]["messages"] if m["type"].startswith("Batched")}
    moment, arrays = decoded(frames.moment(run.id, "paper", 5.9))

    assert any("ghosts/line" in m.get("name", "") for m in moment["frames"][0]["messages"])
    made = {m["name"] for m in moment["frames"][0]["messages"] if m["type"].startswith("Batched")}
    assert not made & meshes
    assert all("/grid/" in name for name in made)
    (scales, *_) = (
        np.frombuffer(value, np.float32)
        for name, value in shown(moment["frames"], arrays).items()
        if "-evaluated/" in name and name.endswith("batched_scales")
    )
    assert scales.all()
    assert any("-evaluated/" in name for name in meshes)
