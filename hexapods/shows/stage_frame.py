"""Immutable snapshot of the stage at one moment: all that the viewer and the page draw from."""

import math
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.disturbances import Push
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import Robot
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.clocks import Clock

Kind = Literal["idle", "training", "race"]
Phase = Literal[
    "start-line", "practice", "evaluation", "race", "photo-finish", "finished", "waiting"
]


@dataclass(frozen=True)
class LaneSpec:
    """Agent, display name and colour of a lane."""

    agent: str
    name: str
    """Display name."""
    color: str
    """`#RRGGBB`."""


@dataclass(frozen=True)
class SceneSpec:
    """The constant part of a scene. The viewer rebuilds its scene graph only when this changes."""

    kind: Kind
    robot: Robot
    gait: Gait
    grid: FootGrid
    lane_specs: tuple[LaneSpec, ...]
    """One for each lane, from left to right."""
    ghosts: "SceneSpec | None" = None
    """The scene of the run whose lanes are shown as ghosts; None if it is this one."""


@dataclass(frozen=True, eq=False)
class ActionValuesView:
    """Action values of a learner in its present state, with their visit counts."""

    values_m: FloatArray
    """(groups, cells), NaN where illegal."""
    visits: FloatArray
    """(groups, cells), NaN where illegal."""
    current: Cells
    """Cell of each group of legs."""
    next: Action | None
    """Action taken in this state."""
    low_m: float
    """Lower end of the colour scale; both ends span all values shown of this run so far."""
    high_m: float


class Origin(NamedTuple):
    """Position and rotation of one frame on the ground in another."""

    x_m: float
    y_m: float
    turn_rad: float
    """Anticlockwise from above."""


AT_ORIGIN = Origin(0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class LaneFrame:
    """State of the robot of a lane at one moment."""

    qpos: NDArray[np.floating[Any]]
    """(7 + 3 · legs,) in the lane's own frame: the start line is y = 0, the track goes to +y."""
    step: int
    """Number of steps taken, the current one included."""
    steps: int
    distance_m: float
    """Distance along the track as drawn: since the start of the race, or of the episode."""
    steps_made: int = 0
    """Number of steps that have ended."""
    rank: int = 1
    thinking: bool = False
    """Whether it is computing a decision by look-ahead."""
    futures: int = 0
    """Number of transitions simulated so far for this decision."""
    futures_total: int = 0
    """Number of transitions that this decision simulates in all."""
    done: bool = False
    """Whether it takes no further steps: it has used all of them, or failed."""
    halted: bool = False
    """Whether it takes no further steps because its run ended before, as one that was stopped."""
    crossed_s: float | None = None
    """Race time at which it crossed the finish line [s]; None if it has not by now."""
    marching: bool = False
    """Whether it steps on the spot: under 1 cm gained in ten steps."""
    failure: str | None = None
    fell_at_step: int | None = None
    """First step in which it fell, counted from 0; None if it has not fallen so far."""
    action_values: ActionValuesView | None = None
    conditions: World = UNDISTURBED
    """Conditions in the step that is shown, a result of `World.as_of`."""
    pushes: tuple[Push, ...] = ()
    """Pushes in the step that is shown."""
    origin: Origin = AT_ORIGIN
    """Pose of the lane's frame on the ground; in a race the ground's own origin."""


@dataclass(frozen=True)
class Ghost:
    """Distance that the learner reached in one evaluation, shown as a ghost."""

    step: int
    distance_m: float
    conditions: World = UNDISTURBED
    """Conditions in the evaluation, a result of `World.as_of`."""


@dataclass(frozen=True, eq=False)
class StageFrame:
    """State of the whole stage at one moment."""

    spec: SceneSpec
    run_id: str | None
    phase: Phase
    label: str
    lanes: tuple[LaneFrame, ...]
    ghosts: tuple[Ghost, ...] = ()
    """Evaluations so far, of a training."""
    ghost_lanes: tuple[LaneFrame | None, ...] = ()
    """Lanes of another run at the same time of its own, drawn as ghosts on the lanes of the same
    number: of the race from which this one branched off, from the branch on, or of a run that is
    compared. Empty without one; there may be more or fewer than `lanes`."""
    time_s: float = 0.0
    duration_s: float | None = None
    """None while it is unknown, since the run is still computed."""
    computed_s: float = 0.0
    """Time of the run up to which it is computed, and can be shown [s]."""
    time_out_s: float | None = None
    """Time-out of a race [s]; None of a training, and until it is known."""
    ended: bool = False
    """Whether playback has ended: at the end of the run, or of a race at its time-out."""
    shown_speed: float = 1.0
    playing: bool = True
    clock: Clock = "paper"
    replay: bool = False


def rotated(pose: FloatArray, about: FloatArray, turn_rad: float) -> FloatArray:
    """Return a pose translated in the plane and then rotated about the vertical.

    Args:
        pose: qpos, (7 + joints,): position [m], quaternion wxyz, joint angles [rad].
        about: (x, y) of the point that becomes the origin [m].
        turn_rad: angle of the rotation about the new origin, anticlockwise [rad].

    Returns:
        a new qpos, with height, tilt and joints unchanged.
    """
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    half_cos, half_sin = math.cos(turn_rad / 2), math.sin(turn_rad / 2)
    x, y = pose[:2] - about
    w, i, j, k = pose[3:7]
    result = pose.copy()
    result[:2] = cos * x - sin * y, sin * x + cos * y
    result[3:7] = (
        half_cos * w - half_sin * k,
        half_cos * i - half_sin * j,
        half_cos * j + half_sin * i,
        half_cos * k + half_sin * w,
    )
    return result
