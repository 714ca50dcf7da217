"""A race over time under one clock: when each lane thinks and walks, and how far it is."""

from collections.abc import Sequence
from typing import Any

from app.runs.clocks import FINISH_LINE_M, Clock, Timetable, crossing_s
from app.runs.recording import LaneRecording
from app.runs.results import finish_s
from app.stage.palette import lane_colors


def timeline(
    lanes: Sequence[LaneRecording],
    training_ids: Sequence[str | None],
    steps: int,
    clock: Clock,
) -> dict[str, Any]:
    """The race so far in plain types.

    Args:
        lanes: the recording.
        training_ids: for each lane where its table is from.
        steps: that each lane is to take.
        clock: that the race is timed by.
    """
    # Others may add to the recording meanwhile.
    taken = [LaneRecording(o.agent, o.rest_qpos, list(o.steps), o.failure) for o in lanes]
    colors = lane_colors([lane.agent for lane in taken])
    return {
        "clock": clock,
        "steps": steps,
        "finish_line_m": FINISH_LINE_M,
        "first_finish_s": finish_s(taken, steps, clock),
        "lanes": [
            {"agent": lane.agent, "training_id": training, "color": color, **_lane(lane, clock)}
            for lane, training, color in zip(taken, training_ids, colors, strict=True)
        ],
    }


def _lane(lane: LaneRecording, clock: Clock) -> dict[str, Any]:
    table = Timetable.of(lane.steps, clock)
    points, thinking = [(0.0, 0.0)], []
    began, distance = 0.0, 0.0
    for step, thought, end in zip(lane.steps, table.thought, table.ends, strict=True):
        if thought > began:
            thinking.append((began, thought))
            points.append((thought, distance))
        began, distance = end, step.distance_m
        points.append((end, distance))
    return {
        "points": points,
        "thinking": thinking,
        "futures": [step.transitions for step in lane.steps],
        "crossed_s": crossing_s(lane, table),
        "total_s": table.total_s,
        "failure": lane.failure,
    }
