"""A long queue: what it costs to end it, and to tell all who wait, grows with its length alone."""

import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import pytest
from sqlalchemy import Connection, event

from app.jobs.queue import Owner, RunQueue
from app.storage.database.store import RunStore
from app.storage.run import Run
from tests.jobs.test_jobs import training


class Cost(NamedTuple):
    """Time and memory that something in a queue has taken.

    Attributes:
        transactions: of the database.
        looks: how often it was asked who waits for a run.
        events: published runs.
    """

    transactions: int
    looks: int
    events: int


def cost_of(store: RunStore, length: int, do: Callable[[RunQueue], Any]) -> Cost:
    """Return what something costs in a queue of visitors' runs."""
    transactions: list[Connection] = []
    looks: list[str] = []
    events: list[Any] = []

    def owner_of(run_id: str) -> Owner:
        looks.append(run_id)
        return Owner(run_id, run_id[-1], is_guest=True)

    queue = RunQueue(store, lambda run, position: events.append((run, position)), owner_of)
    config = training().config
    for number in range(length):
        run_id = f"{length:05}{number:05}"
        queue.add([Run(id=run_id, kind="training", name="x", config=config, total=10)], 0)
    looks.clear()
    events.clear()

    def note(connection: Connection) -> None:
        # Not those of the thread that renews the ownership of the database.
        if threading.current_thread() is threading.main_thread():
            transactions.append(connection)

    event.listen(store.database.engine, "begin", note)
    try:
        do(queue)
    finally:
        event.remove(store.database.engine, "begin", note)
    return Cost(len(transactions), len(looks), len(events))


DEEDS: dict[str, Callable[[RunQueue], Any]] = {
    "it is interrupted": lambda queue: queue.interrupt("The server was stopped."),
    "all are told their places": lambda queue: queue.publish_positions(),
    "one is stopped": lambda queue: queue.stop(next(iter(queue._runs.values()))),  # noqa: SLF001
}


@pytest.mark.parametrize("deed", DEEDS)
def test_it_takes_no_more_transactions_and_looks_in_proportion(store: RunStore, deed: str) -> None:
    short, long = (cost_of(store, length, DEEDS[deed]) for length in (10, 100))
    assert short.transactions == long.transactions <= 1
    assert long.looks <= 3 * 100
    assert (short.events, long.events) == (10, 100)


def test_all_that_wait_are_interrupted_at_once(store: RunStore) -> None:
    published: list[tuple[Run, int | None]] = []
    queue = RunQueue(store, lambda run, position: published.append((run, position)))
    config = training().config
    for run_id in ("a", "b"):
        queue.add([Run(id=run_id, kind="training", name="x", config=config, total=10)], 0)
    published.clear()
    queue.interrupt("The server was stopped.")
    assert [(run.id, position) for run, position in published] == [("a", None), ("b", None)]
    for run, _ in published:
        assert store.get(run.id) == run
        assert (run.state, run.error) == ("interrupted", "The server was stopped.")
        assert run.ended_at is not None
        assert run.ended_at >= run.created_at
    assert queue.pop_ready() is None
