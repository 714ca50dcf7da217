"""A recorded walk is walked again, and the best move in each of its states is told."""

import pytest

from hexapods.assembly import build_simulator, build_walkers, sensor_noise
from hexapods.domain.world import parse_world
from hexapods.runs.lane import LaneConfig
from hexapods.runs.move_comparison import ComparedMove, NotRepeated, compare_moves
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.recording import LaneRecording
from hexapods.runs.seeding import RACING
from hexapods.runs.walker import Sensors


def race_of(*agents: str, world: str = "flat", steps: int = 12) -> RaceConfig:
    lanes = tuple(LaneConfig(agent=agent, observation="measured") for agent in agents)
    return RaceConfig(
        gait="left-right-origin",
        simulator="kinematic",
        world=parse_world(world),
        lanes=lanes,
        steps=steps,
        seed=4,
    )


def walked(race: RaceConfig) -> list[LaneRecording]:
    *_, lanes = record_race(build_walkers(race, [None] * len(race.lanes)), race, lambda: 0.0)
    return lanes


def compared(race: RaceConfig, lane: LaneRecording, number: int = 0) -> list[ComparedMove]:
    simulator = build_simulator(race)
    sensors = Sensors(simulator, sensor_noise(race.seed, RACING, number))
    return compare_moves(simulator, sensors, "measured", lane.steps.choices(race.steps))


def test_greedy_makes_the_best_move_of_each_state() -> None:
    race = race_of("greedy")
    (lane,) = walked(race)
    moves = compared(race, lane)

    assert [move.reward_m for move in moves] == lane.steps.figures["reward_m"].tolist()
    assert all(move.best == move.action for move in moves)
    assert all(move.best_reward_m == move.reward_m for move in moves)


def test_of_random_steps_most_bring_less_than_they_could() -> None:
    race = race_of("random-walk")
    (lane,) = walked(race)
    moves = compared(race, lane)

    assert all(move.best_reward_m >= move.reward_m for move in moves)
    assert sum(move.best_reward_m > move.reward_m + 0.001 for move in moves) > 6  # of 12


def test_noisy_sensors_say_the_same_again() -> None:
    race = race_of("two-step", "greedy", world="noise")
    lanes = walked(race)
    moves = compared(race, lanes[1], 1)

    assert [move.observation for move in moves] == [
        tuple(cells) for cells in lanes[1].steps.figures["observation"].tolist()
    ]


def test_a_walk_that_the_robot_does_not_repeat_is_refused() -> None:
    race = race_of("greedy")
    (lane,) = walked(race)
    (cells, action), *rest = lane.steps.choices(race.steps)
    simulator = build_simulator(race)

    with pytest.raises(NotRepeated, match="step 2 cannot be walked again"):
        compare_moves(simulator, Sensors(simulator), "measured", [(cells, action), *rest[1:]])
