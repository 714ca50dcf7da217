"""The linear model's figures in physics (docs/linear-model.md); the gate tests one gait.

It makes no random choices, so that one run is all runs of a robot.
"""

from functools import cache

import pytest

from hexapods.assembly import build_learner
from hexapods.domain.gait import PAPER_GAITS
from hexapods.domain.robot import PRESETS
from hexapods.runs.config import training_config
from hexapods.runs.records import StepTaken
from hexapods.runs.training import evaluate, train
from tests.figures import look_ahead
from tests.promises.length import at_length

pytestmark = pytest.mark.promises

GAITS = at_length(("left-right-vertical",), tuple(PAPER_GAITS))
PRIORS = at_length(("none",), ("none", "kinematic"))
UNEVEN = at_length((("slippery", 1.3),), (("compliant", 1.2), ("slippery", 1.3)))


@cache
def greedy_m(gait: str, robot: str) -> float:
    return look_ahead(("greedy", gait, "mujoco", {"preset": robot}))


def life(gait: str, robot: str, steps: int, prior: str) -> tuple[list[float], float]:
    """Return the rewards of a life without practice, and what a frozen copy then covers [m]."""
    config = training_config(
        "linear-model",
        gait=gait,
        robot=PRESETS[robot],
        steps=steps,
        evaluate_every=0,
        prior=prior,
    )
    learner = build_learner(config)
    rewards = [
        record.reward_m for record in train(learner, config) if isinstance(record, StepTaken)
    ]
    return rewards, evaluate(learner, config, 0.0).distance_m


@pytest.mark.parametrize("prior", PRIORS)
@pytest.mark.parametrize("gait", GAITS)
def test_it_walks_without_practice(gait: str, prior: str) -> None:
    """Greedy stands at 0.35 to 0.37 m when a lane that decides at once has used its 50 steps."""
    rewards, _ = life(gait, "stiff", 100, prior)
    assert sum(rewards[:50]) > 0.46
    assert sum(rewards[50:]) > 0.98 * greedy_m(gait, "stiff")


@pytest.mark.parametrize("prior", PRIORS)
@pytest.mark.parametrize("gait", GAITS)
def test_frozen_after_50_steps_it_covers_what_greedy_covers(gait: str, prior: str) -> None:
    _, frozen_m = life(gait, "stiff", 50, prior)
    assert frozen_m > 0.95 * greedy_m(gait, "stiff")


@pytest.mark.parametrize(("robot", "share"), UNEVEN)
@pytest.mark.parametrize("prior", PRIORS)
def test_it_beats_a_search_that_knows_the_simulator(robot: str, share: float, prior: str) -> None:
    """After 150 steps, frozen, in the gait in which the body pitches."""
    _, frozen_m = life("left-right-vertical", robot, 150, prior)
    assert frozen_m > share * greedy_m("left-right-vertical", robot)
