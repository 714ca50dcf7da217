"""Compare the gain of each step of a recorded walk with that of the best legal move."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from hexapods.domain.errors import HexapodError
from hexapods.domain.observation import Observation, legal_in
from hexapods.domain.simulator import Simulator
from hexapods.domain.types import Action, Cells
from hexapods.runs.walker import Sensors


class NotRepeated(HexapodError):
    """A recorded walk cannot be simulated again: another robot would walk."""


class ComparedMove(NamedTuple):
    """The move of a step beside the best one in the state that it was made in.

    Attributes:
        observation: the state, as the agent observed it.
        action: the move that was made.
        reward_m: what it brought [m].
        best: the legal move that brings most in this one step, by the simulator.
        best_reward_m: what that brings [m]; what was made brought it if nothing brings more.
    """

    observation: Cells
    action: Action
    reward_m: float
    best: Action
    best_reward_m: float


def compare_moves(
    simulator: Simulator[Any],
    sensors: Sensors,
    observation: Observation,
    walked: Sequence[tuple[Cells, Action]],
) -> list[ComparedMove]:
    """Walk a recorded walk again, and simulate all legal moves in each of its states.

    Args:
        simulator: the robot and the world of the walk.
        sensors: of this robot, with the errors of the walk.
        observation: how the agent observed its state.
        walked: observation and move of each step, from rest.

    Raises:
        NotRepeated: if the robot does not come into the states that were observed.
        Diverged: if the physics diverges.
    """
    state = simulator.rest()
    compared = []
    for number, (recorded, action) in enumerate(walked, start=1):
        sensors.at(state)
        cells = sensors(observation)
        legal = legal_in(simulator, state, cells)
        if cells != recorded or action not in legal:
            raise NotRepeated(
                f"step {number} cannot be walked again: the robot observed {tuple(recorded)} there "
                f"and now observes {tuple(cells)}; another processor, NumPy or MuJoCo computed it"
            )
        rewards_m = simulator.expand([state] * len(legal), legal).rewards_m
        step = simulator.step(state, action)
        best = int(np.argmax(rewards_m))
        # A push is in the step, and in no expansion.
        is_made = step.reward_m >= rewards_m[best]
        compared.append(
            ComparedMove(
                *(cells, action, step.reward_m),
                action if is_made else legal[best],
                step.reward_m if is_made else float(rewards_m[best]),
            )
        )
        state = step.state
    return compared
