"""All learners of the registry: exact values, resume to the last bit, files, evaluation, looks."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from app.storage.imported_tables import checked_table
from hexapods.agents.appearance import colors_of, description_of, title_of
from hexapods.agents.protocol import Problem, Transition, Valuing
from hexapods.agents.registry import BUILT_IN, build, find, learns, settings_of
from hexapods.agents.tabular import TabularAgent, TabularLearner
from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.errors import HexapodError
from hexapods.domain.feet import Feet
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.domain.settings import SettingValues
from hexapods.domain.types import Action, Cells
from hexapods.domain.world import UNDISTURBED
from hexapods.experiments.trial import TrialConfig, run_trial
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import training_result
from hexapods.runs.seeding import RACING, generator
from hexapods.runs.tables import Checkpoint, from_bytes, restore, snapshot, table_of, to_bytes
from hexapods.runs.training import Learner, evaluate, train

LEARNERS = [name for name in BUILT_IN if learns(name)]
TABULAR = [name for name in LEARNERS if issubclass(find(name), TabularAgent)]  # type: ignore[arg-type]
ON_POLICY = ["sarsa", "expected-sarsa", "n-step-sarsa", "sarsa-lambda"]
OF_RETURNS = [name for name in TABULAR if name != "tamer"]
"""Those whose values are expected returns; the others predict what people press."""


def config_of(agent: str, steps: int = 90) -> TrainingConfig:
    return training_config(
        agent, gait="left-right-origin", simulator="kinematic", steps=steps, seed=4
    )


def trained(config: TrainingConfig, steps: int | None = None) -> Learner:
    learner = build_learner(config)
    for _ in train(learner, config):
        if learner.step == steps:
            break
    return learner


@cache
def checkpoint_of(agent: str) -> Checkpoint:
    """Return a checkpoint amid a training, when traces, queues and plans are not empty."""
    return snapshot(trained(config_of(agent), 47), config_of(agent))


@pytest.fixture(params=LEARNERS)
def agent(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


# ---- convergence to exact values: the kinematic problem with its feet put back on the grid

GRID = FootGrid()
PAIRS, CELLS = 2, len(GRID)
PROBLEM = Problem(((1, 3), (2, 4)), GRID.cells)
GAMMA = 0.5


def moved(state: Cells, action: Action) -> tuple[Cells, float]:
    """Return the next state and the reward of four legs that stand exactly on `state`.

    The kinematic law; then every foot is put on the cell nearest to it, so that the state is
    Markov: what the agent observes decides what comes next.
    """
    lateral, forward = zip(*(GRID.places_m[cell] for cell in state), strict=True)
    feet = Feet(state, lateral, forward).landed(*action, GRID.places_m[action.cell])
    advance_m = feet.mean_m((2, 2))
    after = feet.shifted(advance_m)
    cells = map(GRID.nearest, after.lateral_m, after.forward_m)
    return tuple(cells), advance_m


@cache
def outcomes() -> Mapping[tuple[Cells, Action], tuple[Cells, float]]:
    """Return what follows each state and action, for all states that can be reached from home."""
    results, open_states = {}, [(0,) * PAIRS]
    while open_states:
        state = open_states.pop()
        for action in legal_actions(state, CELLS):
            results[state, action] = moved(state, action)
        seen = {state for state, _ in results} | set(open_states)
        open_states += {after for after, _ in results.values()} - seen
    return results


@cache
def exact_values(*, of_random_policy: bool) -> Mapping[tuple[Cells, Action], float]:
    """Return the values of the best policy by value iteration, or those of the random one."""
    values = dict.fromkeys(outcomes(), 0.0)
    for _ in range(40):
        of_state: dict[Cells, list[float]] = {}
        for (state, _), value in values.items():
            of_state.setdefault(state, []).append(value)
        worth = {
            state: float(np.mean(of)) if of_random_policy else max(of)
            for state, of in of_state.items()
        }
        values = {
            pair: reward + GAMMA * worth[after] for pair, (after, reward) in outcomes().items()
        }
    return values


def practised(name: str, rounds: list[tuple[int, float]], **settings: Any) -> TabularAgent:
    """Return a learner after rounds of random steps, each so many at a learning rate."""
    rng = np.random.default_rng(0)
    offered = {"rng": rng, "problem": PROBLEM, "gamma": GAMMA, "epsilon_end": 1.0, **settings}
    agent = build(find(name), offered)
    assert isinstance(agent, TabularAgent)
    state, action = (0,) * PAIRS, Action(0, 1)
    for steps, alpha in rounds:
        if isinstance(agent, TabularLearner):
            agent.tune(alpha=alpha)
        for _ in range(steps):
            after, reward = outcomes()[state, action]
            legal = legal_actions(after, CELLS)
            chosen = legal[int(rng.integers(len(legal)))]
            agent.learn(Transition(state, action, reward, after, legal, chosen))
            state, action = after, chosen
    return agent


def error(agent: TabularAgent, exact: Mapping[tuple[Cells, Action], float]) -> float:
    """Return the largest error of an action value, as a share of the range of the exact ones."""
    errors = [
        abs(agent.table.values(state)[action] - exact[state, action]) for state, action in exact
    ]
    return float(max(errors) / (max(exact.values()) - min(exact.values())))


@pytest.mark.parametrize("name", [name for name in OF_RETURNS if name not in ON_POLICY])
def test_values_converge_to_those_of_value_iteration(name: str) -> None:
    settings = {"planning_steps": 5, "plan_every": 100, "bonus_m": 0.0, "objective": "discounted"}
    agent = practised(name, [(12_000, 0.5)], **settings)

    assert error(agent, exact_values(of_random_policy=False)) < 0.01


@pytest.mark.parametrize("name", ON_POLICY)
def test_values_converge_to_those_of_the_policy(name: str) -> None:
    """An on-policy learner learns what its own policy is worth, here a random one."""
    agent = practised(name, [(5000, 0.5), (5000, 0.2), (8000, 0.05), (20_000, 0.02)])

    assert error(agent, exact_values(of_random_policy=True)) < 0.08
    assert error(agent, exact_values(of_random_policy=False)) > 0.2


# ---- the average reward, in place of discounting

TEMPORAL = [name for name in TABULAR if "average_rate" in settings_of(find(name))]


def best_average_m() -> float:
    """Return the highest average reward of a step, by value iteration without a discount [m].

    The best sum of rewards of n steps less that of n − 1 tends to it, here with a period.
    """
    worth = dict.fromkeys((state for state, _ in outcomes()), 0.0)
    sums = []
    for _ in range(240):
        best: dict[Cells, float] = {}
        for (state, _), (after, reward) in outcomes().items():
            best[state] = max(best.get(state, -np.inf), reward + worth[after])
        worth = best
        sums.append(worth[(0,) * PAIRS])
    return (sums[239] - sums[119]) / 120


@pytest.mark.promises
@pytest.mark.parametrize("name", [name for name in TEMPORAL if name not in ON_POLICY])
def test_the_average_reward_converges_to_the_best(name: str) -> None:
    """Each value is then its reward, less the average, and the best value that follows it."""
    rounds = [(12_000, 0.5), (12_000, 0.1)]
    agent = practised(name, rounds, objective="average", planning_steps=5, bonus_m=0.0)
    average_m = agent.state()["average"][0]
    best_m = {
        state: np.nanmax(agent.table.values(state)) for state in {state for state, _ in outcomes()}
    }
    errors_m = [
        abs(agent.table.values(state)[action] - (reward - average_m + best_m[after]))
        for (state, action), (after, reward) in outcomes().items()
    ]

    assert average_m == pytest.approx(best_average_m(), rel=0.01)
    assert max(errors_m) < 0.02 * best_average_m()


@pytest.mark.promises
@pytest.mark.parametrize("name", ON_POLICY)
def test_the_average_reward_converges_to_that_of_the_policy(name: str) -> None:
    """It is that of random steps here, which lead nowhere."""
    rounds = [(5000, 0.5), (8000, 0.05), (20_000, 0.02)]
    settings = {"objective": "average", "average_rate": 0.1}
    average_m = practised(name, rounds, **settings).state()["average"][0]

    assert abs(average_m) < 0.05 * best_average_m()


def test_a_table_of_the_discounted_objective_goes_on_with_the_average_one() -> None:
    config = config_of("q-learning")
    table = snapshot(trained(config), config)
    averaging = replace(config, settings=SettingValues({"objective": "average"}))
    learner = build_learner(averaging, table)

    assert learner.walker.agent.state()["average"].tolist() == [0.0]
    assert "average" not in table.part("agent.")


def test_an_average_reward_that_is_no_number_is_refused() -> None:
    state = build_learner(config_of("afterstate-q")).walker.agent.state()
    TabularLearner.check_state(state)

    with pytest.raises(ValueError, match="average reward is no finite number"):
        TabularLearner.check_state({**state, "average": np.array([np.nan])})


# ---- what every part of the product relies on


def test_training_resumes_to_the_last_bit(agent: str) -> None:
    config = config_of(agent)
    ended = snapshot(trained(config), config)
    again = build_learner(config)
    restore(again, from_bytes(to_bytes(checkpoint_of(agent)), "checkpoint"))
    for _ in train(again, config):
        pass

    resumed = snapshot(again, config)
    assert resumed.meta == ended.meta
    assert set(resumed.arrays) == set(ended.arrays)
    for name, array in ended.arrays.items():
        np.testing.assert_array_equal(resumed.arrays[name], array, name)


def test_evaluation_and_display_do_not_change_what_is_learned(agent: str) -> None:
    config = config_of(agent)
    watched, unwatched = trained(config, 47), trained(config, 47)
    for _ in range(2):
        evaluate(watched, config, 0)
        watched.walker.action_values()
        snapshot(watched, config)
    for learner in (watched, unwatched):
        for _ in train(learner, config, record=learner is watched):
            pass

    assert to_bytes(snapshot(watched, config)) == to_bytes(snapshot(unwatched, config))


def test_a_loaded_learner_walks_as_far_as_the_one_evaluated(agent: str) -> None:
    config = config_of(agent)
    race = RaceConfig(gait=config.gait, simulator="kinematic", lanes=(LaneConfig(agent=agent),))
    learner = trained(config)
    (walker,) = build_walkers(race, [snapshot(learner, config)])
    evaluated = learner.evaluator(UNDISTURBED, generator(race.seed, RACING, 0))
    for _ in range(20):
        action = evaluated.decide()
        assert walker.decide() == action
        walker.carry_out(action)
        evaluated.carry_out(action)


def test_values_and_visits_are_shown(agent: str) -> None:
    learner = trained(config_of(agent), 47)
    walker = learner.walker
    assert isinstance(walker.agent, Valuing)
    values, visits = (of(walker.observed) for of in (walker.agent.values, walker.agent.visits))

    assert values.shape == visits.shape == (3, 5)
    at_present_cell = np.zeros((3, 5), bool)
    at_present_cell[range(3), walker.observed] = True
    np.testing.assert_array_equal(np.isnan(values), at_present_cell)
    np.testing.assert_array_equal(np.isnan(visits), at_present_cell)


@pytest.mark.parametrize("name", TABULAR)
def test_table_of_a_file_is_that_of_the_result(name: str) -> None:
    config = config_of(name)
    learner = trained(config)
    result = training_result(learner, config)
    table = table_of(from_bytes(to_bytes(snapshot(learner, config)), "q.npz"))

    assert table.sha256() == result.q_table_sha256
    assert sum(np.nansum(visits) for _, _, visits in table.rows()) == config.steps


def test_practice_continues_from_what_was_learned(agent: str) -> None:
    config = config_of(agent, 5)
    learner = build_learner(config, checkpoint_of(agent))
    before = learner.walker.agent
    assert isinstance(before, Valuing)
    assert np.nansum([before.visits((0, 0, 0))]) > 0
    for _ in train(learner, config):
        pass
    assert learner.step == 5


def test_practice_continues_from_a_training_that_was_stopped_before_its_first_step(
    agent: str,
) -> None:
    config = config_of(agent, 3)
    nothing = snapshot(build_learner(config), config)
    checked_table(to_bytes(nothing), "q.npz", LEARNERS)
    learner = build_learner(config, nothing)
    evaluate(learner, config, 0)
    for _ in train(learner, config):
        pass
    assert learner.step == 3


def test_trial_of_an_experiment_runs(agent: str) -> None:
    result = run_trial(TrialConfig(training=config_of(agent, 30), blocks=2))

    assert result.failure is None
    assert len(result.distances_m) == 2


def test_a_file_of_its_own_is_imported(agent: str) -> None:
    checkpoint, _, config = checked_table(to_bytes(checkpoint_of(agent)), "q.npz", LEARNERS)

    assert config == config_of(agent)
    assert checkpoint.meta["step"] == 47


def test_a_damaged_array_in_a_file_is_refused(agent: str) -> None:
    original = checkpoint_of(agent)
    names = [name for name in original.arrays if name.startswith("agent.")]
    for name in names:
        array = original.arrays[name]
        for damaged in (np.array(["a lot"]), np.append(array.ravel(), array.ravel()[:1])):
            arrays = {**original.arrays, name: damaged}
            data = to_bytes(Checkpoint(original.meta, arrays))
            with pytest.raises(HexapodError):
                checked_table(data, "q.npz", LEARNERS)


def test_a_file_that_lacks_an_array_is_refused(agent: str) -> None:
    original = checkpoint_of(agent)
    names = [name for name in original.arrays if name.startswith("agent.")]
    for gone in [*([name] for name in names), names]:
        arrays = {name: array for name, array in original.arrays.items() if name not in gone}
        with pytest.raises(HexapodError):
            checked_table(to_bytes(Checkpoint(original.meta, arrays)), "q.npz", LEARNERS)


def test_every_agent_looks_different() -> None:
    colors = colors_of(list(BUILT_IN))
    assert len({title_of(agent) for agent in BUILT_IN}) == len(set(colors)) == len(BUILT_IN)
    declared_colors = {getattr(find(agent), "color", None) for agent in BUILT_IN}
    assert set(colors) == declared_colors


def test_every_agent_says_what_it_does_in_a_sentence(agent: str) -> None:
    assert 20 < len(description_of(agent)) < 100
    assert description_of(agent).endswith(".")
