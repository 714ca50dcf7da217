"""Export runs from a store to an archive, and import them from one after validation.

An archive of several runs has the archive of each as a member.
"""

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import partial

from app.api.budgeted_chunks import BudgetedChunks
from app.features.archives import archive
from app.features.archives.archived_files import check_files, is_file_of, members_of
from app.features.archives.archived_robots import (
    is_robot,
    robot_members,
    robots_to_store,
    take_documents,
)
from app.features.archives.archived_run import read_run_json, run_json
from app.limits.memory_budget import MemoryBudget
from app.storage.database.store import RunStore
from app.storage.errors import Damaged
from app.storage.json_text import is_finite
from app.storage.run import Content, IdempotencyKey, Run
from app.storage.run_ids import RunIds
from app.storage.run_kind import Rows, added_kind, run_kinds
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.robot_library import LIBRARY, RobotLibrary

RUN = "run.json"
MAX_RUNS = 100
"""Runs of an archive."""
_ONE_OF_SEVERAL = re.compile(rf"({'|'.join(run_kinds())})-[0-9a-z]{{1,32}}\.zip", re.ASCII)


def export_chunks(
    store: RunStore, run_id: str, budget: MemoryBudget | None = None
) -> Iterator[bytes]:
    """Export an ended run to an archive as a stream of chunks; its files are not held in memory.

    Args:
        store: store of the run.
        run_id: id of the run.
        budget: memory budget for what is held until the last chunk: the encoded run, its curve
            and what its kind adds; None for no limit.

    Raises:
        NotFound: if there is no such run.
        Conflict: if it has not ended.
        Damaged: if its rows in the database are damaged.
        DamagedFile: if one of its files is damaged.
        InvalidInput: if the archive would be too large to be imported.
        Busy: if the budget is exhausted at present.
    """
    _, texts, files = _contents(store, run_id)
    in_memory = {name: archive.member(text) for name, text in texts.items()}
    chunks = archive.pack_chunks(in_memory | files)
    size = sum(map(len, texts.values()))
    return chunks if budget is None else BudgetedChunks(chunks, size, budget)


def export_many(
    store: RunStore, run_ids: Sequence[str], budget: MemoryBudget | None = None
) -> Iterator[bytes]:
    """Export ended runs to one archive, as a stream of chunks that holds one run's texts at a time.

    Args:
        store: store of the runs.
        run_ids: ids of the runs, at most `MAX_RUNS`; repeated ones count once.
        budget: memory budget, as for `export_chunks`.

    Raises:
        InvalidInput: if there are none or too many, or the archive would be too large.
        NotFound, Conflict, Damaged, DamagedFile, Busy: as `export_chunks`, for any of them.
    """
    ids = list(dict.fromkeys(run_ids))
    if not 1 <= len(ids) <= MAX_RUNS:
        raise InvalidInput(f"an archive has from 1 to {MAX_RUNS} runs, not {len(ids):,}")
    members, largest = {}, 0
    for run_id in ids:
        run, texts, files = _contents(store, run_id)
        in_memory = sum(map(len, texts.values()))
        size = in_memory + sum(file.size for file in files.values())
        chunks = partial(export_chunks, store, run_id)
        members[f"{run.kind}-{run.id}.zip"] = archive.Member(archive.packed_size(size), chunks)
        largest = max(largest, in_memory)
    packed = archive.pack_chunks(members)
    return packed if budget is None else BudgetedChunks(packed, largest, budget)


def _contents(
    store: RunStore, run_id: str
) -> tuple[Run, dict[str, bytes], dict[str, archive.Member]]:
    """Return an ended run, and of its archive the members in memory and those in files."""
    run = store.get(run_id)
    curve = store.curves.get(run_id)
    if not is_finite(curve):
        # It would be null in JSON, which every import rejects.
        raise Damaged(run_id, "its curve has NaN or an infinity")
    texts = {RUN: run_json(run, curve), **robot_members(store, run)}
    if (kind := added_kind(run.kind)) is not None:
        texts |= kind.texts(run, store)
    return run, texts, members_of(store, run)


def import_runs(
    store: RunStore,
    data: bytes,
    ids: RunIds,
    agents: Collection[str],
    label: str,
    *,
    is_one: bool = False,
    key: IdempotencyKey | None = None,
) -> list[Run]:
    """Validate an archive of one run or several, and add all of them to a store, or none.

    No run is replaced. Each keeps its id if that is free in this store and not in the future; new
    runs would sort before a run with a future id.

    Args:
        store: store that receives the runs.
        data: the whole archive.
        ids: generator of ids for this store.
        agents: names of the registered agents.
        label: name of the archive for error messages.
        is_one: whether an archive of several is refused.
        key: idempotency key of the request, stored with the runs.

    Returns:
        the runs as stored.

    Raises:
        DamagedFile: if it is no archive of runs, or was changed since its export.
        InvalidInput: if an agent, robot or gait is not supported here.
        StorageFull: if there is too little disk space.
    """
    store.check_disk_space(len(data))
    members = archive.unpack(data, label, _is_member_name if is_one else _is_any_member_name)
    if is_one or RUN in members:
        checked = [_checked(members, store.kinds, ids, agents, label)]
    elif not members or not all(map(_ONE_OF_SEVERAL.fullmatch, members)):
        raise DamagedFile(f"{label} is no archive of runs: it has no {RUN}")
    else:
        checked = [
            _checked(
                archive.unpack(member, label, _is_member_name), store.kinds, ids, agents, label
            )
            for label, member in (
                (f"{name} of {label}", member) for name, member in members.items()
            )
        ]
    return list(store.add(checked, ids, key))


def _checked(
    members: dict[str, bytes],
    kinds: Collection[str],
    ids: RunIds,
    agents: Collection[str],
    label: str,
) -> tuple[Run, Content]:
    """Validate the members of a run's archive; return the run with the id that it is to get."""
    if RUN not in members:
        raise DamagedFile(f"{label} is no archive of a run: it has no {RUN}")
    documents = take_documents(members, label)
    library = RobotLibrary(LIBRARY, documents.values())
    run, curve = read_run_json(members.pop(RUN), f"{RUN} of {label}", kinds, agents, library)
    if (kind := added_kind(run.kind)) is None:
        check_files(run, members, label, library)
        rows: Rows = {}
    else:
        rows = kind.take_members(run, members, label)
    robots = robots_to_store(run, documents, label)
    if not ids.is_plausible(run.id):
        run = replace(run, id=ids())
    return run, Content(evaluations=curve, rows=rows, artifacts=members, robots=robots)


def _is_any_member_name(name: str) -> bool:
    return _is_member_name(name) or _ONE_OF_SEVERAL.fullmatch(name) is not None


def _is_member_name(name: str) -> bool:
    return name == RUN or is_robot(name) or any(is_file_of(name, kind) for kind in run_kinds())
