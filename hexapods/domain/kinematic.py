"""The kinematic simulator: steps without slip by the law of `hexapods.domain.feet`, no physics."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.feet import Feet, StepLaw
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import check_reach
from hexapods.domain.motion import StepMotion, StepPlan, ease, recorded_substeps
from hexapods.domain.robot import Robot
from hexapods.domain.simulator import Expansion, Motion, Step
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.domain.world import UNDISTURBED, World


@dataclass(frozen=True, slots=True)
class KinematicState:
    """State of the kinematic simulator: foot offsets, body displacement [m], steps taken."""

    feet: Feet
    distance_m: float = 0.0
    steps: int = 0

    @property
    def commanded(self) -> Cells:
        """The cell that each group was last sent to."""
        return self.feet.commanded


class KinematicSimulator:
    """Implements `Simulator` by the kinematic law: a step's reward is the body's displacement."""

    def __init__(
        self, robot: Robot, gait: Gait, grid: FootGrid, world: World = UNDISTURBED
    ) -> None:
        """Create the simulator.

        Raises:
            Unreachable: if a cell of the grid is out of a leg's reach.
            InvalidInput: if a disturbance of the world is not simulated here.
        """
        self.law = StepLaw(gait, grid, check_reach(robot, gait, grid))
        world.check(robot, "kinematic")
        self.robot, self.gait, self.grid, self.world = robot, gait, grid, world
        recorded = recorded_substeps(robot)
        self._motion = StepMotion(robot, gait, self.law, recorded)
        self._times_s = ((recorded + 1) * robot.dt_s).astype(np.float32)
        self._times_s.setflags(write=False)  # all motions have this array
        shift_phase = (recorded - robot.swing_substeps + 1) / robot.shift_substeps
        self._share_of_advance = np.where(shift_phase > 0, ease(shift_phase), 0.0)

    def rest(self) -> KinematicState:
        return KinematicState(self.law.at_home())

    def standing(self, cells: Cells) -> KinematicState:
        """Return the state on the start line with the feet of each group in a cell of the grid.

        Raises:
            InvalidInput: unless there is one cell of the grid for each group.
        """
        groups, last = len(self.gait.groups), len(self.grid) - 1
        if len(cells) != groups:
            raise InvalidInput(
                f"cells must be {groups} numbers, one for each group of legs, not {len(cells)}"
            )
        for cell in cells:
            if not 0 <= cell <= last:
                raise InvalidInput(f"each of the cells must be from 0 to {last}, not {cell}")
        places = [self.grid.places_m[cell] for cell in cells]
        lateral_m, forward_m = (tuple(place[axis] for place in places) for axis in (0, 1))
        return KinematicState(Feet(tuple(cells), lateral_m, forward_m))

    def step(
        self,
        state: KinematicState,
        action: Action,
        record: bool = False,
        effort: bool = False,  # noqa: ARG002  # nothing has servos here
    ) -> Step[KinematicState]:
        plan = self._motion.plan(state.feet, action)
        distance = state.distance_m + plan.advance_m
        after = KinematicState(plan.end, distance, state.steps + 1)
        motion = self._record(plan, state.distance_m) if record else None
        return Step(after, plan.advance_m, motion)

    def expand(
        self,
        states: Sequence[KinematicState],
        actions: Sequence[Action],
        as_of: int | None = None,  # noqa: ARG002  # no condition changes a step here
    ) -> Expansion[KinematicState]:
        steps = [self.step(s, a) for s, a in zip(states, actions, strict=True)]
        return Expansion([s.state for s in steps], np.array([s.reward_m for s in steps]))

    def estimate(self, state: KinematicState, error_m: FloatArray) -> KinematicState:
        return replace(state, feet=state.feet.moved(error_m))

    def group_offsets(self, state: KinematicState) -> Sequence[tuple[float, float]]:
        return state.feet.offsets_m

    def pose(self, state: KinematicState) -> FloatArray:
        kinematics = self._motion.kinematics
        feet = np.zeros((len(kinematics.legs), 3))
        feet[:, :2] = self.gait.by_leg(np.array((state.feet.lateral_m, state.feet.forward_m)).T)
        angles = kinematics.joint_angles(feet)
        pose: FloatArray = self._qpos(np.array([state.distance_m]), angles[None])[0]
        return pose

    def torso(self, state: KinematicState) -> Sequence[float]:
        # Upright at body height, facing forward.
        half = math.radians(90 - self.gait.forward_deg) / 2
        height_m = self.robot.body_height_m + self.robot.foot_radius_m
        return 0.0, state.distance_m, height_m, math.cos(half), 0.0, 0.0, math.sin(half)

    def dump(self, state: KinematicState) -> dict[str, FloatArray]:
        return {
            "feet": state.feet.as_array(),
            "travel": np.array([state.distance_m, state.steps]),
        }

    def load(self, arrays: dict[str, FloatArray]) -> KinematicState:
        distance, steps = arrays["travel"].tolist()
        return KinematicState(Feet.from_array(arrays["feet"]), distance, int(steps))

    def _record(self, plan: StepPlan, distance_m: float) -> Motion:
        angles = self._motion.joint_targets([plan])[0]  # (recorded substeps, joints)
        place = distance_m + plan.advance_m * self._share_of_advance
        return Motion(self._times_s, self._qpos(place, angles).astype(np.float32))

    def _qpos(self, distance_m: FloatArray, angles: FloatArray) -> FloatArray:
        """Return generalised positions (k, 7 + joints).

        Args:
            distance_m: displacement along the track (world +y), (k,).
            angles: joint angles [rad], (k, joints).
        """
        qpos = np.zeros((len(distance_m), 7 + angles.shape[1]))
        qpos[:, :7] = self.torso(self.rest())
        qpos[:, 1] = distance_m
        qpos[:, 7:] = angles
        return qpos
