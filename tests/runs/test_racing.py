"""Race loop: lanes are independent, and a failing lane does not affect the others."""

from collections.abc import Callable
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest

from app.assembly import build_walkers
from app.domain.simulator import WalkState
from app.physics.mujoco_simulator import MujocoState
from app.runs.config import LaneConfig, RaceConfig
from app.runs.racing import race, record_race
from app.runs.records import LaneFailed, LaneStep, RaceRecord
from app.runs.results import race_result


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


def run(asked: RaceConfig) -> list[RaceRecord]:
    walkers = build_walkers(asked, [None] * len(asked.lanes), threads=1)
    return list(race(walkers, asked.steps, ticking()))


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


def test_a_lane_is_independent_of_the_other_lanes() -> None:
    alone = of_lane(run(config("greedy", simulator="mujoco", steps=3)), 0)
    beside = of_lane(run(config("greedy", "greedy", "two-step", simulator="mujoco", steps=3)), 0)

    for one, other in zip(alone, beside, strict=True):
        assert isinstance(one, LaneStep)
        assert isinstance(other, LaneStep)
        assert one.motion.qpos.tobytes() == other.motion.qpos.tobytes()
        assert (one.action, one.reward_m) == (other.action, other.reward_m)


def test_decision_time_does_not_affect_motion() -> None:
    asked = config("greedy", "two-step")
    slow, quick = (
        list(race(build_walkers(asked, [None, None]), asked.steps, ticking(tick)))
        for tick in (100.0, 0.001)
    )

    for one, other in zip(slow, quick, strict=True):
        assert isinstance(one, LaneStep)
        assert isinstance(other, LaneStep)
        assert one.decision_s != other.decision_s
        assert one.motion.qpos.tobytes() == other.motion.qpos.tobytes()


def test_lanes_of_the_same_agent_have_independent_generators() -> None:
    records = run(config("tests.own_agents:Restless", "tests.own_agents:Restless", steps=8))
    one, other = (
        [r.action for r in of_lane(records, n) if isinstance(r, LaneStep)] for n in (0, 1)
    )

    assert one != other


def test_race_is_deterministic() -> None:
    asked = config("tests.own_agents:Restless", "greedy", seed=3, simulator="mujoco", steps=3)

    def bits() -> list[bytes]:
        return [r.motion.qpos.tobytes() for r in run(asked) if isinstance(r, LaneStep)]

    assert len(bits()) == 6
    assert bits() == bits()


@pytest.mark.parametrize(
    ("agent", "step", "reason"),
    [
        ("tests.own_agents:Clumsy", 3, "its agent failed: RuntimeError: I tripped"),
        (
            "tests.own_agents:Cheat",
            1,
            "Cheat chose Action(pair=0, cell=0), which is not a legal",
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
    asked = config(agent, "greedy", simulator="mujoco", steps=4)
    walkers = build_walkers(asked, [None, None], threads=1)
    records = []
    for record in race(walkers, asked.steps, ticking()):
        records.append(record)
        if (record.lane, record.step) == (0, 2):
            walkers[0].place(with_a_broken_joint(walkers[0].state))
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


def test_recording_has_every_step_and_the_reason_of_a_failure() -> None:
    asked = config("tests.own_agents:Clumsy", "greedy", steps=3)
    walkers = build_walkers(asked, [None, None])
    grown = [
        [len(lane.steps) for lane in lanes] for lanes in record_race(walkers, asked, ticking())
    ]
    *_, lanes = record_race(build_walkers(asked, [None, None]), asked, ticking())

    assert grown == [[1, 0], [1, 1], [2, 1], [2, 2], [2, 2], [2, 3]]
    assert lanes[0].failure == "its agent failed: RuntimeError: I tripped"
    assert lanes[1].failure is None
    assert [lane.agent for lane in lanes] == ["tests.own_agents:Clumsy", "greedy"]


def test_paper_clock_ends_three_lanes_after_16_22_and_91_seconds() -> None:
    """At 0.32 s per motion; decisions without look-ahead take no time."""
    asked = config("tests.own_agents:Restless", "greedy", "two-step", steps=50)
    *_, lanes = record_race(build_walkers(asked, [None] * 3), asked, ticking())
    result = race_result(lanes, 50)["lanes"]
    paper = [lane["clocks"]["paper"] for lane in result]

    assert [round(lane["elapsed_s"]) for lane in paper] == [16, 22, 91]
    assert [lane["elapsed_s"] for lane in paper] == pytest.approx(
        [50 * 0.32, 50 * 0.32 * 1.36, 50 * 0.32 * 5.68]
    )
    assert [lane["simulated_transitions"] for lane in result] == [0, 600, 7_800]
    # When the first lane is done greedy has about 74 % of its way, two-step 18 %.
    shares = [
        p["finished_distance_m"] / lane["total_distance_m"]
        for p, lane in zip(paper, result, strict=True)
    ]
    assert shares[1] == pytest.approx(1 / 1.36, abs=0.02)
    assert shares[2] == pytest.approx(1 / 5.68, abs=0.03)
