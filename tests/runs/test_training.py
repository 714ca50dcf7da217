"""Training loop: schedule, records, determinism, and bit-exact resume from a checkpoint."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from hexapods.agents.q_learning import QLearning
from hexapods.assembly import build_learner
from hexapods.domain.disturbances import Limp, SensorNoise, Slope
from hexapods.domain.errors import IllegalAction, InvalidInput
from hexapods.domain.settings import SettingValues
from hexapods.domain.world import World
from hexapods.runs import seeding
from hexapods.runs.config import SIMULATORS, SimulatorName, TrainingConfig, training_config
from hexapods.runs.records import EpisodeEnded, Evaluated, Reference, StepTaken, TrainingRecord
from hexapods.runs.results import TrainingResult, training_result
from hexapods.runs.tables import from_bytes, restore, snapshot, to_bytes
from hexapods.runs.training import Learner, train
from hexapods.runs.walker import Walker
from tests.quick_robot import HASTY

CONFIG = training_config(
    gait="left-right-vertical", simulator="kinematic", steps=200, seed=3, evaluate_every=50
)

on_both = pytest.mark.parametrize("simulator", SIMULATORS)


def run(config: TrainingConfig, threads: int = 1) -> tuple[Learner, list[TrainingRecord]]:
    learner = build_learner(config, threads=threads)
    return learner, list(train(learner, config))


def table_hash(learner: Learner) -> str:
    agent = learner.walker.agent
    assert isinstance(agent, QLearning)
    return agent.table.sha256()


def everything(learner: Learner) -> tuple[Any, ...]:
    """Return the complete state of a training, for exact comparison."""
    walker = learner.walker
    return (
        table_hash(learner),
        {name: array.tobytes() for name, array in walker.agent.state().items()},
        seeding.dump(learner.rng),
        {name: a.tobytes() for name, a in walker.simulator.dump(walker.state).items()},
        (learner.step, learner.episode_reward_m, learner.greedy_distance_m, learner.epsilon),
    )


def steps(records: list[TrainingRecord]) -> list[StepTaken]:
    return [r for r in records if isinstance(r, StepTaken)]


@pytest.mark.parametrize(
    ("total", "per_episode", "epsilons"),
    [
        (500, 50, [1 - e / 9 for e in range(10)]),
        (250, 50, [1, 0.75, 0.5, 0.25, 0]),
        (100, 50, [1, 0]),
        (50, 50, [1]),
        (20, 50, [1]),
        (120, 50, [1, 0.5, 0]),  # a last partial episode counts
        (7, 2, [1, 2 / 3, 1 / 3, 0]),
    ],
)
def test_epsilon_falls_linearly_over_the_episodes(
    total: int, per_episode: int, epsilons: list[float]
) -> None:
    config = replace(CONFIG, steps=total, steps_per_episode=per_episode, evaluate_every=0)
    _, records = run(config)
    taken = steps(records)

    assert [s.step for s in taken] == list(range(1, total + 1))
    assert [s.episode for s in taken] == [s // per_episode for s in range(total)]
    assert [s.epsilon for s in taken] == pytest.approx(
        [epsilons[s // per_episode] for s in range(total)]
    )


def test_epsilon_schedule_has_configurable_ends() -> None:
    config = replace(
        CONFIG,
        steps=150,
        evaluate_every=0,
        settings=CONFIG.settings | {"epsilon_start": 0.9, "epsilon_end": 0.3},
    )
    _, records = run(config)

    assert sorted({s.epsilon for s in steps(records)}) == pytest.approx([0.3, 0.6, 0.9])


def test_episodes_end_every_50_steps_and_at_the_end() -> None:
    _, records = run(replace(CONFIG, steps=120, evaluate_every=0))
    ended = [r for r in records if isinstance(r, EpisodeEnded)]
    taken = steps(records)

    assert [(e.episode, e.step) for e in ended] == [(0, 50), (1, 100), (2, 120)]
    assert ended[1].reward_m == pytest.approx(sum(s.reward_m for s in taken[50:100]))
    assert ended[2].reward_m == pytest.approx(sum(s.reward_m for s in taken[100:]))


def test_robot_is_not_reset_during_a_training() -> None:
    _, records = run(replace(CONFIG, evaluate_every=0))
    total = 0.0
    for taken in steps(records):
        total += taken.reward_m
        assert taken.distance_m == pytest.approx(total)


def test_step_records_observation_and_action_values() -> None:
    learner = build_learner(CONFIG)
    first, *_, last = [
        r
        for r in train(learner, replace(CONFIG, steps=60), record=True)
        if isinstance(r, StepTaken)
    ]

    assert first.observation == (0, 0, 0)
    assert first.motion is not None
    assert first.motion.qpos.shape == (16, 25)
    assert first.action_values is not None
    assert np.nansum(first.action_values.visits) == 0  # before the step
    assert last.action_values is not None
    assert np.isnan(last.action_values.values[range(3), last.observation]).all()
    _, unrecorded = run(replace(CONFIG, steps=1, evaluate_every=0))
    assert steps(unrecorded)[0].motion is None


def test_reference_is_yielded_once_before_the_first_evaluation() -> None:
    _, records = run(replace(CONFIG, steps=120))
    evaluations = [r for r in records if isinstance(r, Reference | Evaluated)]

    assert isinstance(evaluations[0], Reference)
    assert evaluations[0].greedy_distance_m == pytest.approx(24.833 * 0.02, abs=1e-4)
    assert [r.step for r in evaluations[1:] if isinstance(r, Evaluated)] == [50, 100, 120]
    assert isinstance(records[-1], Evaluated)


def test_the_baseline_walks_once_in_a_process_for_what_it_depends_on() -> None:
    config = replace(CONFIG, grid_side_m=0.0337, tolerance=0.0, steps=1, evaluate_every=1)
    noisy = replace(config, world=World((SensorNoise(sd_m=0.006),)))
    walks: list[World] = []

    def measured(config: TrainingConfig) -> float | None:
        learner = build_learner(config)
        baseline = learner.baseline

        def counted(world: World) -> Walker:
            walks.append(world)
            return baseline(world)

        learner.baseline = counted
        list(train(learner, config))
        return learner.greedy_distance_m

    assert measured(config) == measured(replace(config, seed=4, steps=2)) != 0
    assert len(walks) == 1
    assert measured(replace(config, grid_side_m=0.0338)) != measured(config)
    assert len(walks) == 2
    # Noise is of a seed, as is a robot that was built with a tolerance.
    assert measured(noisy) != measured(replace(noisy, seed=4))
    assert len(walks) == 4


@pytest.mark.test
@on_both
def test_evaluation_does_not_change_the_learner(simulator: SimulatorName) -> None:
    config = replace(CONFIG, simulator=simulator, robot=HASTY, steps=70)

    def learned(every: int) -> tuple[Any, ...]:
        *rest, (step, reward, _, epsilon) = everything(
            run(replace(config, evaluate_every=every))[0]
        )
        return (*rest, step, reward, epsilon)

    assert learned(7) == learned(0)
    assert learned(50) == learned(0)


def test_evaluation_is_independent_of_earlier_ones() -> None:
    def last(every: int) -> Evaluated:
        record = run(replace(CONFIG, evaluate_every=every))[1][-1]
        assert isinstance(record, Evaluated)
        return record

    assert last(7).distance_m == last(50).distance_m == last(200).distance_m


def test_evaluation_takes_fifty_steps_from_rest() -> None:
    learner = build_learner(CONFIG)
    evaluated = [r for r in train(learner, CONFIG, record=True) if isinstance(r, Evaluated)][-1]

    assert evaluated.motion is not None
    assert evaluated.motion.qpos.shape == (50 * 16, 25)
    assert evaluated.motion.time_s == pytest.approx(np.arange(1, 801) * 0.02, abs=1e-4)
    assert evaluated.motion.qpos[-1, 1] == pytest.approx(evaluated.distance_m, abs=1e-6)


@pytest.mark.test
@on_both
def test_the_same_config_and_seed_give_the_same_table(simulator: SimulatorName) -> None:
    config = replace(CONFIG, simulator=simulator, robot=HASTY, steps=60, evaluate_every=0)

    assert everything(run(config)[0]) == everything(run(config)[0])
    assert table_hash(run(config)[0]) != table_hash(run(replace(config, seed=4))[0])


@pytest.mark.test
def test_the_table_is_the_same_at_any_thread_count() -> None:
    config = replace(CONFIG, simulator="mujoco", robot=HASTY, steps=40, evaluate_every=40)
    runs = [run(config, threads) for threads in (1, 2, 4)]

    assert everything(runs[0][0]) == everything(runs[1][0]) == everything(runs[2][0])
    evaluations = [[r for r in records if isinstance(r, Evaluated)] for _, records in runs]
    assert evaluations[0] == evaluations[1] == evaluations[2]


@cache
def unbroken_run(simulator: SimulatorName) -> tuple[TrainingConfig, Learner, list[TrainingRecord]]:
    """Return a training's config, and what `run` gives for it."""
    config = replace(CONFIG, simulator=simulator, robot=HASTY, steps=90, evaluate_every=45)
    return config, *run(config)


