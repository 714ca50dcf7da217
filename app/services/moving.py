"""Moves a run between stores: all it has into an archive, and out of one, checked."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from app.domain.errors import DamagedFile
from app.experiments.config import ExperimentConfig
from app.services import archives
from app.services.archived_files import check_files, files_of, is_file_of
from app.services.archived_run import read_run_json, run_json
from app.services.archived_trials import TRIALS, read_trials_json, trials_json
from app.services.ids import RunIds
from app.services.store import KINDS, Content, IdempotencyKey, Run, RunStore

RUN = "run.json"


def export_run(store: RunStore, run_id: str) -> bytes:
    """The archive of a run that has ended.

    Raises:
        NotFound: if there is no such run.
        Conflict: if it has not ended.
        DamagedFile: if one of its files is damaged.
        InvalidInput: if it is too large.
    """
    run = store.get(run_id)
    members = {RUN: run_json(run, store.evaluations(run_id))}
    if run.kind == "experiment":
        members[TRIALS] = trials_json(store.trials(run_id))
    return archives.pack(members | files_of(store, run))


def import_run(
    store: RunStore,
    data: bytes,
    ids: RunIds,
    agents: Collection[str],
    said: str,
    *,
    key: IdempotencyKey | None = None,
) -> Run:
    """Take in a run with all it has: visible whole or not at all. No run is replaced.

    Its id stays if it is free here, and one that could have been made by now; a later one would
    sort before all runs to come.

    Args:
        store: where it goes.
        data: the archive.
        ids: of this store.
        agents: the names that are registered here.
        said: what to call the archive in messages.
        key: of the request, remembered with the run.

    Returns:
        the run as it is here.

    Raises:
        DamagedFile: if it is no archive, or was changed since it was made.
        InvalidInput: if it is of an agent, a robot or a gait that cannot be here.
        StorageFull: if there is no room for it.
    """
    members = archives.unpack(data, said, _is_known)
    if RUN not in members:
        raise DamagedFile(f"{said} is no archive of a run: it has no {RUN}")
    run, curve = read_run_json(members.pop(RUN), f"{RUN} of {said}", agents)
    trials = _trials(run, members, said)
    check_files(run, members, said)
    if not ids.may_have_made(run.id):
        run = replace(run, id=ids())
    content = Content(evaluations=curve, trials=trials, artifacts=members)
    return store.add(run, content, ids, key)


def _trials(run: Run, members: dict[str, bytes], said: str) -> list[dict[str, Any]]:
    """Take the trials out of the members, checked."""
    if not isinstance(run.config, ExperimentConfig):
        return []
    if TRIALS not in members:
        raise DamagedFile(f"{said} is no archive of an experiment: it has no {TRIALS}")
    return read_trials_json(members.pop(TRIALS), run.config, f"{TRIALS} of {said}")


def _is_known(name: str) -> bool:
    return name in (RUN, TRIALS) or any(is_file_of(name, kind) for kind in KINDS)
