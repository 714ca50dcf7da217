"""A recorded walk as servo pulses: sampled each 20 ms, checked for limits and speed, slowed."""

import csv
import dataclasses
import io
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hexapods.domain.creatures import PRESETS
from hexapods.domain.errors import InvalidInput, TooLong
from hexapods.exports import servo_walk as module
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.exports.servo_files import arduino_header, joint_trajectory, servo_csv
from hexapods.exports.servo_map import ServoMap
from hexapods.exports.servo_map_file import load_servo_map, read_servo_map
from hexapods.exports.servo_walk import FRAME_S, ServoWalk, servo_walk
from tests.exports.conftest import recorded_walks
from tests.exports.servo_maps import JOINTS, map_text
from tests.stage.stage_parts import StageParts

STEPS = 6


def servo_map(head: str = "", **servos: str | None) -> ServoMap:
    return read_servo_map(map_text(head, **servos).encode(), "mine.yaml", JOINTS)


def speeds_deg_s(walk: ServoWalk) -> Any:
    return np.rad2deg(np.abs(np.diff(walk.angles_rad, axis=0))).max(axis=0) / FRAME_S


def test_a_frame_each_20_ms_has_the_recorded_angles(raced: RecordedWalks) -> None:
    walk = servo_walk(raced, servo_map())
    lane, step_s = raced.lanes[0], raced.problem.robot.step_s

    assert (walk.lane, walk.agent, walk.steps, walk.slowed) == (0, "greedy", (1, STEPS), 1)
    assert walk.duration_s == pytest.approx(STEPS * step_s)
    recorded = np.concatenate([lane.start_qpos[None], *(lane.motion(n).qpos for n in range(STEPS))])
    assert walk.angles_rad == pytest.approx(recorded[:, 7:], abs=1e-6), "which is recorded so too"
    assert walk.pulses_us.tolist() == np.rint(1500 + 400 * walk.angles_rad).astype(int).tolist()


def test_another_lane_is_chosen_by_its_number(raced: RecordedWalks) -> None:
    assert servo_walk(raced, servo_map(), 1).agent == "wave"
    with pytest.raises(InvalidInput, match="lane must be from 0 to 1, not 2"):
        servo_walk(raced, servo_map(), 2)


def test_a_practice_begins_after_its_gap(parts: StageParts) -> None:
    run = parts.finished_training(steps=30)
    walks = recorded_walks(parts, run)
    (lane,) = walks.lanes
    assert servo_walk(walks, servo_map()).steps == (1, 30)
    gap = dataclasses.replace(lane, steps=[*lane.steps[:20], *lane.steps[25:]])

    walk = servo_walk(dataclasses.replace(walks, lanes=[gap]), servo_map())

    assert walk.steps == (26, 30)
    assert walk.angles_rad[0] == pytest.approx(gap.motion(20).qpos[0, 7:], abs=1e-6)


def test_servos_that_cannot_follow_are_named_and_slowed_down(raced: RecordedWalks) -> None:
    as_recorded = servo_walk(raced, servo_map("speed_deg_s: 100"))
    fastest = max(as_recorded.speeds, key=lambda speed: speed.needed_deg_s)
    usable = pytest.approx(70)

    assert as_recorded.too_slow[0].servo.joint == fastest.servo.joint
    assert fastest.usable_deg_s == usable
    assert fastest.needed_deg_s == pytest.approx(speeds_deg_s(as_recorded).max(), rel=1e-3)
    assert 0 < fastest.at_s <= as_recorded.duration_s

    slowed = servo_walk(raced, servo_map("speed_deg_s: 100"), slow_down=True)

    assert slowed.slowed == as_recorded.slow_enough > 1
    assert slowed.too_slow == []
    assert slowed.duration_s == pytest.approx(as_recorded.duration_s * slowed.slowed, abs=FRAME_S)
    assert 65 < speeds_deg_s(slowed).max() <= 70
    assert slowed.angles_rad[0] == pytest.approx(as_recorded.angles_rad[0])
    assert slowed.angles_rad[-1] == pytest.approx(as_recorded.angles_rad[-1])


def test_servos_that_can_follow_are_not_slowed_down(raced: RecordedWalks) -> None:
    for head in ("speed_deg_s: 9000", ""):
        walk = servo_walk(raced, servo_map(head), slow_down=True)
        assert (walk.slowed, walk.slow_enough, walk.too_slow) == (1, 1, [])
    assert {speed.usable_deg_s for speed in walk.speeds} == {None}, "it is not known"


def test_a_pulse_outside_of_its_limits_is_refused_with_its_servo(raced: RecordedWalks) -> None:
    tight = "{board: 3, channel: 7, us_at_zero: 1500, us_per_rad: 500, limits_us: [1400, 2500]}"
    with pytest.raises(InvalidInput) as refusal:
        servo_walk(raced, servo_map(leg2_tibia=tight))
    assert str(refusal.value).startswith("leg2_tibia (board 3, channel 7) would get ")
    assert "outside of its limits_us, 1400 to 2500; correct its pulses in mine.yaml" in str(
        refusal.value
    )


