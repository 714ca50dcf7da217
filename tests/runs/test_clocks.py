"""Decision, motion and crossing times under the three clocks, on small hand-made lanes."""

import pytest

from hexapods.domain.errors import UnknownName
from hexapods.runs.clocks import (
    CLOCKS,
    FINISH_LINE_M,
    Moment,
    Timetable,
    check_clock,
    crossing_s,
    decisions_s,
    distance_at,
    motions_s,
)
from tests.runs.sample_lanes import lane, step

# Two steps of a second each: 10 cm, then 20 cm; 10 and 20 transitions; 0.7 and 0.1 s of thought.
WALK = lane(
    step(1, [0.05, 0.1], transitions=10, decision_s=0.7),
    step(2, [0.2, 0.3], transitions=20, decision_s=0.1),
)


def test_step_time_is_decision_plus_motion() -> None:
    figures = WALK.steps.figures

    assert motions_s(figures).tolist() == [1, 1]
    assert decisions_s(figures, "free").tolist() == [0, 0]
    assert decisions_s(figures, "wall").tolist() == [0.7, 0.1]
    # 0.03 × motion time for every transition.
    assert decisions_s(figures, "paper") == pytest.approx([0.3, 0.6])


def test_paper_clock_scales_with_the_duration_of_the_motion() -> None:
    figures = lane(step(1, [0.1], transitions=12, frame_s=0.32)).steps.figures

    assert decisions_s(figures, "paper") == pytest.approx([0.03 * 12 * 0.32])


@pytest.mark.parametrize(
    ("clock", "thought", "ends"),
    [
        ("free", (0, 1), (1, 2)),
        ("wall", (0.7, 1.8), (1.7, 2.8)),
        ("paper", (0.3, 1.9), (1.3, 2.9)),
    ],
)
def test_timetable_has_the_ends_of_decisions_and_motions(
    clock: str, thought: tuple[float, ...], ends: tuple[float, ...]
) -> None:
    table = Timetable.of(WALK.steps, next(c for c in CLOCKS if c == clock))

    assert table.thought == pytest.approx(thought)
    assert table.ends == pytest.approx(ends)
    assert table.total_s == pytest.approx(ends[-1])


@pytest.mark.parametrize(
    ("time_s", "moment"),
    [
        (0, (0, 0, 0)),
        (0.15, (0, 0.5, 0)),
        (0.3, (0, 1, 0)),
        (0.8, (0, 1, 0.5)),
        (1.3, (0, 1, 1)),
        (1.6, (1, 0.5, 0)),
        (2.4, (1, 1, 0.5)),
        (2.91, (2, 0, 0)),
        (99, (2, 0, 0)),
    ],
)
def test_moment_is_in_a_decision_a_motion_or_after_the_last_step(
    time_s: float, moment: tuple[int, float, float]
) -> None:
    assert Timetable.of(WALK.steps, "paper").at(time_s) == pytest.approx(Moment(*moment))


def test_without_decision_time_the_motion_starts_at_zero() -> None:
    table = Timetable.of(WALK.steps, "free")

    assert table.at(0.25) == Moment(0, 1, 0.25)
    assert table.at(1.25) == Moment(1, 1, 0.25)


@pytest.mark.parametrize(
    ("time_s", "distance_m"),
    [
        (0, 0),
        (0.3, 0),  # has only thought so far
        (0.55, 0.025),  # half way to the first frame
        (0.8, 0.05),
        (1.05, 0.075),
        (1.3, 0.1),
        (1.7, 0.1),  # thinks again
        (2.15, 0.15),
        (2.65, 0.25),
        (2.9, 0.3),
        (50, 0.3),
    ],
)
def test_distance_is_interpolated_within_a_motion(time_s: float, distance_m: float) -> None:
    table = Timetable.of(WALK.steps, "paper")

    assert distance_at(WALK, table, time_s) == pytest.approx(distance_m, abs=1e-7)


def test_final_distance_is_exact() -> None:
    """It is the step's distance, not the single-precision pose."""
    for clock in CLOCKS:
        table = Timetable.of(WALK.steps, clock)
        assert distance_at(WALK, table, table.total_s) == WALK.distance_m


def test_lane_without_steps_has_distance_zero() -> None:
    table = Timetable.of(lane().steps, "paper")

    assert table.total_s == 0
    assert distance_at(lane(), table, 3.0) == 0
    assert crossing_s(lane(), table) is None


def test_crossing_of_the_finish_line_is_interpolated_between_frames() -> None:
    runner = lane(
        step(1, [0.1, 0.2], transitions=10),  # 0.3 s of thought, then a second
        step(2, [0.4, 0.5], transitions=10),  # over 0.45 three quarters into its motion
        step(3, [0.4, 0.6], transitions=10),  # and back, and again: too late to count
    )

    assert FINISH_LINE_M == 0.45
    assert crossing_s(runner, Timetable.of(runner.steps, "free")) == pytest.approx(1.75)
    assert crossing_s(runner, Timetable.of(runner.steps, "paper")) == pytest.approx(2.35)


def test_crossing_before_the_first_frame_of_a_step_is_found() -> None:
    runner = lane(step(1, [0.1, 0.4]), step(2, [0.5, 0.5]))

    assert crossing_s(runner, Timetable.of(runner.steps, "free")) == pytest.approx(1.25)


def test_lane_short_of_the_finish_line_has_no_crossing() -> None:
    assert crossing_s(WALK, Timetable.of(WALK.steps, "paper")) is None


def test_unknown_clock_is_refused_with_the_valid_names() -> None:
    check_clock("paper")
    with pytest.raises(UnknownName, match="unknown clock 'sun'; choose one of: paper, wall, free"):
        check_clock("sun")