@pytest.mark.test
@on_both
@pytest.mark.parametrize("broken_at", [13, 50, 77])
def test_training_resumed_from_a_checkpoint_equals_the_unbroken_run(
    simulator: SimulatorName, broken_at: int
) -> None:
    config, unbroken, records = unbroken_run(simulator)

    first = build_learner(config)
    for _ in train(first, config):
        if first.step == broken_at:
            break
    saved = to_bytes(snapshot(first, config))
    second = build_learner(config)
    restore(second, from_bytes(saved, "midway.npz"))
    assert everything(second) == everything(first)
    after = list(train(second, config))

    assert everything(second) == everything(unbroken)
    later_records = [r for r in records if isinstance(r, Reference) or r.step > broken_at]
    assert after == later_records[-len(after) :]


def test_pending_evaluation_is_repeated_after_resume() -> None:
    config = replace(CONFIG, steps=150, steps_per_episode=50, evaluate_every=50)
    unbroken, records = run(config)
    saved = []
    first = build_learner(config)
    evaluator = first.evaluator

    def saving(world: World, rng: np.random.Generator) -> Walker:
        saved.append(to_bytes(snapshot(first, config)))
        return evaluator(world, rng)

    first.evaluator = saving
    list(train(first, config))
    for number, data in enumerate(saved):
        second = build_learner(config)
        restore(second, from_bytes(data, "evaluating.npz"))
        after = list(train(second, config))
        assert everything(second) == everything(unbroken)
        assert [r for r in after if isinstance(r, Evaluated)] == [
            r for r in records if isinstance(r, Evaluated)
        ][number:]


