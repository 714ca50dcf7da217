"""Results of trainings and races, as answers, files and the database have them.

Each record is declared here, with its limits: what reads one from JSON checks them. How the lanes
of a race are ranked is here, too.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any

from annotated_types import Ge, Le, MaxLen, MinLen, Predicate

from hexapods.agents.protocol import Tabular
from hexapods.domain.posture import have_fallen, heading_deg
from hexapods.domain.robot import Robot
from hexapods.domain.short_repr import short_repr
from hexapods.domain.sums import ordered_sum
from hexapods.domain.text import MAX_MESSAGE, message
from hexapods.domain.world import World
from hexapods.runs.best_known import best_known_m
from hexapods.runs.clocks import CLOCKS, Clock, Timetable, crossing_s, distance_at
from hexapods.runs.config import MAX_STEPS, TrainingConfig
from hexapods.runs.lane import PlanningModel, plans_with
from hexapods.runs.race_config import MAX_LANES, RaceConfig
from hexapods.runs.recording import LaneRecording, recording_sha256
from hexapods.runs.records import Evaluated
from hexapods.runs.training import Learner, evaluate, measure_baseline

Metres = Annotated[float, Ge(-1e6), Le(1e6)]
Seconds = Annotated[float, Ge(0), Le(1e9)]
StepNumber = Annotated[int, Ge(0), Le(MAX_STEPS)]
Count = Annotated[int, Ge(0), Le(2**53)]
"""Any other count, up to JavaScript's largest exact integer."""


def _is_hexadecimal(text: str) -> bool:
    return not set(text) - set("0123456789abcdef")


def _is_storable(text: str) -> bool:
    return "\0" not in text  # which no database stores


Sha256 = Annotated[str, MinLen(64), MaxLen(64), Predicate(_is_hexadecimal)]
Message = Annotated[str, MaxLen(MAX_MESSAGE), Predicate(_is_storable)]


@dataclass(frozen=True, kw_only=True)
class TrainingResult:
    """Final distance [m] of the agent and of the greedy reference, and the Q-table's hash.

    Both walked in the world as it was at the end. `fell_at_step` is the first step of practice,
    counted from 0, in which the robot fell.
    """

    __repr__ = short_repr

    distance_m: Metres | None
    greedy_distance_m: Metres | None = None
    best_known_m: Metres | None = None
    q_table_sha256: Sha256 | None = None
    fell_at_step: StepNumber | None = None


@dataclass(frozen=True, kw_only=True)
class FiguresUnderClock:
    """Figures of a lane under one clock; lanes are ranked by the distance at time-out.

    Without a time-out, as of a race that was stopped before, there are no ranks.
    """

    finished_distance_m: Metres | None
    elapsed_s: Seconds
    crossed_s: Seconds | None
    rank: Annotated[int, Ge(1), Le(MAX_LANES)] | None


@dataclass(frozen=True, kw_only=True)
class LaneFigures:
    """Figures of a lane under each clock."""

    paper: FiguresUnderClock
    wall: FiguresUnderClock
    free: FiguresUnderClock

    def under(self, clock: Clock) -> FiguresUnderClock:
        """Return the figures under one clock."""
        figures: FiguresUnderClock = getattr(self, clock)
        return figures


@dataclass(frozen=True, kw_only=True)
class LaneResult:
    """Result of a lane. Deterministic except for `decision_s` and the `wall` clock.

    A lane that did not take all its steps has no total distance, and its failure as the reason.
    `trained_robot` is set if its table was learned on another robot. `plans_with` is what its
    search knew, null if it does not search. `fell_at_step` is counted from 0, null if it did not
    fall; `heading_deg` is its heading at the end: 0 along the track, and 90 to the left.
    """

    __repr__ = short_repr

    agent: Message
    training_id: str | None = None
    trained_robot: Mapping[str, Any] | None = None
    steps: StepNumber
    total_distance_m: Metres | None
    failure: Message | None
    decision_s: Seconds
    simulated_transitions: Count
    clocks: LaneFigures
    plans_with: PlanningModel | None = None
    fell_at_step: StepNumber | None = None
    heading_deg: Annotated[float, Ge(-180), Le(180)] | None = None


@dataclass(frozen=True, kw_only=True)
class RaceResult:
    """Result of a race, by lane.

    `recording_sha256` is a hash of all steps without the times of decisions, the same wherever the
    race is repeated. `shared_machine`: whether other
    runs computed beside it, which slows its wall clock.
    """

    __repr__ = short_repr

    lanes: Annotated[tuple[LaneResult, ...], MaxLen(MAX_LANES)]
    recording_sha256: Sha256 | None = None
    shared_machine: bool = False


