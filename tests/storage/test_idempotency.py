"""Idempotency keys: a repeated request returns the same run, for a day and across restarts."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import text

from app.storage.database import keys
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, Gone
from app.storage.idempotency import Idempotency
from app.storage.run import KEY_LIFETIME, Content, IdempotencyKey, Run
from app.storage.run_ids import RunIds
from hexapods.domain.errors import InvalidInput
from tests.storage.stores import training

new_id = RunIds()


class Starts:
    """Start function that creates a new run with each call."""

    def __init__(self, store: RunStore) -> None:
        self.store = store

    def __call__(self, key: IdempotencyKey | None) -> Run:
        run = training(new_id(), state="finished")
        self.store.create(run, key=key)
        return run


def run_of(
    idempotency: Idempotency,
    key: str | None,
    request: bytes,
    start: Callable[[IdempotencyKey | None], Run],
) -> Run:
    (run,) = idempotency.runs(key, request, lambda key: [start(key)])
    return run


def count(store: RunStore) -> int:
    return len(store.list().items)


def test_key_starts_one_run_and_rejects_another_request(store: RunStore) -> None:
    idempotency, start = Idempotency(store), Starts(store)
    assert run_of(idempotency, None, b"x", start) != run_of(idempotency, None, b"x", start)
    run = run_of(idempotency, "key", b"x", start)
    assert run_of(idempotency, "key", b"x", start) == run
    assert run_of(Idempotency(store), "key", b"x", start) == run
    assert run_of(idempotency, "other", b"x", start) != run
    with pytest.raises(InvalidInput, match="Idempotency-Key"):
        run_of(idempotency, "key", b"y", start)
    assert count(store) == 4


def test_import_stores_its_key(store: RunStore) -> None:
    idempotency = Idempotency(store)

    def add(key: IdempotencyKey | None) -> Run:
        run = training("00000000000t1", state="finished")
        content = Content(artifacts={"q-table.npz": b"x"})
        return store.add([(run, content)], new_id, key)[0]

    run = run_of(idempotency, "key", b"x", add)
    assert run_of(idempotency, "key", b"x", add) == run
    assert run_of(idempotency, "other", b"x", add).id != run.id
    assert count(store) == 2


def test_concurrent_requests_with_one_key_return_the_same_run(store: RunStore) -> None:
    idempotency, start, gate = Idempotency(store), Starts(store), threading.Event()

    def slowly(key: IdempotencyKey | None) -> Run:
        gate.wait()
        return start(key)

    with ThreadPoolExecutor(8) as pool:
        futures = [pool.submit(run_of, idempotency, "key", b"x", slowly) for _ in range(8)]
        gate.set()
        runs = {future.result().id for future in futures}
    assert len(runs) == count(store) == 1


def test_failed_start_can_be_retried_with_the_same_key(store: RunStore) -> None:
    idempotency = Idempotency(store)

    def refuse(key: IdempotencyKey | None) -> Run:
        raise Busy("later", 1)

    with pytest.raises(Busy):
        run_of(idempotency, "key", b"x", refuse)
    assert run_of(idempotency, "key", b"x", Starts(store)).state == "finished"


def test_key_of_a_deleted_run_raises_gone(store: RunStore) -> None:
    idempotency, start = Idempotency(store), Starts(store)
    run = run_of(idempotency, "key", b"x", start)
    store.delete(run.id)
    with pytest.raises(Gone, match=f"{run.id}.*send a new key"):
        run_of(idempotency, "key", b"x", start)
    assert count(store) == 0


class Clock(datetime):
    """System time, set forward by `ahead`."""

    ahead = timedelta()

    @classmethod
    def now(cls, tz: object = None) -> datetime:  # type: ignore[override]
        return datetime.now(UTC) + cls.ahead


def test_keys_expire_after_a_day_or_beyond_the_maximum(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(keys, "datetime", Clock)
    monkeypatch.setattr(keys, "MAX_KEYS", 5)
    idempotency, start = Idempotency(store), Starts(store)
    first = run_of(idempotency, "key", b"x", start)
    monkeypatch.setattr(Clock, "ahead", KEY_LIFETIME - timedelta(minutes=1))
    assert run_of(idempotency, "key", b"x", start) == first
    monkeypatch.setattr(Clock, "ahead", KEY_LIFETIME + timedelta(minutes=1))
    assert run_of(idempotency, "key", b"y", start) != first
    for number in range(10):
        monkeypatch.setattr(Clock, "ahead", Clock.ahead + timedelta(seconds=1))
        run_of(idempotency, f"key {number}", b"x", start)
    left = [n for n in range(10) if store.keys.find(f"key {n}") is not None]
    assert left == [5, 6, 7, 8, 9]


def test_a_key_whose_row_is_damaged_starts_no_second_run(store: RunStore) -> None:
    """Whether it is the same request is not known any more."""
    idempotency, start = Idempotency(store), Starts(store)
    run_of(idempotency, "key", b"x", start)
    is_sqlite = store.database.engine.dialect.name == "sqlite"
    value = "'yesterday'" if is_sqlite else "'infinity'"
    damage = text(f"UPDATE idempotency_keys SET created_at = {value}")
    store.database.write(lambda connection: connection.execute(damage))
    with pytest.raises(Conflict, match="send a new key"):
        run_of(idempotency, "key", b"x", start)
    assert count(store) == 1
