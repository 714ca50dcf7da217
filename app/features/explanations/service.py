"""Explanation service: explains steps of trainings and races, and shows tables of any moment."""

import json
from collections.abc import Callable, Hashable
from typing import TypeVar

from cachetools import LRUCache

from app.cache import BytesCache
from app.features.explanations.loss import (
    LIMIT_S,
    ValuedTable,
    WalkedLane,
    loss_view,
    practised_steps,
    simulate,
    standing_of,
)
from app.features.explanations.rebuilt_practice import Changes, LoggedSteps, RebuiltPractice
from app.features.explanations.response_models import ExplanationView, LossView, TableView
from app.features.explanations.sentences import SearchFindings
from app.features.explanations.views import MAX_VALUES_SHOWN, explanation_view, table_view
from app.jobs.process_pool import OutOfProcessorTime, ProcessPool
from app.jobs.stopping import Stopping
from app.jobs.turns import Turns
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict
from app.storage.recordings import Recordings
from app.storage.run import RUNNING, Run
from app.storage.run_kind import with_article
from app.storage.stored_tables import load_table
from hexapods.agents import registry
from hexapods.agents.protocol import Tabular, Valuing
from hexapods.assembly import rebuild_lane, rebuild_learner
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import Record, to_json_bytes
from hexapods.domain.types import Action
from hexapods.runs.clocks import Clock
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.rebuilding import ExplainedStep, NotRebuilt, RebuiltLearner
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import LaneStep
from hexapods.runs.transition_log import Logged, TransitionLog

MAX_PRACTICES = 4
"""Capacity of the cache of rebuilt walks; the least recently used one is dropped."""
MAX_ANSWER_BYTES = 16_000_000
"""Limit on the memory of all answers in the cache."""
MAX_WAITING = 8
MAX_TABLE_VALUES = 16_000_000
"""Largest table of a learner that is built again, about 200 MB."""
_BLOCK_STEPS = 1000
T = TypeVar("T")