def training_result(
    learner: Learner,
    config: TrainingConfig,
    measure_reference: bool = True,
    evaluated: Evaluated | None = None,
) -> TrainingResult:
    """Compute the result of a training: an evaluation, its references, the hash of the Q-table.

    Args:
        learner: the training's state.
        config: the training's config.
        measure_reference: whether to measure the baseline; without it `greedy_distance_m` is None
            unless it was measured before.
        evaluated: the evaluation of the learner as it is, if there was one; it is not repeated.
    """
    evaluated = evaluated or evaluate(learner, config, learner.epsilon)
    conditions = learner.conditions(config.steps)
    is_measured = learner.greedy_distance_m is not None and learner.measured_in == conditions
    if measure_reference and not is_measured:
        measure_baseline(learner, config, conditions)
    agent, is_known = learner.walker.agent, is_measured or measure_reference
    return TrainingResult(
        distance_m=evaluated.distance_m,
        greedy_distance_m=learner.greedy_distance_m if is_known else None,
        best_known_m=best_known_m(config, conditions),
        q_table_sha256=agent.table.sha256() if isinstance(agent, Tabular) else None,
        fell_at_step=learner.fell_at_step,
    )


def race_result(lanes: Sequence[LaneRecording], config: RaceConfig) -> RaceResult:
    """Compute the result of a race from its recording, complete or not.

    Of a race that was stopped before time-out no lane has a rank.
    """
    figures = {clock: lane_figures(lanes, config.steps, clock) for clock in CLOCKS}
    return RaceResult(
        lanes=tuple(
            LaneResult(
                agent=lane.agent,
                steps=len(lane.steps),
                total_distance_m=lane.distance_m if len(lane.steps) == config.steps else None,
                failure=None if lane.failure is None else message(lane.failure),
                decision_s=decision_s(lane),
                simulated_transitions=int(lane.steps.figures["transitions"].sum()),
                clocks=LaneFigures(**{clock: figures[clock][number] for clock in CLOCKS}),
                plans_with=plans_with(config.lanes[number], config),
                fell_at_step=fell_at_step(lane, config.robot, config.world),
                heading_deg=heading_deg(
                    lane.start_qpos(len(lane.steps)).tolist(), lane.rest_qpos.tolist()
                ),
            )
            for number, lane in enumerate(lanes)
        ),
        recording_sha256=recording_sha256(lanes),
    )


def decision_s(lane: LaneRecording) -> float:
    """Return the time that a lane thought, in all its steps [s]."""
    return float(ordered_sum(lane.steps.figures["decision_s"].tolist()))


def fell_at_step(lane: LaneRecording, robot: Robot, world: World, first: int = 0) -> int | None:
    """Return the first step, from `first` on, in which the robot fell; None if in none.

    Steps are counted from 0.
    """
    tilts = lane.steps.figures["tilt"]
    for begin, end in pairwise(sorted({first, *world.change_steps, len(tilts)})):
        if first <= begin:
            fallen = have_fallen(robot, tilts[begin:end].astype(float), world.ground_m(begin))
            if fallen.any():
                return begin + int(fallen.argmax())
    return None


def finish_s(lanes: Sequence[LaneRecording], steps: int, clock: Clock) -> float | None:
    """Return the time-out: when the first lane has used all its steps [s].

    None if no lane has, or if another was not computed up to then: of a race that goes on or was
    stopped. A lane that failed stays where it is.
    """
    ends = [Timetable.of(lane.steps, clock).total_s for lane in lanes]
    used_all = [len(lane.steps) == steps for lane in lanes]
    return time_out_s(ends, used_all, [lane.failure is not None for lane in lanes])


def time_out_s(
    ends_s: Sequence[float], used_all: Sequence[bool], failed: Sequence[bool]
) -> float | None:
    """Return the time-out of lanes that are computed up to these times [s]; see `finish_s`."""
    first = min((end for end, used in zip(ends_s, used_all, strict=True) if used), default=None)
    if first is None:
        return None
    lanes = zip(ends_s, used_all, failed, strict=True)
    is_known = all(used or has_failed or end >= first for end, used, has_failed in lanes)
    return first if is_known else None


def lane_figures(
    lanes: Sequence[LaneRecording], steps: int, clock: Clock
) -> list[FiguresUnderClock]:
    """Compute each lane's figures under one clock; lanes are ranked by distance at time-out.

    Without a time-out they have neither ranks nor distances at it.
    """
    tables = [Timetable.of(lane.steps, clock) for lane in lanes]
    finish = finish_s(lanes, steps, clock)
    finished = (
        []
        if finish is None
        else [distance_at(lane, table, finish) for lane, table in zip(lanes, tables, strict=True)]
    )
    return [
        FiguresUnderClock(
            finished_distance_m=finished[number] if finished else None,
            elapsed_s=table.total_s,
            crossed_s=crossing_s(lanes[number], table),
            rank=1 + sum(o > finished[number] for o in finished) if finished else None,
        )
        for number, table in enumerate(tables)
    ]
