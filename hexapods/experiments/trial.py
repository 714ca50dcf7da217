"""One trial: practice, a walk of 50 steps, and timing. Deterministic; configs can be pickled."""

import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hexapods.agents.registry import check_unattended
from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.errors import Diverged
from hexapods.domain.settings import SettingValues
from hexapods.domain.short_repr import short_repr
from hexapods.domain.sums import ordered_sum
from hexapods.runs.clocks import Timetable, distance_at
from hexapods.runs.config import RACE_STEPS, TrainingConfig
from hexapods.runs.lane import LaneConfig, PlansWith
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import StepTaken
from hexapods.runs.results import decision_s, lane_figures
from hexapods.runs.tables import Checkpoint, from_bytes, snapshot, to_bytes
from hexapods.runs.training import evaluate, train


@dataclass(frozen=True, kw_only=True)
class TrialConfig:
    """Config of one trial.

    Attributes:
        training: training of one block, with its seed; for an agent that does not learn, only
            agent, observation mode and walking problem matter.
        blocks: number of consecutive blocks of practice; between blocks the table is saved to a
            file and loaded, and ε restarts (paper §5, Figure 4). 0 for no practice.
        rivals: agents that race in further lanes, to measure decision times by the wall clock.
        evaluations: steps of practice after which the learner walks 50 steps from rest, ascending;
            with any there is no race.
        earning_steps: number of steps after each evaluation whose rewards are added up; 0 for none.
        plans_with: model that a search plans with, as in `LaneConfig`.
        keep_learning: whether the agent learns from each step of the race too.
        most_transitions: most transitions that a search may simulate in the race; with more, the
            trial fails. None for any number.
    """

    __repr__ = short_repr

    training: TrainingConfig
    blocks: int = 1
    rivals: tuple[str, ...] = ()
    evaluations: tuple[int, ...] = ()
    earning_steps: int = 0
    plans_with: PlansWith | None = None
    keep_learning: bool = False
    most_transitions: int | None = None

    def __post_init__(self) -> None:
        check_unattended(self.training.agent, self.training.settings)

    @property
    def must_be_alone(self) -> bool:
        """Whether the trial measures wall-clock time, so that no other may run concurrently."""
        return bool(self.rivals)


