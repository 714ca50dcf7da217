"""What every store of runs has to do."""

import threading

import pytest

from app.runs.config import TrainingConfig
from app.services.errors import Conflict, NotFound
from app.services.ids import RunIds
from app.services.store import LIVE, QUEUED, RUNNING, MemoryStore, Run, RunStore

CONFIG = TrainingConfig(gait="left-right-origin")
new_id = RunIds()


@pytest.fixture
def store() -> RunStore:
    return MemoryStore()


def a_run(store: RunStore, name: str = "it") -> Run:
    run = Run(id=new_id(), kind="training", name=name, config=CONFIG, total=500)
    store.create(run)
    return run


def test_a_state_changes_only_from_where_it_was_thought_to_be(store: RunStore) -> None:
    run = a_run(store)
    assert store.change(run.id, QUEUED, "running", done=3).done == 3
    with pytest.raises(Conflict, match="is running") as error:
        store.change(run.id, QUEUED, "stopped")
    assert error.value.state == "running"
    assert store.get(run.id).state == "running"


def test_of_many_at_once_one_wins(store: RunStore) -> None:
    run = a_run(store)
    store.change(run.id, QUEUED, "running")
    won: list[int] = []

    def pause(number: int) -> None:
        try:
            store.change(run.id, RUNNING, "paused")
        except Conflict:
            return
        won.append(number)

    threads = [threading.Thread(target=pause, args=(n,)) for n in range(32)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(won) == 1


def test_pages_go_on_where_the_last_ended(store: RunStore) -> None:
    runs = [a_run(store, f"run {n}") for n in range(5)]
    seen, cursor = [], None
    while True:
        page = store.list(limit=2, cursor=cursor)
        seen += [run.id for run in page.items]
        cursor = page.next_cursor
        if cursor is None:
            break
        a_run(store, "one more does not move the page")
    assert seen == [run.id for run in reversed(runs)]
    assert store.list(kind="race").items == []
    assert store.list(state="running").items == []


def test_only_what_has_ended_is_deleted_and_then_wholly(store: RunStore) -> None:
    run = a_run(store)
    store.put_artifact(run.id, "a", b"1")
    store.append_evaluations(run.id, [{"step": 50}])
    assert store.artifact(run.id, "a") == b"1"
    assert store.artifact(run.id, "b") is None
    with pytest.raises(Conflict, match="queued"):
        store.delete(run.id)
    store.change(run.id, QUEUED | LIVE, "stopped")
    store.delete(run.id)
    for look in (store.get, store.delete, store.evaluations):
        with pytest.raises(NotFound, match=run.id):
            look(run.id)
    with pytest.raises(NotFound):
        store.artifact(run.id, "a")


def test_ids_rise_even_within_a_millisecond() -> None:
    ids = [new_id() for _ in range(1000)]
    assert ids == sorted(ids)
    assert len(set(ids)) == 1000
    assert all(len(made) == 13 and made.isalnum() for made in ids)
