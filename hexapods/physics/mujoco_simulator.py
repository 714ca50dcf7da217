"""The MuJoCo simulator: steps with rigid-body physics, single or in batches."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import mujoco
import numpy as np
from mujoco.batch import Batch

from hexapods.domain.disturbances import DeadBand, Delay, Push, Rough, Stuck
from hexapods.domain.errors import Diverged
from hexapods.domain.feet import Feet, StepLaw
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import check_reach
from hexapods.domain.motion import StepMotion, StepPlan, recorded_substeps
from hexapods.domain.robot import Robot
from hexapods.domain.simulator import Expansion, Motion, RewardKind, Step
from hexapods.domain.terrain import ROUGH_PERIOD_M
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.domain.world import UNDISTURBED, World
from hexapods.physics.conditions import direction
from hexapods.physics.mjcf import compile_model
from hexapods.physics.servo_torque import servo_effort

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
        steps: number of steps taken since rest.
        origin_m: position of the row's origin in the world (x, y); on rough ground, which repeats,
            the row is moved by whole periods so that the robot stays on one of them.
        delayed: servo targets that the servos have not received yet [rad], (k, joints); only with
            a delay.
    """

    row: FloatArray
    feet: Feet
    distance_m: float = 0.0
    steps: int = 0
    origin_m: tuple[float, float] = (0.0, 0.0)
    delayed: FloatArray | None = None

    @property
    def commanded(self) -> Cells:
        """The cell that each group was last sent to."""
        return self.feet.commanded


class _Batches(NamedTuple):
    """Simulations of one model."""

    single: Batch
    many: Batch
    """Grows with the number of states of `expand`."""


