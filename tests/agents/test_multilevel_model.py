"""The multilevel model: its posterior by hand, what it generalises, its plan, files and limits."""

from typing import Any

import numpy as np
import pytest

import hexapods as hx
from hexapods.agents.explanation import evaluate
from hexapods.agents.multilevel_model import MAX_PAIRS, MultilevelModel
from hexapods.agents.multilevel_regression import MultilevelRegression, PairLayout
from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.domain.body import ring
from hexapods.domain.errors import InvalidInput
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action, Cells, FloatArray

GRID = FootGrid()
PROBLEM = Problem(((1, 2), (3, 4)), GRID.cells)
HALF_SIDE_M = GRID.half_side_m
HOME, FRONT_LEFT, FRONT_RIGHT, BACK_LEFT, BACK_RIGHT = range(5)
AT_HOME: Cells = (HOME, HOME)
LEGAL = legal_actions(AT_HOME, 5)


def model(**settings: Any) -> MultilevelModel:
    return MultilevelModel(PROBLEM, **settings)


def experience(
    agent: MultilevelModel, before: Cells, action: Action, reward_m: float, after: Cells = AT_HOME
) -> None:
    agent.learn(Transition(before, action, reward_m, after, legal_actions(after, 5)))


def practised(steps: int, seed: int = 0) -> MultilevelModel:
    """Return a model after random steps with random rewards."""
    agent, rng, cells = model(), np.random.default_rng(seed), AT_HOME
    for _ in range(steps):
        legal = legal_actions(cells, 5)
        action = legal[int(rng.integers(len(legal)))]
        agent.act(cells, legal)
        after = tuple(rng.integers(0, 5, 2).tolist())
        experience(agent, cells, action, float(rng.normal(0.0, 0.01)), after)
        cells = after
    return agent