def test_checkpoint_preserves_tuned_rates() -> None:
    config = replace(CONFIG, evaluate_every=0)
    first = build_learner(config)
    agent = first.walker.agent
    assert isinstance(agent, QLearning)
    for _ in train(first, replace(config, steps=100)):
        if first.step == 60:
            agent.tune(alpha=0.05, epsilon=0.4)
    second = build_learner(config)
    restore(second, from_bytes(to_bytes(snapshot(first, config)), "tuned.npz"))

    assert second.epsilon == 0.4
    assert [r.epsilon for r in train(second, config) if isinstance(r, StepTaken)] == [0.4] * 100


def test_continue_from_a_table_takes_values_visits_and_generator_only() -> None:
    first, _ = run(CONFIG)
    table = snapshot(first, CONFIG)
    onward = build_learner(
        replace(CONFIG, seed=99, settings=CONFIG.settings | {"alpha": 0.1}), table
    )
    agent, successor = first.walker.agent, onward.walker.agent
    assert isinstance(agent, QLearning)
    assert isinstance(successor, QLearning)

    # Values, visits and the learning generator go on …
    assert table_hash(onward) == table_hash(first)
    assert np.array_equal(successor.table.dump()["n"], agent.table.dump()["n"])
    assert seeding.dump(onward.rng) == seeding.dump(first.rng)
    # … ε restarts, rates are the new run's, the robot starts from rest.
    assert onward.epsilon == 1
    assert successor.state()["rates"][0] == 0.1
    assert onward.step == 0
    assert (onward.walker.state.distance_m, onward.walker.state.steps) == (0, 0)
    assert onward.walker.observed == (0, 0, 0)


def test_blocks_restart_the_schedule_and_keep_the_table() -> None:
    config = replace(CONFIG, steps=250, evaluate_every=0)
    table, visits, epsilons = None, [], []
    for _ in range(3):
        learner = build_learner(config, table)
        records = list(train(learner, config))
        epsilons.append([r.epsilon for r in records if isinstance(r, EpisodeEnded)])
        table = from_bytes(to_bytes(snapshot(learner, config)), "block.npz")
        visits.append(int(table.arrays["agent.n"].sum()))

    assert epsilons == [[1, 0.75, 0.5, 0.25, 0]] * 3
    assert visits == [250, 500, 750]


def test_blocks_draw_different_random_numbers() -> None:
    """The generator's state carries over, so the second block explores differently."""
    config = replace(CONFIG, evaluate_every=0, settings=CONFIG.settings | {"epsilon_end": 1.0})
    first, records = run(config)
    onward = build_learner(config, snapshot(first, config))
    again = list(train(onward, config))

    assert [s.action for s in steps(records)] != [s.action for s in steps(again)]


def test_result_has_distance_greedy_distance_and_hash() -> None:
    learner, records = run(CONFIG)
    result = training_result(learner, CONFIG)
    last = records[-1]

    assert isinstance(last, Evaluated)
    assert result == TrainingResult(
        distance_m=last.distance_m,
        greedy_distance_m=learner.greedy_distance_m,
        q_table_sha256=table_hash(learner),
        fell_at_step=None,
        best_known_m=None,
    )


def test_result_takes_over_the_last_evaluation_to_the_bit() -> None:
    learner, records = run(CONFIG)
    last = records[-1]

    assert isinstance(last, Evaluated)
    assert training_result(learner, CONFIG, evaluated=last) == training_result(learner, CONFIG)
    other = replace(last, distance_m=-1.0)
    assert training_result(learner, CONFIG, evaluated=other).distance_m == -1


