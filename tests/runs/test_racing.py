"""Race loop: lanes are independent, and a failing lane does not affect the others."""

from collections.abc import Callable
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest

from hexapods.agents.protocol import Transition
from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.disturbances import Limp, SensorNoise
from hexapods.domain.simulator import WalkState
from hexapods.domain.world import World
from hexapods.physics.mujoco_simulator import MujocoState
from hexapods.runs.config import training_config
from hexapods.runs.lane import LaneConfig, lane_config
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.racing import race, record_race
from hexapods.runs.recording import recording_sha256
from hexapods.runs.records import LaneFailed, LaneStep, RaceRecord, StepTaken
from hexapods.runs.results import race_result
from hexapods.runs.seeding import RACING, generator
from hexapods.runs.tables import snapshot, to_bytes
from hexapods.runs.training import train
from hexapods.runs.walker import SearchInterrupted
from tests.own_agents import Restless


def ticking(tick_s: float = 1.0) -> Callable[[], float]:
    """Fake timer that advances by a tick at each call."""
    ticks = count()
    return lambda: next(ticks) * tick_s


def config(*agents: str, steps: int = 5, seed: int = 0, simulator: Any = "kinematic") -> RaceConfig:
    return RaceConfig(
        gait="left-right-origin",
        simulator=simulator,
        steps=steps,
        seed=seed,
        lanes=tuple(LaneConfig(agent=agent) for agent in agents),
    )


def run(race_config: RaceConfig) -> list[RaceRecord]:
    walkers = build_walkers(race_config, [None] * len(race_config.lanes), threads=1)
    return list(race(walkers, race_config.steps, ticking()))


def of_lane(records: list[RaceRecord], lane: int) -> list[RaceRecord]:
    return [r for r in records if r.lane == lane]


