"""Tables from elsewhere: checked, and then trainings like any other."""

from collections.abc import Collection
from datetime import UTC, datetime

from app.archive.imported_tables import checked_table
from app.domain.errors import UnknownName
from app.domain.text import check_name
from app.jobs.jobs import Jobs
from app.jobs.submissions import check_walk
from app.runs import tables
from app.storage.store import IdempotencyKey, Run


def adopt(
    jobs: Jobs,
    data: bytes,
    agents: Collection[str],
    name: str | None = None,
    key: IdempotencyKey | None = None,
) -> Run:
    """Keep a table as a finished training.

    Args:
        jobs: where the training is to be found afterwards.
        data: the table's `.npz` file.
        agents: the names that are known here.
        name: of the training.
        key: of the request, remembered with the training.

    Raises:
        DamagedFile: if it is no table, or does not hold together.
        InvalidInput: if it was learned by an agent, or on a robot, that cannot be here.
        StorageFull: if there is no room for it; nothing of it is left then.
    """
    checkpoint, meta, config = checked_table(data, "the file")
    check_walk(config)
    if config.agent not in agents:
        raise UnknownName("agent", config.agent, agents)
    digest = None
    if "where" in tables.agent_state(checkpoint):
        digest = tables.table_of(checkpoint).sha256()
    greedy, step = meta.greedy_distance_m, meta.step
    run = Run(
        id=jobs.new_id(),
        kind="training",
        name=check_name(name or "") or f"Imported, {step:,} steps, {config.resolved_gait.name}",
        state="finished",
        config=config,
        done=step,
        total=step,
        greedy_distance_m=greedy,
        result={"distance_m": None, "greedy_distance_m": greedy, "q_table_sha256": digest},
        ended_at=datetime.now(UTC),
    )
    return jobs.keep(run, data, key)
