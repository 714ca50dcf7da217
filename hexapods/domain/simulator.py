"""The simulator protocol: immutable states, single steps, and batches of steps."""

from collections.abc import Sequence
from typing import Generic, Literal, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.feet import Feet, StepLaw
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import Robot
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.domain.world import World

RECORDING_HZ = 50
RewardKind = Literal["forward", "track"]
"""Displacement that a step's reward is: `forward`, along the robot's own forward direction at the
start of the step; `track`, along the track. Both are the same for a robot that does not turn."""


class WalkState(Protocol):
    """Immutable state of a walk between two steps; simulators add the fields that they need."""

    @property
    def feet(self) -> Feet:
        """Foot offsets by dead reckoning: where the feet would be if nothing had slipped."""

    @property
    def commanded(self) -> Cells:
        """The cell that each group was last sent to."""

    @property
    def distance_m(self) -> float:
        """Displacement of the torso's centre along the track (world +y) since the start."""

    @property
    def steps(self) -> int:
        """Number of steps taken since rest."""


S = TypeVar("S", bound=WalkState)


class Motion(NamedTuple):
    """Recorded motion of a robot during a step, at `RECORDING_HZ`."""

    time_s: NDArray[np.float32]
    """Times since the step's start, (k,); the last is the step's end."""
    qpos: NDArray[np.float32]
    """Torso position [m], its rotation (quaternion wxyz), joint angles [rad],
    (k, 7 + joints)."""
    torque_nm: NDArray[np.float16] | None = None
    """Largest torque by magnitude of each servo since the frame before [N·m], (k, joints); None if
    it was not recorded, or the simulator has no servos."""
    work_j: NDArray[np.float32] | None = None
    """Positive mechanical work of all servos since the frame before [J], (k,); None as above."""

    def __repr__(self) -> str:
        return f"<Motion of {len(self.time_s)} poses>"


class Step(NamedTuple, Generic[S]):
    """Result of one step: the next state, its reward, and the motion if recorded."""

    state: S
    reward_m: float
    """Displacement of the torso's centre in the step, as the simulator's `RewardKind` says."""
    motion: Motion | None
    """The motion between the two states, if `record` was set."""


class Expansion(NamedTuple, Generic[S]):
    """Results of n independent steps."""

    states: list[S]
    rewards_m: FloatArray
    """As `Step.reward_m`, (n,)."""


class Simulator(Protocol[S]):
    """Simulator of a robot on the track, under one gait and foot grid.

    Results are deterministic to the last bit, and do not depend on the batch size.
    """

    robot: Robot
    gait: Gait
    grid: FootGrid
    world: World
    law: StepLaw

    def rest(self) -> S:
        """Return the state at rest on the start line, with every foot at home."""

    def step(self, state: S, action: Action, record: bool = False, effort: bool = False) -> Step[S]:
        """Carry out one action.

        Args:
            state: the state before.
            action: the action.
            record: whether to return the motion.
            effort: whether the motion includes torque and work of the servos, where there are any;
                a recorded step takes 5 % longer with them.

        Raises:
            Diverged: if the physics diverges; the message names the step.
        """

    def expand(
        self, states: Sequence[S], actions: Sequence[Action], as_of: int | None = None
    ) -> Expansion[S]:
        """Carry out one action from each state, with the results of `step` but without pushes.

        Args:
            states: n states.
            actions: one action for each.
            as_of: the step whose conditions hold for all states; None for each state's own step.

        Raises:
            Diverged: if the physics diverges.
        """

    def estimate(self, state: S, error_m: FloatArray) -> S:
        """Return a state as sensors measure it: with errors of the feet, otherwise exact.

        Args:
            state: the true state.
            error_m: errors of the measured offsets of the groups, (groups, 2) [m].
        """

    def group_offsets(self, state: S) -> Sequence[tuple[float, float]]:
        """Return the feet's actual offsets (x, y) from home in the robot frame [m], per group.

        Each is the mean of the group's feet, mirrored as the gait says.
        """

    def pose(self, state: S) -> FloatArray:
        """Return torso position [m], rotation (wxyz) and joint angles [rad], (7 + joints,)."""

    def torso(self, state: S) -> Sequence[float]:
        """Return the first seven numbers of `pose`, which may take less time than all."""

    def dump(self, state: S) -> dict[str, FloatArray]:
        """Serialise a state as named arrays, for storage."""

    def load(self, arrays: dict[str, FloatArray]) -> S:
        """Restore a state from the arrays of `dump`, to the last bit."""
