"""The queue is fair among participants of rooms, and theirs do not use up the places of others."""

import pytest

from app.jobs.queue import MAX_QUEUED, RunQueue
from app.storage.database.store import RunStore
from app.storage.errors import Busy
from app.storage.run import Run
from tests.jobs.test_jobs import training


def queue_of(store: RunStore) -> RunQueue:
    """Return a queue in which the first letter of an id tells the participant; `o` is none."""
    return RunQueue(store, lambda run: None, lambda run_id: run_id[0].replace("o", "") or None)


def add(queue: RunQueue, *run_ids: str) -> None:
    for run_id in run_ids:
        config = training().config
        queue.add([Run(id=run_id, kind="training", name="x", config=config, total=10)], 0)


def popped(queue: RunQueue) -> list[str]:
    ids = []
    while (run := queue.pop_ready()) is not None:
        ids.append(run.id)
    return ids


def test_who_has_had_the_fewest_turns_comes_first(store: RunStore) -> None:
    queue = queue_of(store)
    add(queue, "a1", "a2", "a3", "b1", "b2", "c1")
    assert popped(queue) == ["a1", "b1", "c1", "a2", "b2", "a3"]
    add(queue, "a4", "d1", "c2")
    assert popped(queue) == ["d1", "c2", "a4"]


def test_others_keep_their_place(store: RunStore) -> None:
    queue = queue_of(store)
    add(queue, "o1", "a1", "a2", "o2", "b1")
    assert popped(queue) == ["o1", "a1", "b1", "o2", "a2"]


def test_a_full_class_leaves_the_places_of_others(store: RunStore) -> None:
    queue = queue_of(store)
    letters = [chr(point) for point in range(ord("p"), ord("z"))]
    add(queue, *(f"{letter}{n}" for letter in letters for n in range(8)))
    add(queue, *(f"o{n}" for n in range(MAX_QUEUED)))
    add(queue, "z1")
    with pytest.raises(Busy, match=f"{MAX_QUEUED} runs are waiting"):
        add(queue, "oo")