class Explanations:
    """Builds learners again to explain their steps; one request at a time. Thread-safe."""

    def __init__(
        self, store: RunStore, recordings: Recordings, stopping: Stopping | None = None
    ) -> None:
        self._store, self._recordings = store, recordings
        self._stopping = stopping or Stopping()
        self._practices: LRUCache[Hashable, RebuiltPractice] = LRUCache(MAX_PRACTICES)
        self._answers = BytesCache(MAX_ANSWER_BYTES)
        self._turns = Turns("explanations", MAX_WAITING)
        self._pool = ProcessPool(count=1, name="move comparison")

    def close(self) -> None:
        """Shut down the process that simulates moves."""
        self._pool.close()

    def explain(self, run_id: str, step: int | None, lane: int) -> bytes:
        """Explain a step of a training, or of a lane of a race.

        Args:
            run_id: id of the run.
            step: counted from 1; None for the newest.
            lane: lane of a race, counted from 0; 0 for a training.

        Returns:
            the explanation as JSON.

        Raises:
            NotFound: if there is no such run.
            InvalidInput: if there is no such step or lane.
            Conflict: if the run has no steps (yet), or its learner cannot be built again.
            Busy: if it takes longer than a request may, or a running run has not recorded the step.
        """
        run = self._store.get(run_id)
        if isinstance(run.config, RaceConfig):
            return self._explain_lane(run, run.config, step, lane)
        if not isinstance(run.config, TrainingConfig):
            kind = with_article(run.kind)
            raise InvalidInput(f"run {run_id} is {kind}, which has no steps to explain")
        if lane != 0:
            raise InvalidInput("a training has one lane, 0")
        config, log = run.config, self._log(run)
        number = _checked_step(step, len(log), config.steps, run)
        # Read after the log, when all changes before its last step are stored.
        run, steps = self._store.get(run_id), _TrainingSteps(log)

        def answer() -> ExplanationView:
            practice = _in(run, lambda: self._practice(run, config, steps))
            explained = _in(run, lambda: practice.explain(number, steps, run.changes))
            return explanation_view(run_id, config, config.agent, explained)

        return self._answer((_version(run, number, steps), number), answer)

    def table(self, run_id: str, step: int | None, first: int, count: int) -> bytes:
        """Return the values, visits and best actions of some states, as a learner has them.

        Args:
            run_id: id of a training.
            step: number of steps after which they are returned; None for the newest.
            first: index of the first state.
            count: number of states.

        Returns:
            the table as JSON.

        Raises:
            NotFound, InvalidInput, Conflict, Busy: as `explain`; Conflict also for a learner
                without a table.
        """
        run = self._store.get(run_id)
        if not isinstance(run.config, TrainingConfig):
            raise InvalidInput(f"run {run_id} is a {run.kind}; only trainings have a table")
        config, log = run.config, self._log(run)
        number = _checked_step(step, len(log), config.steps, run, first=0)
        # Read after the log, when all changes before its last step are stored.
        run, steps = self._store.get(run_id), _TrainingSteps(log)
        groups, cells = len(config.resolved_gait.groups), len(config.grid)
        if not 0 <= first < cells**groups:
            raise InvalidInput(f"first must be from 0 to {cells**groups - 1:,}, not {first}")
        count = min(count, MAX_VALUES_SHOWN // (groups * cells))

        def answer() -> TableView:
            practice = _in(run, lambda: self._practice(run, config, steps))
            learner = _in(run, lambda: practice.learner_at(number, steps, run.changes))
            if not isinstance(learner.agent, Tabular) or not isinstance(learner.agent, Valuing):
                raise Conflict(
                    f"{config.agent} keeps no table: it generalises over all states", run.state
                )
            table = learner.agent.table
            states = [table.cells_at(n) for n in range(first, min(first + count, table.states))]
            return table_view(
                *(config, learner.agent, table, states),
                step=number,
                first=first,
                total=table.states,
            )

        # After the last step settings may still be changed, which changes no value.
        return self._answer((_version(run, number, steps), "table", number, first, count), answer)

    def explain_loss(self, run_id: str, lane: int, clock: Clock) -> bytes:
        """Explain why a learner with a table loses a race, by all steps that it has taken.

        Args:
            run_id: id of a race.
            lane: counted from 0.
            clock: under which the lanes are ranked.

        Returns:
            the numbers and three sentences as JSON.

        Raises:
            NotFound: if there is no such race.
            InvalidInput: if there is no such lane.
            Conflict: if the race has no steps (yet), or the lane does not lose, keeps no table,
                or cannot be built or walked again.
            Busy: if it takes longer than a request may.
        """
        run = self._store.get(run_id)
        if not isinstance(run.config, RaceConfig):
            raise InvalidInput(f"run {run_id} is a {run.kind}; only the lanes of a race can lose")
        config, recording = run.config, self._lane(run, lane)
        number = _checked_step(None, len(recording.steps), config.steps, run)
        standing = standing_of(run, self._recordings.race(run.id) or [], lane, config.steps, clock)
        steps = LoggedLane(recording, config.lanes[lane].observation == "measured")

        def answer() -> LossView:
            practice = _in(run, lambda: self._lane_practice(run, config, lane, steps))

            def learner_before(step: int) -> ValuedTable:
                agent = practice.learner_at(step, steps, ()).agent
                if not isinstance(agent, ValuedTable):
                    raise Conflict(f"{recording.agent} keeps no table that can be read", run.state)
                return agent

            # First that it has a table, and can be built again: that takes no simulation.
            _in(run, lambda: learner_before(number - 1))
            walked = WalkedLane(config, lane, recording.steps.choices(number))
            try:
                (compared,) = self._pool.map(simulate, [walked], self._stopping.check, LIMIT_S)
            except OutOfProcessorTime as error:
                raise Conflict(f"its {number:,} steps are too many: {error}", run.state) from error
            except InvalidInput as error:
                raise Conflict(f"it cannot be walked again: {error}", run.state) from error
            practised = practised_steps(self._store, run.lane_training_ids[lane])
            return _in(run, lambda: loss_view(standing, compared, learner_before, practised))

        key = (_version(run, number, steps), "loss", lane, number, standing)
        return self._answer(key, answer)

    def _lane(self, run: Run, lane: int) -> LaneRecording:
        lanes = self._recordings.race(run.id)
        if lanes is None:
            raise Conflict(f"race {run.id} is {run.state} and has no recording (yet)", run.state)
        if not 0 <= lane < len(lanes):
            raise InvalidInput(f"lane must be from 0 to {len(lanes) - 1}, not {lane}")
        return lanes[lane]

    def _answer(self, key: Hashable, answer: Callable[[], Record]) -> bytes:
        """Return the cached answer of a key as JSON, or compute it and cache it."""
        cached = self._answers.get(key)
        if cached is not None:
            return cached
        with self._turns.turn(self._stopping.check):
            # Another request may have asked for the same meanwhile.
            cached = self._answers.get(key)
            if cached is None:
                cached = to_json_bytes(answer())
                self._answers.put(key, cached)
            return cached

    def _explain_lane(self, run: Run, config: RaceConfig, step: int | None, lane: int) -> bytes:
        recording, lane_config = self._lane(run, lane), config.lanes[lane]
        number = _checked_step(step, len(recording.steps), config.steps, run)
        steps = LoggedLane(recording, lane_config.observation == "measured")

        def answer() -> ExplanationView:
            why = None
            explained = ExplainedStep(number, steps.step(number - 1), None, None, None)
            search = _search_of(lane_config.agent, recording.steps[number - 1])
            if search is None:
                try:
                    practice = self._lane_practice(run, config, lane, steps)
                    explained = practice.explain(number, steps, ())
                except (Conflict, InvalidInput, NotRebuilt) as error:
                    why = str(error)
            return explanation_view(
                *(run.id, config, lane_config.agent, explained),
                lane=lane,
                search=search,
                unexplained=why,
            )

        # The update by the newest step of a race that runs is told with the next one.
        is_newest = number == len(recording.steps)
        return self._answer((_version(run, number, steps), lane, number, is_newest), answer)

    def _log(self, run: Run) -> TransitionLog:
        log = self._recordings.transitions(run.id)
        if log is None or not len(log):
            raise Conflict(
                f"training {run.id} has no log of its steps: it has not begun, or was "
                "imported without one; train it again to explain it",
                run.state,
            )
        return log

    def _practice(self, run: Run, config: TrainingConfig, steps: LoggedSteps) -> RebuiltPractice:
        """Return the cached walk of a training, with its learner, or a new one."""

        def new() -> RebuiltLearner:
            table = (
                None if run.continued_from is None else load_table(self._store, run.continued_from)
            )
            return rebuild_learner(config, table)

        def make() -> RebuiltPractice:
            groups, cells = len(config.resolved_gait.groups), len(config.grid)
            rows = cells**groups if run.continued_from else min(cells**groups, len(steps))
            if rows * groups * cells > MAX_TABLE_VALUES:
                raise Conflict(
                    f"the table of training {run.id} is too large to be built again: it may have "
                    f"{rows * groups * cells:,} values, and the most is {MAX_TABLE_VALUES:,}",
                    run.state,
                )
            return RebuiltPractice(new)

        return self._practice_of((run.id, run.created_at), steps, run.changes, make)

    def _lane_practice(
        self, run: Run, config: RaceConfig, lane: int, steps: LoggedSteps
    ) -> RebuiltPractice:
        training_id = run.lane_training_ids[lane]

        def new() -> RebuiltLearner:
            table = None if training_id is None else load_table(self._store, training_id)
            return rebuild_lane(config, lane, table)

        key = (run.id, run.created_at, lane)
        return self._practice_of(key, steps, (), lambda: RebuiltPractice(new))

    def _practice_of(
        self,
        key: Hashable,
        steps: LoggedSteps,
        changes: Changes,
        make: Callable[[], RebuiltPractice],
    ) -> RebuiltPractice:
        """Return the cached walk of a key, or a new one if there is none or it does not fit."""
        practice = self._practices.get(key)
        if practice is None or not practice.fits(steps, changes):
            self._practices[key] = practice = make()
        return practice


class _TrainingSteps:
    """The steps of a training's log, read in blocks."""

    def __init__(self, log: TransitionLog) -> None:
        self._log = log
        self._block = log.part(0, 0)

    def __len__(self) -> int:
        return len(self._log)

    def step(self, number: int) -> Logged:
        """Return the step of an index, from 0 on."""
        place = number - self._block.first
        if not 0 <= place < len(self._block.rewards_m):
            first = number - number % _BLOCK_STEPS
            self._block, place = self._log.part(first, first + _BLOCK_STEPS), number - first
        return self._block.step(place)


class LoggedLane:
    """The steps of a lane's recording."""

    def __init__(self, lane: LaneRecording, is_measured: bool) -> None:
        """Read a recording.

        Args:
            lane: the recording.
            is_measured: whether the lane observed where its feet are.
        """
        self._lane, self._is_measured = lane, is_measured

    def __len__(self) -> int:
        return len(self._lane.steps)

    def step(self, number: int) -> Logged:
        """Return the step of an index, from 0 on; the last one has no next observation."""
        rows = self._lane.steps.figures[number : number + 2]
        before, after = ([tuple(row) for row in rows["observation"].tolist()] + [()])[:2]
        measured = (before, after) if self._is_measured else ((), ())
        action, reward_m = Action(*rows["action"][0].tolist()), float(rows["reward_m"][0])
        return Logged(before, measured[0], action, reward_m, after, measured[1])


def _version(run: Run, step: int, steps: LoggedSteps) -> Hashable:
    """Return a key of all that the learner after a step depends on, without step and lane.

    A run repeats its steps where it resumes, unless its agent has another source of randomness;
    changes of settings may be others then. Not the log itself, which is large, and another object
    each time that it is read.
    """
    changes = [change for change in run.changes if change["step"] < step]
    taken = steps.step(step - 1) if step else None
    return (run.id, run.created_at, json.dumps(changes, default=str), taken)


def _search_of(agent: str, step: LaneStep) -> SearchFindings | None:
    """Return the findings of a lane's search in a step; None if no search was recorded."""
    if not any(future.action == step.action for future in step.futures):
        return None
    return SearchFindings(registry.compares(agent), step.transitions, step.futures)


def _checked_step(step: int | None, taken: int, steps: int, run: Run, first: int = 1) -> int:
    """Return a step of a run of `steps` from `first` to the last one `taken`, the default.

    Raises:
        InvalidInput: if the run has no such step.
        Busy: if a running run will have it: what it took last is recorded a moment later.
    """
    if run.state in RUNNING and step is not None and taken < step <= steps:
        raise Busy(f"step {step:,} of run {run.id} is not recorded yet; ask again later", 1)
    if taken < first:
        raise InvalidInput("it has taken no step yet")
    if step is None:
        return taken
    if not first <= step <= taken:
        raise InvalidInput(f"step must be from {first} to {taken:,}, not {step}")
    return step


def _in(run: Run, explain: Callable[[], T]) -> T:
    """Call a function; raise Conflict with the run if its learner cannot be rebuilt."""
    try:
        return explain()
    except (InvalidInput, NotRebuilt) as error:
        reason = f"the learner of {run.kind} {run.id} cannot be built again: {error}"
        raise Conflict(reason, run.state) from error
