"""The race of a class: its best, its median and its last robot of a card, side by side.

A participant's run is recorded alone. The race puts the recorded lanes of several of them beside
each other, in a run of its own that ended as it began: it is shown as any race, and nothing of it
is computed by chance again. Of a practice the walk of its last evaluation is repeated with its own
random numbers, which gives the same steps.
"""

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from datetime import UTC, datetime
from typing import Any, NamedTuple

from app.answer import Answer, Count
from app.features.classroom.room import Room
from app.features.classroom.room_rows import RoomRun
from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.recordings import Recordings
from app.storage.run import Run
from app.storage.stored_tables import load_table
from hexapods.assembly import build_learner
from hexapods.domain.errors import HexapodError
from hexapods.domain.text import MAX_NAME, check_name
from hexapods.runs.config import RACE_STEPS, TrainingConfig, WalkingProblem
from hexapods.runs.lane import LaneConfig, lane_config
from hexapods.runs.race_config import MAX_RACE_STEPS, RaceConfig
from hexapods.runs.race_file import race_chunks
from hexapods.runs.racing import record_race
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import TrainingResult, race_result
from hexapods.runs.seeding import EVALUATION, generator

RACED = "class race"
"""Key of the settings of a class race, below which are the seeds of its lanes."""
_SAME_M = 1e-9


class ClassRaceView(Answer):
    """The race of a card's best, median and last robot.

    Attributes:
        run_id: id of the race.
        seeds: seeds of its lanes, from left to right: the best, then the median, then the last.
        of: number of robots among which they are: those that walk alike, of which most do.
    """

    run_id: str
    seeds: list[Count]
    of: Count


class Finisher(NamedTuple):
    """A participant's finished run on a card, and how far its robot walked."""

    seed: int
    run_id: str
    distance_m: float


class ClassRace(NamedTuple):
    """A race of recorded lanes.

    Attributes:
        seeds: seeds of its lanes.
        of: number of robots among which they are.
        config: its config.
        training_ids: of each lane the training that has taught its agent.
        lanes: the recordings of its lanes.
    """

    seeds: tuple[int, ...]
    of: int
    config: RaceConfig
    training_ids: tuple[str | None, ...]
    lanes: Sequence[LaneRecording]

    @property
    def given(self) -> dict[str, Any]:
        """The settings of its link to the room."""
        return {RACED: {"seeds": list(self.seeds), "of": self.of}}

    def run(self, run_id: str, name: str) -> Run:
        """Return it as a run that has finished."""
        now = datetime.now(UTC)
        total = sum(len(lane.steps) for lane in self.lanes)  # whole numbers
        return Run(
            id=run_id,
            kind="race",
            name=check_name(name[:MAX_NAME]),
            state="finished",
            config=self.config,
            lane_training_ids=self.training_ids,
            done=total,
            total=total,
            result=race_result(self.lanes, self.config),
            created_at=now,
            started_at=now,
            ended_at=now,
        )

    def file(self) -> bytes:
        """Return its recording as a file."""
        return b"".join(race_chunks(self.lanes))


