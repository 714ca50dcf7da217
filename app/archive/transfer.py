"""Moves a run between stores: all it has into an archive, and out of one, checked."""

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Any

from app.archive import archive
from app.archive.archived_files import check_files, files_of, is_file_of
from app.archive.archived_run import read_run_json, run_json
from app.archive.archived_trials import TRIALS, read_trials_json, trials_json
from app.domain.errors import DamagedFile
from app.events.run_view import as_shown
from app.experiments.config import ExperimentConfig
from app.limits.memory_budget import MemoryBudget
from app.storage.errors import Busy, Damaged
from app.storage.json_text import is_finite
from app.storage.run_ids import RunIds
from app.storage.store import KINDS, Content, DamagedRun, IdempotencyKey, Run, RunStore

RUN = "run.json"
_ANYONE = "anyone"


def export_run(store: RunStore, run_id: str) -> bytes:
    """The archive of a run that has ended, all at once; raises as `export_pieces`."""
    return b"".join(export_pieces(store, run_id))


def export_pieces(
    store: RunStore, run_id: str, budget: MemoryBudget | None = None
) -> Iterator[bytes]:
    """The archive of a run that has ended, piece by piece: its files are not held in memory.

    Args:
        store: where it is.
        run_id: of the run.
        budget: for what is held until the last piece: the run's row, its curve or its trials.

    Raises:
        NotFound: if there is no such run.
        Conflict: if it has not ended.
        Damaged: if what the database holds of it is damaged.
        DamagedFile: if one of its files is damaged.
        InvalidInput: if it is too large.
        Busy: if the budget does not allow for it now.
    """
    run = as_shown(store.get(run_id))
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    curve, trials = store.evaluations(run_id), store.trials(run_id)
    if not is_finite([curve, trials]):
        # JSON would have null there, and no import would take that.
        raise Damaged(run_id, "its curve or its trials have a number that is none")
    texts = {RUN: run_json(run, curve)}
    if run.kind == "experiment":
        texts[TRIALS] = trials_json(trials)
    held = {name: archive.member(text) for name, text in texts.items()}
    pieces = archive.packed(held | files_of(store, run))
    return pieces if budget is None else _HeldPieces(pieces, sum(map(len, texts.values())), budget)


class _HeldPieces:
    """Pieces whose beginnings stay in memory, and count, for as long as this object is there."""

    def __init__(self, pieces: Iterator[bytes], size: int, budget: MemoryBudget) -> None:
        self._pieces, self._size, self._budget = pieces, 0, budget
        if budget.take(_ANYONE, size) is not None:
            raise Busy("as much is exported as the server can at once; try again in a moment", 5)
        self._size = size

    def __iter__(self) -> Iterator[bytes]:
        return self

    def __next__(self) -> bytes:
        return next(self._pieces)

    def __del__(self) -> None:
        # Also of an answer that was never begun, whose generator's `finally` would not run.
        if self._size:
            self._budget.give_back(_ANYONE, self._size)


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
    members = archive.unpack(data, said, _is_known)
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
