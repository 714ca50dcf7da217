"""The run store, on SQLite and PostgreSQL."""

import base64
import contextlib
import json
import math
import threading
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from itertools import product
from typing import Any

import pytest

from app.storage.database.listing import cursor_before
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import (
    LIVE,
    NOT_ENDED,
    QUEUED,
    RUNNING,
    SORTS,
    AnyRun,
    DamagedRun,
    Run,
    Sort,
    State,
)
from app.storage.run_ids import RunIds
from hexapods.domain.disturbances import Slope
from hexapods.domain.errors import InvalidInput
from hexapods.domain.world import World
from hexapods.runs.results import (
    FiguresUnderClock,
    LaneFigures,
    LaneResult,
    RaceResult,
    TrainingResult,
)
from tests.features.needing import needs
from tests.storage.stores import (
    ODD,
    RACE,
    experiment,
    race,
    training,
)

new_id = RunIds()


def queued_run(store: RunStore, name: str = "it") -> Run:
    run = training(new_id(), name=name)
    store.create(run)
    return run


@needs("experiments")
def test_stored_runs_are_returned_unchanged(store: RunStore) -> None:
    now = datetime(2026, 3, 1, 12, 30, 15, 123456, tzinfo=timezone(timedelta(hours=5)))
    runs = [
        training("a", config=ODD, continued_from="x", changes=({"step": 3, "pace": "max"},)),
        training("b", result=TrainingResult(distance_m=0.5, fell_at_step=3), error="It broke."),
        race("c", waiting_for=("a", "b"), state="running", done=2**40, eta_s=1.25),
        training("d", name="ü 🕷 <b>'--", created_at=now, started_at=now, ended_at=now),
        experiment("d2", workers=2, done=7),
        training("e", greedy_distance_m=-0.1, state="failed", config=replace(ODD, pace="max")),
        race("f", config=replace(RACE, world=World((Slope(degrees=8.0, until_step=900),)))),
    ]
    store.create(*runs)
    store.create()
    assert [store.get(run.id) for run in runs] == runs
    assert store.list().items == list(reversed(runs))
    assert store.get("d").created_at.astimezone(UTC) == now


def test_counts_are_by_state(store: RunStore) -> None:
    assert not store.counts()
    store.create(training("a"), race("b"), training("c", state="failed"))
    assert store.counts() == {"queued": 2, "failed": 1}


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (
            {"result": TrainingResult(distance_m=1e9)},
            "distance_m: Input should be less than or equal to",
        ),
        ({"greedy_distance_m": math.inf}, "its greedy_distance_m has NaN or an infinity"),
        (
            {"changes": ({"step": 1, "settings": {"alpha": math.nan}},)},
            "its changes has NaN or an infinity",
        ),
    ],
)
def test_run_with_an_impossible_number_is_damaged(
    store: RunStore, damage: dict[str, Any], reason: str
) -> None:
    """JSON has no NaN."""
    store.create(training("a", **damage))
    damaged = store.find("a")
    assert isinstance(damaged, DamagedRun)
    assert reason in damaged.damaged


def test_nan_in_a_result_is_what_was_not_measured(store: RunStore) -> None:
    """Earlier versions stored it."""
    store.create(training("a", result=TrainingResult(distance_m=math.nan)))
    assert store.get("a").result == TrainingResult(distance_m=None)


def test_nan_in_a_curve_is_preserved(store: RunStore) -> None:
    store.create(training("a"))
    store.curves.append("a", [{"step": 1, "distance_m": math.nan, "epsilon": 1.0}])
    assert math.isnan(store.curves.get("a")[0]["distance_m"])


def test_unknown_run_raises_not_found(store: RunStore) -> None:
    for run_id in ("none", "", "a\0b", "\ud800", "' OR 1=1 --"):
        for look in (
            store.get,
            store.delete,
            store.curves.get,
            lambda i: store.update(i, done=1),
            lambda i: store.update_progress(i, 1),
            lambda i: store.change(i, NOT_ENDED, "failed"),
            lambda i: store.artifact(i, "a"),
            lambda i: store.put_artifact(i, "a", b""),
            lambda i: store.curves.append(i, [{"step": 1, "distance_m": 0.0, "epsilon": 0}]),
        ):
            with pytest.raises(NotFound):
                look(run_id)


