"""An open-loop tripod walks beside greedy: sines of time, no observation, no learning, no search.

    python open_loop_tripod.py
    python open_loop_tripod.py --amplitude 0.03 --frequency 2 --seconds 5

It is the robot of the MuJoCo figures, with the servos, masses and friction of every race. Its feet
go back and forth as sines, two groups of three in turn, and rise while they go forward. Greedy's 50
steps take 16 s, in which each step puts one pair of feet into another cell and waits until the body
has followed: that pace is fixed by the grid and by the time of a step, not by who chooses the step.
"""

import argparse
from typing import NamedTuple

import mujoco
import numpy as np

from hexapods.assembly import build_walkers
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import robot
from hexapods.physics.mjcf import compile_model
from hexapods.physics.mujoco_simulator import MujocoSimulator
from hexapods.runs.clocks import Timetable
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race

TRIPOD = (0, 1, 0, 1, 0, 1)
"""Group of each leg: neighbours are in different ones."""


class Walk(NamedTuple):
    """A walk of a robot."""

    distance_m: float
    seconds: float


def open_loop(
    amplitude_m: float = 0.02, frequency_hz: float = 1.6, lift_m: float = 0.03, seconds: float = 16
) -> Walk:
    """Walk by sines of time.

    Args:
        amplitude_m: how far each foot goes forward and back from its home.
        frequency_hz: how often.
        lift_m: how high it rises on its way forward.
        seconds: for how long.

    Raises:
        ValueError: if a foot would be out of reach.
    """
    race = _race()
    body = robot("stiff")
    simulator = MujocoSimulator(body, race.resolved_gait, race.grid)
    feet = legs_of(body).under(race.resolved_gait)
    model = compile_model(body)
    data = mujoco.MjData(model)
    data.qpos[:] = simulator.pose(simulator.rest())
    times = np.arange(round(seconds / model.opt.timestep)) * model.opt.timestep
    phases = 2 * np.pi * frequency_hz * times[:, None] + np.pi * np.array(TRIPOD)
    # From rest to the full stride within one cycle, so that no foot jumps.
    growth = np.minimum(1, frequency_hz * times)[:, None]
    offsets = np.stack(
        [
            np.zeros_like(phases),
            growth * amplitude_m * np.sin(phases),
            growth * lift_m * np.maximum(0, np.cos(phases)),
        ],
        axis=-1,
    )
    targets = feet.joint_angles(offsets)
    if np.isnan(targets).any():
        raise ValueError("a foot is out of reach; choose a smaller amplitude or lift")
    start_m = float(data.qpos[1])
    for target in targets:
        data.ctrl[:] = target
        mujoco.mj_step(model, data)
    return Walk(float(data.qpos[1]) - start_m, seconds)


def greedy(steps: int = 50) -> Walk:
    """Walk as greedy does, which simulates every next step and takes the farthest."""
    race = _race(steps)
    *_, (lane,) = record_race(build_walkers(race, [None], threads=1), race, lambda: 0.0)
    return Walk(lane.distance_m, Timetable.of(lane.steps, "free").total_s)


def _race(steps: int = 50) -> RaceConfig:
    return RaceConfig(gait="left-right-origin", lanes=(LaneConfig(agent="greedy"),), steps=steps)


def main() -> None:
    """Print both walks."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--amplitude", type=float, default=0.02, help="of each foot [m]")
    parser.add_argument("--frequency", type=float, default=1.6, help="cycles a second")
    parser.add_argument("--lift", type=float, default=0.03, help="of each foot [m]")
    parser.add_argument("--seconds", type=float, default=16.0, help="for how long it walks")
    chosen = parser.parse_args()
    walks = {
        "open-loop tripod": open_loop(
            chosen.amplitude, chosen.frequency, chosen.lift, chosen.seconds
        ),
        "greedy, 50 steps": greedy(),
    }
    for name, walk in walks.items():
        print(f"{name}: {walk.distance_m:.2f} m in {walk.seconds:.1f} s")


if __name__ == "__main__":
    main()
