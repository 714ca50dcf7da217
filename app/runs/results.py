"""Results of a race: distances, times and ranks under each clock."""

from collections.abc import Sequence
from typing import Any

from app.runs.clocks import CLOCKS, Clock, Timetable, crossing_s, distance_at
from app.runs.recording import LaneRecording


def race_result(lanes: Sequence[LaneRecording], steps: int) -> dict[str, Any]:
    """The result of a race in plain types.

    All but `decision_s` and what stands under the `wall` clock is deterministic. A lane that did
    not take all its steps has no total distance and says why.

    Args:
        lanes: the whole recording.
        steps: how many steps each lane was to take.
    """
    under = {clock: _under(lanes, steps, clock) for clock in CLOCKS}
    return {
        "lanes": [
            {
                "agent": lane.agent,
                "steps": len(lane.steps),
                "total_distance_m": lane.distance_m if len(lane.steps) == steps else None,
                "failure": lane.failure,
                "decision_s": sum(s.decision_s for s in lane.steps),
                "simulated_transitions": sum(s.transitions for s in lane.steps),
                "clocks": {clock: under[clock][number] for clock in CLOCKS},
            }
            for number, lane in enumerate(lanes)
        ]
    }


def finish_s(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> float | None:
    """When the first lane has used all its steps [s]; None while none has."""
    totals = [Timetable.of(lane.steps, clock).total_s for lane in lanes if len(lane.steps) == steps]
    return min(totals, default=None)


def _under(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> list[dict[str, Any]]:
    """Each lane's figures under one clock; the distance at time-out ranks the race."""
    tables = [Timetable.of(lane.steps, clock) for lane in lanes]
    finish = finish_s(lanes, steps, clock)
    finished = [
        lane.distance_m if finish is None else distance_at(lane, table, finish)
        for lane, table in zip(lanes, tables, strict=True)
    ]
    return [
        {
            "finished_distance_m": finished[number],
            "elapsed_s": table.total_s,
            "crossed_s": crossing_s(lanes[number], table),
            "rank": 1 + sum(other > finished[number] for other in finished),
        }
        for number, table in enumerate(tables)
    ]
