"""The walking problem as a Gymnasium environment, for learners outside this product.

Importing this module registers it; the package `gymnasium` comes with `racing-hexapods[gym]`:

    walk = gymnasium.make("hexapods.environment:RacingHexapods/Walk-v0", gait="left-right-origin")

imports it, and makes one. After `import hexapods.environment` its name alone is enough.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, SupportsInt, Unpack

import numpy as np
from numpy.typing import NDArray

from hexapods.arguments import (
    WALK,
    Walk,
    WorldLike,
    check_names,
    plain,
    read_disturbance,
    read_walk,
    read_world,
)
from hexapods.assembly import build_simulator, sensor_noise
from hexapods.domain.disturbances import Disturbance
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.observation import Observation, action_mask, legal_in
from hexapods.domain.simulator import Simulator
from hexapods.domain.types import Action, IntArray
from hexapods.domain.world import UNDISTURBED, World
from hexapods.exports.video import robot_camera
from hexapods.extras import needs
from hexapods.runs.config import RACE_STEPS, TrainingConfig
from hexapods.runs.walker import Sensors

with needs("gym", "the Gymnasium environment"):
    import gymnasium
    from gymnasium import spaces

if TYPE_CHECKING:
    from hexapods.exports.video_pictures import RobotCamera

WALK_ID = "RacingHexapods/Walk-v0"


class WalkEnv(gymnasium.Env[IntArray, SupportsInt]):
    """Gymnasium environment of a walking hexapod, with the rewards of a training.

    - Observation: `MultiDiscrete`, the observed cell of the foot grid of each group of legs.
    - Action: `Discrete`, group × cells + cell: move that group to that cell. `info["action_mask"]`
      marks the legal actions, as `action_space.sample(mask)` expects, and `action_masks()` too, as
      MaskablePPO of sb3-contrib does. Sending a group to its observed cell is illegal in the
      walking problem: it is carried out as a no-op with reward 0, which counts as a step.
    - Reward: displacement of the torso's centre in the robot's forward direction [m], as the
      simulator measures it, or along the track with `reward="track"`.
    - `info["distance_m"]`: displacement along the track since the start.
    - `info["heading_rad"]`: angle by which the torso has turned since the start, anticlockwise.
    - An episode starts from rest and never terminates: `gymnasium.make` truncates it after 50
      steps, the length of a race, or after `max_episode_steps`.
    - Rendering: with `render_mode="rgb_array"`, `render()` returns a picture of the robot as videos
      show it, (360, 640, 3); it needs `racing-hexapods[video]`. `metadata["render_fps"]` is the
      number of steps that the robot takes in a second.

    Random are only the robot within its `tolerance`, the errors of noisy sensors, and the start
    with `start_noise_m`. `reset(seed=…)` draws them as a training with that seed does; a `reset`
    without one keeps the robot, and draws the rest from `np_random`.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 2.5}  # noqa: RUF012  # Gymnasium's

    def __init__(
        self,
        *,
        observation: Observation = "measured",
        disturbances: Iterable[Disturbance | Mapping[str, Any] | str] = (),
        start_noise_m: float = 0.0,
        render_mode: str | None = None,
        **walk: Unpack[Walk],
    ) -> None:
        """Build the robot and put it at rest.

        Args:
            observation: `measured`, `commanded` or `planned`, how the state is read.
            disturbances: what is added to the world, such as `["limp:legs=1,4:at=10"]`.
            start_noise_m: each group's feet start up to so far from home, sideways and forward,
                every offset with the same probability; at most half of `grid_side_m` [m].
            render_mode: `rgb_array`, or None for no pictures.
            walk: `gait`, `robot`, `simulator`, `divisions`, `grid_side_m`, `world`, `tolerance` and
                `reward`, as in `hexapods.train`. What happens in the world at a step happens at
                that step of each episode.

        Raises:
            InvalidInput: if a value is invalid; the message names the valid ones.
        """
        modes = type(self).metadata["render_modes"]
        if render_mode is not None and render_mode not in modes:
            raise UnknownName("render mode", render_mode, modes)
        valid = ("observation", "disturbances", "start_noise_m", "render_mode", *WALK)
        check_names("the environment", walk, valid)
        world = _world_with(walk.get("world", UNDISTURBED), disturbances)
        self._config = TrainingConfig(
            **read_walk(plain({**walk, "world": world})), observation=observation
        )
        self._start_noise_m = _checked_noise_m(start_noise_m, self._config.grid_side_m)
        self.render_mode = render_mode
        self.metadata = type(self).metadata | {"render_fps": 1 / self._config.robot.step_s}
        self._camera: RobotCamera | None = None
        self._simulator: Simulator[Any] = build_simulator(self._config)
        self._state: Any = self._simulator.rest()
        self._sensors = Sensors(self._simulator)
        self._has_drawn_robot = False
        self._cells, groups = len(self._config.grid), len(self._config.resolved_gait.groups)
        self.observation_space = spaces.MultiDiscrete([self._cells] * groups)
        self.action_space = spaces.Discrete(groups * self._cells)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[IntArray, dict[str, Any]]:
        """Put the robot at rest on the start line; there are no options.

        Args:
            seed: seed of `np_random`, and of the draws of a training with this seed.
            options: ignored; there are none.
        """
        super().reset(seed=seed, options=options)
        episode_seed = int(self.np_random.integers(2**32)) if seed is None else int(seed)
        if self._config.tolerance and (seed is not None or not self._has_drawn_robot):
            self._config = replace(self._config, seed=episode_seed)
            self._simulator = build_simulator(self._config)
            self._has_drawn_robot = True
            self.close()  # its camera shows the robot as it was
        self._begin(episode_seed)
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
            self._sensors.at(self._state)
        cells, info = self._observation_and_info()
        return cells, reward_m, False, False, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Return for each action whether it is legal now, as sb3-contrib's MaskablePPO asks."""
        return action_mask(self._legal(), len(self._simulator.gait.groups), self._cells)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture of the robot, (height, width, 3); None without a render mode.

        Raises:
            MissingExtra: if a package of the extra `video`, or OpenGL, is not installed.
        """
        if self.render_mode is None:
            return None
        if self._camera is None:
            self._camera = robot_camera(self._config)
        return self._camera.picture(self._simulator.pose(self._state))

    def close(self) -> None:
        """Close the camera of `render`, which frees its OpenGL context."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _begin(self, episode_seed: int) -> None:
        """Put the robot at rest, with its feet off home by the start noise."""
        self._state = self._simulator.rest()
        if self._start_noise_m:
            size = (len(self._simulator.gait.groups), 2)
            offsets_m = self.np_random.uniform(-self._start_noise_m, self._start_noise_m, size)
            # Its next step is planned from where the feet are; an estimate knows where they were.
            feet = self._state.feet.moved(offsets_m)
            self._state = replace(self._simulator.estimate(self._state, offsets_m), feet=feet)
        self._sensors = Sensors(self._simulator, sensor_noise(episode_seed))
        self._sensors.at(self._state)

    def _legal(self) -> Sequence[Action]:
        cells = self._sensors(self._config.observation)
        return legal_in(self._simulator, self._state, cells)

    def _observation_and_info(self) -> tuple[IntArray, dict[str, Any]]:
        """Return the current observation and its `info`."""
        cells = self._sensors(self._config.observation)
        info = {
            "action_mask": self.action_masks().astype(np.int8),
            "distance_m": self._state.distance_m,
            "heading_rad": self._sensors.heading_rad,
        }
        return np.array(cells, np.int64), info


def _world_with(
    world: WorldLike, disturbances: Iterable[Disturbance | Mapping[str, Any] | str]
) -> World:
    """Return a world with further disturbances."""
    if isinstance(disturbances, str | Mapping) or not isinstance(disturbances, Iterable):
        raise InvalidInput(
            f'disturbances is a list, such as ["limp:legs=1,4:at=10"], not {disturbances!r}'
        )
    begun = read_world(world)
    return World((*begun.disturbances, *map(read_disturbance, disturbances)))


def _checked_noise_m(start_noise_m: object, grid_side_m: float) -> float:
    number = plain(start_noise_m)
    if isinstance(number, bool | str) or not isinstance(number, int | float):
        number = float("nan")
    if not 0 <= number <= grid_side_m / 2:
        raise InvalidInput(
            f"start_noise_m must be a number from 0 to {grid_side_m / 2:g}, half of the foot "
            f"grid's side, not {start_noise_m!r}"
        )
    return float(number)


gymnasium.register(WALK_ID, f"{__name__}:{WalkEnv.__name__}", max_episode_steps=RACE_STEPS)
