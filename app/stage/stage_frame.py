"""What is on stage at one moment, as immutable values: all that drawing and the page need."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from app.domain.gait import Gait
from app.domain.grid import FootGrid
from app.domain.robot import Robot
from app.domain.types import Action, Cells, FloatArray

Kind = Literal["idle", "training", "race"]
Phase = Literal[
    "start-line", "practice", "evaluation", "race", "photo-finish", "finished", "waiting"
]


@dataclass(frozen=True)
class LaneSpec:
    """Who walks on a lane."""

    agent: str
    name: str
    """As people read it."""
    color: str
    """`#RRGGBB`."""


@dataclass(frozen=True)
class SceneSpec:
    """Who is on stage. The scene is built anew when this changes, and only then."""

    kind: Kind
    robot: Robot
    gait: Gait
    grid: FootGrid
    roles: tuple[LaneSpec, ...]
    """One for each lane, from left to right."""


@dataclass(frozen=True, eq=False)
class ActionValuesView:
    """What a learner expects of each move from where it is."""

    values_m: FloatArray
    """(pairs, cells), NaN where illegal."""
    visits: FloatArray
    """(pairs, cells), NaN where illegal."""
    current: Cells
    next: Action | None
    """What it does from here."""
    low_m: float
    """The ends of the colour scale: the lowest and highest value shown of this run so far."""
    high_m: float


@dataclass(frozen=True, eq=False)
class LaneView:
    """One robot as it is shown."""

    qpos: NDArray[np.floating[Any]]
    """(7 + 3 · legs,) in the lane's own frame: the start line is y = 0, the track goes to +y."""
    step: int
    """Steps taken, with the one that it is in."""
    steps: int
    distance_m: float
    """Along the track as drawn: of a race since its start, of practice since the episode began."""
    rank: int = 1
    thinking: bool = False
    futures: int = 0
    """How many transitions it has simulated for this decision."""
    futures_total: int = 0
    done: bool = False
    crossed: bool = False
    """Whether it has passed the finish line."""
    marching: bool = False
    """Whether it gained less than a centimetre in ten steps."""
    failure: str | None = None
    knowledge: ActionValuesView | None = None


@dataclass(frozen=True)
class Ghost:
    """How far the learner came when it was evaluated."""

    step: int
    distance_m: float


@dataclass(frozen=True, eq=False)
class StageFrame:
    """Everything that is on stage at one moment."""

    cast: SceneSpec
    run_id: str | None
    phase: Phase
    label: str
    lanes: tuple[LaneView, ...]
    ghosts: tuple[Ghost, ...] = ()
    time_s: float = 0.0
    duration_s: float | None = None
    """None while nobody knows."""
    shown_speed: float = 1.0
    playing: bool = True
    clock: str = "paper"
    replay: bool = False

    def scene(self) -> dict[str, Any]:
        """The same in plain types for the page, without poses."""
        return {
            "run_id": self.run_id,
            "kind": self.cast.kind,
            "phase": self.phase,
            "time_s": round(self.time_s, 3),
            "duration_s": None if self.duration_s is None else round(self.duration_s, 3),
            "shown_speed": round(self.shown_speed, 2),
            "playing": self.playing,
            "clock": self.clock,
            "replay": self.replay,
            "label": self.label,
            "lanes": [self._lane(number) for number in range(len(self.lanes))],
            "ghosts": [
                {"step": ghost.step, "distance_m": round(ghost.distance_m, 4)}
                for ghost in self.ghosts
            ],
            "knowledge": self._knowledge(),
        }

    def _lane(self, number: int) -> dict[str, Any]:
        lane, role = self.lanes[number], self.cast.roles[number]
        plain = ("step", "steps", "thinking", "futures", "futures_total")
        flags = ("done", "crossed", "rank", "marching", "failure")
        return {
            "lane": number,
            "agent": role.agent,
            "name": role.name,
            "color": role.color,
            "distance_m": round(lane.distance_m, 4),
            **{name: getattr(lane, name) for name in (*plain, *flags)},
        }

    def _knowledge(self) -> dict[str, Any] | None:
        """Of the first lane that has any."""
        learners = ((n, lane.knowledge) for n, lane in enumerate(self.lanes) if lane.knowledge)
        lane, known = next(learners, (0, None))
        if known is None:
            return None
        cast = self.cast
        return {
            "lane": lane,
            "agent": cast.roles[lane].agent,
            "pairs": [list(pair) for pair in cast.gait.pairs],
            "cells_m": cast.grid.cells.round(5).tolist(),
            "cell_names": [cast.grid.name(cell) for cell in range(len(cast.grid))],
            "current": list(known.current),
            "values_m": _table(known.values_m),
            "visits": _table(known.visits),
            "next": None if known.next is None else known.next._asdict(),
            "low": round(known.low_m, 5),
            "high": round(known.high_m, 5),
        }


def _table(values: FloatArray) -> list[list[float | None]]:
    """Rows of numbers; JSON has no NaN."""
    rows: list[list[float]] = values.tolist()
    return [[None if math.isnan(v) else round(v, 5) for v in row] for row in rows]


def yaw_rad(wxyz: NDArray[np.floating[Any]]) -> float:
    """How far an attitude is turned about the vertical, anticlockwise from above."""
    w, x, y, z = wxyz.tolist()
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def turned(pose: FloatArray, about: FloatArray, turn_rad: float) -> FloatArray:
    """A pose, (7 + joints,), with `about` (x, y) put on the origin and the world turned about it.

    Height, tilt and joints stay as they are.
    """
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    half_cos, half_sin = math.cos(turn_rad / 2), math.sin(turn_rad / 2)
    x, y = pose[:2] - about
    w, i, j, k = pose[3:7]
    seen = pose.copy()
    seen[:2] = cos * x - sin * y, sin * x + cos * y
    seen[3:7] = (
        half_cos * w - half_sin * k,
        half_cos * i - half_sin * j,
        half_cos * j + half_sin * i,
        half_cos * k + half_sin * w,
    )
    return seen
