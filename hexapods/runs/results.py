"""Results of a race: distances, times and ranks under each clock."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from hexapods.domain.posture import have_fallen, heading_deg
from hexapods.domain.robot import Robot
from hexapods.domain.world import World
from hexapods.runs.clocks import CLOCKS, Clock, Timetable, crossing_s, distance_at
from hexapods.runs.lane import plans_with
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording


def race_result(lanes: Sequence[LaneRecording], steps: int) -> dict[str, Any]:
    """Compute the result of a race, in plain types.

    Deterministic except for `decision_s` and the values of the `wall` clock. A lane that did not
    take all its steps has no total distance, and its failure as the reason. Of a race that was
    stopped before time-out no lane has a rank.

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
                "decision_s": sum(lane.steps.figures["decision_s"].tolist()),
                "simulated_transitions": int(lane.steps.figures["transitions"].sum()),
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
    tilts = lane.steps.figures["tilt"]
    for begin, end in pairwise(sorted({first, *world.change_steps, len(tilts)})):
        if first <= begin:
            fallen = have_fallen(robot, tilts[begin:end].astype(float), world.ground_m(begin))
            if fallen.any():
                return begin + int(fallen.argmax())
    return None


def finish_s(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> float | None:
    """Return the time-out: when the first lane has used all its steps [s].

    None if no lane has, or if another was not computed up to then: of a race that goes on or was
    stopped. A lane that failed stays where it is.
    """
    ends = [Timetable.of(lane.steps, clock).total_s for lane in lanes]
    used_all = [len(lane.steps) == steps for lane in lanes]
    return time_out_s(ends, used_all, [lane.failure is not None for lane in lanes])


def time_out_s(
    ends_s: Sequence[float], used_all: Sequence[bool], failed: Sequence[bool]
) -> float | None:
    """Return the time-out of lanes that are computed up to these times [s]; see `finish_s`."""
    first = min((end for end, used in zip(ends_s, used_all, strict=True) if used), default=None)
    if first is None:
        return None
    lanes = zip(ends_s, used_all, failed, strict=True)
    is_known = all(used or has_failed or end >= first for end, used, has_failed in lanes)
    return first if is_known else None


def _lane_results(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> list[dict[str, Any]]:
    """Compute each lane's values under one clock; lanes are ranked by distance at time-out.

    Without a time-out they have neither ranks nor distances at it.
    """
    tables = [Timetable.of(lane.steps, clock) for lane in lanes]
    finish = finish_s(lanes, steps, clock)
    finished = (
        []
        if finish is None
        else [distance_at(lane, table, finish) for lane, table in zip(lanes, tables, strict=True)]
    )
    return [
        {
            "finished_distance_m": finished[number] if finished else None,
            "elapsed_s": table.total_s,
            "crossed_s": crossing_s(lanes[number], table),
            "rank": 1 + sum(o > finished[number] for o in finished) if finished else None,
        }
        for number, table in enumerate(tables)
    ]