def test_result_is_the_same_without_evaluations() -> None:
    quiet = replace(CONFIG, evaluate_every=0)

    assert training_result(run(quiet)[0], quiet) == training_result(run(CONFIG)[0], CONFIG)


def test_user_supplied_agent_trains_and_resumes() -> None:
    config = replace(
        CONFIG, agent="tests.own_agents:Restless", settings=SettingValues({}), steps=40
    )
    learner, _ = run(config)
    state = learner.walker.agent.state()
    onward = build_learner(config, from_bytes(to_bytes(snapshot(learner, config)), "own.npz"))

    assert float(state["earned_m"][0]) == pytest.approx(learner.walker.state.distance_m)
    assert onward.walker.agent.state() == state
    assert training_result(learner, config).q_table_sha256 is None


def test_illegal_action_raises_an_error_that_names_agent_and_action() -> None:
    with pytest.raises(IllegalAction, match=r"Cheat chose Action\(group=0, cell=0\).*in legal"):
        run(replace(CONFIG, agent="tests.own_agents:Cheat", settings=SettingValues({})))


EVENTFUL = training_config(
    gait="left-right-origin",
    robot=HASTY,
    steps=30,
    evaluate_every=20,
    seed=3,
    world=World(
        (Limp(legs=(1, 4), at_step=10), SensorNoise(sd_m=0.004), Slope(degrees=5, at_step=20))
    ),
)


@pytest.mark.promises
def test_the_robot_is_evaluated_where_the_world_changes_and_greedy_in_each_world() -> None:
    learner, records = run(EVENTFUL)
    evaluated = [record.step for record in records if isinstance(record, Evaluated)]
    references = [r.greedy_distance_m for r in records if isinstance(r, Reference)]

    assert evaluated == [10, 20, 30]
    assert len(references) == len(set(references)) == 2
    assert training_result(learner, EVENTFUL).greedy_distance_m == references[-1]


@pytest.mark.test
def test_a_disturbed_training_resumes_to_the_last_bit() -> None:
    unbroken, records = run(EVENTFUL)
    for step in (9, 10, 21):
        first = build_learner(EVENTFUL)
        for record in train(first, EVENTFUL):
            if isinstance(record, StepTaken) and record.step == step:
                break
        second = build_learner(EVENTFUL)
        restore(second, from_bytes(to_bytes(snapshot(first, EVENTFUL)), "it.npz"))
        after = list(train(second, EVENTFUL))

        assert everything(second) == everything(unbroken)
        distances = [r.distance_m for r in records if isinstance(r, StepTaken)]
        assert [r.distance_m for r in after if isinstance(r, StepTaken)] == distances[step:]


@pytest.mark.test
def test_what_happens_while_it_runs_equals_what_was_planned() -> None:
    """But for an evaluation in the new world, which changes nothing."""
    planned = replace(EVENTFUL, world=World((Limp(legs=(1, 4), at_step=7),)))
    calm = replace(planned, world=World())
    live = build_learner(calm)
    live_records = []
    for record in train(live, calm):
        live_records.append(record)
        if isinstance(record, StepTaken) and record.step == 7:
            live.disturb(Limp(legs=(1, 4)), calm)
    expected, records = run(planned)

    assert live.world == planned.world
    assert everything(live) == everything(expected)
    for kind in (StepTaken, Evaluated):
        of_both = [[r for r in some if isinstance(r, kind)] for some in (live_records, records)]
        assert [r.distance_m for r in of_both[0]] == [r.distance_m for r in of_both[1]]
        assert [r.epsilon for r in of_both[0]] == [r.epsilon for r in of_both[1]]


def test_noise_that_begins_while_it_runs_spoils_no_chosen_action() -> None:
    """An on-policy agent has chosen its next action by what it measured before."""
    gait = "left-right-origin"
    config = training_config(gait=gait, simulator="kinematic", agent="sarsa", steps=60)
    for seed in range(6):
        unbroken, saved = build_learner(replace(config, seed=seed)), None
        for record in train(unbroken, replace(config, seed=seed)):
            if isinstance(record, StepTaken) and record.step == 20:
                unbroken.disturb(SensorNoise(sd_m=0.03), config)
                saved = to_bytes(snapshot(unbroken, replace(config, seed=seed)))
        assert saved is not None
        resumed = build_learner(replace(config, seed=seed))
        restore(resumed, from_bytes(saved, "it.npz"))
        list(train(resumed, replace(config, seed=seed)))
        assert resumed.walker.state == unbroken.walker.state


def test_a_disturbance_needs_a_step_to_happen_in() -> None:
    learner, _ = run(replace(CONFIG, steps=3))
    with pytest.raises(InvalidInput, match="at_step must be from 0 to 2"):
        learner.disturb(SensorNoise(sd_m=0.001), replace(CONFIG, steps=3))