def test_an_angle_that_is_no_number_is_refused(raced: RecordedWalks) -> None:
    lane = raced.lanes[0]
    motion = lane.motion(1)
    broken = motion.qpos.copy()
    broken[0, 8] = np.nan
    steps: list[Any] = [*lane.steps]
    steps[1] = dataclasses.replace(steps[1], motion=motion._replace(qpos=broken))
    walks = dataclasses.replace(raced, lanes=[dataclasses.replace(lane, steps=steps)])
    with pytest.raises(InvalidInput, match=r"the angle of leg1_femur at 0\.34 s is no number"):
        servo_walk(walks, servo_map())


def test_a_walk_that_is_too_long_is_refused(
    raced: RecordedWalks, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_FRAMES", 90)
    with pytest.raises(TooLong, match="the walk would have 97 frames of 20 ms, at most 90 can be"):
        servo_walk(raced, servo_map())


def test_a_table_has_the_pulses(raced: RecordedWalks) -> None:
    walk = servo_walk(raced, servo_map())
    head, *rows = csv.reader(io.StringIO("".join(servo_csv(walk, "A race"))))
    assert head == ["time_s", *(f"{joint}_us" for joint in JOINTS)]
    assert [row[0] for row in rows[:3]] == ["0.00", "0.02", "0.04"]
    assert np.array([row[1:] for row in rows], int).tolist() == walk.pulses_us.tolist()


def test_a_trajectory_is_a_message_of_ros_2(raced: RecordedWalks) -> None:
    walk = servo_walk(raced, servo_map())
    message = json.loads("".join(joint_trajectory(walk, "A race")))
    assert {*message} == {"joint_names", "points"}
    assert message["joint_names"] == JOINTS
    assert {*message["points"][0]} == {"positions", "time_from_start"}
    assert message["points"][51]["time_from_start"] == {"sec": 1, "nanosec": 20_000_000}
    positions = np.array([point["positions"] for point in message["points"]])
    assert positions == pytest.approx(walk.angles_rad, abs=1e-5)


PRINT = """
#include "walk.h"
#include <stdio.h>
int main(void) {
  for (int servo = 0; servo < WALK_SERVOS; servo++)
    printf("%d %d ", WALK_BOARD[servo], WALK_CHANNEL[servo]);
  for (int frame = 0; frame < WALK_FRAMES; frame++)
    for (int servo = 0; servo < WALK_SERVOS; servo++) printf("%d ", WALK_US[frame][servo]);
  return WALK_FRAME_MS;
}
"""


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler here")
def test_a_header_compiles_and_has_the_pulses(raced: RecordedWalks, tmp_path: Path) -> None:
    walk = servo_walk(raced, servo_map())
    (tmp_path / "walk.h").write_text("".join(arduino_header(walk, "A race")))
    (tmp_path / "main.c").write_text(PRINT)
    flags = ("-std=c99", "-Wall", "-Wextra", "-Werror")
    subprocess.run(["cc", *flags, "main.c", "-o", "main"], cwd=tmp_path, check=True, timeout=60)
    done = subprocess.run(
        [tmp_path / "main"], capture_output=True, text=True, timeout=60, check=False
    )
    numbers = [int(word) for word in done.stdout.split()]
    assert done.returncode == 20
    places = [number for servo in walk.map.servos for number in (servo.board, servo.channel)]
    assert numbers == [*places, *walk.pulses_us.ravel().tolist()]


def test_a_header_says_what_it_is_and_no_name_ends_its_comment(raced: RecordedWalks) -> None:
    walk = dataclasses.replace(servo_walk(raced, servo_map()), slowed=1.4)
    text = "".join(arduino_header(walk, "*/ int evil; /* \\\n α"))
    assert "evil" in text.partition("*/")[0]
    assert "97 frames of 20 ms, 1.4 times as long as recorded" in text
    assert "lane 0 (greedy), steps 1 to 6" in text
    assert "WALK_US takes 3492 bytes of flash memory" in text
    assert text.isascii()


def test_the_example_of_the_document_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    document = (Path(__file__).parents[2] / "docs" / "servos.md").read_text("utf-8")
    monkeypatch.chdir(tmp_path)
    exec(document.partition("```python\n")[2].partition("```")[0], {})
    assert (tmp_path / "walk.csv").read_text().startswith("time_s,leg1_coxa_us")


def test_freenoves_servos_walk_as_its_map_says(parts: StageParts) -> None:
    run = parts.finished_race(("greedy",), steps=3, simulator="mujoco", robot=PRESETS["freenove"])
    walks = recorded_walks(parts, run)
    walk = servo_walk(walks, load_servo_map("freenove", JOINTS))
    assert walk.pulses_us.min() > 500
    assert walk.pulses_us.max() < 2500
    assert {servo.speed_deg_s for servo in walk.map.servos} == {353}
