"""The trajectory of a recorded walk as CSV and Parquet: its numbers are the recorded ones."""

import csv
import dataclasses
import io
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.exports.export_format import ExportSource
from hexapods.exports.recorded_walks import RecordedWalks, checked_lane
from hexapods.exports.trajectory import column_names, trajectory_csv, trajectory_parquet
from hexapods.runs.clocks import Clock
from tests.exports.conftest import recorded_walks
from tests.stage.stage_parts import StageParts


def table_of(walks: RecordedWalks, lane: int | None = None) -> tuple[list[str], list[list[str]]]:
    chunks = trajectory_csv(lambda: walks, checked_lane(walks, lane))
    head, *rows = csv.reader(io.StringIO("".join(chunks)))
    return head, rows


def test_rows_of_csv_are_the_recorded_frames_to_the_last_bit(raced: RecordedWalks) -> None:
    head, rows = table_of(raced)
    robot, step_s = raced.problem.built_robot, raced.problem.robot.step_s
    has_torque = "leg1_coxa_torque_nm" in head

    assert head == column_names(robot, has_torque)
    assert head[2:7] == ["time_s", "body_x_m", "body_y_m", "body_z_m", "body_qw"]
    assert head[-1] == "clock"
    assert {row[-1] for row in rows} == {"free"}, "robot time by default"
    joints = 3 * len(robot.legs)
    for number, lane in enumerate(raced.lanes):
        rows_of_lane = [row for row in rows if row[0] == str(number)]
        motions = [lane.motion(index) for index in range(6)]
        recorded = np.concatenate([lane.start_qpos[None], *(motion.qpos for motion in motions)])
        written = np.array([row[3 : 10 + joints] for row in rows_of_lane], np.float32)
        assert np.array_equal(written, recorded)
        times = [0.0, *(k * step_s + t for k, motion in enumerate(motions) for t in motion.time_s)]
        assert np.array([float(row[2]) for row in rows_of_lane]) == pytest.approx(times, abs=1e-5)
        assert [row[1] for row in rows_of_lane][:2] == ["0", "1"]
        feet = np.array([row[10 + joints : 10 + 2 * joints] for row in rows_of_lane], float)
        expected = (
            legs_of(robot).foot_positions(recorded.astype(float)).reshape(len(rows_of_lane), -1)
        )
        assert feet == pytest.approx(expected, abs=2e-6)


def test_torques_are_written_where_they_are_recorded(raced: RecordedWalks) -> None:
    lane = raced.lanes[0]
    steps: list[Any] = [*lane.steps]
    motion = lane.motion(0)
    torque = np.linspace(-2, 2, motion.qpos[:, 7:].size).reshape(motion.qpos[:, 7:].shape)
    steps[0] = dataclasses.replace(
        steps[0], motion=motion._replace(torque_nm=torque.astype(np.float16))
    )
    bare = [dataclasses.replace(s, motion=s.motion._replace(torque_nm=None)) for s in steps[1:]]
    walks = dataclasses.replace(raced, lanes=[dataclasses.replace(lane, steps=[steps[0], *bare])])
    head, rows = table_of(walks)

    at = head.index("leg1_coxa_torque_nm")
    count = len(motion.time_s)
    written = np.array([row[at:-1] for row in rows[1 : 1 + count]], np.float16)
    assert np.array_equal(written, torque.astype(np.float16))
    assert set(rows[0][at:-1]) == {""}, "at rest it is not known"
    assert set(rows[-1][at:-1]) == {""}


def test_parquet_has_the_table_of_the_csv(raced: RecordedWalks) -> None:
    chunks = trajectory_parquet(lambda: raced, checked_lane(raced, None))
    table = pyarrow.parquet.read_table(io.BytesIO(b"".join(chunks)))
    head, rows = table_of(raced)

    assert table.column_names == head
    assert table.num_rows == len(rows)
    for name in ("body_y_m", "leg3_femur_rad", "leg6_foot_z_m"):
        written = np.array([row[head.index(name)] for row in rows], np.float32)
        assert np.array_equal(table[name].to_numpy(), written)


@pytest.mark.parametrize("clock", ["paper", "free"])
def test_times_are_those_of_the_clock_that_is_named(raced: RecordedWalks, clock: Clock) -> None:
    chunks = trajectory_csv(lambda: raced, checked_lane(raced, 0), clock)
    rows = [*csv.DictReader(io.StringIO("".join(chunks)))]
    lane, step_s = raced.lanes[0], raced.problem.robot.step_s
    starts = lane.starts_s(step_s, clock)
    times = [0.0, *(starts[k] + t for k in range(6) for t in lane.motion(k).time_s)]
    assert [float(row["time_s"]) for row in rows] == pytest.approx(times, abs=1e-5)
    assert {row["clock"] for row in rows} == {clock}
    assert (starts[0] > 0) == (clock == "paper"), "the first decision takes time"


def test_metadata_of_parquet_tell_run_clock_and_units(raced: RecordedWalks) -> None:
    source = ExportSource("race-1", "A race", lambda: raced, lambda _: pytest.fail("not needed"))
    lanes = checked_lane(raced, None)
    about = source.about("wall")
    chunks = trajectory_parquet(lambda: raced, lanes, "wall", about)
    table = pyarrow.parquet.read_table(io.BytesIO(b"".join(chunks)))
    metadata = {name.decode(): text.decode() for name, text in table.schema.metadata.items()}
    assert (metadata["run"], metadata["title"], metadata["clock"]) == ("race-1", "A race", "wall")
    assert "real clock" in metadata["time"]
    assert metadata["written_by"].startswith("Racing Hexapods ")
    assert set(table["clock"].to_pylist()) == {"wall"}
    units = {
        field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in table.schema
    }
    assert units["time_s"] == "s"
    assert units["body_y_m"] == units["leg1_foot_z_m"] == "m"
    assert units["leg1_coxa_rad"] == "rad"
    assert units["lane"] == units["body_qw"] == ""


def test_a_lane_is_taken_alone(raced: RecordedWalks) -> None:
    _, rows = table_of(raced, 1)
    assert {row[0] for row in rows} == {"1"}
    with pytest.raises(InvalidInput, match="lane must be from 0 to 1, not 2"):
        checked_lane(raced, 2)


def test_a_practice_has_its_recorded_steps(parts: StageParts) -> None:
    run = parts.finished_training(steps=30)
    walks = recorded_walks(parts, run)
    _, rows = table_of(walks)
    assert {int(row[1]) for row in rows} == set(range(31))
    assert {row[-1] for row in rows} == {"free"}
    with pytest.raises(InvalidInput, match="lane must be 0, not 1"):
        checked_lane(walks, 1)
