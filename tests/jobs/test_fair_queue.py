"""The queue is fair among participants of rooms, and theirs do not use up the places of others."""

import pytest

from app.jobs.queue import MAX_OF_GUESTS, MAX_QUEUED, Owner, RunQueue
from app.storage.database.store import RunStore
from app.storage.errors import Busy
from app.storage.run import Run
from tests.jobs.test_jobs import training


def queue_of(store: RunStore) -> RunQueue:
    """Return a queue in which the first letter of an id tells the owner.

    `o` is an operator, other small letters are participants, capital ones visitors: the second
    letter tells the address.
    """

    def owner_of(run_id: str) -> Owner | None:
        name = run_id[0]
        if name.isupper():
            return Owner(name, run_id[1], is_guest=True)
        return None if name == "o" else Owner(name)

    return RunQueue(store, lambda run, position: None, owner_of)


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


def test_visitors_come_last_and_take_turns(store: RunStore) -> None:
    queue = queue_of(store)
    add(queue, "Ax1", "Ax2", "Ax3", "By1", "By2", "Cz1", "o1", "p1")
    expected = ["o1", "p1", "Ax1", "By1", "Cz1", "Ax2", "By2", "Ax3"]
    positions = {run_id: queue.position(run_id) for run_id in expected}
    assert popped(queue) == expected
    assert positions == {run_id: n for n, run_id in enumerate(expected, 1)}


def test_an_address_that_poses_as_many_has_the_turns_of_one(store: RunStore) -> None:
    queue = queue_of(store)
    ids = [*(f"{letter}x{n}" for letter in "ABCDE" for n in (1, 2)), "Zy1", "Zy2", "Zy3"]
    add(queue, *ids)
    places = {run_id: queue.position(run_id) for run_id in ids}
    order = popped(queue)
    assert places == {run_id: n for n, run_id in enumerate(order, 1)}
    order = [run_id[0] for run_id in order]
    assert order[:6] == ["A", "Z", "B", "Z", "C", "Z"]
    assert sorted(order[6:]) == sorted("ABCDEDE")


def test_turns_of_visitors_are_remembered(store: RunStore) -> None:
    queue = queue_of(store)
    add(queue, "Ax1", "Ax2")
    assert popped(queue) == ["Ax1", "Ax2"]
    add(queue, "Ax3", "By1")
    assert queue.position("Ax3") == 2
    assert popped(queue) == ["By1", "Ax3"]


def test_full_places_of_visitors_leave_those_of_others(store: RunStore) -> None:
    queue = queue_of(store)
    letters = "ABCDEFGH"
    add(queue, *(f"{letter}x{n}" for letter in letters for n in range(MAX_OF_GUESTS // 8)))
    add(queue, "o1", "p1")
    with pytest.raises(Busy, match=f"{MAX_OF_GUESTS} runs are waiting"):
        add(queue, "Ixx")
    assert popped(queue)[:2] == ["o1", "p1"]
