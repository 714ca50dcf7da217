"""Timelines: each step of a race, and strides of several steps of one that is long."""

import pytest

from app.stage import timeline as timelines
from app.stage.timeline import TimelineLane, timeline
from hexapods.runs.recording import LaneRecording
from tests.runs.sample_lanes import lane, step


def walker(steps: int) -> LaneRecording:
    """A lane that thinks for 0.1 s, then walks 1 cm in a second, in each step."""
    taken = (
        step(n, [0.01 * n], transitions=n, decision_s=0.1, frame_s=1.0) for n in range(1, steps + 1)
    )
    return lane(*taken)


def lane_timeline(steps: int) -> TimelineLane:
    (shown,) = timeline([walker(steps)], [None], 100, "wall").lanes
    return shown


def test_each_step_is_listed_with_its_decision_time() -> None:
    shown = lane_timeline(3)

    assert (shown.steps, shown.stride) == (3, 1)
    assert shown.futures == [1, 2, 3]
    thinking = [(0, 0.1), (1.1, 1.2), (2.2, 2.3)]
    assert shown.thinking == [pytest.approx(span) for span in thinking]
    points = [(0, 0), (0.1, 0), (1.1, 0.01), (1.2, 0.01), (2.2, 0.02), (2.3, 0.02), (3.3, 0.03)]
    assert shown.points == [pytest.approx(point) for point in points]


@pytest.mark.parametrize(
    ("steps", "stride", "strides"), [(4, 1, 4), (5, 2, 3), (8, 2, 4), (9, 3, 3)]
)
def test_a_long_race_is_listed_in_strides_of_steps(
    monkeypatch: pytest.MonkeyPatch, steps: int, stride: int, strides: int
) -> None:
    """With the distance at the end of each, and as long a time of thinking as its steps had."""
    whole = lane_timeline(steps)
    monkeypatch.setattr(timelines, "MAX_STRIDES", 4)
    shown = lane_timeline(steps)

    assert (shown.steps, shown.stride) == (steps, stride)
    assert isinstance(shown.futures, list)
    assert len(shown.futures) == strides
    assert sum(shown.futures) == sum(range(steps + 1))
    assert sum(end - begin for begin, end in shown.thinking) == pytest.approx(0.1 * steps)
    assert set(shown.points[::2]) <= set(whole.points), "the ends of strides are exact"
    for name in ("total_s", "crossed_s", "failure"):
        assert getattr(shown, name) == getattr(whole, name)
    assert shown.points[-1] == whole.points[-1]
