"""Playback of a race under one of three clocks, with a photo finish; it may still be computed."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

from hexapods.domain.types import FloatArray
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.clocks import SAME_MOMENT_S, Clock
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import time_out_s as time_out_of
from hexapods.shows.race_lane import RaceLane
from hexapods.shows.scene_spec import rest_pose
from hexapods.shows.show import PlayedShow, ReplayMark, RunLabel, on_start_line
from hexapods.shows.stage_frame import LaneFrame, Phase, SceneSpec, StageFrame

SPEED, LAST_LANE_SPEED = 2.0, 8.0
PHOTO_FINISH_S = 3.0
BUFFER_S = 0.5
"""Playback buffer [s of real time]: near the newest step, playback of a live race slows down."""
_SNAP_S = 0.002


class Original(NamedTuple):
    """The race from which the shown one branched off.

    Attributes:
        step: number of steps that both races share.
        world: world of the original.
        lanes: recordings of the original's lanes, which may grow.
    """

    step: int
    world: World
    lanes: Sequence[LaneRecording]


class RaceShow(PlayedShow):
    """Plays a race's recording while it grows, never beyond what every lane has computed.

    Args:
        spec: the scene.
        steps: number of steps of each lane.
        clock: see `hexapods.runs.clocks`.
        recording: returns the lanes' recordings so far, None before there are any.
        world: the world in which the robots walk.
        original: the race from which this one branched off, if it is known.
    """

    def __init__(
        self,
        spec: SceneSpec,
        steps: int,
        clock: Clock,
        recording: Callable[[], Sequence[LaneRecording] | None],
        *,
        world: World = UNDISTURBED,
        original: Original | None = None,
    ) -> None:
        self.spec, self.steps, self.clock = spec, steps, clock
        self.ends_at_time_out = False
        """Whether playback ends with the photo finish, where the ranking is settled."""
        self._recording, self._world = recording, world
        self._lanes: list[RaceLane] = []
        self._source: Sequence[LaneRecording] | None = None
        """The recordings that are played."""
        self.recording_number = 0
        """Number of recordings that were played before: a race that is resumed is recorded anew."""
        self._is_final = False
        """Whether the recordings are those of the run since it has ended."""
        self._branch_step = 0
        self._original_lanes: list[RaceLane] = []
        self._prefix: list[LaneRecording] = []
        """Lanes of the original up to the branch: played until this race has computed as much."""
        if original is not None and len(original.lanes) == len(spec.lane_specs):
            self._branch_step = original.step
            self._original_lanes = self._playing(original.lanes, original.world)
            self._prefix = [lane.first(original.step) for lane in original.lanes]
        self.time_s = 0.0
        """Playback position in race time [s]."""
        self._freeze_left_s = 0.0
        self._run_ended = self._waiting = False
        self._rate = SPEED

    @property
    def ended(self) -> bool:
        """Whether all lanes have reached their end, or time-out if playback ends there."""
        return self._freeze_left_s == 0 and (self._is_at_end or self._ends_here)

    @property
    def duration_s(self) -> float | None:
        """Race time at which the last lane ends [s]; None while one is still computed."""
        return self._end_s if self._lanes and self._all_complete else None

    @property
    def time_out_s(self) -> float | None:
        """Race time of the time-out [s]; None until it is known, see `finish_s`."""
        return time_out_of(
            [lane.end_s for lane in self._lanes],
            [lane.all_recorded for lane in self._lanes],
            [lane.recording.failure is not None for lane in self._lanes],
        )

    @property
    def computed_s(self) -> float:
        """Race time up to which every lane is computed [s]."""
        return self._horizon_s

    @property
    def recorded(self) -> tuple[tuple[float, float], ...]:
        """Intervals of race time that can be shown [s]."""
        return ((0.0, self._horizon_s),) if self._lanes else ()

    @property
    def step_ends_s(self) -> list[FloatArray]:
        """For each lane the race times at which its steps end [s]."""
        return [lane.timetable.ends for lane in self._lanes]

    def marks(self) -> list[ReplayMark]:
        """Return marks of time-out, disturbances, crossings and falls, in order of time.

        Marks after the time up to which all lanes are computed are left out.
        """
        marks = []
        if self.time_out_s is not None:
            marks.append(ReplayMark("time-out", self.time_out_s, None, None, None))
        changes = self._world.change_steps
        for number, lane in enumerate(self._lanes):
            ends = lane.timetable.ends
            marks += [
                ReplayMark("disturbance", float(ends[step - 1]), number, step, None)
                for step in changes
                if step <= len(ends)
            ]
            if lane.crossing_s is not None:
                marks.append(ReplayMark("crossing", lane.crossing_s, number, None, None))
            if lane.fell_at_step is not None and lane.fell_at_step < len(ends):
                fell = lane.fell_at_step
                marks.append(ReplayMark("fall", float(ends[fell]), number, fell, None))
        in_view = [mark for mark in marks if mark.time_s <= self._horizon_s]
        return sorted(in_view, key=lambda mark: mark.time_s)

    def update(self, *, run_ended: bool) -> None:
        """Take in what the race has recorded; see `Show.update`."""
        self._run_ended = run_ended
        self._update_lanes()

    def move(self, elapsed_s: float, speed: float | None) -> None:
        """Advance the playback position; see `Show.move`."""
        self._rate = self._automatic_speed if speed is None else speed
        if self._freeze_left_s > 0:
            self._freeze_left_s = max(0.0, self._freeze_left_s - elapsed_s)
            return
        if self._ends_here:
            return
        limit = self._horizon_s
        # A resumed race has computed less than was shown.
        self.time_s = min(self.time_s, limit)
        self._waiting = not self._all_complete and self._slow_down_near(limit)
        target, first = self.time_s + elapsed_s * self._rate, self.time_out_s
        if elapsed_s and limit - target < _SNAP_S:
            target = limit
        if first is not None and self.time_s < first <= target:
            self._freeze_left_s = PHOTO_FINISH_S
            target = first
        self.time_s = min(target, limit)

    def _slow_down_near(self, limit: float) -> bool:
        """Reduce the playback rate near the newest step of a live race (buffer control).

        Without it playback would stop and start at each step.

        Returns:
            Whether the buffer is nearly empty, so that playback practically waits.
        """
        full_rate, self._rate = self._rate, min(self._rate, (limit - self.time_s) / BUFFER_S)
        return self._rate < full_rate / 4

    def seek(self, time_s: float) -> None:
        """Set the playback position to a race time [s], at most to where all lanes are computed.

        A time within `SAME_MOMENT_S` of time-out or the end is set to it: pages know milliseconds.
        """
        self._update_lanes()
        self._freeze_left_s = 0.0
        self.time_s = min(max(time_s, 0.0), self._horizon_s)
        for moment_s in (self.time_out_s, self._horizon_s):
            if moment_s is not None and abs(self.time_s - moment_s) <= SAME_MOMENT_S:
                self.time_s = moment_s
                return

    def seek_branch(self, time_s: float) -> None:
        """Set the playback position to a race time of the original, at most to where both part."""
        self._update_lanes()
        ends = [lane.timetable.ends[: self._branch_step] for lane in self._original_lanes]
        self.seek(min([time_s, *(float(shared[-1]) if len(shared) else 0.0 for shared in ends)]))

    def seek_end(self) -> None:
        """Set the playback position to where the show ends: time-out, or the last step."""
        first = self.time_out_s
        self.seek(math.inf if first is None or not self.ends_at_time_out else first)

    def retime(self, clock: Clock) -> None:
        """Change the clock and keep the leading lane at the same moment of its walk."""
        self._update_lanes()
        at_end, first = self._is_at_end, self.time_out_s
        at_finish = first is not None and self.time_s == first
        leader = max(self._lanes, key=lambda lane: lane.timetable.at(self.time_s), default=None)
        moment = leader.timetable.at(self.time_s) if leader else None
        self.clock = clock
        for lane in (*self._lanes, *self._original_lanes):
            lane.retime(self.clock)
        first = self.time_out_s
        if at_end:
            self.time_s = self._end_s
        elif at_finish and first is not None:
            self.time_s, self._freeze_left_s = first, PHOTO_FINISH_S
        elif leader and moment:
            self.time_s = min(leader.time_of(moment), self._horizon_s)

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Return the frame at the playback position."""
        lanes = tuple(lane.view(self.time_s, self._complete(lane)) for lane in self._lanes)
        lanes = lanes or self._at_rest()
        return StageFrame(
            spec=self.spec,
            run_id=run_label.run_id,
            phase=self._phase,
            label=self._label(run_label, lanes),
            lanes=self._with_ranks(lanes),
            ghost_lanes=tuple(map(self._original, range(len(self._original_lanes)))),
            time_s=self.time_s,
            duration_s=self.duration_s,
            computed_s=self._horizon_s,
            time_out_s=self.time_out_s,
            ended=self.ended,
            shown_speed=0.0 if self._freeze_left_s else self._rate,
            playing=run_label.playing,
            clock=self.clock,
            replay=run_label.replay,
        )

    def start(self, run_label: RunLabel) -> StageFrame:
        """Return the frame before the first step, which what is recorded does not change."""
        frame = on_start_line(self.spec, run_label, self._at_rest())
        ghosts = (None,) * len(self._original_lanes)
        return replace(frame, ghost_lanes=ghosts, clock=self.clock)

    def _at_rest(self) -> tuple[LaneFrame, ...]:
        at_start = self._world.as_of(0)
        at_rest = LaneFrame(rest_pose(self.spec), 0, self.steps, 0.0, conditions=at_start)
        return (at_rest,) * len(self.spec.lane_specs)

    def _label(self, run_label: RunLabel, lanes: tuple[LaneFrame, ...]) -> str:
        """Return the run's name with the progress of the lanes that still walk."""
        step = max(lane.step for lane in lanes)
        walking = [n for n, lane in enumerate(lanes) if not (lane.done or lane.halted)]
        if step == 0:
            return run_label.name
        if len(walking) in (0, len(lanes)):
            halted = [lane.step for lane in lanes if lane.halted and not walking]
            return run_label.at_step(min(halted, default=step), self.steps, halted=bool(halted))
        if len(walking) > 1:
            return f"{run_label.name}, {len(walking)} robots still walk"
        last = walking[0]
        lane_name = self.spec.lane_specs[last].name
        return f"{run_label.name}, {lane_name} at step {lanes[last].step} of {self.steps}"

    @property
    def _phase(self) -> Phase:
        if not self._lanes:
            return "start-line"
        if self._freeze_left_s or self._ends_here:
            return "photo-finish"
        if self.ended:
            return "finished"
        return "waiting" if self._waiting else "race"

    @property
    def _automatic_speed(self) -> float:
        first = self.time_out_s
        under_way = sum(
            not self._complete(lane) or self.time_s < lane.end_s for lane in self._lanes
        )
        alone = len(self._lanes) > 1 and under_way == 1
        past_first = first is not None and self.time_s >= first
        return LAST_LANE_SPEED if alone and past_first else SPEED

    @property
    def _all_complete(self) -> bool:
        # Without lanes: a race that ended before it recorded anything is complete.
        return all(map(self._complete, self._lanes)) if self._lanes else self._run_ended

    @property
    def _is_at_end(self) -> bool:
        return self._all_complete and self.time_s >= self._end_s

    @property
    def _ends_here(self) -> bool:
        """Whether playback is at time-out and does not go on."""
        if not self.ends_at_time_out or self._freeze_left_s or self._is_at_end:
            return False
        return self.time_s > 0 and self.time_s == self.time_out_s

    @property
    def _end_s(self) -> float:
        return max((lane.end_s for lane in self._lanes), default=0.0)

    @property
    def _horizon_s(self) -> float:
        """Race time up to which every lane is computed [s]."""
        computing = [lane.end_s for lane in self._lanes if not self._complete(lane)]
        return min(computing, default=self._end_s)

    def _complete(self, lane: RaceLane) -> bool:
        return self._run_ended or lane.is_over

    def _update_lanes(self) -> None:
        """Extend the lanes by newly recorded steps; a race that is resumed is recorded anew."""
        if not self._is_final:
            recorded = self._recording()
            if not self._run_ended and self._prefix and not self._has_prefix(recorded):
                recorded = self._prefix
            if not recorded or len(recorded) != len(self.spec.lane_specs):
                return
            if recorded is not self._source:
                self._source, self._lanes = recorded, self._playing(recorded, self._world)
                self.recording_number += 1
        self._is_final = self._run_ended
        for lane in (*self._lanes, *self._original_lanes):
            lane.update()
        self.time_s = min(self.time_s, self._horizon_s)

    def _has_prefix(self, recorded: Sequence[LaneRecording] | None) -> bool:
        """Whether each lane has taken the steps that it shares with the original, or has failed."""
        return bool(recorded) and all(
            lane.failure is not None or len(lane.steps) >= self._branch_step
            for lane in recorded or ()
        )

    def _playing(self, lanes: Sequence[LaneRecording], world: World) -> list[RaceLane]:
        robot = self.spec.robot
        return [RaceLane(lane, self.steps, self.clock, robot, world) for lane in lanes]

    def _original(self, number: int) -> LaneFrame | None:
        """Return a lane in the original race; None before the races part."""
        if number >= len(self._lanes):
            return None
        if self._lanes[number].timetable.at(self.time_s).step < self._branch_step:
            return None
        return self._original_lanes[number].view(self.time_s, complete=True)

    def _with_ranks(self, lanes: tuple[LaneFrame, ...]) -> tuple[LaneFrame, ...]:
        """Rank the lanes by distance now; after time-out by distance at that time."""
        first = self.time_out_s
        distances = [lane.distance_m for lane in lanes]
        if first is not None and self.time_s >= first:
            distances = [lane.distance_at(first) for lane in self._lanes]
        # As `lane_figures` does, to the last bit.
        ranks = [1 + sum(other > distance for other in distances) for distance in distances]
        return tuple(replace(lane, rank=rank) for lane, rank in zip(lanes, ranks, strict=True))
