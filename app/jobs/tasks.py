"""Derive from a stored run what its process needs to start, whether it starts or resumes.

A training starts from its newest checkpoint; without one from the table that it continues, if any.
Changes of rates and pace made since are replayed after the same steps, so that a resumed training
has the same result. One that was stopped has a table, which others may have used since; then it
stays as it is. A race is repeated from its start: it is short and deterministic. A run of a kind
that a feature adds has a task of its own.
"""

import logging
from dataclasses import replace

import numpy as np

from app.jobs.messages import AddedTask, RaceTask, Task, TrainingTask
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, RESUMABLE, Run
from app.storage.run_kind import added_kind
from app.storage.stored_tables import load_checkpoint, load_table
from hexapods.domain.errors import HexapodError
from hexapods.domain.simulator import Motion
from hexapods.runs.baseline import baseline_id
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.records import LaneStep

_logger = logging.getLogger(__name__)


_MOST_REPEATED = 5_000
"""Most lane steps that a race takes over from the one from which it branches off: they are sent."""
_NO_MOTION = Motion(np.empty(0, np.float32), np.empty((0, 0), np.float32))


def task_for(run: Run, store: RunStore, recordings: Recordings | None = None) -> Task:
    """Return the task of a run, with the tables, the checkpoint or the parts that it needs.

    Args:
        run: the run.
        store: store of the runs.
        recordings: their recordings, from which a race that branches off takes its first steps;
            without them it computes all of its steps.

    Raises:
        Conflict, InvalidInput: if a table or checkpoint that it needs is missing or damaged.
    """
    config = run.config
    if (kind := added_kind(run.kind)) is not None:
        task: AddedTask = kind.task(run, store)
        return task
    if isinstance(config, RaceConfig):
        ids = run.lane_training_ids
        tables = tuple(None if i is None else load_table(store, i) for i in ids)
        return RaceTask(config, tables, _prefix_of(config, recordings))
    return _training_task(run, config, store)


def _prefix_of(
    config: RaceConfig, recordings: Recordings | None
) -> tuple[tuple[LaneStep, ...], ...]:
    """Return the steps that a race shares with the one from which it branches off, by lane."""
    branch = config.branch_from
    if branch is None or recordings is None:
        return ()
    lanes = recordings.race(branch.race_id)
    if not lanes or len(lanes) != len(config.lanes):
        return ()  # deleted, or it cannot be read
    count = min(branch.step, _MOST_REPEATED // len(lanes))
    try:
        return tuple(
            tuple(replace(step, motion=_NO_MOTION) for step in lane.steps[:count]) for lane in lanes
        )
    except HexapodError:
        _logger.warning("the steps of race %s cannot be taken over", branch.race_id)
        return ()


def _training_task(run: Run, config: TrainingConfig, store: RunStore) -> TrainingTask:
    checkpoint, steps = load_checkpoint(store, run, config), (0, *config.world.change_steps)
    ids = [baseline_id(config, config.world.as_of(step)) for step in steps if step < config.steps]
    baselines = store.baselines.get(ids)
    if checkpoint is None:
        table = None if run.continued_from is None else load_table(store, run.continued_from)
        return TrainingTask(config, table, changes=run.changes, baselines=baselines)
    since = run.changes[len(checkpoint.meta["changes"]) :]
    return TrainingTask(config, checkpoint=checkpoint, changes=since, baselines=baselines)


def resumed_runs(run: Run, store: RunStore) -> list[Run]:
    """Return an ended run as it is to be queued again, preceded by the trainings it depends on.

    Raises:
        Conflict: if its state does not allow it, or a training it needs was deleted.
        InvalidInput: if a table or checkpoint it needs is missing or damaged.
    """
    if run.state not in RESUMABLE:
        choices = " or ".join(sorted(RESUMABLE))
        raise Conflict(
            f"{run.kind} {run.id} is {run.state}; it can be resumed while it is {choices}",
            run.state,
        )
    trainings: list[Run] = []
    waiting_for, done = run.waiting_for, 0
    if run.kind == "race":
        trainings, waiting_for = _unended_trainings(run, store)
    else:
        if run.state == "stopped":
            _check_unused(run, store)
        # Refuses what could not start later.
        task = task_for(run, store)
        if isinstance(task, AddedTask):
            done = task.done
        elif isinstance(task, TrainingTask) and task.checkpoint is not None:
            done = task.checkpoint.meta["step"]
    queued = replace(
        run,
        state="queued",
        done=done,
        waiting_for=waiting_for,
        error=None,
        result=None,
        ended_at=None,
    )
    return [*trainings, queued]


def _unended_trainings(race: Run, store: RunStore) -> tuple[list[Run], tuple[str, ...]]:
    """Return the trainings to resume before a race, and the ids of all that it has to wait for."""
    resumed: list[Run] = []
    waiting_for = []
    for training_id in dict.fromkeys(filter(None, race.lane_training_ids)):
        try:
            training = store.get(training_id)
        except NotFound as error:
            reason = f"training {training_id}, whose table it needs, was deleted"
            raise Conflict(f"race {race.id} cannot go on: {reason}", race.state) from error
        # A race has the table of a training that was stopped, unless it was to wait for its end.
        is_kept = training.state == "stopped" and training_id not in race.waiting_for
        if training.state in RESUMABLE and not is_kept:
            resumed += resumed_runs(training, store)
        elif training.state not in NOT_ENDED:
            load_table(store, training_id)
            continue
        waiting_for.append(training_id)
    return resumed, tuple(waiting_for)


def _check_unused(training: Run, store: RunStore) -> None:
    """Refuse to change a table from which something was made that could not be repeated then."""
    users = [user for user in store.users_of_table(training.id) if user.done > 0]
    if users:
        raise Conflict(
            f"the table of training {training.id} is used by {users[0].id}; continue it as a new "
            f"training instead",
            training.state,
        )
