"""Playheads: the time of a run that is shown, as a function of the server's clock."""

import math

import pytest

from hexapods.shows.playhead import Playhead, simplified
from hexapods.shows.race_show import PHOTO_FINISH_S, SPEED
from tests.stage.stage_parts import FRAME_S, StageParts


def playhead(*points: tuple[float, float], rate: float = 0.0) -> Playhead:
    return Playhead(
        at_s=100.0,
        points=list(points),
        rate=rate,
        computed_s=9.0,
        duration_s=None,
        time_out_s=None,
    )


def test_it_moves_uniformly_between_points_and_by_its_rate_after_the_last() -> None:
    moving = playhead((0, 1), (2, 5), (4, 5), rate=3)
    assert [moving.time_at(now_s) for now_s in (99, 100, 101, 102, 103, 104, 106)] == [
        *(1, 1, 3, 5, 5, 5, 11)
    ]
    assert [moving.rate_at(now_s) for now_s in (100, 103, 105)] == [2, 0, 3]


def test_it_knows_when_a_time_of_the_run_is_shown() -> None:
    moving = playhead((0, 1), (2, 5), (4, 5), rate=3)
    assert moving.when(3, since_s=100) == 101
    assert moving.when(3, since_s=101.5) == 101.5
    assert moving.when(8, since_s=100) == 105
    assert playhead((0, 1)).when(3, since_s=100) == math.inf


def test_points_on_a_line_are_left_out_and_corners_stay() -> None:
    points = [(n / 30, min(n, 60) / 15) for n in range(121)]
    assert simplified(points) == [points[0], points[60], points[120]]


def test_simplified_points_follow_a_time_lapse_within_a_frame(parts: StageParts) -> None:
    run = parts.finished_training(steps=100)
    parts.stage.set(run_id=run.id)
    parts.watch(1)
    planned = parts.stage.picture().playhead
    assert len(planned.points) < 30
    while not (frame := parts.watch(FRAME_S)[-1]).ended:
        rate = max(planned.rate_at(parts.now), planned.rate_at(parts.now - FRAME_S))
        assert planned.time_at(parts.now) == pytest.approx(frame.time_s, abs=2 * FRAME_S * rate)


def test_the_plan_of_a_race_holds_at_its_photo_finish_and_goes_on(parts: StageParts) -> None:
    run = parts.finished_race()
    parts.stage.set(run_id=run.id, end_at_time_out=False)
    parts.stage.frame()
    planned = parts.stage.picture().playhead
    time_out_s = planned.time_out_s
    assert time_out_s is not None

    began_s = planned.when(time_out_s, parts.now)
    assert began_s - parts.now == pytest.approx(time_out_s / SPEED, abs=0.1)
    assert planned.rate_at(began_s + 0.1) == 0
    ended_s = planned.when(time_out_s + 0.05, parts.now)
    assert ended_s - began_s == pytest.approx(PHOTO_FINISH_S, abs=0.2)