def exact_posterior(
    layout: PairLayout, tries: FloatArray, sums: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return means and deviations of all pairs by one Gaussian process over them."""
    cells = layout.cells_of[layout.landings]
    prior = (cells[:, None] == cells).sum(-1) * 1.0
    for deviation, members in (
        (0.2, layout.landings),
        (0.2, layout.movers),
        (0.3, np.arange(layout.pairs)),
    ):
        prior += deviation**2 * (members[:, None] == members)
    tried = np.flatnonzero(tries)
    noise = np.diag(0.1**2 / tries[tried])
    gain = prior[:, tried] @ np.linalg.inv(prior[np.ix_(tried, tried)] + noise)
    means = gain @ (sums[tried] / tries[tried])
    return means, np.sqrt(np.diag(prior - gain @ prior[tried])) * HALF_SIDE_M


def test_the_levels_give_the_posterior_of_one_gaussian_process() -> None:
    layout, rng = PairLayout(PROBLEM), np.random.default_rng(1)
    tries = np.where(layout.is_legal, rng.poisson(0.6, layout.pairs), 0)
    sums = tries * rng.normal(0.0, 0.01, layout.pairs)

    levels = MultilevelRegression(PROBLEM, layout).levels(tries, sums)

    means, deviations = exact_posterior(layout, tries, sums)
    np.testing.assert_allclose(levels[-1].mean, means, atol=1e-9)
    np.testing.assert_allclose(levels[-1].deviation, deviations, atol=1e-9)


def test_before_its_first_step_it_expects_nothing_of_any_step() -> None:
    values = model(explore=False).values(AT_HOME)

    assert np.isnan(values[:, HOME]).all()
    assert (values[:, 1:] == 0).all()


def test_steps_that_share_more_with_one_that_was_taken_are_expected_to_be_more_like_it() -> None:
    agent = model(explore=False, gamma=0.0)
    experience(agent, AT_HOME, Action(0, FRONT_LEFT), 0.01)

    def expected(before: Cells, action: Action) -> float:
        return float(agent.values(before)[action])

    same_pair = expected(AT_HOME, Action(0, FRONT_LEFT))
    from_elsewhere = expected((BACK_LEFT, HOME), Action(0, FRONT_LEFT))
    by_the_other_group = expected((FRONT_LEFT, BACK_LEFT), Action(1, HOME))
    with_one_cell_alike = expected((HOME, BACK_LEFT), Action(0, FRONT_LEFT))
    with_none = expected((HOME, BACK_LEFT), Action(0, BACK_RIGHT))
    assert same_pair > from_elsewhere > by_the_other_group > with_one_cell_alike > 0.001
    assert with_one_cell_alike > with_none


def test_it_tells_by_which_group_the_feet_came_to_the_same_places() -> None:
    """A body that tips has another tilt; no sum over where the feet stand expresses it."""
    agent = model(explore=False, gamma=0.0)
    for _ in range(20):
        experience(agent, AT_HOME, Action(0, FRONT_LEFT), 0.01)
        experience(agent, (FRONT_LEFT, BACK_LEFT), Action(1, HOME), -0.01)

    assert agent.values(AT_HOME)[0, FRONT_LEFT] == pytest.approx(0.01, abs=5e-4)
    assert agent.values((FRONT_LEFT, BACK_LEFT))[1, HOME] == pytest.approx(-0.01, abs=5e-4)


def test_it_plans_for_what_comes_after_the_next_step() -> None:
    """A step that earns something is not taken where all that follows it loses more."""
    trap = (FRONT_LEFT, HOME)
    near, far = model(explore=False, gamma=0.0), model(explore=False)
    for agent in (near, far):
        for _ in range(20):
            experience(agent, AT_HOME, Action(0, FRONT_LEFT), 0.002, trap)
            experience(agent, AT_HOME, Action(1, BACK_LEFT), 0.0, AT_HOME)
            for action in legal_actions(trap, 5):
                experience(agent, trap, action, -0.02, trap)
    choices = [Action(0, FRONT_LEFT), Action(1, BACK_LEFT)]

    assert near.act(AT_HOME, choices) == Action(0, FRONT_LEFT)
    assert far.act(AT_HOME, choices) == Action(1, BACK_LEFT)


def test_optimism_tries_what_is_uncertain_and_a_frozen_copy_does_not() -> None:
    hopeful, frozen = model(optimism=3.0, gamma=0.0), model(explore=False, gamma=0.0)
    for agent in (hopeful, frozen):
        for _ in range(5):
            experience(agent, AT_HOME, Action(0, FRONT_LEFT), 0.006)

    assert hopeful.act(AT_HOME, LEGAL) != Action(0, FRONT_LEFT)
    assert frozen.act(AT_HOME, LEGAL) == Action(0, FRONT_LEFT)


def test_the_rule_names_hope_only_where_it_hopes() -> None:
    for agent, rule in (
        (model(), "r̂ + β · σ + γ · V′"),
        (model(explore=False), "r̂ + γ · V′"),
    ):
        step = Transition(AT_HOME, Action(0, FRONT_LEFT), 0.01, (FRONT_LEFT, HOME), LEGAL)
        explained = agent.explain_update(step)
        assert explained.update is not None
        assert explained.update.rule == rule
        value = agent.values(AT_HOME)[0, FRONT_LEFT]
        assert evaluate(rule, explained.update.terms) == explained.update.after == value
        assert [belief.name for belief in explained.beliefs] == [
            "reward by cells",
            "reward by landing",
            "reward by landing and mover",
            "reward by pair",
        ]
        for belief in explained.beliefs:
            assert belief.deviation_before is not None
            assert belief.deviation_after is not None
            assert belief.deviation_after < belief.deviation_before


def test_looking_at_values_does_not_change_the_next_plan() -> None:
    watched, unwatched = practised(30), practised(30)
    watched.values(AT_HOME)
    watched.tune(gamma=0.8)
    watched.values(AT_HOME)
    unwatched.tune(gamma=0.8)
    for agent in (watched, unwatched):
        experience(agent, AT_HOME, Action(0, FRONT_LEFT), 0.01)

    for name, array in watched.state().items():
        np.testing.assert_array_equal(array, unwatched.state()[name], name)


def test_settings_change_live_and_are_saved() -> None:
    agent, copy = model(), model(optimism=1.0)
    agent.tune(optimism=0.0, gamma=0.5)
    agent.tune()
    copy.load(agent.state())
    assert copy.state()["tuned"].tolist() == [0.0, 0.5]
    copy.continue_from(agent.state())
    assert np.isnan(copy.state()["tuned"]).all()


@pytest.mark.parametrize(
    "change",
    [
        {"tuned": np.array([-1.0, np.nan])},
        {"tuned": np.array([np.nan, 1.0])},
        {"shape": np.array([2, 6])},
        {"shape": np.array([10**9, 5])},
        {"shape": np.array([0, 5])},
        {"tries": np.full(250, -1)},
        {"reward_sums": np.full(250, np.inf)},
        {"first_values": np.full(25, np.nan)},
        {"outcomes": np.zeros((0, 3), int)},
        {"outcomes": np.array([[0, 25, 5]])},
        {"outcomes": np.array([[0, 0, 2], [0, 0, 3]])},
    ],
)
def test_a_state_that_is_not_possible_is_refused(change: AgentState) -> None:
    state = practised(5).state()
    MultilevelModel.check_state(state)
    with pytest.raises(ValueError, match=r"its |optimism|gamma|discount"):
        MultilevelModel.check_state({**state, **change})


def test_a_state_of_another_problem_is_refused() -> None:
    three = MultilevelModel(Problem(((1,), (2,), (3,)), GRID.cells))
    with pytest.raises(ValueError, match=r"\[3, 5\], not \[2, 5\]"):
        model().load(three.state())


def test_a_problem_with_too_many_pairs_is_refused_with_what_helps() -> None:
    six = Problem(tuple((leg,) for leg in range(1, 7)), GRID.cells)
    with pytest.raises(InvalidInput, match=rf"at most {MAX_PAIRS:,}.* linear-model"):
        MultilevelModel(six)


@pytest.mark.test
def test_a_frozen_copy_walks_forward_on_a_body_that_tips() -> None:
    """Four legs in a ring, moved two by two, tip; greedy walks 0.396 m there."""
    trained = hx.train(
        "multilevel-model",
        gait="left-right-vertical",
        robot=hx.Robot(name="ring", legs=ring(4)),
        steps=100,
        seed=1,
        evaluate_every=0,
    )
    assert trained.distance_m is not None
    assert trained.distance_m > 0.3
