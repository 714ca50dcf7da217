"""Timeline of a race under one clock: distance over time, and intervals of thinking, per lane."""

from collections.abc import Sequence

import numpy as np

from app.answer import Answer, Count
from hexapods.agents.appearance import colors_of
from hexapods.domain.types import FloatArray
from hexapods.runs.clocks import FINISH_LINE_M, Clock, Timetable, crossing_s
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import finish_s

MAX_STRIDES = 2000
"""Most entries of a lane: of more steps, several are summed up in one entry."""


class TimelineLane(Answer):
    """A lane's distance over time: points are [s, m], decision intervals are [from s, to s].

    Of a lane of more than 2,000 steps, `stride` steps together are told as one: it decides on all
    of them, then walks.

    Attributes:
        steps: that it has taken so far.
        stride: number of steps told as one; 1 in all but long races.
    """

    agent: str
    training_id: str | None
    color: str
    steps: Count
    stride: int
    points: list[tuple[float, float]]
    thinking: list[tuple[float, float]]
    futures: list[int]
    crossed_s: float | None
    total_s: float
    failure: str | None


class TimelineView(Answer):
    """Timeline of a race under one clock."""

    clock: Clock
    steps: int
    finish_line_m: float
    first_finish_s: float | None
    lanes: list[TimelineLane]


def timeline(
    lanes: Sequence[LaneRecording],
    training_ids: Sequence[str | None],
    steps: int,
    clock: Clock,
) -> TimelineView:
    """Return the race so far; times in s, distances in m.

    Args:
        lanes: the recording.
        training_ids: for each lane the training its table is from.
        steps: number of steps of each lane.
        clock: clock that times the race.
    """
    # The race may append to the recording meanwhile.
    snapshot = [lane.so_far() for lane in lanes]
    colors = colors_of([lane.agent for lane in snapshot])
    lanes_with_names = zip(snapshot, training_ids, colors, strict=True)
    return TimelineView(
        clock=clock,
        steps=steps,
        finish_line_m=FINISH_LINE_M,
        first_finish_s=finish_s(snapshot, steps, clock),
        lanes=[_lane(lane, clock, training, color) for lane, training, color in lanes_with_names],
    )


def _lane(lane: LaneRecording, clock: Clock, training_id: str | None, color: str) -> TimelineLane:
    timetable, figures = Timetable.of(lane.steps, clock), lane.steps.figures
    stride = max(1, -(-len(figures) // MAX_STRIDES))
    thought, ends = timetable.thought, timetable.ends
    distances, futures = figures["distance_m"], figures["transitions"]
    if stride > 1:
        thought = _together(thought, ends, stride)
        firsts = np.arange(0, len(figures), stride)
        lasts = np.append(firsts[1:], len(figures)) - 1
        ends, distances = ends[lasts], distances[lasts]
        futures = np.add.reduceat(futures, firsts)
    points, thinking = [(0.0, 0.0)], []
    step_start_s, distance = 0.0, 0.0
    rows = zip(thought.tolist(), ends.tolist(), distances.tolist(), strict=True)
    for decision_end_s, step_end_s, distance_then in rows:
        if decision_end_s > step_start_s:
            thinking.append((step_start_s, decision_end_s))
            points.append((decision_end_s, distance))
        step_start_s, distance = step_end_s, distance_then
        points.append((step_end_s, distance))
    return TimelineLane(
        agent=lane.agent,
        training_id=training_id,
        color=color,
        steps=len(figures),
        stride=stride,
        points=points,
        thinking=thinking,
        futures=futures.tolist(),
        crossed_s=crossing_s(lane, timetable),
        total_s=timetable.total_s,
        failure=lane.failure,
    )


def _together(thought: FloatArray, ends: FloatArray, stride: int) -> FloatArray:
    """Return when decisions would end if those of several steps were made before the first."""
    starts = np.append(0.0, ends[:-1])
    firsts = np.arange(0, len(ends), stride)
    together: FloatArray = starts[firsts] + np.add.reduceat(thought - starts, firsts)
    return together