@dataclass(frozen=True)
class TrialResult:
    """Result of a trial; deterministic except for `wall`.

    Attributes:
        distances_m: distance over 50 steps from rest after each block, or at each of the trial's
            evaluations; one entry without practice.
        finished_distance_m: distance under the paper clock when an agent without decision time
            has taken its 50 steps; None without a race.
        elapsed_s: duration of the 50 steps under the paper clock; None without a race.
        transitions: number of transitions simulated to decide on the 50 steps.
        wall: times measured with rivals: for each lane `agent`, `decision_s`, and under the wall
            clock `finished_distance_m`, `elapsed_s` and `rank`.
        failure: reason if there are no distances, one sentence.
        earned_m: rewards of the practice that follows each evaluation, added up over
            `TrialConfig.earning_steps` [m].
    """

    __repr__ = short_repr

    distances_m: tuple[float, ...] = ()
    finished_distance_m: float | None = None
    elapsed_s: float | None = None
    transitions: int = 0
    wall: tuple[Mapping[str, Any], ...] | None = None
    failure: str | None = None
    earned_m: tuple[float, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """Convert to plain types; inverse of `from_json`."""
        data = asdict(self)
        if not self.earned_m:
            del data["earned_m"]
        return data

    @classmethod
    def from_json(cls, lane_results: Mapping[str, Any]) -> "TrialResult":
        """Parse the output of `as_json`.

        Raises:
            KeyError, TypeError, ValueError: if it is not the output of `as_json`.
        """
        wall = lane_results["wall"]
        return cls(
            **{
                **lane_results,
                "distances_m": tuple(float(distance) for distance in lane_results["distances_m"]),
                "wall": None if wall is None else tuple(dict(lane) for lane in wall),
                "earned_m": tuple(float(sum_m) for sum_m in lane_results.get("earned_m", ())),
            }
        )


def run_trial(
    config: TrialConfig,
    timer: Callable[[], float] = time.perf_counter,
    table: Checkpoint | None = None,
) -> TrialResult:
    """Run a trial; diverging physics, or an agent that fails in the race, is a result too.

    Args:
        config: the trial.
        timer: clock in seconds that measures decisions.
        table: checkpoint of the agent from an earlier practice; with 0 blocks it races with that.
            No evaluations are made with it.

    Raises:
        HexapodError: if the config is invalid: an unknown agent, an unreachable grid.
    """
    try:
        if config.evaluations:
            return _practise_and_evaluate(config)
        table, distances = _practise(config, table)
        if config.blocks > 1:
            return TrialResult(distances_m=distances)
        lanes = _race(config, table, timer)
    except Diverged as error:
        return TrialResult(failure=str(error))
    failures = [f"{lane.agent}: {lane.failure}" for lane in lanes if lane.failure]
    if failures:
        return TrialResult(failure="; ".join(failures))
    return _result(lanes, _wall_clock_results(lanes) if config.rivals else None)


def _practise(
    config: TrialConfig, table: Checkpoint | None
) -> tuple[Checkpoint | None, tuple[float, ...]]:
    """Return the table after all blocks, and with several blocks the distance [m] after each."""
    distances = []
    for _ in range(config.blocks):
        learner = build_learner(config.training, table)
        for _ in train(learner, config.training):
            pass
        table = snapshot(learner, config.training)
        if config.blocks > 1:
            table = _file_round_trip(table)
            distances.append(evaluate(learner, config.training, learner.epsilon).distance_m)
    return table, tuple(distances)


def _practise_and_evaluate(config: TrialConfig) -> TrialResult:
    """Practise once, and evaluate the learned policy at the trial's evaluation steps."""
    learner = build_learner(config.training)
    rewards: list[float] = []
    distances: list[float] = []

    def evaluate_if_due() -> None:
        if learner.step in config.evaluations:
            evaluated = evaluate(learner, config.training, learner.epsilon)
            distances.append(evaluated.distance_m)

    evaluate_if_due()
    for record in train(learner, config.training):
        if isinstance(record, StepTaken):
            rewards.append(record.reward_m)
            evaluate_if_due()
    earned = [
        ordered_sum(rewards[step : step + config.earning_steps]) for step in config.evaluations
    ]
    return TrialResult(
        distances_m=tuple(distances), earned_m=tuple(earned) if config.earning_steps else ()
    )


def _file_round_trip(table: Checkpoint) -> Checkpoint:
    with tempfile.TemporaryDirectory(prefix="hexapods-") as folder:
        path = Path(folder) / "q.npz"
        path.write_bytes(to_bytes(table))
        return from_bytes(path.read_bytes(), path.name)


def _race(
    config: TrialConfig, table: Checkpoint | None, timer: Callable[[], float]
) -> list[LaneRecording]:
    training = config.training
    walk = vars(training.walk())
    own_lane = LaneConfig(
        agent=training.agent,
        observation=training.observation,
        plans_with=config.plans_with,
        keep_learning=config.keep_learning,
        settings=training.settings if table is None else SettingValues(),
    )
    rivals = (LaneConfig(agent=rival, observation=training.observation) for rival in config.rivals)
    race = RaceConfig(**walk, lanes=(own_lane, *rivals), seed=training.seed)
    walkers = build_walkers(race, [table, *(None for _ in config.rivals)], threads=1)
    for walker in walkers:
        if walker.expand is not None:
            walker.expand.budget = config.most_transitions
    *_, recorded = record_race(walkers, race, timer)
    return recorded


def _result(lanes: list[LaneRecording], wall: tuple[Mapping[str, Any], ...] | None) -> TrialResult:
    lane = lanes[0]
    timetable = Timetable.of(lane.steps, "paper")
    at_once_s = Timetable.of(lane.steps, "free").total_s
    return TrialResult(
        distances_m=(lane.distance_m,),
        finished_distance_m=distance_at(lane, timetable, at_once_s),
        elapsed_s=timetable.total_s,
        transitions=int(lane.steps.figures["transitions"].sum()),
        wall=wall,
    )


def _wall_clock_results(lanes: list[LaneRecording]) -> tuple[Mapping[str, Any], ...]:
    lane_results = []
    for lane, figures in zip(lanes, lane_figures(lanes, RACE_STEPS, "wall"), strict=True):
        timed = {k: getattr(figures, k) for k in ("finished_distance_m", "elapsed_s", "rank")}
        lane_results.append({"agent": lane.agent, "decision_s": decision_s(lane), **timed})
    return tuple(lane_results)
