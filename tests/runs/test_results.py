"""Results of a race: distances, times and ranks."""

from collections.abc import Sequence
from typing import Any

import pytest

from hexapods.runs import results
from hexapods.runs.clocks import Clock
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import LaneResult, RaceResult, finish_s
from tests.runs.sample_lanes import lane, step


def hare() -> LaneRecording:
    """Return a lane of long steps and slow decisions: 1 s + 1.5 s each under the paper clock."""
    return lane(
        step(1, [0.1, 0.2], transitions=50, decision_s=0.25),
        step(2, [0.3, 0.5], transitions=50, decision_s=0.25),
        agent="hare",
    )


def tortoise() -> LaneRecording:
    return lane(step(1, [0.05, 0.1]), step(2, [0.15, 0.2]), agent="tortoise")


def race_result(lanes: Sequence[LaneRecording]) -> RaceResult:
    """Return the result of a race over two steps."""
    lane_configs = tuple(LaneConfig(agent="greedy") for _ in lanes)
    return results.race_result(
        lanes,
        RaceConfig(gait="left-right-origin", steps=2, lanes=lane_configs, simulator="kinematic"),
    )


def under(result: RaceResult, clock: Clock, name: str) -> list[Any]:
    return [getattr(lane.clocks.under(clock), name) for lane in result.lanes]


def test_lanes_are_ranked_by_distance_at_time_out() -> None:
    """At the time-out, 2 s, the faster walker is 0.5 s into its first motion."""
    result = race_result([hare(), tortoise()])

    assert under(result, "paper", "elapsed_s") == pytest.approx([5, 2])
    assert under(result, "paper", "finished_distance_m") == pytest.approx([0.1, 0.2])
    assert under(result, "paper", "rank") == [2, 1]
    assert under(result, "free", "elapsed_s") == pytest.approx([2, 2])
    assert under(result, "free", "finished_distance_m") == pytest.approx([0.5, 0.2])
    assert under(result, "free", "rank") == [1, 2]
    # By the wall it was done at 2.5 s, so at 2 s it was half way through its second motion.
    assert under(result, "wall", "finished_distance_m") == pytest.approx([0.3, 0.2])
    assert under(result, "wall", "rank") == [1, 2]


def test_result_of_a_lane_has_its_totals() -> None:
    first, second = race_result([hare(), tortoise()]).lanes

    assert first.clocks.paper.crossed_s == pytest.approx(4.875)
    assert first == LaneResult(
        agent="hare",
        steps=2,
        total_distance_m=0.5,
        failure=None,
        decision_s=0.5,
        simulated_transitions=100,
        clocks=first.clocks,
        plans_with="world",
        heading_deg=0.0,
    )
    assert second.total_distance_m == 0.2
    assert second.clocks.paper.crossed_s is None


def test_first_lane_to_finish_is_at_its_total_distance() -> None:
    result = race_result([tortoise(), hare()])

    assert under(result, "paper", "finished_distance_m")[0] == 0.2


def test_ties_share_a_rank_and_the_next_rank_is_skipped() -> None:
    result = race_result(
        [tortoise(), hare(), tortoise(), lane(step(1, [0.0, 0.0]), failure="it fell")]
    )

    assert under(result, "free", "rank") == [2, 1, 2, 4]


def test_failed_lane_has_no_total_distance_and_a_reason() -> None:
    fallen = lane(step(1, [0.3, 0.4]), agent="clumsy", failure="it tripped")
    result = race_result([fallen, tortoise()])

    assert result.lanes[0].total_distance_m is None
    assert result.lanes[0].failure == "it tripped"
    assert result.lanes[0].steps == 1
    assert finish_s([fallen, tortoise()], 2, "free") == 2  # it does not end the race
    assert under(result, "free", "finished_distance_m") == pytest.approx([0.4, 0.2])
    assert under(result, "free", "elapsed_s") == pytest.approx([1, 2])


def test_race_that_is_stopped_before_time_out_ranks_nobody() -> None:
    lanes = [lane(step(1, [0.1, 0.2])), lane()]
    result = race_result(lanes)

    assert finish_s(lanes, 2, "paper") is None
    assert under(result, "paper", "finished_distance_m") == [None, None]
    assert under(result, "paper", "rank") == [None, None]
    assert [lane_result.steps for lane_result in result.lanes] == [1, 0]


def test_lane_that_is_not_computed_up_to_the_first_finish_leaves_the_race_undecided() -> None:
    stopped = lane(step(1, [0.3, 0.4]))
    result = race_result([tortoise(), stopped])

    assert finish_s([tortoise(), stopped], 2, "free") is None, "one lane stands at 1 s of 2"
    assert under(result, "free", "rank") == [None, None]
