"""A race as it is shown: from race time to poses, under one of three clocks."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from app.runs.clocks import Clock
from app.runs.recording import LaneRecording
from app.stage.race_lane import RaceLane
from app.stage.scene_spec import rest_pose
from app.stage.show import RunLabel
from app.stage.stage_frame import LaneView, Phase, SceneSpec, StageFrame

SPEED, LAST_LANE_SPEED = 2.0, 8.0
PHOTO_FINISH_S = 3.0
CUSHION_S = 0.5
"""How far, in real time, a race that still computes is shown behind it."""
_AS_GOOD_AS_THERE_S = 0.002


class RaceShow:
    """Plays a race's recording while it grows; never beyond what every lane has computed.

    Args:
        cast: who is on stage.
        steps: of each lane.
        clock: see `app.runs.clocks`.
        recording: what is recorded by now, None before there is anything.
    """

    def __init__(
        self,
        cast: SceneSpec,
        steps: int,
        clock: Clock,
        recording: Callable[[], Sequence[LaneRecording] | None],
    ) -> None:
        self.cast, self.steps, self.clock = cast, steps, clock
        self._recording = recording
        self._lanes: list[RaceLane] = []
        self._time_s = 0.0
        self._photo_left_s = 0.0
        self._over = self._waiting = False
        self._rate = SPEED

    @property
    def time_s(self) -> float:
        """Race time."""
        return self._time_s

    @property
    def ended(self) -> bool:
        """Whether every lane is at its end, and the photo finish is over."""
        return self._all_complete and self._time_s >= self._end_s and self._photo_left_s == 0

    @property
    def duration_s(self) -> float | None:
        """Race time at which the last lane is done; None while one still computes."""
        return self._end_s if self._lanes and self._all_complete else None

    @property
    def first_finish_s(self) -> float | None:
        """When the first lane has used its steps, once that is certain."""
        ends = [lane.end_s for lane in self._lanes if lane.walked_all]
        first = min(ends, default=None)
        return None if first is None or first > self._horizon_s else first

    def advance(self, elapsed_s: float, speed: float | None, over: bool) -> None:
        """Go on; see `Show`."""
        self._over = over
        self._look()
        self._rate = self._own_speed if speed is None else speed
        if self._photo_left_s > 0:
            self._photo_left_s = max(0.0, self._photo_left_s - elapsed_s)
            return
        limit = self._horizon_s
        self._waiting = not self._all_complete and self._hold_back(limit)
        target, first = self._time_s + elapsed_s * self._rate, self.first_finish_s
        if elapsed_s and limit - target < _AS_GOOD_AS_THERE_S:
            target = limit
        if first is not None and self._time_s < first <= target:
            self._photo_left_s = PHOTO_FINISH_S
            target = first
        self._time_s = min(target, limit)

    def _hold_back(self, limit: float) -> bool:
        """Go slower before the end of what is computed, so as not to stop and go at each step.

        Returns:
            Whether there is next to nothing left to show.
        """
        wanted, self._rate = self._rate, min(self._rate, (limit - self._time_s) / CUSHION_S)
        return self._rate < wanted / 4

    def seek(self, time_s: float) -> None:
        """Go to a race time, at most to what every lane has computed."""
        self._look()
        self._photo_left_s = 0.0
        self._time_s = min(max(time_s, 0.0), self._horizon_s)

    def retime(self, clock: str) -> None:
        """Show it under another clock, with the leading lane at the same place of its walk."""
        self._look()
        ended, first = self.ended, self.first_finish_s
        at_finish = first is not None and self._time_s == first
        leader = max(self._lanes, key=lambda lane: lane.at(self._time_s), default=None)
        moment = leader.at(self._time_s) if leader else None
        self.clock = clock  # type: ignore[assignment]  # checked by the stage
        for lane in self._lanes:
            lane.retime(self.clock)
        first = self.first_finish_s
        if ended:
            self._time_s = self._end_s
        elif at_finish and first is not None:
            self._time_s, self._photo_left_s = first, PHOTO_FINISH_S
        elif leader and moment:
            self._time_s = min(leader.time_of(moment), self._horizon_s)

    def frame(self, run_label: RunLabel) -> StageFrame:
        """What is to be seen now."""
        lanes = tuple(lane.view(self._time_s, self._complete(lane)) for lane in self._lanes)
        standing = LaneView(rest_pose(self.cast), 0, self.steps, 0.0)
        lanes = lanes or (standing,) * len(self.cast.roles)
        step = max(lane.step for lane in lanes)
        return StageFrame(
            cast=self.cast,
            run_id=run_label.run_id,
            phase=self._phase,
            label=f"{run_label.name}, step {step} of {self.steps}" if step else run_label.name,
            lanes=self._ranked(lanes),
            time_s=self._time_s,
            duration_s=self.duration_s,
            shown_speed=0.0 if self._photo_left_s else self._rate,
            playing=run_label.playing,
            clock=self.clock,
            replay=run_label.replay,
        )

    @property
    def _phase(self) -> Phase:
        if not self._lanes:
            return "start-line"
        if self._photo_left_s:
            return "photo-finish"
        if self.ended:
            return "finished"
        return "waiting" if self._waiting else "race"

    @property
    def _own_speed(self) -> float:
        first = self.first_finish_s
        under_way = sum(
            not self._complete(lane) or self._time_s < lane.end_s for lane in self._lanes
        )
        alone = len(self._lanes) > 1 and under_way == 1
        past_first = first is not None and self._time_s >= first
        return LAST_LANE_SPEED if alone and past_first else SPEED

    @property
    def _all_complete(self) -> bool:
        # A race that ended before it recorded anything has nothing more to show either.
        return all(map(self._complete, self._lanes)) if self._lanes else self._over

    @property
    def _end_s(self) -> float:
        return max((lane.end_s for lane in self._lanes), default=0.0)

    @property
    def _horizon_s(self) -> float:
        """Up to where it is certain what every lane does."""
        computing = [lane.end_s for lane in self._lanes if not self._complete(lane)]
        return min(computing, default=self._end_s)

    def _complete(self, lane: RaceLane) -> bool:
        return self._over or lane.walked_all or lane.recording.failure is not None

    def _look(self) -> None:
        """Take in what was recorded since."""
        if not self._lanes:
            recorded = self._recording()
            if not recorded or len(recorded) != len(self.cast.roles):
                return
            self._lanes = [RaceLane(lane, self.steps, self.clock) for lane in recorded]
        for lane in self._lanes:
            lane.look(self._over)

    def _ranked(self, lanes: tuple[LaneView, ...]) -> tuple[LaneView, ...]:
        """By distance now, or as it was at the first finish, which decides the race."""
        first = self.first_finish_s
        far = [lane.distance_m for lane in lanes]
        if first is not None and self._time_s >= first:
            far = [lane.distance_at(first) for lane in self._lanes]
        ranks = [1 + sum(other > mine + 1e-9 for other in far) for mine in far]
        return tuple(replace(lane, rank=rank) for lane, rank in zip(lanes, ranks, strict=True))