@pytest.mark.parametrize("cursor", ["", "a\0", "\ud800", "zzzz", "c"])
@pytest.mark.parametrize("sort", SORTS)
def test_a_text_that_is_no_cursor_is_refused(store: RunStore, sort: Sort, cursor: str) -> None:
    store.create(training("b"), training("d"))
    with pytest.raises(InvalidInput, match="cursor must be the next_cursor") as refusal:
        store.list(sort=sort, cursor=cursor)
    assert refusal.value.field == "cursor"


def test_a_cursor_is_of_lists_in_one_order(store: RunStore) -> None:
    store.create(training("b"), training("c"), training("d"))
    newest = store.list(limit=1).next_cursor
    assert [run.id for run in store.list(cursor=newest).items] == ["c", "b"]
    for sort in set(SORTS) - {"newest"}:
        with pytest.raises(InvalidInput, match="of a list in the same order"):
            store.list(sort=sort, cursor=newest)


def test_a_list_can_begin_before_any_id(store: RunStore) -> None:
    store.create(training("b"), training("d"))
    assert [run.id for run in store.list(cursor=cursor_before("c")).items] == ["b"]


def test_list_filters_by_kind_and_state_and_paginates(store: RunStore) -> None:
    states: list[State] = ["queued", "running", "finished"]
    store.create(*(training(f"t{n}", state=state) for n, state in enumerate(states)))
    store.create(*(race(f"r{n}", state=state) for n, state in enumerate(states)))

    def listed(**filters: Any) -> list[str]:
        return [run.id for run in store.list(**filters).items]

    assert listed() == ["t2", "t1", "t0", "r2", "r1", "r0"]
    assert listed(kind="race") == ["r2", "r1", "r0"]
    assert listed(state="running") == ["t1", "r1"]
    assert listed(kind="training", state="finished", limit=1) == ["t2"]
    page = store.list(kind="race", limit=2)
    assert [run.id for run in page.items] == ["r2", "r1"]
    assert store.list(kind="race", limit=2, cursor=page.next_cursor).next_cursor is None


def test_list_finds_a_part_of_a_name_or_id_literally(store: RunStore) -> None:
    runs = [
        training(f"0{number}", name=name)
        for number, name in enumerate(["Slow tripod", "ripple 100%", "ripple 100 steps", "a_b"])
    ]
    store.create(*runs)

    def names_with(search: str) -> list[str]:
        return [run.name for run in store.list(search=search).runs]

    assert names_with("TRIPOD") == ["Slow tripod"]
    assert names_with("100%") == ["ripple 100%"], "% is no wildcard"
    assert names_with("a_b") == ["a_b"], "_ is no wildcard"
    assert names_with("02") == ["ripple 100 steps"], "by id"
    assert names_with("\\") == []
    assert names_with("") == names_with("0") == [run.name for run in reversed(runs)]
    page = store.list(kind="training", search="ripple", limit=1)
    assert [run.name for run in page.runs] == ["ripple 100 steps"]
    page = store.list(kind="training", search="ripple", limit=1, cursor=page.next_cursor)
    assert [run.name for run in page.runs] == ["ripple 100%"]
    assert page.next_cursor is None


def walked(run_id: str, distance_m: float, **fields: Any) -> Run:
    return training(
        run_id, state="finished", result=TrainingResult(distance_m=distance_m), **fields
    )


def race_won(run_id: str, distance_m: float) -> Run:
    """Create a race that its second lane won."""
    lanes = tuple(lane_result(rank, distance_m / rank) for rank in (2, 1))
    return race(run_id, state="finished", result=RaceResult(lanes=lanes))


def lane_result(rank: int, distance_m: float) -> LaneResult:
    figures = FiguresUnderClock(
        finished_distance_m=distance_m, elapsed_s=1.0, crossed_s=None, rank=rank
    )
    return LaneResult(
        agent="greedy",
        steps=1,
        total_distance_m=distance_m,
        failure=None,
        decision_s=0.0,
        simulated_transitions=12,
        clocks=LaneFigures(paper=figures, wall=figures, free=figures),
    )


