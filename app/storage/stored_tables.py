"""Load the Q-tables and checkpoints of stored trainings.

Both may have been imported from another machine, so they are checked as untrusted input.
"""

import io
from typing import TypeVar

from app.storage.artifact_file import ArtifactFile, ReadableArtifact
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import CHECKPOINT, TABLE, Run
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.runs.config import TrainingConfig
from hexapods.runs.table_file import TableFile
from hexapods.runs.tables import Checkpoint, check_fits, from_bytes

T = TypeVar("T")


def load_table(store: RunStore, training_id: str) -> Checkpoint:
    """Load the table of a training.

    Raises:
        InvalidInput: if there is no such training.
        Conflict: if it has no table, or none yet.
        DamagedFile: if the table is damaged.
    """
    run = _training(store, training_id)
    data = _require_table(run, store.artifact(training_id, TABLE))
    return from_bytes(data, _table_name(training_id))


def open_table(store: RunStore, training_id: str) -> ArtifactFile:
    """Open the table of a training for reading in chunks; the caller closes it.

    Raises:
        InvalidInput, Conflict, DamagedFile: as `load_table`.
    """
    run = _training(store, training_id)
    return _require_table(run, store.open_artifact(training_id, TABLE))


def read_rows(file: ArtifactFile, training_id: str) -> TableFile:
    """Return the Q-table in a file that `open_table` opened.

    Raises:
        TableMismatch: if its agent has no Q-table.
        DamagedFile: if it is damaged.
    """
    return TableFile(io.BufferedReader(ReadableArtifact(file)), _table_name(training_id))


def load_checkpoint(store: RunStore, run: Run, config: TrainingConfig) -> Checkpoint | None:
    """Load the newest checkpoint of a training; None if it has none.

    Args:
        store: store of the runs.
        run: the training.
        config: its config, which the checkpoint must fit.

    Raises:
        DamagedFile, TableMismatch: if it is damaged, or is that of another training.
    """
    data, name = store.artifact(run.id, CHECKPOINT), f"the checkpoint of training {run.id}"
    if data is None:
        return None
    checkpoint = from_bytes(data, name)
    meta = checkpoint.meta
    try:
        check_fits(checkpoint, config, config.observation)
        is_whole = meta["agent"] == config.agent and 0 <= meta["step"] <= config.steps
        steps = [change["step"] <= meta["step"] for change in meta["changes"]]
        is_whole = is_whole and all(steps) and len(steps) <= len(run.changes)
        is_whole = is_whole and {"due_epsilon", "episode_reward_m", "rng"} <= set(meta)
    except (KeyError, TypeError) as error:
        raise DamagedFile(f"{name} is inconsistent ({error!r})") from error
    if not is_whole:
        raise DamagedFile(f"{name} is inconsistent")
    return checkpoint


def _training(store: RunStore, training_id: str) -> Run:
    try:
        run = store.get(training_id)
    except NotFound as error:
        raise InvalidInput(
            f"there is no training {training_id!r}; GET /api/v1/trainings lists all"
        ) from error
    if run.kind != "training":
        raise InvalidInput(f"{training_id!r} is a {run.kind}; name a training")
    return run


def _require_table(run: Run, table: T | None) -> T:
    if run.state not in ("finished", "stopped"):
        raise Conflict(
            f"training {run.id} is {run.state}; choose one that is finished or stopped", run.state
        )
    if table is None:
        raise Conflict(f"training {run.id} was {run.state} before it kept a table", run.state)
    return table


def _table_name(training_id: str) -> str:
    return f"the table of training {training_id}"
