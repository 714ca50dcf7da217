"""Export a run to an archive, and import it."""

from app.features.archives.transfer import export_chunks, import_runs
from app.storage.database.store import RunStore
from app.storage.run import IdempotencyKey, Run
from app.storage.run_ids import RunIds
from hexapods.agents.registry import BUILT_IN


def export_run(store: RunStore, run_id: str) -> bytes:
    return b"".join(export_chunks(store, run_id))


def import_run(
    store: RunStore, data: bytes, ids: RunIds, label: str, key: IdempotencyKey | None = None
) -> Run:
    (run,) = import_runs(store, data, ids, tuple(BUILT_IN), label, is_one=True, key=key)
    return run