def test_lists_are_sorted_by_name_distance_and_time_page_by_page(store: RunStore) -> None:
    store.create(
        walked("a", 0.3, name="beta"),
        race_won("b", 0.5),
        walked("c", float("nan"), name="Beta"),
        training("d", name="ähnlich"),
        walked("e", 0.3, name="Alpha"),
    )

    def listed(sort: Any) -> str:
        """List two at a time."""
        ids: list[str] = []
        cursor = None
        while not ids or cursor is not None:
            page = store.list(limit=2, sort=sort, cursor=cursor)
            ids += [run.id for run in page.items]
            cursor = page.next_cursor
        return "".join(ids)

    assert listed("newest") == "edcba"
    assert listed("oldest") == "abcde"
    assert listed("name") == "ecabd", "A to Z alike, the newest first, and letters beyond Z last"
    assert listed("distance") == "beadc", "those without a distance last"
    store.change("e", {"finished"}, "failed", result=None)
    assert listed("distance") == "baedc"
    page = store.list(limit=2, sort="name")
    store.delete("c")
    assert [run.id for run in store.list(sort="name", cursor=page.next_cursor).runs] == [
        "a",
        "b",
        "d",
    ]
    for cursor in ("a", "\ud800", page.next_cursor):
        with pytest.raises(InvalidInput, match="cursor must be the next_cursor"):
            store.list(sort="distance", cursor=cursor)


def test_a_forged_cursor_is_taken_or_refused(store: RunStore) -> None:
    store.create(training("a"), training("b"))
    keys = [0.5, 5, -0.0, 1e999, math.nan, True, None, "b", "a\0", "\ud800", [0.5], {"a": "b"}]
    ids = ["a", "", 5, True, None, "a\0", "\ud800", "damaged-", [0.5]]
    for key in [*product(keys, ids), ["b"], [0.5, "b", "c"], {"a": 1, "b": 2}, 7, "ab"]:
        for sort in SORTS:
            forged = [sort, *key] if isinstance(key, list | tuple) else key
            cursor = base64.urlsafe_b64encode(json.dumps(forged).encode()).decode()
            with contextlib.suppress(InvalidInput):
                store.list(sort=sort, cursor=cursor)
    for text in ("[" * 1400, "9" * 1400, "[0.5, ", "\xff"):
        cursor = base64.urlsafe_b64encode(text.encode("latin-1")).decode()
        with pytest.raises(InvalidInput, match="cursor must be the next_cursor"):
            store.list(sort="distance", cursor=cursor)


def test_tags_and_notes_are_kept_and_found(store: RunStore) -> None:
    store.create(training("a", tags=("ice", "50 %")), training("b", tags=("iceberg",), notes="Ice"))
    store.update("a", notes="one\n\ttwo", name="A")
    assert (store.get("a").tags, store.get("a").notes) == (("ice", "50 %"), "one\n\ttwo")

    def ids_of(**filters: Any) -> list[str]:
        return [run.id for run in store.list(**filters).runs]

    assert ids_of(tag="ICE") == ["a"], "the whole tag, A to Z alike"
    assert ids_of(tag="50 %") == ["a"]
    assert ids_of(tag="50") == ids_of(tag="%") == []
    assert ids_of(search="ice") == ["b", "a"], "in tags and in notes"
    store.update("a", tags=())
    assert ids_of(tag="ice") == []


def test_progress_is_visible_at_once_and_survives_changes(store: RunStore) -> None:
    run = queued_run(store)
    store.change(run.id, QUEUED, "running")
    for done in range(1, 200):
        store.update_progress(run.id, done, eta_s=200.0 - done)
        assert store.get(run.id).done == done
    assert store.list().runs[0].done == 199
    assert store.get(run.id).eta_s == 1.0
    assert store.update(run.id, greedy_distance_m=0.5).done == 199
    store.update_progress(run.id, 200, eta_s=0.0)
    ended = store.change(run.id, RUNNING, "finished")
    assert (ended.done, ended.eta_s, ended.greedy_distance_m) == (200, None, 0.5)
    assert store.get(run.id) == ended
    assert store.update(run.id, done=7).done == 7


