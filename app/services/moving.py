"""Moves a run between stores: all it has into an archive, and out of one, checked."""

import threading
from collections.abc import Callable, Collection
from dataclasses import replace

from app.domain.errors import DamagedFile
from app.services import archives
from app.services.archived_files import check_files, files_of, is_file_of
from app.services.archived_run import read_run_json, run_json
from app.services.errors import NotFound
from app.services.store import KINDS, Run, RunStore

RUN = "run.json"
_creating = threading.Lock()


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
    return archives.pack(members | files_of(store, run))


def import_run(
    store: RunStore,
    data: bytes,
    new_id: Callable[[], str],
    agents: Collection[str],
    said: str,
) -> Run:
    """Take in a run with all it has. Its id stays if it is free here, and no run is replaced.

    Args:
        store: where it goes.
        data: the archive.
        new_id: makes ids.
        agents: the names that are registered here.
        said: what to call the archive in messages.

    Raises:
        DamagedFile: if it is no archive, or was changed since it was made.
        InvalidInput: if it is of an agent, a robot or a gait that cannot be here.
        StorageFull: if there is no room for it.
    """
    members = archives.unpack(data, said, _is_known)
    if RUN not in members:
        raise DamagedFile(f"{said} is no archive of a run: it has no {RUN}")
    run, curve = read_run_json(members.pop(RUN), f"{RUN} of {said}", agents)
    check_files(run, members, said)
    with _creating:
        if _is_taken(store, run.id):
            run = replace(run, id=new_id())
        store.create(run)
    try:
        store.append_evaluations(run.id, curve)
        for name, content in members.items():
            store.put_artifact(run.id, name, content)
    except BaseException:
        # Half a run would look like one that lost something.
        store.delete(run.id)
        raise
    return store.get(run.id)


def _is_known(name: str) -> bool:
    return name == RUN or any(is_file_of(name, kind) for kind in KINDS)


def _is_taken(store: RunStore, run_id: str) -> bool:
    try:
        store.get(run_id)
    except NotFound:
        return False
    return True
