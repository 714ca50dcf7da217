"""Results of a race: distances, times and ranks under each clock."""

from collections.abc import Sequence
from typing import Any

from app.domain.posture import has_fallen, heading_deg
from app.domain.robot import Robot
from app.domain.world import World
from app.runs.clocks import CLOCKS, Clock, Timetable, crossing_s, distance_at
from app.runs.lane import plans_with
from app.runs.race_config import RaceConfig
from app.runs.recording import LaneRecording


def race_result(lanes: Sequence[LaneRecording], steps: int) -> dict[str, Any]:
    """Compute the result of a race, in plain types.

    Deterministic except for `decision_s` and the values of the `wall` clock. A lane that did not
    take all its steps has no total distance, and its failure as the reason.

    Args:
        lanes: the complete recording.
        steps: planned number of steps of each lane.
    """
    results_by_clock = {clock: _lane_results(lanes, steps, clock) for clock in CLOCKS}
    return {
        "lanes": [
            {
                "agent": lane.agent,
                "steps": len(lane.steps),
                "total_distance_m": lane.distance_m if len(lane.steps) == steps else None,
                "failure": lane.failure,
                "decision_s": sum(s.decision_s for s in lane.steps),
                "simulated_transitions": sum(s.transitions for s in lane.steps),
                "clocks": {clock: results_by_clock[clock][number] for clock in CLOCKS},
            }
            for number, lane in enumerate(lanes)
        ]
    }


def lane_details(lanes: Sequence[LaneRecording], config: RaceConfig) -> list[dict[str, Any]]:
    """Return for each lane what its search knew, in which step it fell, and its heading at the end.

    None if it does not search, or did not fall. The step is counted from 0. The heading is in
    degrees: 0 along the track, and 90 to the left.
    """
    return [
        {
            "plans_with": plans_with(own, config),
            "fell_at_step": fell_at_step(lane, config.robot, config.world),
            "heading_deg": heading_deg(
                lane.start_qpos(len(lane.steps)).tolist(), lane.rest_qpos.tolist()
            ),
        }
        for own, lane in zip(config.lanes, lanes, strict=True)
    ]


def fell_at_step(lane: LaneRecording, robot: Robot, world: World, first: int = 0) -> int | None:
    """Return the first step, from `first` on, in which the robot fell; None if in none.

    Steps are counted from 0.
    """
    for number in range(first, len(lane.steps)):
        pose = lane.steps[number].motion.qpos[-1].tolist()
        if has_fallen(robot, pose, world.ground_m(number)):
            return number
    return None


def finish_s(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> float | None:
    """Return the time-out: when the first lane has used all its steps [s]; None if none has."""
    totals = [Timetable.of(lane.steps, clock).total_s for lane in lanes if len(lane.steps) == steps]
    return min(totals, default=None)


def _lane_results(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> list[dict[str, Any]]:
    """Compute each lane's values under one clock; lanes are ranked by distance at time-out."""
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