class MujocoSimulator:
    """Implements `Simulator` on MuJoCo.

    The robot starts over the world's origin, facing world +y. Not thread-safe.

    Args:
        robot, gait, grid: the walking problem.
        threads: number of threads of `expand`; 0 for one per core. Results do not depend on it.
        world: disturbances of the robot and the ground.
        built: the robot as it was built, which is simulated; commands and measured feet are by the
            kinematics of `robot`, as it was designed. None if both are the same.
        reward: displacement that counts as reward.

    Raises:
        Unreachable: if a cell of the grid is out of a leg's reach.
        InvalidInput: if a disturbance cannot happen to this robot.
    """

    def __init__(
        self,
        robot: Robot,
        gait: Gait,
        grid: FootGrid,
        threads: int = 1,
        world: World = UNDISTURBED,
        *,
        built: Robot | None = None,
        reward: RewardKind = "forward",
    ) -> None:
        self.law = StepLaw(gait, grid, check_reach(robot, gait, grid))
        world.check(robot, "mujoco")
        _silence_mujoco_log()
        self.robot, self.gait, self.grid, self.world = robot, gait, grid, world
        self._built = robot if built is None else built
        self._is_along_track = reward == "track"
        self.model = self._model(world.as_of(0))
        self._motion = StepMotion(robot, gait, self.law)
        self._legs = self._motion.kinematics.legs
        self._substeps = robot.swing_substeps + robot.shift_substeps
        self._recorded_substeps = recorded_substeps(robot)
        self._threads = threads
        self._batches: dict[World, _Batches] = {}
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
        standing = self._motion.kinematics.joint_angles(np.zeros((len(self._legs), 3)))
        half = np.deg2rad(90 - self.gait.forward_deg) / 2
        conditions = self.world.as_of(0)
        batch = Batch(self.model, 1, 1)
        qpos = batch.bind("qpos")[0]
        qpos[:7] = 0, 0, self.robot.body_height_m + self.robot.foot_radius_m, 1, 0, 0, 0
        rough = conditions.one_of(Rough)
        if rough:
            qpos[2] += rough.amplitude_m  # so that no foot begins in the ground
        qpos[3], qpos[6] = np.cos(half), np.sin(half)
        qpos[7:] = standing
        for stuck in conditions.all_of(Stuck):
            joint = self._legs.index(stuck.leg, stuck.joint)
            standing[joint] = qpos[7 + joint] = stuck.angle_rad
        batch.rollout(round(SETTLE_S / self.robot.dt_s), standing[None, None], record=())
        self._check(batch, [0.0], [0])
        batch.bind("time")[0] = 0
        qpos[:2] = 0
        return MujocoState(_read_only_copy(batch.state[0]), self.law.at_home())

    def step(
        self, state: MujocoState, action: Action, record: bool = False, effort: bool = False
    ) -> Step[MujocoState]:
        conditions = self.world.as_of(state.steps)
        batch = self._batches_of(conditions).single
        pushes = self.world.pushes_at(state.steps)
        moved = self._placed(state, conditions)
        (end,), (reward,), recorded = self._advance(
            batch,
            conditions,
            [moved],
            [action],
            record=(("qpos", "qvel") if effort else ("qpos",)) if record else (),
            pushes=pushes,
        )
        motion = None
        if record:
            recorded_qpos = recorded["qpos"][0, self._recorded_substeps]
            if moved.origin_m != (0.0, 0.0):
                recorded_qpos[:, :2] += moved.origin_m
            motion = Motion(
                ((self._recorded_substeps + 1) * self.robot.dt_s).astype(np.float32),
                recorded_qpos.astype(np.float32),
            )
            if effort:
                motion = motion._replace(
                    **servo_effort(
                        batch.model,
                        recorded["target"][0],
                        recorded["qpos"][0, :, 7:],
                        recorded["qvel"][0, :, 6:],
                        speeds_before=recorded["qvel_before"][0, 6:],
                        frames=self._recorded_substeps,
                    )._asdict()
                )
        return Step(end, reward, motion)

    def expand(
        self,
        states: Sequence[MujocoState],
        actions: Sequence[Action],
        as_of: int | None = None,
    ) -> Expansion[MujocoState]:
        if not states:
            return Expansion([], np.empty(0))
        if as_of is None and self.world:
            return self._expand_by_conditions(states, actions)
        conditions = self.world.as_of(as_of or 0)
        batch = self._batches_of(conditions, len(states)).many
        moved = [self._placed(state, conditions) for state in states]
        ends, rewards, _ = self._advance(batch, conditions, moved, actions)
        return Expansion(ends, np.array(rewards))

    def _expand_by_conditions(
        self, states: Sequence[MujocoState], actions: Sequence[Action]
    ) -> Expansion[MujocoState]:
        """Carry out each action under the conditions of its own step."""
        by_step: dict[int, list[int]] = {}
        for number, state in enumerate(states):
            by_step.setdefault(state.steps, []).append(number)
        ends: dict[int, MujocoState] = {}
        rewards = np.empty(len(states))
        for step, numbers in by_step.items():
            states_of_step = [states[i] for i in numbers]
            expansion = self.expand(states_of_step, [actions[i] for i in numbers], step)
            ends |= dict(zip(numbers, expansion.states, strict=True))
            rewards[numbers] = expansion.rewards_m
        return Expansion([ends[i] for i in range(len(states))], rewards)

    def commands(self, states: Sequence[MujocoState], actions: Sequence[Action]) -> FloatArray:
        """Return the servo targets over a step from each state, (n, substeps, joints) [rad].

        They are those of an undisturbed robot.
        """
        return self._motion.joint_targets(self._plans(states, actions))

    def _model(self, conditions: World) -> mujoco.MjModel:
        return compile_model(self._built, conditions, self.gait.forward_deg)

    def _batches_of(self, conditions: World, count: int = 1) -> _Batches:
        """Return the simulations of these conditions, with room for so many states."""
        batches = self._batches.get(conditions)
        if batches is None:
            single = Batch(self._model(conditions), 1, 1)
            batches = self._batches[conditions] = _Batches(single, single)
        if count > batches.many.nsim:
            many = Batch(batches.single.model, count, self._threads)
            batches = self._batches[conditions] = batches._replace(many=many)
        return batches

    def _plans(self, states: Sequence[MujocoState], actions: Sequence[Action]) -> list[StepPlan]:
        return [self._motion.plan(s.feet, a) for s, a in zip(states, actions, strict=True)]

    def _advance(
        self,
        batch: Batch,
        conditions: World,
        states: Sequence[MujocoState],
        actions: Sequence[Action],
        *,
        record: Sequence[str] = (),
        pushes: Sequence[Push] = (),
    ) -> tuple[list[MujocoState], list[float], dict[str, FloatArray]]:
        """Plan and simulate a step from each state; return ends, rewards, and recorded arrays.

        With `qvel`, that includes the servos' targets and the speeds before.

        Raises:
            Diverged: if the physics diverges.
        """
        plans, count = self._plans(states, actions), len(states)
        for simulation, state in enumerate(states):
            batch.state[simulation] = state.row
        for push in pushes:
            change = push.impulse_ns / float(batch.model.body_mass.sum())
            batch.bind("qvel")[:count, :2] += change * direction(push.direction_deg)
        targets, delayed = self._received(batch, conditions, states, plans)
        before = {}
        if "qvel" in record:
            before = {"target": targets, "qvel_before": batch.bind("qvel").copy()}
        recorded = before | batch.rollout(
            self._substeps,
            targets,
            record=record,
            ids=None if count == batch.nsim else np.arange(count),
        )
        after = _read_only_copy(batch.state[:count])
        ends = [
            MujocoState(
                row,
                plan.end,
                float(row[2]) + state.origin_m[1],
                state.steps + 1,
                state.origin_m,
                late,
            )
            for row, plan, state, late in zip(after, plans, states, delayed, strict=True)
        ]
        rewards = [self._reward(s.row, row) for s, row in zip(states, after, strict=True)]
        self._check(batch, rewards, [end.steps for end in ends])
        return ends, rewards, recorded

    def _received(
        self,
        batch: Batch,
        conditions: World,
        states: Sequence[MujocoState],
        plans: Sequence[StepPlan],
    ) -> tuple[FloatArray, Sequence[FloatArray | None]]:
        """Return the targets that the servos act on, and those that they receive after the step.

        Returns:
            targets (n, substeps, joints) [rad], and for each state those delayed.
        """
        targets = self._motion.joint_targets(plans)
        delayed: list[FloatArray | None] = [None] * len(plans)
        if not conditions:
            return targets, delayed
        delay, dead_band = conditions.one_of(Delay), conditions.one_of(DeadBand)
        late_count = round(delay.seconds / self.robot.dt_s) if delay else 0
        if late_count == 0 and not dead_band and not conditions.all_of(Stuck):
            return targets, delayed
        targets_rad = np.array(batch.bind("ctrl")[: len(plans)])  # the last targets before the step
        if late_count:
            before = np.repeat(targets_rad[:, None], late_count, 1)
            for number, state in enumerate(states):
                if state.delayed is not None and len(state.delayed) == late_count:
                    before[number] = state.delayed
            stream = np.concatenate((before, targets), 1)
            targets, rest = stream[:, : self._substeps], stream[:, self._substeps :]
            delayed = [_read_only_copy(late) for late in rest]
        if dead_band:
            for substep in range(self._substeps):
                wanted = targets[:, substep]
                targets_rad = np.where(
                    np.abs(wanted - targets_rad) > dead_band.radians, wanted, targets_rad
                )
                targets[:, substep] = targets_rad
        for stuck in conditions.all_of(Stuck):
            targets[:, :, self._legs.index(stuck.leg, stuck.joint)] = stuck.angle_rad
        return targets, delayed

    def _placed(self, state: MujocoState, conditions: World) -> MujocoState:
        """Return a state with its row placed on the ground of these conditions.

        On rough ground it is moved by whole periods to the one around the origin, and lifted over
        the bumps as they begin; on other ground its row has the position in the world.
        """
        if not conditions and not any(state.origin_m):
            return state
        rough = conditions.one_of(Rough)
        shift = np.negative(state.origin_m)
        if rough is not None:
            shift = ROUGH_PERIOD_M * np.round(state.row[1:3] / ROUGH_PERIOD_M)
        begins = rough is not None and self._begins(rough, state.steps)
        if not shift.any() and not begins:
            return state
        row = state.row.copy()
        row[1:3] -= shift
        if rough is not None and begins:
            row[3] += rough.amplitude_m
        x, y = np.add(state.origin_m, shift).tolist()
        return replace(state, row=_read_only_copy(row), origin_m=(x, y))

    def _begins(self, rough: Rough, step: int) -> bool:
        """Whether the ground gets these bumps in a step after the start."""
        return step > 0 and self.world.as_of(step - 1).one_of(Rough) != rough

    def _reward(self, before: FloatArray, after: FloatArray) -> float:
        """Return the displacement along the track (world +y) or the robot's forward direction [m].

        That is its horizontal forward direction at the start. In plain floats, which are much
        faster than arrays for a single row.
        """
        from_x, from_y, _, w, x, y, z = before[1:8].tolist()
        to_x, to_y = after[1:3].tolist()
        if self._is_along_track:
            return float(to_y - from_y)
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
        first = int((warned | ~np.isfinite(rewards)).argmax())
        raise Diverged(
            f"the physics diverged at step {steps[first]}; try a smaller robot.dt_s, a "
            "lower servo_kp or heavier links"
        )

    def estimate(self, state: MujocoState, error_m: FloatArray) -> MujocoState:
        kinematics, leg_of = self._motion.kinematics, self._legs.leg_of_joint
        angles = state.row[self._joints]
        feet = np.array(kinematics.foot_offsets(angles.tolist()))
        measured = feet.copy()
        measured[:, :2] += self.gait.by_leg(error_m)
        # As differences, so that an error of 0 changes nothing.
        moved = angles + (kinematics.joint_angles(measured) - kinematics.joint_angles(feet))
        row = state.row.copy()
        is_unreached = np.bincount(leg_of, ~np.isfinite(moved)) > 0  # (legs,)
        # A foot that seems to be out of reach stays where it is.
        possible = np.clip(moved, *self._legs.limits_rad)
        row[self._joints] = np.where(is_unreached[leg_of], angles, possible)
        return replace(state, row=_read_only_copy(row))

    def group_offsets(self, state: MujocoState) -> Sequence[tuple[float, float]]:
        angles = state.row[self._joints].tolist()
        feet_m = self._motion.kinematics.foot_offsets(angles)
        return self.gait.by_group(feet_m, state.feet.lateral_m)

    def pose(self, state: MujocoState) -> FloatArray:
        pose: FloatArray = state.row[1 : 1 + self.model.nq].copy()
        pose[:2] += state.origin_m
        return pose

    def torso(self, state: MujocoState) -> Sequence[float]:
        x, y, *rest = state.row[1:8].tolist()
        return [x + state.origin_m[0], y + state.origin_m[1], *rest]

    def dump(self, state: MujocoState) -> dict[str, FloatArray]:
        return {
            "row": state.row.copy(),
            "feet": state.feet.as_array(),
            "travel": np.array([state.distance_m, state.steps]),
            **({} if state.delayed is None else {"delayed": state.delayed.copy()}),
            **({"origin": np.array(state.origin_m)} if any(state.origin_m) else {}),
        }

    def load(self, arrays: dict[str, FloatArray]) -> MujocoState:
        distance, steps = arrays["travel"].tolist()
        x, y = arrays["origin"].tolist() if "origin" in arrays else (0.0, 0.0)
        delayed = arrays.get("delayed")
        return MujocoState(
            _read_only_copy(arrays["row"]),
            Feet.from_array(arrays["feet"]),
            distance,
            int(steps),
            (x, y),
            None if delayed is None else _read_only_copy(delayed),
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