@pytest.mark.parametrize("state", ["paused", "finished", "failed"])
def test_only_a_running_run_has_an_estimate(store: RunStore, state: State) -> None:
    """A late report of progress does not restore the estimate."""
    run = queued_run(store)
    store.change(run.id, QUEUED, "running")
    store.update_progress(run.id, 10, eta_s=5.0)
    returned: list[AnyRun] = [store.change(run.id, RUNNING, state)]
    for done in (11, 12):
        store.update_progress(run.id, done, eta_s=4.0)
        returned += [store.get(run.id), *store.list().items, store.update(run.id, error="late")]
    assert [stored_run.eta_s for stored_run in returned if isinstance(stored_run, Run)] == [
        None
    ] * len(returned)


def test_ended_run_never_has_an_estimate(store: RunStore) -> None:
    """Also not between the write of the final state and the removal of the cached progress."""
    runs = [queued_run(store) for _ in range(50)]
    seen: list[Run] = []
    over = threading.Event()

    def read() -> None:
        is_last = False
        while not is_last:
            is_last = over.is_set()
            items = store.list().items
            seen.extend(run for run in items if isinstance(run, Run) and run.state == "finished")

    readers = [threading.Thread(target=read) for _ in range(2)]
    for reader in readers:
        reader.start()
    for run in runs:
        store.change(run.id, QUEUED, "running")
        store.update_progress(run.id, 500, eta_s=0.0)
        store.change(run.id, RUNNING, "finished", eta_s=None)
    over.set()
    for reader in readers:
        reader.join()
    assert seen
    assert {run.eta_s for run in seen} == {None}


def test_progress_never_decreases(store: RunStore) -> None:
    """Not even with concurrent writes to the run."""
    run = queued_run(store)
    store.change(run.id, QUEUED, "running")
    seen: list[int] = []
    over = threading.Event()

    def repeatedly(call: Callable[[], object]) -> threading.Thread:
        def repeat() -> None:
            while not over.is_set():
                call()

        thread = threading.Thread(target=repeat)
        thread.start()
        return thread

    threads = [
        repeatedly(lambda: seen.append(store.get(run.id).done)),
        repeatedly(lambda: store.update(run.id, greedy_distance_m=0.5)),
        repeatedly(lambda: store.put_artifact(run.id, "a", b"", error=None)),
    ]
    for done in range(1, 300):
        store.update_progress(run.id, done, eta_s=1.0)
    over.set()
    for thread in threads:
        thread.join()
    assert seen == sorted(seen)
    assert store.get(run.id).done == 299


def test_repeated_evaluations_replace_the_curve_from_their_step_on(store: RunStore) -> None:
    run = queued_run(store)

    def row(step: int, distance: float) -> dict[str, float]:
        return {"step": step, "distance_m": distance, "epsilon": 1 - step / 1000}

    store.curves.append(run.id, [])
    store.curves.append(run.id, [row(50, 0.1), row(100, 0.2)])
    store.curves.append(run.id, [row(150, 0.3)])
    assert store.curves.get(run.id) == [row(50, 0.1), row(100, 0.2), row(150, 0.3)]
    store.curves.append(run.id, [row(100, 0.25)])
    assert store.curves.get(run.id) == [row(50, 0.1), row(100, 0.25)]


def test_thinned_curves_end_with_the_newest_point(store: RunStore) -> None:
    for run_id, count in (("a", 3), ("b", 100), ("c", 0), ("d", 1)):
        store.create(training(run_id))
        rows = ({"step": n, "distance_m": n / 100, "epsilon": 0.0} for n in range(1, count + 1))
        store.curves.append(run_id, list(rows))
    store.curves.append("d", [{"step": 1, "distance_m": math.nan, "epsilon": 1.0}])
    curves = store.curves.thinned(["a", "b", "c", "d", "none"], 30)
    assert curves.keys() == {"a", "b", "d"}
    assert curves["a"] == [(1, 0.01), (2, 0.02), (3, 0.03)]
    assert [step for step, _ in curves["b"]] == list(range(4, 101, 4))
    assert math.isnan(curves["d"][0][1])
    assert store.curves.thinned(["b"], 1)["b"] == [(100, 1.0)]


