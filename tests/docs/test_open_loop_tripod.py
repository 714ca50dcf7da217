"""An open-loop tripod walks several times as fast as greedy: the grid limits speed."""

import runpy

import pytest

from tests.docs.programs import DOCS

EXAMPLE = runpy.run_path(str(DOCS / "examples" / "open_loop_tripod.py"))


def test_sines_are_several_times_as_fast_as_greedy() -> None:
    sines, greedy = EXAMPLE["open_loop"](seconds=3), EXAMPLE["greedy"](steps=6)

    assert sines.seconds == 3
    assert greedy.seconds == pytest.approx(6 * 0.32)
    assert sines.distance_m / sines.seconds > 3 * greedy.distance_m / greedy.seconds


def test_a_foot_that_is_out_of_reach_is_refused() -> None:
    with pytest.raises(ValueError, match="out of reach"):
        EXAMPLE["open_loop"](amplitude_m=0.5, seconds=1)
