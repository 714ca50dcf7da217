"""Joint angles, feet and torques of a recorded walk over time, as CSV and Parquet.

A row is a recorded frame: first the pose at rest, with step 0, then the frames of each step. Angles
and torso are the recorded numbers; feet follow from them by the forward kinematics of the robot as
it was built.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray
from hexapods.exports.export_format import NO_METADATA
from hexapods.exports.options import DEFAULT_CLOCK
from hexapods.exports.recorded_walks import ExportedLane, RecordedWalks
from hexapods.extras import needs
from hexapods.files import DrainedBuffer
from hexapods.runs.clocks import Clock

_STEPS_PER_BLOCK = 8
"""About 130 frames, 90 kB of text, which stay in memory while a client reads them."""
_ROWS_PER_GROUP = 16_384
_INDEX = ("lane", "step", "time_s")
_CLOCK = "clock"
"""The last column."""
_UNITS = (("_torque_nm", "N·m"), ("_rad", "rad"), ("_m", "m"), ("_s", "s"))
"""Units of columns, by how their names end."""
_BODY = ("body_x_m", "body_y_m", "body_z_m", "body_qw", "body_qx", "body_qy", "body_qz")

Look = Callable[[], RecordedWalks]
"""Returns the recording. Called for each chunk, and not kept while a client receives that:
recordings are large, and clients may be many and slow."""


class _Block(NamedTuple):
    """Consecutive frames of one lane: its number, of each its step and time, and numbers."""

    lane: int
    steps: NDArray[np.int32]
    times_s: NDArray[np.float64]
    numbers: NDArray[np.float32]
    """(k, columns after those of `_INDEX`); NaN where torque was not recorded."""


def column_names(robot: Robot, has_torque: bool) -> list[str]:
    """Return the names of the columns, with units."""
    legs = legs_of(robot)
    joints = [joint.label for joint in legs.joints]
    return [
        *_INDEX,
        *_BODY,
        *(f"{joint}_rad" for joint in joints),
        *(f"leg{leg}_foot_{axis}_m" for leg in range(1, len(legs) + 1) for axis in "xyz"),
        *(f"{joint}_torque_nm" for joint in joints if has_torque),
        _CLOCK,
    ]


def trajectory_csv(look: Look, lanes: Sequence[int], clock: Clock = DEFAULT_CLOCK) -> Iterator[str]:
    """Yield a CSV table in chunks. Numbers are the shortest that give the recorded ones again.

    Args:
        look: returns the recording.
        lanes: numbers of the lanes, counted from 0.
        clock: times a race.
    """
    walks = look()
    robot, has_torque = walks.problem.built_robot, _has_torque(walks, lanes)
    clock = walks.clock_of(clock)
    del walks
    yield ",".join(column_names(robot, has_torque)) + "\r\n"
    for block in _blocks(look, lanes, clock, has_torque):
        index = zip(block.steps.tolist(), block.times_s.tolist(), block.numbers, strict=True)
        yield "".join(
            f"{block.lane},{step},{time_s:.6g}," + ",".join(map(_cell, row)) + f",{clock}\r\n"
            for step, time_s, row in index
        )


def _cell(number: np.float32) -> str:
    return "" if np.isnan(number) else str(number)


def trajectory_parquet(
    look: Look,
    lanes: Sequence[int],
    clock: Clock = DEFAULT_CLOCK,
    about: Mapping[str, str] = NO_METADATA,
) -> Iterator[bytes]:
    """Yield a Parquet file in chunks; a row group has about 16,000 frames.

    Args:
        look: returns the recording.
        lanes: numbers of the lanes, counted from 0.
        clock: times a race.
        about: metadata of the schema; each column has its unit.

    Raises:
        MissingExtra: at the call, if PyArrow is not installed.
    """
    with needs("parquet", "a Parquet file"):
        import pyarrow as arrow  # noqa: PLC0415
        from pyarrow import parquet  # noqa: PLC0415
    return _parquet((arrow, parquet), look, lanes, clock, about)


def _parquet(
    modules: tuple[Any, Any],
    look: Look,
    lanes: Sequence[int],
    clock: Clock,
    about: Mapping[str, str],
) -> Iterator[bytes]:
    arrow, parquet = modules
    walks = look()
    robot, has_torque = walks.problem.built_robot, _has_torque(walks, lanes)
    clock = walks.clock_of(clock)
    del walks
    types = [arrow.int16(), arrow.int32(), arrow.float64()]
    names = column_names(robot, has_torque)
    types += [arrow.float32()] * (len(names) - len(types) - 1)
    of_clock = arrow.dictionary(arrow.int8(), arrow.string())
    fields = [
        arrow.field(name, kind, metadata=_metadata_of(name))
        for name, kind in zip(names, [*types, of_clock], strict=True)
    ]
    schema = arrow.schema(fields, metadata=dict(about))
    clock_name = arrow.array([clock], of_clock)
    buffer = DrainedBuffer()
    with parquet.ParquetWriter(arrow.PythonFile(buffer, mode="w"), schema) as writer:
        for group in _groups(_blocks(look, lanes, clock, has_torque)):
            numbers = np.concatenate([block.numbers for block in group])
            columns = [
                np.concatenate(
                    [np.full(len(block.steps), block.lane, np.int16) for block in group]
                ),
                np.concatenate([block.steps for block in group]),
                np.concatenate([block.times_s for block in group]),
                *(np.ascontiguousarray(column) for column in numbers.T),
            ]
            arrays = [
                arrow.array(column, kind, from_pandas=True)  # NaN as null
                for column, kind in zip(columns, types, strict=True)
            ]
            arrays.append(clock_name.take(arrow.array(np.zeros(len(numbers), np.int8))))
            writer.write_table(arrow.Table.from_arrays(arrays, schema=schema))
            yield buffer.drain()
    yield buffer.drain()


def _metadata_of(column: str) -> dict[str, str]:
    units = (unit for ending, unit in _UNITS if column.endswith(ending))
    unit = next(units, None)
    return {} if unit is None else {"unit": unit}


def _groups(blocks: Iterator[_Block]) -> Iterator[list[_Block]]:
    group: list[_Block] = []
    for block in blocks:
        group.append(block)
        if sum(len(rows.steps) for rows in group) >= _ROWS_PER_GROUP:
            yield group
            group = []
    if group:
        yield group


def _has_torque(walks: RecordedWalks, lanes: Sequence[int]) -> bool:
    """Whether torques were recorded: of a lane in its first step, or in none."""
    recorded = (walks.lanes[number] for number in lanes)
    return any(lane.steps and lane.motion(0).torque_nm is not None for lane in recorded)


def _blocks(look: Look, lanes: Sequence[int], clock: Clock, has_torque: bool) -> Iterator[_Block]:
    for number in lanes:
        walks = look()
        count, problem = len(walks.lanes[number].steps), walks.problem
        starts_s = walks.lanes[number].starts_s(problem.robot.step_s, clock)
        encode = _Encoder(number, problem.built_robot, starts_s, has_torque)
        rest = walks.lanes[number].start_qpos
        del walks
        yield encode.rest(rest)
        for first in range(0, count, _STEPS_PER_BLOCK):
            yield encode.steps(look().lanes[number], first, min(first + _STEPS_PER_BLOCK, count))


class _Encoder(NamedTuple):
    """Turns recorded poses of a lane into blocks."""

    lane: int
    robot: Robot
    starts_s: FloatArray
    """Of each step the time at which its motion begins [s]."""
    has_torque: bool

    def rest(self, qpos: NDArray[np.float32]) -> _Block:
        """Return the pose before the first step."""
        return self._block(np.zeros(1), np.zeros(1), qpos[None], self._torques(None, 1))

    def steps(self, lane: ExportedLane, first: int, end: int) -> _Block:
        """Return the frames of the steps with these indices."""
        motions = [lane.motion(index) for index in range(first, end)]
        steps = [lane.steps[index].step for index in range(first, end)]
        counts = [len(motion.time_s) for motion in motions]
        starts_s = np.repeat(self.starts_s[first:end], counts)
        return self._block(
            np.repeat(steps, counts),
            (starts_s + np.concatenate([motion.time_s for motion in motions])).round(6),
            np.concatenate([motion.qpos for motion in motions]),
            np.concatenate(
                [self._torques(motion.torque_nm, len(motion.time_s)) for motion in motions]
            ),
        )

    def _torques(self, recorded: NDArray[np.float16] | None, frames: int) -> NDArray[np.float32]:
        if recorded is None or not self.has_torque:
            joints = len(legs_of(self.robot).joints) if self.has_torque else 0
            return np.full((frames, joints), np.nan, np.float32)
        return recorded.astype(np.float32)

    def _block(
        self,
        steps: NDArray[Any],
        times_s: NDArray[np.float64],
        qpos: NDArray[np.float32],
        torques: NDArray[np.float32],
    ) -> _Block:
        feet = (
            legs_of(self.robot).foot_positions(qpos.astype(float)).reshape(len(qpos), -1).round(6)
        )
        numbers = np.hstack([qpos, feet.astype(np.float32), torques])
        return _Block(self.lane, steps.astype(np.int32), times_s, numbers)
