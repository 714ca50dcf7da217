"""The linear model: posteriors by hand, optimism, choice between experts, and bit-exact resume."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from hexapods.agents.linear_model import LinearModel
from hexapods.agents.protocol import Problem, Transition, Tunable, Valuing
from hexapods.assembly import build_learner
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import read_gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import Observation, legal_actions
from hexapods.domain.robot import PRESETS
from hexapods.domain.types import Action, Cells
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.records import StepTaken
from hexapods.runs.tables import from_bytes, restore, snapshot, to_bytes
from hexapods.runs.training import Learner, evaluate, train

GRID = FootGrid()
PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), GRID.cells)
HOME, FRONT_LEFT, FRONT_RIGHT, BACK_LEFT, BACK_RIGHT = range(5)
AT_HOME: Cells = (HOME, HOME, HOME)
LEGAL = legal_actions(AT_HOME, 5)


@dataclass
class Plan:
    """A plan of the feet that a test sets."""

    planned_offsets_m: Sequence[tuple[float, float]] = ((0.0, 0.0),) * 3
    heading_rad: float = 0.0

    def __call__(self, how: Observation) -> Cells:
        return tuple(GRID.nearest(x, y) for x, y in self.planned_offsets_m)


def model(plan: Plan | None = None, **settings: Any) -> LinearModel:
    return LinearModel(PROBLEM, plan or Plan(), **settings)


def experience(
    agent: LinearModel, action: Action, reward_m: float, before: Cells = AT_HOME
) -> None:
    agent.act(before, [action])
    agent.learn(Transition(before, action, reward_m, before, LEGAL))


def practice(simulator: Any = "kinematic", **options: Any) -> TrainingConfig:
    return training_config(
        "linear-model",
        **{"gait": "left-right-vertical", "simulator": simulator, "evaluate_every": 0, **options},
    )


def practised(config: TrainingConfig) -> Learner:
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    return learner


def test_kinematic_prior_predicts_the_law_of_a_step() -> None:
    """Before the first step the values are the mean of the forward offsets after landing."""
    plan = Plan(((0.0, 0.01), (0.02, -0.005), (0.0, -0.005)))
    values = model(plan, prior="kinematic").values(AT_HOME)

    for pair, (_, y) in enumerate(plan.planned_offsets_m):
        for cell, (_, forward) in enumerate(GRID.places_m):
            if cell != HOME:
                assert values[pair, cell] == pytest.approx((forward - y) / 3)
    assert np.isnan(values[:, HOME]).all()


def test_without_a_prior_it_expects_nothing() -> None:
    values = model().values(AT_HOME)
    assert (values[:, 1:] == 0).all()


def test_one_step_teaches_about_all_pairs() -> None:
    agent = model()
    experience(agent, Action(0, FRONT_LEFT), 0.006)
    values = agent.values(AT_HOME)

    assert values[1, FRONT_RIGHT] > 0.004
    assert values[2, BACK_RIGHT] < -0.004
    visits = agent.visits(AT_HOME)
    assert visits[0, FRONT_LEFT] == np.nansum(visits) == 1


@pytest.mark.parametrize(("optimism", "expected"), [(0.0, FRONT_LEFT), (5.0, FRONT_RIGHT)])
def test_optimism_prefers_what_is_uncertain(optimism: float, expected: int) -> None:
    """Of two cells expected to be nearly as good, the optimist takes the less certain one."""
    agent = model(optimism=optimism)
    for _ in range(3):
        experience(agent, Action(0, FRONT_LEFT), 0.0068)
    assert agent.act(AT_HOME, LEGAL[:4]) == Action(0, expected)


def test_optimism_changes_live_and_is_saved() -> None:
    agent, copy = model(), model(optimism=1.0)
    copy.load(agent.state())
    assert np.isnan(copy.state()["tuned_optimism"])  # its own setting stays
    assert isinstance(agent, Tunable)
    assert isinstance(agent, Valuing)
    agent.tune(optimism=3.0)
    agent.tune()
    copy.load(agent.state())
    assert copy.state()["tuned_optimism"].tolist() == [3.0]


def decided_by(agent: LinearModel, reward_m: float) -> list[int]:
    """Return which policy decides in each of six blocks of six steps of one reward."""
    policies = []
    for _ in range(6):
        for _ in range(6):
            agent.act(AT_HOME, LEGAL)
            agent.learn(Transition(AT_HOME, Action(0, FRONT_LEFT), reward_m, AT_HOME, LEGAL))
        policies.append(int(agent.state()["deciding"][0]))
    return policies


def test_measured_cells_decide_only_where_both_orders_by_the_plan_earn_little() -> None:
    """The best possible without slip is h/2 = 0.01 m; cells are tried below half of that."""
    assert set(decided_by(model(), 0.009)) == {0, 1}
    assert decided_by(model(), 0.001)[:3] == [0, 1, 2]


def test_planned_policies_let_the_pairs_take_turns() -> None:
    agent, moved = model(prior="kinematic"), []
    for _ in range(12):
        action = agent.act(AT_HOME, LEGAL)
        moved.append(action.group)
        agent.learn(Transition(AT_HOME, action, 0.009, AT_HOME, LEGAL))
    assert moved == [0, 1, 2, 0, 1, 2, 1, 0, 2, 1, 0, 2]


def test_a_sudden_change_makes_it_forget_and_explore() -> None:
    def certainty(agent: LinearModel) -> float:
        return float(agent.state()["planned_moments"][0, 0])

    agent = model()
    for _ in range(40):
        experience(agent, Action(0, FRONT_LEFT), 0.006)
    before = certainty(agent)
    for _ in range(3):
        experience(agent, Action(0, FRONT_LEFT), -0.02)
    assert certainty(agent) < before / 2


def test_a_frozen_copy_leaves_a_cycle_in_which_the_plan_does_not_move() -> None:
    """Its cells value a step on the spot; the plan tells that nothing was gained."""
    agent = model()
    for step in range(60):
        forward = Action(0, FRONT_LEFT) if step % 2 else Action(0, BACK_LEFT)
        agent.act(AT_HOME, [forward])
        agent.learn(Transition(AT_HOME, forward, 0.006 if step % 2 else -0.006, AT_HOME, LEGAL))
    state = agent.state()
    state["measured_products"][:] = 0.0
    state["measured_moments"][:] = np.eye(15)
    state["measured_products"][[BACK_LEFT, BACK_RIGHT]] = 0.02
    state["earned"][:] = (10, 0.01), (10, 0.02), (10, 0.05)  # the cells once earned more
    frozen = model(explore=False)
    frozen.load(state)

    chosen = [frozen.act(AT_HOME, LEGAL) for _ in range(8)]
    assert {cell for _, cell in chosen[:6]} <= {BACK_LEFT, BACK_RIGHT}
    assert {cell for _, cell in chosen[6:]} <= {FRONT_LEFT, FRONT_RIGHT}


@pytest.mark.parametrize("prior", ["none", "kinematic"])
@pytest.mark.parametrize("gait", ["left-right-origin", "left-right-vertical", "front-back-origin"])
def test_it_walks_like_the_best_on_the_kinematic_problem(gait: str, prior: str) -> None:
    """24.833 h is the best possible over 50 steps from rest (docs/figures.md)."""
    config = practice(gait=gait, prior=prior, steps=12)
    learner = practised(config)
    assert evaluate(learner, config, 0.0).distance_m / 0.02 > 0.99 * 24.833


def test_a_saved_learner_continues_identically() -> None:
    config = practice(
        "mujoco", gait="left-right-vertical", robot=PRESETS["compliant"], steps=40, optimism=1.0
    )
    whole = practised(config)
    half = practised(replace(config, steps=17))
    resumed = build_learner(config)
    restore(resumed, from_bytes(to_bytes(snapshot(half, config)), "a table"))
    for _ in train(resumed, config):
        pass

    assert resumed.walker.state.distance_m == whole.walker.state.distance_m
    expected = whole.walker.agent.state()
    actual = resumed.walker.agent.state()
    assert {k: v.tobytes() for k, v in actual.items()} == {
        k: v.tobytes() for k, v in expected.items()
    }


def test_evaluation_leaves_the_learner_unchanged() -> None:
    config = practice(steps=20)
    learner = practised(config)
    before = {k: v.tobytes() for k, v in learner.walker.agent.state().items()}
    evaluate(learner, config, 0.0)
    assert {k: v.tobytes() for k, v in learner.walker.agent.state().items()} == before


def test_a_state_of_another_grid_is_refused() -> None:
    other = LinearModel(Problem(PROBLEM.groups, FootGrid(divisions=3).cells), Plan())
    with pytest.raises(ValueError, match="measured_moments has the shape"):
        model().load(other.state())


def _broken() -> list[tuple[str, Any, str]]:
    return [
        ("tuned_optimism", np.array([-1.0]), "optimism must be a number from 0 to 10"),
        ("measured_moments", np.zeros((3, 3)), "measured evidence has no shape"),
        ("planned_moments", -np.eye(4), "no sum of squares"),
        ("planned_products", np.full(4, np.nan), "planned_products are no numbers"),
        ("earned", np.full((3, 2), -1.0), "below zero"),
        ("deciding", np.array([3, 0, 0]), "counters"),
        ("visits", np.full((3, 5), -1), "counters"),
    ]


@pytest.mark.parametrize(("name", "value", "complaint"), _broken())
def test_a_broken_state_is_refused(name: str, value: Any, complaint: str) -> None:
    LinearModel.check_state(model().state())
    with pytest.raises((InvalidInput, ValueError), match=complaint):
        LinearModel.check_state({**model().state(), name: value})


TRIPOD = Problem(((1, 3, 5), (2, 4, 6)), GRID.cells)


def test_of_two_groups_there_is_one_order() -> None:
    agent = LinearModel(TRIPOD, Plan(((0.0, 0.0),) * 2))

    assert agent.state()["earned"].shape == (2, 2)


@pytest.mark.parametrize(
    ("robot", "gait", "expected_m"),
    [
        ("dog", "trot", 0.66),
        ("starfish", {"right_leg": 1, "left_leg": 2, "groups": [[1, 3], [2, 5], [4]]}, 0.48),
        ("stiff", "one-by-one", 0.26),
        ("centipede", "one-by-one", 0.14),
    ],
)
def test_it_walks_with_any_number_of_groups(robot: str, gait: Any, expected_m: float) -> None:
    """By the law without slip, in steps 51 to 100 of its life."""
    config = practice(gait=read_gait(gait), robot=PRESETS[robot], steps=100)
    learner = build_learner(config)
    rewards_m = [
        record.reward_m for record in train(learner, config) if isinstance(record, StepTaken)
    ]

    assert sum(rewards_m[50:]) > expected_m
