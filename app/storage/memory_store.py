"""In-memory implementation of `RunStore`, for tests and for a data folder that is empty."""

import math
import threading
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from app.storage.artifact_file import ArtifactFile, BytesFile
from app.storage.errors import Conflict, NotFound
from app.storage.sessions import MemorySessionRows
from app.storage.store import (
    RUNNING,
    UNENDED,
    AnyRun,
    Content,
    IdempotencyKey,
    KeyRecord,
    Kind,
    Page,
    Run,
    State,
)


class MemoryStore:
    """Implements `RunStore` with dictionaries under one lock; lost when the process ends."""

    def __init__(self) -> None:
        self._runs: dict[str, Run] = {}
        self._curves: dict[str, list[Mapping[str, Any]]] = {}
        self._trials: dict[str, dict[str, Mapping[str, Any]]] = {}
        self._artifacts: dict[str, dict[str, bytes]] = {}
        self._keys: dict[str, KeyRecord] = {}
        self._lock = threading.Lock()
        self.sessions = MemorySessionRows()

    def check_disk_space(self) -> None:
        pass

    def create(self, *runs: Run, key: IdempotencyKey | None = None) -> None:
        with self._lock:
            self._runs |= {run.id: run for run in runs}
            if key is not None:
                self._keys[key.key] = KeyRecord(key.digest, runs[-1].id)

    def add(
        self,
        run: Run,
        content: Content,
        new_id: Callable[[], str],
        key: IdempotencyKey | None = None,
    ) -> Run:
        if run.id in self._runs:
            run = replace(run, id=new_id())
        self.create(run, key=key)
        self.append_evaluations(run.id, content.evaluations)
        self.append_trials(run.id, content.trials)
        for name, data in content.artifacts.items():
            self.put_artifact(run.id, name, data)
        return run

    def find_key(self, key: str) -> KeyRecord | None:
        with self._lock:
            return self._keys.get(key)

    def find(self, run_id: str) -> AnyRun:
        return self.get(run_id)

    def get(self, run_id: str) -> Run:
        with self._lock:
            return self._run(run_id)

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page:
        with self._lock:
            matching = [
                run
                for run in self._runs.values()
                if (kind is None or run.kind == kind)
                and (state is None or run.state == state)
                and (cursor is None or run.id < cursor)
            ]
        matching.sort(key=lambda run: run.id, reverse=True)
        has_more = len(matching) > limit
        return Page([*matching[:limit]], matching[limit - 1].id if has_more else None)

    def counts(self) -> Mapping[State, int]:
        with self._lock:
            return Counter(run.state for run in self._runs.values())

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        with self._lock:
            run = self._run(run_id)
            if run.state not in from_states:
                raise Conflict(f"{run.kind} {run_id} is {run.state}", run.state)
            self._runs[run_id] = replace(run, state=to_state, **{"eta_s": None, **fields})
            return self._runs[run_id]

    def update(self, run_id: str, **fields: Any) -> Run:
        with self._lock:
            self._runs[run_id] = replace(self._run(run_id), **fields)
            return self._runs[run_id]

    def update_progress(self, run_id: str, done: int, eta_s: float | None = None) -> None:
        with self._lock:
            run = self._run(run_id)
            left_s = eta_s if run.state in RUNNING else None
            self._runs[run_id] = replace(run, done=done, eta_s=left_s)

    def delete(self, run_id: str) -> None:
        with self._lock:
            run = self._run(run_id)
            if run.state in UNENDED:
                raise Conflict(f"{run.kind} {run_id} is {run.state}; stop it first", run.state)
            for table in (self._runs, self._curves, self._trials, self._artifacts):
                table.pop(run_id, None)

    def append_evaluations(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        with self._lock:
            self._run(run_id)
            first = min((row["step"] for row in rows), default=math.inf)
            before = [row for row in self._curves.get(run_id, ()) if row["step"] < first]
            self._curves[run_id] = [*before, *rows]

    def evaluations(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        with self._lock:
            self._run(run_id)
            return [*self._curves.get(run_id, ())]

    def delete_evaluations(self, run_id: str, after_step: int) -> None:
        with self._lock:
            curve = self._curves.get(run_id, [])
            self._curves[run_id] = [row for row in curve if row["step"] <= after_step]

    def append_trials(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        with self._lock:
            self._run(run_id)
            self._trials.setdefault(run_id, {}).update({row["key"]: dict(row) for row in rows})

    def trials(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        with self._lock:
            self._run(run_id)
            return [row for _, row in sorted(self._trials.get(run_id, {}).items())]

    def put_artifact(self, run_id: str, name: str, data: bytes, **fields: Any) -> None:
        with self._lock:
            self._runs[run_id] = replace(self._run(run_id), **fields)
            self._artifacts.setdefault(run_id, {})[name] = data

    def artifact(self, run_id: str, name: str) -> bytes | None:
        with self._lock:
            self._run(run_id)
            return self._artifacts.get(run_id, {}).get(name)

    def open_artifact(self, run_id: str, name: str) -> ArtifactFile | None:
        data = self.artifact(run_id, name)
        return None if data is None else BytesFile(data)

    def _run(self, run_id: str) -> Run:
        if run_id not in self._runs:
            raise NotFound(f"there is no run {run_id!r} (any more)")
        return self._runs[run_id]
