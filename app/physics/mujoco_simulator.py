"""The MuJoCo simulator: steps with rigid-body physics, single or in batches."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
from mujoco.batch import Batch

from app.domain.errors import Diverged
from app.domain.feet import Feet
from app.domain.gait import Gait
from app.domain.grid import FootGrid
from app.domain.kinematics import check_reach
from app.domain.motion import StepMotion, StepPlan, recorded_substeps
from app.domain.robot import Robot
from app.domain.simulator import Expansion, Motion, Step
from app.domain.types import Action, Cells, FloatArray
from app.physics.mjcf import compile_model

SETTLE_S = 1.0
"""Time that the robot stands before a walk, until servo torques and contact forces settle."""


@dataclass(frozen=True, slots=True, eq=False)
class MujocoState:
    """Simulator state between two steps.

    Attributes:
        row: the full mjSTATE_INTEGRATION vector; continuing from a smaller state vector gives
            other results.
        feet: foot offsets without slip, from which the next step is planned.
        distance_m: displacement of the torso's centre along the track (world +y).
        steps: taken since rest.
    """

    row: FloatArray
    feet: Feet
    distance_m: float = 0.0
    steps: int = 0

    @property
    def commanded(self) -> Cells:
        """The cell that each pair was last sent to."""
        return self.feet.commanded


class MujocoSimulator:
    """Implements `Simulator` on MuJoCo.

    The robot starts over the world's origin, facing world +y. Not thread-safe.

    Args:
        robot, gait, grid: the walking problem.
        threads: number of threads of `expand`; 0 for one per core. Results do not depend on it.

    Raises:
        Unreachable: if a cell of the grid is out of a leg's reach.
    """

    def __init__(self, robot: Robot, gait: Gait, grid: FootGrid, threads: int = 1) -> None:
        check_reach(robot, gait, grid)
        _silence_mujoco_log()
        self.robot, self.gait, self.grid = robot, gait, grid
        self.model = compile_model(robot)
        self._motion = StepMotion(robot, gait, grid)
        self._substeps = robot.swing_substeps + robot.shift_substeps
        self._recorded_substeps = recorded_substeps(robot)
        self._threads = threads
        self._step_batch = Batch(self.model, 1, 1)
        self._expand_batch = self._step_batch
        forward = np.deg2rad(gait.forward_deg)
        self._forward = float(np.cos(forward)), float(np.sin(forward))
        self._joints = slice(
            8, 8 + self.model.nu
        )  # in a row after time, torso position and rotation

    def rest(self) -> MujocoState:
        return self._rest

    @cached_property
    def _rest(self) -> MujocoState:
        """The settled state with every foot at home, over the origin."""
        standing = self._motion.legs.joint_angles(np.zeros((len(self.robot.legs), 3))).ravel()
        half = np.deg2rad(90 - self.gait.forward_deg) / 2
        batch = Batch(self.model, 1, 1)
        qpos = batch.bind("qpos")[0]
        qpos[:7] = 0, 0, self.robot.body_height_m + self.robot.foot_radius_m, 1, 0, 0, 0
        qpos[3], qpos[6] = np.cos(half), np.sin(half)
        qpos[7:] = standing
        batch.rollout(round(SETTLE_S / self.robot.dt_s), standing[None, None], record=())
        self._check(batch, [0.0], [0])
        batch.bind("time")[0] = 0
        qpos[:2] = 0
        return MujocoState(_read_only_copy(batch.state[0]), self._motion.at_home())

    def step(self, state: MujocoState, action: Action, record: bool = False) -> Step[MujocoState]:
        (end,), (reward,), recorded = self._advance(self._step_batch, [state], [action], record)
        motion = None
        if record:
            recorded_qpos = recorded["qpos"][0, self._recorded_substeps].astype(np.float32)
            motion = Motion(
                ((self._recorded_substeps + 1) * self.robot.dt_s).astype(np.float32), recorded_qpos
            )
        return Step(end, reward, motion)

    def expand(
        self, states: Sequence[MujocoState], actions: Sequence[Action]
    ) -> Expansion[MujocoState]:
        if not states:
            return Expansion([], np.empty(0))
        if len(states) > self._expand_batch.nsim:
            self._expand_batch = Batch(self.model, len(states), self._threads)
        ends, rewards, _ = self._advance(self._expand_batch, states, actions, record=False)
        return Expansion(ends, np.array(rewards))

    def commands(self, states: Sequence[MujocoState], actions: Sequence[Action]) -> FloatArray:
        """Return the servo targets over a step from each state, (n, substeps, 3 · legs) [rad]."""
        return self._motion.joint_targets(self._plans(states, actions))

    def _plans(self, states: Sequence[MujocoState], actions: Sequence[Action]) -> list[StepPlan]:
        return [self._motion.plan(s.feet, a) for s, a in zip(states, actions, strict=True)]

    def _advance(
        self,
        batch: Batch,
        states: Sequence[MujocoState],
        actions: Sequence[Action],
        record: bool,
    ) -> tuple[list[MujocoState], list[float], dict[str, FloatArray]]:
        """Plan and simulate a step from each state; return ends, rewards, and `qpos` if recorded.

        Raises:
            Diverged: if the physics diverges.
        """
        plans, count = self._plans(states, actions), len(states)
        for simulation, state in enumerate(states):
            batch.state[simulation] = state.row
        recorded = batch.rollout(
            self._substeps,
            self._motion.joint_targets(plans),
            record=("qpos",) if record else (),
            ids=None if count == batch.nsim else np.arange(count),
        )
        after = _read_only_copy(batch.state[:count])
        ends = [
            MujocoState(row, plan.end, float(row[2]), state.steps + 1)
            for row, plan, state in zip(after, plans, states, strict=True)
        ]
        rewards = [self._reward(s.row, row) for s, row in zip(states, after, strict=True)]
        self._check(batch, rewards, [end.steps for end in ends])
        return ends, rewards, recorded

    def _reward(self, before: FloatArray, after: FloatArray) -> float:
        """Return the displacement along the robot's horizontal forward direction at the start [m].

        In plain floats, which are much faster than arrays for a single row.
        """
        from_x, from_y, _, w, x, y, z = before[1:8].tolist()
        to_x, to_y = after[1:3].tolist()
        cos, sin = self._forward
        ahead_x = (1 - 2 * (y * y + z * z)) * cos + 2 * (x * y - w * z) * sin
        ahead_y = 2 * (x * y + w * z) * cos + (1 - 2 * (x * x + z * z)) * sin
        along = (to_x - from_x) * ahead_x + (to_y - from_y) * ahead_y
        return float(along / math.sqrt(ahead_x * ahead_x + ahead_y * ahead_y))

    def _check(self, batch: Batch, rewards: Sequence[float], steps: Sequence[int]) -> None:
        """Raise `Diverged` if any simulation of the batch met a non-finite number.

        MuJoCo itself only counts a warning then, and resets the state to the model's default.
        """
        if not np.count_nonzero(batch.warning) and all(map(math.isfinite, rewards)):
            return
        warned = batch.warning[: len(steps), :, 1].sum(axis=1) > 0
        batch.warning[...] = 0
        bad = int((warned | ~np.isfinite(rewards)).argmax())
        raise Diverged(
            f"the physics diverged at step {steps[bad]}; try a smaller robot.dt_s, a "
            "lower servo_kp or heavier links"
        )

    def pair_offsets(self, state: MujocoState) -> Sequence[tuple[float, float]]:
        feet = self._motion.legs.foot_offsets(state.row[self._joints].tolist())
        offsets = []
        for leader, partner in self.gait.pairs:
            (x, y, _), (mirrored_x, partner_y, _) = feet[leader - 1], feet[partner - 1]
            offsets.append(((x - mirrored_x) / 2, (y + partner_y) / 2))
        return offsets

    def pose(self, state: MujocoState) -> FloatArray:
        return state.row[1 : 1 + self.model.nq].copy()

    def dump(self, state: MujocoState) -> dict[str, FloatArray]:
        return {
            "row": state.row.copy(),
            "feet": state.feet.as_array(),
            "travel": np.array([state.distance_m, state.steps]),
        }

    def load(self, arrays: dict[str, FloatArray]) -> MujocoState:
        distance, steps = arrays["travel"].tolist()
        return MujocoState(
            _read_only_copy(arrays["row"]),
            Feet.from_array(arrays["feet"]),
            distance,
            int(steps),
        )


def _silence_mujoco_log() -> None:
    """Disable MuJoCo's own log of warnings, which `Diverged` reports instead.

    By default they go to the console and to MUJOCO_LOG.TXT in the current working directory.
    """
    log = mujoco.MjLogConfig.get()
    log.logto_file = log.logto_console = False
    log.set()


def _read_only_copy(array: FloatArray) -> FloatArray:
    """Return a read-only copy of an array."""
    copy = array.copy()
    copy.flags.writeable = False
    return copy
