"""View of a stage frame that is sent to pages: without poses, in rounded numbers."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge

from hexapods.domain.records import Record
from hexapods.domain.types import FloatArray
from hexapods.runs.clocks import Clock
from hexapods.shows.stage_frame import LaneFrame, LaneSpec, StageFrame

_Count = Annotated[int, Ge(0)]


@dataclass(frozen=True, kw_only=True)
class SceneLane(Record):
    """A lane at the moment that the stage shows; `halted` if its run ended before it was done.

    Attributes:
        step: number of the present step, from 1; at the end of the lane the last.
        steps_made: steps that have ended.
        done: whether it has used all its steps, or failed.
    """

    lane: _Count
    agent: str
    name: str
    color: str
    distance_m: float
    step: _Count
    steps: _Count
    steps_made: _Count
    thinking: bool
    futures: _Count
    futures_total: _Count
    done: bool
    halted: bool
    crossed: bool
    rank: int
    marching: bool
    failure: str | None


@dataclass(frozen=True, kw_only=True)
class GhostView(Record):
    """A robot in the state after an earlier evaluation."""

    step: _Count
    distance_m: float


@dataclass(frozen=True, kw_only=True)
class GhostLane(GhostView):
    """A robot of another run that is shown as a ghost."""

    lane: _Count
    name: str


@dataclass(frozen=True, kw_only=True)
class NextAction(Record):
    """An action: the leg pair, and the cell to which it moves."""

    pair: _Count
    cell: _Count


@dataclass(frozen=True, kw_only=True)
class SceneActionValues(Record):
    """Action values of a learner in its present state.

    Attributes:
        values_m: action values by leg pair and cell; null where the foot already stands.
        current: the cell of each leg pair.
    """

    agent: str
    lane: _Count
    pairs: list[list[int]]
    cell_names: list[str]
    cells_m: list[tuple[float, float]]
    values_m: list[list[float | None]]
    visits: list[list[float | None]]
    current: list[int]
    next: NextAction | None
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class SceneView(Record):
    """The moment of a run that the stage shows, without poses.

    Attributes:
        computed_s: time of the run up to which it is computed.
    """

    run_id: str | None
    kind: Literal["idle", "training", "race"]
    phase: str
    time_s: float
    duration_s: float | None
    computed_s: float
    time_out_s: float | None
    ended: bool
    shown_speed: float
    playing: bool
    clock: Clock
    replay: bool
    label: str
    lanes: list[SceneLane]
    ghosts: list[GhostView]
    ghost_lanes: list[GhostLane]
    action_values: SceneActionValues | None


def scene_view(frame: StageFrame) -> SceneView:
    """Return the view of a stage frame that is sent to pages, in rounded numbers."""
    lanes = zip(frame.lanes, frame.spec.lane_specs, strict=False)
    return SceneView(
        run_id=frame.run_id,
        kind=frame.spec.kind,
        phase=frame.phase,
        time_s=round(frame.time_s, 3),
        duration_s=None if frame.duration_s is None else round(frame.duration_s, 3),
        computed_s=round(frame.computed_s, 3),
        time_out_s=None if frame.time_out_s is None else round(frame.time_out_s, 3),
        ended=frame.ended,
        shown_speed=round(frame.shown_speed, 2),
        playing=frame.playing,
        clock=frame.clock,
        replay=frame.replay,
        label=frame.label,
        lanes=[_lane(number, lane, spec) for number, (lane, spec) in enumerate(lanes)],
        ghosts=[
            GhostView(step=ghost.step, distance_m=round(ghost.distance_m, 4))
            for ghost in frame.ghosts
        ],
        ghost_lanes=_ghost_lanes(frame),
        action_values=_action_values(frame),
    )


def _lane(number: int, lane: LaneFrame, spec: LaneSpec) -> SceneLane:
    return SceneLane(
        lane=number,
        agent=spec.agent,
        name=spec.name,
        color=spec.color,
        distance_m=round(lane.distance_m, 4),
        step=lane.step,
        steps=lane.steps,
        steps_made=lane.steps_made,
        thinking=lane.thinking,
        futures=lane.futures,
        futures_total=lane.futures_total,
        done=lane.done,
        halted=lane.halted,
        crossed=lane.crossed_s is not None,
        rank=lane.rank,
        marching=lane.marching,
        failure=lane.failure,
    )


def _ghost_lanes(frame: StageFrame) -> list[GhostLane]:
    """Return the ghosts of another run by lane; none before the two runs part."""
    lane_specs = (frame.spec.ghosts or frame.spec).lane_specs
    return [
        GhostLane(
            lane=number,
            name=lane_specs[number].name,
            distance_m=round(ghost.distance_m, 4),
            step=ghost.step,
        )
        for number, ghost in enumerate(frame.ghost_lanes)
        if ghost is not None
    ]


def _action_values(frame: StageFrame) -> SceneActionValues | None:
    """Return the action values of the first lane that has any."""
    spec = frame.spec
    for number, lane in enumerate(frame.lanes):
        if (values := lane.action_values) is None:
            continue
        action = values.next
        return SceneActionValues(
            lane=number,
            agent=spec.lane_specs[number].agent,
            pairs=[list(group) for group in spec.gait.groups],
            cells_m=[(x_m, y_m) for x_m, y_m in spec.grid.cells.round(5).tolist()],
            cell_names=[spec.grid.name(cell) for cell in range(len(spec.grid))],
            current=list(values.current),
            values_m=_table(values.values_m),
            visits=_table(values.visits),
            next=None if action is None else NextAction(pair=action.group, cell=action.cell),
            low=round(values.low_m, 5),
            high=round(values.high_m, 5),
        )
    return None


def _table(values: FloatArray) -> list[list[float | None]]:
    """Return rows of rounded numbers, with None for NaN, which JSON lacks."""
    rows: list[list[float]] = values.tolist()
    return [[None if math.isnan(v) else round(v, 5) for v in row] for row in rows]
