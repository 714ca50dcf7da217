"""The specification's figures for MuJoCo: metres over 50 steps from rest.

The gate's shorter form leaves out gaits of some robots, and the learners.
"""

from itertools import product

import numpy as np
import pytest

from hexapods.domain.gait import PAPER_GAITS
from hexapods.domain.robot import robot
from hexapods.domain.types import FloatArray
from hexapods.runs.config import training_config
from tests.figures import in_a_pool, look_ahead, practise
from tests.promises.length import at_length, only_whole

GAITS = tuple(PAPER_GAITS)
EXCEPTIONAL = "left-right-vertical"
"""The gait that lifts both front legs at once."""
COMPLIANT = {"servo_kp": 10, "servo_kv": 0.5}
SOFT = {"servo_kp": 5, "servo_kv": 0.3}
ROBOTS: dict[str, dict[str, float]] = {
    "stiff": {},
    "compliant": COMPLIANT,
    "soft": SOFT,
    "friction 0.3": {"friction": 0.3},
    "friction 0.1": {"friction": 0.1},
}
SEEDS = range(8)

pytestmark = [pytest.mark.promises, pytest.mark.timeout(1800)]


EVERY_ROBOT_AND_GAIT = list(product(ROBOTS, GAITS))
WALKERS = at_length(
    [
        (name, gait)
        for name, gait in EVERY_ROBOT_AND_GAIT
        if gait == (EXCEPTIONAL if name == "soft" else GAITS[0])
        or (name in ("stiff", "compliant") and gait == EXCEPTIONAL)
    ],
    EVERY_ROBOT_AND_GAIT,
)


@pytest.fixture(scope="module")
def greedy_m() -> dict[tuple[str, str], float]:
    keys = WALKERS
    runs = [("greedy", gait, "mujoco", ROBOTS[name]) for name, gait in keys]
    return dict(zip(keys, in_a_pool(look_ahead, runs), strict=True))


@pytest.mark.parametrize(
    ("name", "metres"),
    [
        ("stiff", (0.50, 0.50, 0.50, 0.51)),
        ("compliant", (0.46, 0.31, 0.46, 0.45)),
        ("soft", (0.41, 0.01, 0.40, 0.40)),
        ("friction 0.3", (0.53, 0.54, 0.51, 0.52)),
        ("friction 0.1", (0.41, 0.41, 0.44, 0.46)),
    ],
)
def test_greedy_in_the_four_gaits(
    greedy_m: dict[tuple[str, str], float], name: str, metres: tuple[float, ...]
) -> None:
    for gait, m in zip(GAITS, metres, strict=True):
        if (name, gait) in WALKERS:
            # A centimetre is the specification's own rounding, and all that one of them covers.
            assert greedy_m[name, gait] == pytest.approx(m, rel=0.1, abs=0.01), gait


def test_the_default_robot_covers_half_a_metre_in_every_gait(
    greedy_m: dict[tuple[str, str], float],
) -> None:
    for gait in GAITS:
        if ("stiff", gait) in WALKERS:
            assert greedy_m["stiff", gait] == pytest.approx(0.5, rel=0.1)


def test_compliant_servos_let_the_body_pitch_in_left_right_vertical(
    greedy_m: dict[tuple[str, str], float],
) -> None:
    other_gaits_m = [
        metres
        for (name, gait), metres in greedy_m.items()
        if name == "compliant" and gait != EXCEPTIONAL
    ]

    assert greedy_m["compliant", EXCEPTIONAL] < 0.8 * min(other_gaits_m)


LEARNERS = {
    "left-right-origin stiff": ("left-right-origin", "stiff"),
    "left-right-origin compliant": ("left-right-origin", "compliant"),
    "left-right-vertical compliant": ("left-right-vertical", "compliant"),
}


@pytest.fixture(scope="module")
def learned_m() -> dict[str, FloatArray]:
    """`measured` Q-learning after 500 steps, for each seed."""
    configs = [
        training_config(gait=gait, robot=robot(preset), steps=500, seed=seed, evaluate_every=0)
        for gait, preset in LEARNERS.values()
        for seed in SEEDS
    ]
    distances = np.array(in_a_pool(practise, configs)).reshape(len(LEARNERS), len(SEEDS))
    return dict(zip(LEARNERS, distances, strict=True))


SPANS_M = {
    "left-right-origin stiff": (0.32, 0.43),
    "left-right-origin compliant": (0.00, 0.44),
    "left-right-vertical compliant": (0.02, 0.31),
}


@only_whole
@pytest.mark.parametrize("name", LEARNERS)
def test_measured_q_learning_after_500_steps(learned_m: dict[str, FloatArray], name: str) -> None:
    """Compare the middle half of our seeds with the specification's range of eight seeds.

    Only the middle half, since these are other seeds and the distribution has long tails; to the
    specification's rounding of a centimetre.
    """
    middle, span_m = np.sort(learned_m[name])[2:6], SPANS_M[name]

    assert middle.min() > span_m[0] - 0.01
    assert middle.max() < span_m[1] + 0.01


@only_whole
def test_on_compliant_servos_learned_distances_vary_widely(
    learned_m: dict[str, FloatArray],
) -> None:
    origin, vertical = (learned_m[f"left-right-{s} compliant"] for s in ("origin", "vertical"))

    assert np.median(origin) == pytest.approx(0.30, abs=0.05)
    assert origin.min() < 0.1  # some hardly walk
    assert origin.max() > 0.4  # some nearly as greedy does
    assert np.median(vertical) < 0.5 * np.median(origin)
