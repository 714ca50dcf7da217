"""The specification's figures for the kinematic simulator, over a thousand seeds.

Distances are over 50 steps from rest, in units of h, half the side of the foot grid. All rows share
one pass over the seeds: a minute on two idle cores. The gate's shorter form has 100 to 200 seeds,
fewer practices of other lengths, and the same tolerances.
"""

from itertools import product

import numpy as np
import pytest

from hexapods.domain.gait import PAPER_GAITS
from hexapods.domain.types import FloatArray
from tests.figures import (
    BLOCK_STEPS,
    COMMANDED_STEPS,
    GREEDY_H,
    H_M,
    MEASURED_STEPS,
    NINE_CELLS_STEPS,
    in_a_pool,
    interquartile_mean,
    kinematic_rows,
    look_ahead,
)
from tests.promises.length import at_length

SEEDS = at_length(200, 1000)
Rows = dict[str, FloatArray]

pytestmark = [pytest.mark.promises, pytest.mark.timeout(1800)]


@pytest.fixture(scope="module")
def rows() -> Rows:
    """Compute the distances of all seeds for every row [h]."""
    per_seed = in_a_pool(kinematic_rows, range(SEEDS), chunk=20)
    return {
        name: np.array([distances[name] for distances in per_seed if name in distances])
        for name in per_seed[0]
    }


def share(values: FloatArray) -> float:
    """Return the interquartile mean as a share of greedy's distance [%]."""
    return 100 * interquartile_mean(values) / GREEDY_H


THREE_STEP = "tests.own_agents:ThreeStep"
DEEPEST_IN = at_length(("left-right-origin",), tuple(PAPER_GAITS))


@pytest.mark.parametrize(
    ("agent", "gait"),
    [
        *product(("greedy", "two-step"), PAPER_GAITS),
        *((THREE_STEP, gait) for gait in DEEPEST_IN),
    ],
)
def test_two_step_look_ahead_is_no_better_than_greedy(agent: str, gait: str) -> None:
    distance_m = look_ahead((agent, gait, "kinematic", {}))

    assert distance_m / H_M == pytest.approx(24.833, abs=0.001)


@pytest.mark.parametrize("steps", MEASURED_STEPS)
def test_measured_q_learning_reaches_the_specified_share_of_greedy(rows: Rows, steps: int) -> None:
    percent = {250: 60, 500: 74, 1000: 83}[steps]

    assert share(rows[f"measured {steps}"]) == pytest.approx(percent, rel=0.05)


def test_measured_q_learning_by_seed(rows: Rows) -> None:
    after_500 = 100 * rows["measured 500"] / GREEDY_H

    assert np.percentile(after_500, [25, 75]) == pytest.approx([65, 81], rel=0.05)
    assert 100 * (after_500 > 50).mean() == pytest.approx(92, rel=0.05)


@pytest.mark.parametrize("steps", NINE_CELLS_STEPS)
def test_measured_q_learning_on_nine_cells(rows: Rows, steps: int) -> None:
    percent = {250: 30, 500: 48, 1000: 62}[steps]

    assert share(rows[f"nine cells {steps}"]) == pytest.approx(percent, rel=0.05)


@pytest.mark.parametrize("steps", COMMANDED_STEPS)
def test_commanded_q_learning(rows: Rows, steps: int) -> None:
    least_h, most_h, percent = {500: (3.2, 3.2, 13), 1000: (4.4, 4.9, 19)}[steps]
    commanded = rows[f"commanded {steps}"]

    assert 0.8 * least_h <= interquartile_mean(commanded) <= 1.2 * most_h
    assert share(commanded) == pytest.approx(percent, rel=0.2)


def test_commanded_q_learning_is_heavy_tailed(rows: Rows) -> None:
    """Most seeds hardly move, a few walk."""
    shares = rows["commanded 1000"] / GREEDY_H

    assert (shares < 0.25).mean() > 0.5
    assert (shares > 0.8).mean() > 0.05


@pytest.mark.parametrize("steps", BLOCK_STEPS)
def test_commanded_q_learning_in_blocks_with_epsilon_restarted(rows: Rows, steps: int) -> None:
    distance_h = {250: 3.3, 500: 3.6, 750: 5.4, 1000: 6.9}[steps]

    assert interquartile_mean(rows[f"block {steps}"]) == pytest.approx(distance_h, rel=0.2)
