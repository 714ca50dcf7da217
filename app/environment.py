"""The walking problem as a Gymnasium environment, for learners that are not of this product.

Importing this module registers it; the package `gymnasium` comes with `racing-hexapods[gym]`:

    import app.environment
    walk = gymnasium.make("RacingHexapods/Walk-v0", gait="left-right-origin")

`gymnasium.make("app.environment:RacingHexapods/Walk-v0")` does both.
"""

from collections.abc import Mapping, Sequence
from typing import Any, SupportsInt

import gymnasium
import numpy as np
from gymnasium import spaces

from app.assembly import build_simulator
from app.domain.errors import InvalidInput
from app.domain.gait import GaitSpec
from app.domain.observation import Observation, check_observation, legal_actions, observe
from app.domain.robot import Robot
from app.domain.robot import robot as read_robot
from app.domain.simulator import WalkState
from app.domain.types import Action, IntArray
from app.runs.config import RACE_STEPS, SimulatorName, WalkingProblem

WALK_ID = "RacingHexapods/Walk-v0"


class WalkEnv(gymnasium.Env[IntArray, SupportsInt]):
    """A hexapod that earns what it comes forward, step by step, as in a training.

    - Observation: `MultiDiscrete`, the cell of the foot grid on which each leg pair is seen.
    - Action: `Discrete`, pair × cells + cell: move that pair to that cell. `info["action_mask"]`
      marks what is legal now, as `action_space.sample(mask)` takes it. To send a pair to the cell
      on which it is seen is no action of the walking problem: it is carried out as nothing, so
      that the robot stays as it is and earns 0, and the step counts.
    - Reward: displacement of the torso's centre in the robot's forward direction [m], as the
      simulator measures it.
    - `info["distance_m"]`: displacement along the track since the start.
    - An episode starts from rest and has no end of its own: `gymnasium.make` truncates it after
      50 steps, as long as a race, or after `max_episode_steps`.

    Nothing in it is left to chance, so that every seed gives the same episodes. It draws nothing;
    the stage of `hexapods serve` does.
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
            gait: a name, or how the robot is oriented and its legs pair up.
            robot: a preset's name, or what differs from one.
            simulator: `mujoco` or `kinematic`.
            divisions: of the foot grid.
            grid_side_m: of the foot grid.
            observation: `measured` or `commanded`, how the state is read.

        Raises:
            InvalidInput: if a value cannot be; the message says what can.
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
        self._cells, pairs = len(walk.grid), len(walk.resolved_gait.pairs)
        self.observation_space = spaces.MultiDiscrete([self._cells] * pairs)
        self.action_space = spaces.Discrete(pairs * self._cells)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[IntArray, dict[str, Any]]:
        """Put the robot at rest on the start line; there are no options."""
        super().reset(seed=seed, options=options)
        self._state = self._simulator.rest()
        return self._seen()

    def step(self, action: SupportsInt) -> tuple[IntArray, float, bool, bool, dict[str, Any]]:
        """Carry out one action, or nothing where it is illegal.

        Raises:
            InvalidInput: if the action is none of the action space.
            Diverged: if the physics breaks.
        """
        if not self.action_space.contains(action):
            raise InvalidInput(f"an action is one of {self.action_space}, not {action!r}")
        chosen, reward_m = Action(*divmod(int(action), self._cells)), 0.0
        if chosen in self._legal():
            self._state, reward_m, _ = self._simulator.step(self._state, chosen)
        seen, info = self._seen()
        return seen, reward_m, False, False, info

    def _legal(self) -> Sequence[Action]:
        seen = observe(self._simulator, self._state, self._observation)
        return legal_actions(seen, self._cells)

    def _seen(self) -> tuple[IntArray, dict[str, Any]]:
        """The observation, and what goes with it."""
        seen = observe(self._simulator, self._state, self._observation)
        legal = np.ones((len(seen), self._cells), np.int8)
        legal[np.arange(len(seen)), seen] = 0
        info = {"action_mask": legal.ravel(), "distance_m": self._state.distance_m}
        return np.array(seen, np.int64), info


gymnasium.register(WALK_ID, f"{__name__}:{WalkEnv.__name__}", max_episode_steps=RACE_STEPS)
