"""Timeline of a race under one clock: distance over time, and intervals of thinking, per lane."""

from collections.abc import Sequence
from typing import Any

from app.domain.palette import lane_colors
from app.runs.clocks import FINISH_LINE_M, Clock, Timetable, crossing_s
from app.runs.recording import LaneRecording
from app.runs.results import finish_s


def timeline(
    lanes: Sequence[LaneRecording],
    training_ids: Sequence[str | None],
    steps: int,
    clock: Clock,
) -> dict[str, Any]:
    """Return the race so far in plain types; times in s, distances in m.

    Args:
        lanes: the recording.
        training_ids: for each lane the training its table is from.
        steps: number of steps of each lane.
        clock: clock that times the race.
    """
    # A copy, since the race may append to the recording meanwhile.
    snapshot = [
        LaneRecording(lane.agent, lane.rest_qpos, list(lane.steps), lane.failure) for lane in lanes
    ]
    colors = lane_colors([lane.agent for lane in snapshot])
    return {
        "clock": clock,
        "steps": steps,
        "finish_line_m": FINISH_LINE_M,
        "first_finish_s": finish_s(snapshot, steps, clock),
        "lanes": [
            {"agent": lane.agent, "training_id": training, "color": color, **_lane(lane, clock)}
            for lane, training, color in zip(snapshot, training_ids, colors, strict=True)
        ],
    }


def _lane(lane: LaneRecording, clock: Clock) -> dict[str, Any]:
    timetable = Timetable.of(lane.steps, clock)
    points, thinking = [(0.0, 0.0)], []
    step_start_s, distance = 0.0, 0.0
    for step, decision_end_s, step_end_s in zip(
        lane.steps, timetable.thought, timetable.ends, strict=True
    ):
        if decision_end_s > step_start_s:
            thinking.append((step_start_s, decision_end_s))
            points.append((decision_end_s, distance))
        step_start_s, distance = step_end_s, step.distance_m
        points.append((step_end_s, distance))
    return {
        "points": points,
        "thinking": thinking,
        "futures": [step.transitions for step in lane.steps],
        "crossed_s": crossing_s(lane, timetable),
        "total_s": timetable.total_s,
        "failure": lane.failure,
    }
