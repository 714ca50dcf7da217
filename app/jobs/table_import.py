"""Import of a Q-table file as a finished training."""

from collections.abc import Collection
from datetime import UTC, datetime

from app.jobs.jobs import Jobs
from app.jobs.submissions import check_training
from app.storage.imported_tables import checked_table
from app.storage.run import TABLE, IdempotencyKey, Run
from hexapods.domain.text import check_name
from hexapods.runs import tables
from hexapods.runs.results import TrainingResult


def import_table(
    jobs: Jobs,
    data: bytes,
    agents: Collection[str],
    name: str | None = None,
    key: IdempotencyKey | None = None,
) -> Run:
    """Validate a Q-table, and store it as a finished training.

    Args:
        jobs: job control, which stores the training.
        data: content of the table's `.npz` file.
        agents: names of the registered agents.
        name: of the training; None for a generated one.
        key: idempotency key of the request, stored with the training.

    Returns:
        the training as stored.

    Raises:
        DamagedFile: if it is no table, or is inconsistent.
        InvalidInput: if its agent or robot is not supported here.
        StorageFull: if there is too little disk space; nothing is left behind then.
    """
    checkpoint, meta, config = checked_table(data, "the file", agents)
    check_training(config)
    digest = None
    if tables.table_arrays(tables.agent_state(checkpoint)) is not None:
        digest = tables.table_of(checkpoint).sha256()
    greedy, step = meta.greedy_distance_m, meta.step
    run = Run(
        id=jobs.new_id(),
        kind="training",
        name=check_name(name or "") or f"Imported, {step:,} steps: {config.resolved_gait.title}",
        state="finished",
        config=config,
        done=step,
        total=step,
        greedy_distance_m=greedy,
        result=TrainingResult(distance_m=None, greedy_distance_m=greedy, q_table_sha256=digest),
        ended_at=datetime.now(UTC),
    )
    return jobs.keep(run, {TABLE: data}, key)