def test_artifact_replaces_the_one_with_its_name(store: RunStore) -> None:
    runs = queued_run(store), queued_run(store)
    for size in (0, 1, 1_000_000, 10):
        for number, run in enumerate(runs):
            data = bytes([number]) * size
            store.put_artifact(run.id, "a", data)
            assert store.artifact(run.id, "a") == data
    assert store.artifact(runs[0].id, "../a") is None


def test_concurrent_reads_return_a_complete_artifact(store: RunStore) -> None:
    run = queued_run(store)
    store.put_artifact(run.id, "a", bytes(100_000))
    stopped = threading.Event()
    seen: list[bytes | None] = []

    def read() -> None:
        while not stopped.is_set():
            seen.append(store.artifact(run.id, "a"))

    reader = threading.Thread(target=read)
    reader.start()
    for number in range(50):
        store.put_artifact(run.id, "a", bytes([number]) * 100_000)
    stopped.set()
    reader.join()
    assert seen
    assert all(data == data[:1] * 100_000 for data in seen if data is not None)
    assert None not in seen


def test_change_of_state_is_compare_and_set(store: RunStore) -> None:
    run = queued_run(store)
    assert store.change(run.id, QUEUED, "running", done=3).done == 3
    with pytest.raises(Conflict, match="is running") as error:
        store.change(run.id, QUEUED, "stopped")
    assert error.value.state == "running"
    assert store.get(run.id).state == "running"


def test_one_of_many_concurrent_changes_succeeds(store: RunStore) -> None:
    run = queued_run(store)
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


def test_pages_are_stable_while_runs_are_added(store: RunStore) -> None:
    runs = [queued_run(store, f"run {n}") for n in range(5)]
    seen, cursor = [], None
    while True:
        page = store.list(limit=2, cursor=cursor)
        seen += [run.id for run in page.items]
        cursor = page.next_cursor
        if cursor is None:
            break
        queued_run(store, "one more does not move the page")
    assert seen == [run.id for run in reversed(runs)]
    assert store.list(kind="race").items == []
    assert store.list(state="running").items == []


def test_only_an_ended_run_is_deleted_and_completely(store: RunStore) -> None:
    run = queued_run(store)
    store.put_artifact(run.id, "a", b"1")
    store.curves.append(run.id, [{"step": 50, "distance_m": 0.1, "epsilon": 0.5}])
    assert store.artifact(run.id, "a") == b"1"
    assert store.artifact(run.id, "b") is None
    with pytest.raises(Conflict, match="queued"):
        store.delete(run.id)
    store.change(run.id, QUEUED | LIVE, "stopped")
    store.delete(run.id)
    for look in (store.get, store.delete, store.curves.get):
        with pytest.raises(NotFound, match=run.id):
            look(run.id)
    with pytest.raises(NotFound):
        store.artifact(run.id, "a")


def test_ids_increase_within_a_millisecond() -> None:
    ids = [new_id() for _ in range(1000)]
    assert ids == sorted(ids)
    assert len(set(ids)) == 1000
    assert all(len(identifier) == 13 and identifier.isalnum() for identifier in ids)


def test_artifact_and_fields_are_stored_atomically(store: RunStore) -> None:
    run = queued_run(store)
    store.update_progress(run.id, 7, 2.0)
    store.put_artifact(run.id, "checkpoint.npz", b"5", done=5)
    store.put_artifact(run.id, "other", b"x")
    interrupted = store.change(run.id, QUEUED, "interrupted")
    assert (interrupted.done, store.artifact(run.id, "checkpoint.npz")) == (5, b"5")
    with pytest.raises(NotFound):
        store.put_artifact("none", "checkpoint.npz", b"5", done=5)


def test_evaluations_after_a_step_are_deleted(store: RunStore) -> None:
    run, other = queued_run(store), queued_run(store)
    for owner in (run, other):
        rows = [{"step": step, "distance_m": 0.1, "epsilon": 0.0} for step in (50, 100, 150)]
        store.curves.append(owner.id, rows)
    store.curves.delete_after(run.id, after_step=100)
    assert [row["step"] for row in store.curves.get(run.id)] == [50, 100]
    assert [row["step"] for row in store.curves.get(other.id)] == [50, 100, 150]
