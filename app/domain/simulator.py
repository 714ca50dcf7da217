"""What every simulator offers: immutable states, one step, and many steps at once."""

from collections.abc import Sequence
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.domain.gait import Gait
from app.domain.grid import FootGrid
from app.domain.robot import Robot
from app.domain.types import Action, Cells, FloatArray

RECORDING_HZ = 50


class WalkState(Protocol):
    """A robot in the world, as an immutable value; simulators add what they need to go on."""

    @property
    def commanded(self) -> Cells:
        """The cell that each pair was last sent to."""

    @property
    def distance_m(self) -> float:
        """Displacement of the torso's centre along the track since the start."""

    @property
    def steps(self) -> int:
        """How many steps led from rest to here."""


S = TypeVar("S", bound=WalkState)


class Motion(NamedTuple):
    """What a robot did during a step, at `RECORDING_HZ`."""

    time_s: NDArray[np.float32]
    """(k,) since the step's start; the last is the step's end."""
    qpos: NDArray[np.float32]
    """(k, 7 + 3 · legs): place of the torso [m], its attitude (wxyz), joint angles [rad]."""


class Step(NamedTuple, Generic[S]):
    """What came of one step."""

    state: S
    reward_m: float
    """Displacement along the robot's own forward direction at the start of the step."""
    motion: Motion | None
    """In between, where it was asked for."""


class Expansion(NamedTuple, Generic[S]):
    """What came of many steps, each from a state of its own."""

    states: list[S]
    rewards_m: FloatArray
    """(n,)"""


class Simulator(Protocol[S]):
    """A robot on the track under one gait and foot grid.

    Results repeat to the last bit, and do not depend on how many are computed at once.
    """

    robot: Robot
    gait: Gait
    grid: FootGrid

    def rest(self) -> S:
        """The robot at rest on the start line, every foot at home."""

    def step(self, state: S, action: Action, record: bool = False) -> Step[S]:
        """Carry out one action.

        Raises:
            Diverged: if the physics breaks; the message names the step.
        """

    def expand(self, states: Sequence[S], actions: Sequence[Action]) -> Expansion[S]:
        """Carry out one action from each state, as `step` would."""

    def pair_offsets(self, state: S) -> Sequence[tuple[float, float]]:
        """Where the feet truly are: offsets (x, y) from home in the robot frame [m].

        For each pair the mean of its leader's and its mirrored partner's.
        """

    def pose(self, state: S) -> FloatArray:
        """Place and attitude of the torso and the joint angles, (7 + 3 · legs,)."""

    def dump(self, state: S) -> dict[str, FloatArray]:
        """All of a state as arrays, for a file."""

    def load(self, arrays: dict[str, FloatArray]) -> S:
        """The state that `dump` wrote, to the last bit."""
