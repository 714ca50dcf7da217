"""Response models of what runs recorded: curves, tables, walks, timelines and replays."""

from typing import Literal

from app.answer import Answer, Count
from hexapods.domain.gait import AnyGait
from hexapods.runs.clocks import Clock
from hexapods.shows.show import MarkKind


class Evaluation(Answer):
    """Evaluation of a training: the distance walked [m] after `step` steps of practice."""

    step: Count
    distance_m: float
    epsilon: float


class CurveView(Answer):
    """A learning curve with its references: greedy's distance, and the best known one [m].

    Both are of the world as it is now; the best known is null where it was not computed.
    """

    evaluations: list[Evaluation]
    greedy_distance_m: float | None
    best_known_m: float | None


class ThinnedCurve(Answer):
    """A few points of a training's learning curve, by step."""

    id: str
    steps: list[Count]
    distances_m: list[float | None]


class CurvesView(Answer):
    """Thinned learning curves, of the runs that have one, in the order of their ids."""

    curves: list[ThinnedCurve]


class ActionValue(Answer):
    """Value of an action, [pair, cell], in a state, which is the cell of each pair."""

    state: list[int]
    action: tuple[int, int]
    value: float
    visits: Count


class LandingValue(Answer):
    """Value of a landing, which is the cell of each pair when a step has ended."""

    landing: list[int]
    value: float
    visits: Count


class QTableView(Answer):
    """Q-table; `cells` are the (x, y) of each cell [m].

    `values` are those of all legal actions in all states, or of a learner over landings those of
    all landings.
    """

    gait: AnyGait
    divisions: int
    grid_side_m: float
    cells: list[tuple[float, float]]
    values: list[ActionValue] | list[LandingValue]


class RecordedStep(Answer):
    """A recorded step, with the joint positions `qpos` at `time_s` since the motion began."""

    step: Count
    observation: list[int]
    action: tuple[int, int]
    reward_m: float
    distance_m: float
    transitions: Count
    decision_s: float
    time_s: list[float]
    qpos: list[list[float]]


class RecordedLane(Answer):
    """A lane of a recording; `rest_qpos` are the joint positions before the first step."""

    agent: str
    training_id: str | None
    failure: str | None
    rest_qpos: list[float]
    steps: list[RecordedStep]


class RecordingView(Answer):
    """Recording of a race, sufficient to replay it."""

    steps: int
    lanes: list[RecordedLane]


class TimelineLane(Answer):
    """A lane's distance over time: points are [s, m], decision intervals are [from s, to s].

    Of a lane of more than 2,000 steps, `stride` steps together are told as one: it decides on all
    of them, then walks.

    Attributes:
        steps: that it has taken so far.
        stride: number of steps told as one; 1 in all but long races.
    """

    agent: str
    training_id: str | None
    color: str
    steps: Count
    stride: int
    points: list[tuple[float, float]]
    thinking: list[tuple[float, float]]
    futures: list[int]
    crossed_s: float | None
    total_s: float
    failure: str | None


class TimelineView(Answer):
    """Timeline of a race under one clock."""

    clock: Clock
    steps: int
    finish_line_m: float
    first_finish_s: float | None
    lanes: list[TimelineLane]


class ReplayMark(Answer):
    """Something that happened in a run, as a point on its timeline.

    Attributes:
        lane: from 0; null if it concerns all lanes.
        step: that begins then, or in which a robot fell, from 0.
        distance_m: that an evaluation reached.
    """

    kind: MarkKind
    time_s: float
    lane: int | None
    step: int | None
    distance_m: float | None


class ReplayView(Answer):
    """Plan by which a page plays a run by itself; times are the run's own [s].

    Attributes:
        ghost_id: of the run whose lanes are shown as ghosts.
        clock: that times a race; null for a training.
        complete: whether the run will record no more.
        duration_s: null while it is not known.
        recorded_s: intervals that can be shown; of a long practice the first and newest steps.
        step_ends_s: for each lane, of its recorded steps.
        frame_s: time between two frames of level 0.
        segment_frames: number of frames in a segment.
        lowest_level: each level has half as many frames as the one below.
    """

    run_id: str
    ghost_id: str | None
    kind: Literal["training", "race"]
    clock: Clock | None
    complete: bool
    duration_s: float | None
    recorded_s: list[tuple[float, float]]
    step_ends_s: list[list[float]]
    marks: list[ReplayMark]
    frame_s: float
    segment_frames: int
    lowest_level: int
    highest_level: int