def test_lanes_take_steps_round_robin() -> None:
    records = run(config("greedy", "two-step", steps=4))

    assert [(r.lane, r.step) for r in records] == [(n % 2, 1 + n // 2) for n in range(8)]
    assert all(isinstance(r, LaneStep) for r in records)


def test_step_records_observation_action_and_reward() -> None:
    records = of_lane(run(config("greedy")), 0)
    total = 0.0
    for record in records:
        assert isinstance(record, LaneStep)
        total += record.reward_m
        assert record.distance_m == pytest.approx(total)
        assert record.transitions == 12
        assert record.decision_s == 1  # one tick
        assert record.motion.qpos[-1, 1] == pytest.approx(total, abs=1e-6)
    first = records[0]
    assert isinstance(first, LaneStep)
    assert (first.observation, first.action) == ((0, 0, 0), (0, 1))


@pytest.mark.test
def test_a_lane_is_independent_of_the_other_lanes() -> None:
    alone = of_lane(run(config("greedy", simulator="mujoco", steps=3)), 0)
    with_others = of_lane(
        run(config("greedy", "greedy", "two-step", simulator="mujoco", steps=3)), 0
    )

    for step, same_step in zip(alone, with_others, strict=True):
        assert isinstance(step, LaneStep)
        assert isinstance(same_step, LaneStep)
        assert step.motion.qpos.tobytes() == same_step.motion.qpos.tobytes()
        assert (step.action, step.reward_m) == (same_step.action, same_step.reward_m)


def test_decision_time_does_not_affect_motion() -> None:
    race_config = config("greedy", "two-step")
    slow, quick = (
        list(race(build_walkers(race_config, [None, None]), race_config.steps, ticking(tick)))
        for tick in (100.0, 0.001)
    )

    for slow_step, quick_step in zip(slow, quick, strict=True):
        assert isinstance(slow_step, LaneStep)
        assert isinstance(quick_step, LaneStep)
        assert slow_step.decision_s != quick_step.decision_s
        assert slow_step.motion.qpos.tobytes() == quick_step.motion.qpos.tobytes()


def test_lanes_of_the_same_agent_have_independent_generators() -> None:
    records = run(config("tests.own_agents:Restless", "tests.own_agents:Restless", steps=8))
    first_actions, second_actions = (
        [r.action for r in of_lane(records, n) if isinstance(r, LaneStep)] for n in (0, 1)
    )

    assert first_actions != second_actions


@pytest.mark.test
def test_race_is_deterministic() -> None:
    race_config = config("tests.own_agents:Restless", "greedy", seed=3, simulator="mujoco", steps=3)

    def bits() -> list[bytes]:
        return [r.motion.qpos.tobytes() for r in run(race_config) if isinstance(r, LaneStep)]

    assert len(bits()) == 6
    assert bits() == bits()


@pytest.mark.parametrize(
    ("agent", "step", "reason"),
    [
        ("tests.own_agents:Clumsy", 3, "its agent failed: RuntimeError: I tripped"),
        (
            "tests.own_agents:Cheat",
            1,
            "Cheat chose Action(group=0, cell=0), which is not a legal",
        ),
    ],
)
def test_failing_agent_ends_its_own_lane_only(agent: str, step: int, reason: str) -> None:
    records = run(config(agent, "greedy"))
    *before, failed = of_lane(records, 0)

    assert len(before) == step - 1
    assert isinstance(failed, LaneFailed)
    assert failed.step == step
    assert failed.reason.startswith(reason)
    assert len(of_lane(records, 1)) == 5


@pytest.mark.parametrize("agent", ["tests.own_agents:Restless", "greedy"])
def test_diverging_physics_ends_the_lane_and_names_the_step(agent: str) -> None:
    """Both in the step itself and in look-ahead, where the agent is not at fault."""
    race_config = config(agent, "greedy", simulator="mujoco", steps=4)
    walkers = build_walkers(race_config, [None, None], threads=1)
    records = []
    for record in race(walkers, race_config.steps, ticking()):
        records.append(record)
        if (record.lane, record.step) == (0, 2):
            walkers[0].set_state(with_a_broken_joint(walkers[0].state))
    failed = of_lane(records, 0)[-1]

    assert isinstance(failed, LaneFailed)
    assert failed.step == 3
    assert failed.reason.startswith("the physics diverged at step 3; try a smaller robot.dt_s")
    assert len(of_lane(records, 1)) == 4


def with_a_broken_joint(state: WalkState) -> MujocoState:
    assert isinstance(state, MujocoState)
    row = state.row.copy()
    row[9] = np.nan
    return replace(state, row=row)


@pytest.mark.parametrize("agent", ["q-learning", "sarsa-lambda"])
def test_lane_that_keeps_learning_learns_as_a_training_does(agent: str) -> None:
    """Without practice: the same settings, steps and generator give the same steps and values."""
    lane = lane_config(agent, keep_learning=True, alpha=0.5, epsilon_start=0.3)
    race_config = replace(
        config("greedy", steps=60, seed=5), lanes=(LaneConfig(agent="greedy"), lane)
    )
    raced = [r for r in of_lane(run(race_config), 1) if isinstance(r, LaneStep)]
    practice = training_config(
        agent,
        gait=race_config.gait,
        simulator="kinematic",
        steps=60,
        evaluate_every=0,
        **lane.settings,
    )
    learner = build_learner(practice)
    learner.rng.bit_generator.state = generator(5, RACING, 1).bit_generator.state
    trained = [r for r in train(learner, practice, record=True) if isinstance(r, StepTaken)]

    for raced_step, trained_step in zip(raced, trained, strict=True):
        assert (raced_step.observation, raced_step.action, raced_step.reward_m) == (
            trained_step.observation,
            trained_step.action,
            trained_step.reward_m,
        )
        assert raced_step.action_values is not None
        assert trained_step.action_values is not None
        np.testing.assert_array_equal(
            raced_step.action_values.values, trained_step.action_values.values
        )


def test_race_does_not_change_the_table_that_its_lanes_learn_from() -> None:
    practice = training_config(
        gait="left-right-origin", simulator="kinematic", steps=100, evaluate_every=0
    )
    learner = build_learner(practice)
    for _ in train(learner, practice):
        pass
    table = snapshot(learner, practice)
    before = to_bytes(table)
    lanes = tuple(
        lane_config("q-learning", keep_learning=learns, has_training=True)
        for learns in (True, False)
    )
    race_config = replace(config("greedy", steps=20), lanes=lanes)
    walkers = build_walkers(race_config, [table, table])
    records = list(race(walkers, 20, ticking()))

    assert to_bytes(table) == before
    visits = [walker.agent.state()["n"].sum() for walker in walkers]
    assert visits == [119, 100]  # after the last step nothing is left to decide
    assert not any(isinstance(record, LaneFailed) for record in records)


def test_learning_belongs_to_the_next_decision() -> None:
    lane = lane_config("q-learning", keep_learning=True)
    records = run(replace(config("greedy", steps=3), lanes=(lane,)))

    assert [r.decision_s for r in records if isinstance(r, LaneStep)] == [1, 2, 2]  # ticks


def test_agent_that_fails_to_learn_ends_its_own_lane_only() -> None:
    lane = lane_config(f"{__name__}:Unteachable", keep_learning=True)
    race_config = replace(config("greedy", steps=3), lanes=(lane, LaneConfig(agent="greedy")))
    records = run(race_config)

    _, failed = of_lane(records, 0)
    assert isinstance(failed, LaneFailed)
    assert (failed.step, failed.reason) == (2, "its agent failed: RuntimeError: too hard")
    assert len(of_lane(records, 1)) == 3


def test_decision_may_be_interrupted_and_is_no_failure() -> None:
    walkers = build_walkers(config("greedy", "two-step", steps=3), [None, None])
    records = race(walkers, 3, ticking())
    assert [next(records).lane, next(records).lane] == [0, 1]

    def interrupt() -> None:
        raise SearchInterrupted

    for walker in walkers:
        walker.interrupt_by(interrupt)
    with pytest.raises(SearchInterrupted):
        next(records)


@pytest.mark.test
@pytest.mark.parametrize("threads", [1, 2, 4])
def test_branch_takes_the_same_steps_to_the_last_bit_until_something_happens(threads: int) -> None:
    """The original is on one thread; the robot draws its noise, its build and its learner anew."""
    lanes = (
        lane_config("greedy"),
        lane_config("mcts", budget=20),
        lane_config("q-learning", keep_learning=True),
        lane_config("informed", budget=3, plans_with="world"),
    )
    original = RaceConfig(
        gait="left-right-vertical",
        lanes=lanes,
        steps=6,
        seed=2,
        tolerance=0.03,
        world=World((SensorNoise(sd_m=0.004),)),
    )
    world = original.world.then(Limp(legs=(1, 4), at_step=4))
    branch = replace(original, world=world, branch_from=Branch("abc", 4))

    def walks(race_config: RaceConfig, threads: int) -> list[list[tuple[Any, ...]]]:
        walkers = build_walkers(race_config, [None] * len(lanes), threads=threads)
        *_, recorded = record_race(walkers, race_config, ticking())
        return [
            [(s.action, s.reward_m, s.motion.qpos.tobytes()) for s in lane.steps]
            for lane in recorded
        ]

    before, after = walks(original, 1), walks(branch, threads)
    for was, now in zip(before, after, strict=True):
        assert now[:4] == was[:4]
        assert now[4:] != was[4:]


@pytest.mark.promises
def test_a_branch_does_not_search_again_for_the_steps_it_shares() -> None:
    lanes = (
        lane_config("two-step"),
        lane_config("beam", width=4),
        lane_config("mcts", budget=20),
        lane_config("q-learning", keep_learning=True),
        lane_config("informed", budget=3),
    )
    original = RaceConfig(gait="left-right-vertical", lanes=lanes, steps=4, seed=2, tolerance=0.03)
    limp = original.world.then(Limp(legs=(1, 4), at_step=3))
    branch = replace(original, world=limp, branch_from=Branch("abc", 3))

    def recorded(prefix: list[list[LaneStep]], tick_s: float) -> tuple[list[int], list[Any]]:
        walkers = build_walkers(branch, [None] * len(lanes), threads=1)
        *_, recording = record_race(walkers, branch, ticking(tick_s), prefix)
        return [walker.transitions for walker in walkers], recording

    *_, first = record_race(build_walkers(original, [None] * len(lanes)), original, ticking())
    prefix = [lane.steps[:3] for lane in first]
    searched, whole = recorded([], 2.0)
    searched_with_prefix, with_prefix = recorded(prefix, 2.0)

    assert recording_sha256(with_prefix) == recording_sha256(whole)
    assert searched_with_prefix[0] == searched[0] / 4 == 156
    assert searched_with_prefix[1] == searched[1] / 4
    assert searched_with_prefix[2:] == searched[2:], "what remembers something decides again"
    for lane, shared in zip(with_prefix[:2], prefix[:2], strict=True):
        decisions = [step.decision_s for step in lane.steps]
        assert decisions == [*(step.decision_s for step in shared), 2.0]
        assert [step.futures for step in lane.steps[:3]] == [step.futures for step in shared]


def test_a_lane_whose_steps_do_not_repeat_decides_by_itself_and_is_named(
    caplog: pytest.LogCaptureFixture,
) -> None:
    race_config = config("greedy", steps=4)
    steps = [record for record in run(race_config) if isinstance(record, LaneStep)]
    other_machine = [steps[0], replace(steps[1], reward_m=steps[1].reward_m + 1e-16), steps[2]]
    walkers = build_walkers(race_config, [None], threads=1)

    again = list(race(walkers, race_config.steps, ticking(), [other_machine]))

    assert [step.action for step in again if isinstance(step, LaneStep)] == [
        step.action for step in steps
    ]
    assert walkers[0].transitions == 3 * 12, "the first step alone is taken over"
    assert "lane 1 differs from step 2 on" in caplog.text


class Unteachable(Restless):
    """Breaks when it should learn."""

    def learn(self, transition: Transition) -> None:
        raise RuntimeError("too hard")


def test_recording_has_every_step_and_the_reason_of_a_failure() -> None:
    race_config = config("tests.own_agents:Clumsy", "greedy", steps=3)
    walkers = build_walkers(race_config, [None, None])
    grown = [
        [len(lane.steps) for lane in lanes]
        for lanes in record_race(walkers, race_config, ticking())
    ]
    *_, lanes = record_race(build_walkers(race_config, [None, None]), race_config, ticking())

    assert grown == [[1, 0], [1, 1], [2, 1], [2, 2], [2, 2], [2, 3]]
    assert lanes[0].failure == "its agent failed: RuntimeError: I tripped"
    assert lanes[1].failure is None
    assert [lane.agent for lane in lanes] == ["tests.own_agents:Clumsy", "greedy"]


def test_paper_clock_ends_three_lanes_after_16_22_and_91_seconds() -> None:
    """At 0.32 s per motion; decisions without look-ahead take no time."""
    race_config = config("tests.own_agents:Restless", "greedy", "two-step", steps=50)
    *_, lanes = record_race(build_walkers(race_config, [None] * 3), race_config, ticking())
    result = race_result(lanes, race_config).lanes
    paper = [lane.clocks.paper for lane in result]

    assert [round(lane.elapsed_s) for lane in paper] == [16, 22, 91]
    assert [lane.elapsed_s for lane in paper] == pytest.approx(
        [50 * 0.32, 50 * 0.32 * 1.36, 50 * 0.32 * 5.68]
    )
    assert [lane.simulated_transitions for lane in result] == [0, 600, 7_800]
    # When the first lane is done greedy has about 74 % of its way, two-step 18 %.
    shares = [
        (p.finished_distance_m or 0) / (lane.total_distance_m or 0)
        for p, lane in zip(paper, result, strict=True)
    ]
    assert shares[1] == pytest.approx(1 / 1.36, abs=0.02)
    assert shares[2] == pytest.approx(1 / 5.68, abs=0.03)