def class_race(
    store: RunStore, recordings: Recordings, finishers: Sequence[Finisher]
) -> ClassRace | None:
    """Return the race of the best, the median and the last of the robots that walk alike.

    Robots walk alike if all but what they have learned is the same: legs, gait, grid, simulator and
    world. Of several kinds the one with most robots races, of equal ones that with the best robot.

    Args:
        store: store of the runs.
        recordings: their recordings.
        finishers: the finished runs, in any order.

    Returns:
        the race; None if there is no run that can be shown: they were deleted, or what an agent
        learned cannot be read any more.
    """
    by_distance = sorted(finishers, key=lambda finisher: (-finisher.distance_m, finisher.seed))
    runs = [(finisher, _walk_of(store, finisher.run_id)) for finisher in by_distance]
    kinds = Counter(repr(vars(walk.problem)) for _, walk in runs if walk is not None)
    if not kinds:
        return None
    (kind, of), *_ = kinds.most_common(1)  # of equal ones the first, which has the best robot
    alike = [(f, walk) for f, walk in runs if walk is not None and repr(vars(walk.problem)) == kind]
    chosen = {f.seed: walk for f, walk in (alike[0], alike[len(alike) // 2], alike[-1])}
    lanes = {seed: _lane(store, recordings, walk) for seed, walk in chosen.items()}
    recorded = {seed: lane for seed, lane in lanes.items() if lane is not None}
    if not recorded:
        return None
    steps = min(len(lane.steps) for lane in recorded.values())
    steps = min(steps, MAX_RACE_STEPS // len(recorded))
    config = RaceConfig(
        **vars(alike[0][1].problem),
        lanes=tuple(chosen[seed].lane for seed in recorded),
        steps=steps,
    )
    return ClassRace(
        seeds=tuple(recorded),
        of=of,
        config=config,
        training_ids=tuple(chosen[seed].training_id for seed in recorded),
        lanes=[_as_lane(n, lane, steps) for n, lane in enumerate(recorded.values())],
    )


def class_race_of(room: Room, card: int) -> ClassRaceView | None:
    """Return the newest class race of a card; None if there is none."""
    races = [run for run in room.runs.values() if run.card == card and RACED in run.given]
    return _view(races[-1], room) if races else None


def _view(run: RoomRun, room: Room) -> ClassRaceView:
    raced: Mapping[str, object] = run.given[RACED]
    seeds, of = raced.get("seeds"), raced.get("of")
    return ClassRaceView(
        run_id=run.run_id,
        seeds=[s for s in seeds if s in room.participants] if isinstance(seeds, list) else [],
        of=of if isinstance(of, int) else 0,
    )


class _Walk(NamedTuple):
    """What a finished run brings to a race: the run, its lane there, and how it walks."""

    run: Run
    number: int
    """Number of the learner's lane in a race; 0 of a training."""
    problem: WalkingProblem
    lane: LaneConfig
    training_id: str | None


def _walk_of(store: RunStore, run_id: str) -> _Walk | None:
    try:
        run = store.find(run_id)
    except NotFound:
        return None
    if not isinstance(run, Run):
        return None
    match run.config:
        case TrainingConfig() as config:
            lane = lane_config(config.agent, has_training=True, observation=config.observation)
            # It walks in the world as it is after the practice.
            problem = replace(_problem(config), world=config.world.as_of(config.steps - 1))
            return _Walk(run, 0, problem, lane, run.id)
        case RaceConfig() as config:
            learners = [n for n, training_id in enumerate(run.lane_training_ids) if training_id]
            number = learners[0] if learners else 0
            training_id = run.lane_training_ids[number]
            return _Walk(run, number, _problem(config), config.lanes[number], training_id)
    return None


def _problem(config: WalkingProblem) -> WalkingProblem:
    return WalkingProblem(**{f.name: getattr(config, f.name) for f in fields(WalkingProblem)})


def _lane(store: RunStore, recordings: Recordings, walk: _Walk) -> LaneRecording | None:
    """Return the recorded walk of a run; None if it is not there any more."""
    try:
        if walk.run.kind == "race":
            lanes = recordings.race(walk.run.id)
            lane = None if lanes is None else lanes[walk.number]
        else:
            lane = _last_evaluation(store, walk)
    except HexapodError:
        return None  # deleted meanwhile, or damaged
    return lane if lane is not None and len(lane.steps) else None


def _last_evaluation(store: RunStore, walk: _Walk) -> LaneRecording | None:
    """Walk the last evaluation of a training once more; None if it does not come out the same."""
    config, result = walk.run.config, walk.run.result
    assert isinstance(config, TrainingConfig)  # noqa: S101 - by `_walk_of`
    learner = build_learner(config, load_table(store, walk.run.id))
    walker = learner.evaluator(
        config.world.as_of(config.steps - 1), generator(config.seed, EVALUATION, config.steps)
    )
    race = RaceConfig(**vars(walk.problem), lanes=(walk.lane,), steps=RACE_STEPS)
    *_, (lane,) = record_race([walker], race, time.perf_counter)
    distance_m = result.distance_m if isinstance(result, TrainingResult) else None
    is_same = distance_m is not None and abs(lane.distance_m - distance_m) <= _SAME_M
    return lane if is_same else None


def _as_lane(number: int, lane: LaneRecording, steps: int) -> LaneRecording:
    """Return the first steps of a lane as those of the lane of another number."""
    taken = [replace(step, lane=number) for step in lane.first(steps).steps]
    return LaneRecording(lane.agent, lane.rest_qpos, taken, lane.failure)
