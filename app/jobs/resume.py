"""Build queued runs from interrupted, failed or stopped ones, so that they can be resumed.

A training resumes from its newest checkpoint, or from its start if it has none. Changes of rates
and pace made since are replayed after the same steps, so that the result is the same. A race is
repeated from its start: it is short and deterministic; unfinished trainings that it needs are
resumed before it. An experiment resumes with the trials that are not done yet.
"""

from dataclasses import replace

from app.domain.errors import DamagedFile
from app.experiments.config import ExperimentConfig
from app.jobs.messages import ExperimentTask, RaceTask, TrainingTask
from app.jobs.submissions import QueuedRun, load_table, wall_s_of
from app.runs.config import RaceConfig, TrainingConfig
from app.runs.tables import Checkpoint, check_fits, from_bytes
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import CHECKPOINT, RESUMABLE, UNENDED, Run


def resumed_runs(run: Run, store: RunStore) -> list[QueuedRun]:
    """Return a run as a queued run again, preceded by the trainings that it depends on.

    Raises:
        Conflict: if its state does not allow it, or a training it needs was deleted.
        InvalidInput: if a table or checkpoint it needs is missing or damaged.
    """
    if run.state not in RESUMABLE[run.kind]:
        choices = " or ".join(sorted(RESUMABLE[run.kind]))
        raise Conflict(
            f"{run.kind} {run.id} is {run.state}; it can be resumed while it is {choices}",
            run.state,
        )
    if isinstance(run.config, ExperimentConfig):
        return [_experiment(run, run.config, store)]
    if isinstance(run.config, RaceConfig):
        return _race(run, run.config, store)
    return [_training(run, run.config, store)]


def _training(run: Run, config: TrainingConfig, store: RunStore) -> QueuedRun:
    checkpoint = _checkpoint(run, config, store)
    if checkpoint is None:
        table = None if run.continued_from is None else load_table(store, run.continued_from)
        task, step = TrainingTask(config, table, changes=run.changes), 0
    else:
        since = run.changes[len(checkpoint.meta["changes"]) :]
        task = TrainingTask(config, checkpoint=checkpoint, changes=since)
        step = checkpoint.meta["step"]
    return QueuedRun(_as_queued(run, step), lambda: task, set(), goes_on=True)


def _checkpoint(run: Run, config: TrainingConfig, store: RunStore) -> Checkpoint | None:
    """Load and check the newest checkpoint, None if there is none.

    It may have been imported from another machine, so it is untrusted input, like a table.
    """
    data, subject = store.artifact(run.id, CHECKPOINT), f"the checkpoint of training {run.id}"
    if data is None:
        return None
    checkpoint = from_bytes(data, subject)
    meta = checkpoint.meta
    try:
        check_fits(checkpoint, config, config.observation)
        is_whole = meta["agent"] == config.agent and 0 <= meta["step"] <= config.steps
        steps = [change["step"] <= meta["step"] for change in meta["changes"]]
        is_whole = is_whole and all(steps) and len(steps) <= len(run.changes)
        is_whole = is_whole and {"due_epsilon", "episode_reward_m", "rng"} <= set(meta)
    except (KeyError, TypeError) as error:
        raise DamagedFile(f"{subject} does not hold together ({error!r})") from error
    if not is_whole:
        raise DamagedFile(f"{subject} does not hold together")
    return checkpoint


def _race(run: Run, config: RaceConfig, store: RunStore) -> list[QueuedRun]:
    trainings: list[QueuedRun] = []
    waits_for = []
    for training_id in dict.fromkeys(filter(None, run.lane_training_ids)):
        try:
            training = store.get(training_id)
        except NotFound as error:
            reason = f"training {training_id}, whose table it needs, was deleted"
            raise Conflict(f"race {run.id} cannot go on: {reason}", run.state) from error
        if training.state in RESUMABLE[training.kind]:
            trainings += resumed_runs(training, store)
        elif training.state not in UNENDED:
            load_table(store, training_id)
            continue
        waits_for.append(training_id)

    def make_task() -> RaceTask:
        ids = run.lane_training_ids
        return RaceTask(config, tuple(None if i is None else load_table(store, i) for i in ids))

    queued = replace(_as_queued(run, 0), waiting_for=tuple(waits_for))
    return [*trainings, QueuedRun(queued, make_task, set(waits_for), goes_on=True)]


def _experiment(run: Run, config: ExperimentConfig, store: RunStore) -> QueuedRun:
    def make_task() -> ExperimentTask:
        rows = tuple(store.trials(run.id))
        return ExperimentTask(config, run.workers, rows, wall_s_of(store, run.id))

    return QueuedRun(_as_queued(run, len(store.trials(run.id))), make_task, set(), goes_on=True)


def _as_queued(run: Run, step: int) -> Run:
    return replace(run, state="queued", done=step, error=None, result=None, ended_at=None)
