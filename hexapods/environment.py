"""The walking problem as a Gymnasium environment, for learners outside this product.

`import hexapods` registers it; the package `gymnasium` comes with `racing-hexapods[gym]`:

    import hexapods
    walk = gymnasium.make("RacingHexapods/Walk-v0", gait="left-right-origin")

`gymnasium.make("hexapods:RacingHexapods/Walk-v0")` does both.
"""

from collections.abc import Mapping, Sequence
from typing import Any, SupportsInt

import gymnasium
import numpy as np
from gymnasium import spaces

from hexapods.assembly import build_simulator
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GaitSpec
from hexapods.domain.observation import Observation, check_observation, legal_in, observe
from hexapods.domain.robot import Robot
from hexapods.domain.robot import robot as read_robot
from hexapods.domain.simulator import WalkState
from hexapods.domain.types import Action, IntArray
from hexapods.runs.config import RACE_STEPS, SimulatorName, WalkingProblem

WALK_ID = "RacingHexapods/Walk-v0"


class WalkEnv(gymnasium.Env[IntArray, SupportsInt]):
    """Gymnasium environment of a walking hexapod, with the rewards of a training.

    - Observation: `MultiDiscrete`, the observed cell of the foot grid of each group of legs.
    - Action: `Discrete`, group × cells + cell: move that group to that cell. `info["action_mask"]`
      marks the legal actions, as `action_space.sample(mask)` expects. Sending a group to its
      observed cell is illegal in the walking problem: it is carried out as a no-op with reward 0,
      which counts as a step.
    - Reward: displacement of the torso's centre in the robot's forward direction [m], as the
      simulator measures it.
    - `info["distance_m"]`: displacement along the track since the start.
    - An episode starts from rest and never terminates: `gymnasium.make` truncates it after 50
      steps, the length of a race, or after `max_episode_steps`.

    The environment is deterministic: every seed gives the same episodes. It has no render mode;
    use the stage of `hexapods serve`.
    """

    def __init__(
        self,
        *,
        gait: str | GaitSpec = "left-right-origin",
        robot: str | Mapping[str, Any] | Robot = "stiff",
        simulator: SimulatorName = "mujoco",
        divisions: int = 2,
        grid_side_m: float = 0.04,
        observation: Observation = "measured",
    ) -> None:
        """Build the robot and put it at rest.

        Args:
            gait: a name, or a specification of orientation and groups of legs.
            robot: a preset's name, or overrides of one.
            simulator: `mujoco` or `kinematic`.
            divisions: points along a side of the foot grid.
            grid_side_m: side length of the foot grid.
            observation: `measured`, `commanded` or `planned`, how the state is read.

        Raises:
            InvalidInput: if a value is invalid; the message names the valid ones.
        """
        check_observation(observation)
        walk = WalkingProblem(
            gait=gait,
            robot=read_robot(robot),
            simulator=simulator,
            divisions=divisions,
            grid_side_m=grid_side_m,
        )
        self._simulator = build_simulator(walk)
        self._observation = observation
        self._state: WalkState = self._simulator.rest()
        self._cells, groups = len(walk.grid), len(walk.resolved_gait.groups)
        self.observation_space = spaces.MultiDiscrete([self._cells] * groups)
        self.action_space = spaces.Discrete(groups * self._cells)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[IntArray, dict[str, Any]]:
        """Put the robot at rest on the start line; there are no options."""
        super().reset(seed=seed, options=options)
        self._state = self._simulator.rest()
        return self._observation_and_info()

    def step(self, action: SupportsInt) -> tuple[IntArray, float, bool, bool, dict[str, Any]]:
        """Carry out one action, or a no-op if it is illegal.

        Raises:
            InvalidInput: if the action is not in the action space.
            Diverged: if the physics diverges.
        """
        if not self.action_space.contains(action):
            raise InvalidInput(f"an action is one of {self.action_space}, not {action!r}")
        chosen, reward_m = Action(*divmod(int(action), self._cells)), 0.0
        if chosen in self._legal():
            self._state, reward_m, _ = self._simulator.step(self._state, chosen)
        cells, info = self._observation_and_info()
        return cells, reward_m, False, False, info

    def _legal(self) -> Sequence[Action]:
        cells = observe(self._simulator, self._state, self._observation)
        return legal_in(self._simulator, self._state, cells)

    def _observation_and_info(self) -> tuple[IntArray, dict[str, Any]]:
        """Return the current observation and its `info`."""
        cells = observe(self._simulator, self._state, self._observation)
        legal = np.zeros((len(cells), self._cells), np.int8)
        legal[tuple(np.transpose(self._legal()))] = 1
        info = {"action_mask": legal.ravel(), "distance_m": self._state.distance_m}
        return np.array(cells, np.int64), info


gymnasium.register(WALK_ID, f"{__name__}:{WalkEnv.__name__}", max_episode_steps=RACE_STEPS)
