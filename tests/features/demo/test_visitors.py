"""Visitors: their allowance over time and restarts, and fair turns of three with real jobs."""

from collections.abc import Callable
from pathlib import Path

import pytest

from app.features.demo.rows import VisitorRows
from app.features.demo.visitors import Started, Visitors
from app.jobs.jobs import Jobs
from app.jobs.queue import MAX_OF_GUESTS
from app.jobs.submissions import LaneStart, RaceStart, Start, TrainingStart
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Forbidden
from app.storage.run import Run
from app.storage.run_ids import RunIds
from hexapods.domain.errors import InvalidInput
from tests.features.demo.clock import Clock
from tests.features.demo.conftest import SMALL
from tests.jobs.test_jobs import WALK, endless, training
from tests.jobs.waiting import wait_for_progress, wait_until_ended
from tests.postgresql import PostgresServer
from tests.storage.stores import BACKENDS, database_url, opened

HOME, SCHOOL = "192.0.2.1", "198.51.100.7"


def start(
    visitors: Visitors, jobs: Jobs, what: Start, key: str = "", address: str = HOME
) -> Started:
    return visitors.start(key, address, what, jobs.start)


def stored(store: RunStore, state: str = "finished") -> Callable[[Start], Run]:
    """Return what stores a start as if its runs had ended at once."""
    new_id = RunIds.of(store)

    def queue(what: Start) -> Run:
        runs = what.runs(store, new_id)
        store.create(*runs)
        for run in runs:
            store.change(run.id, {"queued"}, state)  # type: ignore[arg-type]
        return runs[-1]

    return queue


def store_count(store: RunStore) -> int:
    return sum(store.counts().values())


def test_a_visitor_is_known_by_a_key_of_which_a_hash_is_stored(
    store: RunStore, visitors: Visitors
) -> None:
    first = visitors.start("", HOME, training(), stored(store))
    assert len(first.key) > 40
    assert visitors.owns(first.key, first.run.id)
    assert not visitors.owns("another", first.run.id)
    assert not visitors.owns("", first.run.id)
    (row,) = VisitorRows(store.database).all()
    assert first.key not in repr(row)
    assert HOME not in repr(row)
    again = visitors.start(first.key, HOME, training(), stored(store))
    assert again.key == first.key
    assert visitors.count == 1
    forged = visitors.start("of-another-server", HOME, training(), stored(store))
    assert forged.key != "of-another-server"
    assert visitors.count == 2


def test_all_runs_of_a_claimed_start_are_given_and_a_restart_keeps_that(
    store: RunStore, clock: Clock, make_visitors: Callable[[], Visitors]
) -> None:
    visitors, secret = make_visitors(), "a-secret-of-a-request"
    race = RaceStart(WALK, [LaneStart("q-learning", training=training(steps=5))], 5, 0)
    first = visitors.start("", HOME, race, stored(store), secret)
    clock.pass_time(hours=1)
    second = visitors.start(first.key, HOME, training(steps=50), stored(store))
    other = visitors.start("", HOME, training(steps=50), stored(store))
    assert visitors.claim(other.key, "not-" + secret, first.run.id) == ""
    assert visitors.claim(other.key, secret, first.run.id) == other.key
    for visitors_now in (visitors, make_visitors()):
        assert len(visitors_now.use(other.key).kept) == 3
        assert visitors_now.use(first.key).kept == (second.run.id,)
        assert visitors_now.owns(other.key, first.run.lane_training_ids[0] or "")
        assert visitors_now.claim("", secret, first.run.id) == ""
        assert visitors_now.claim("", secret, second.run.id) == first.key


def test_the_steps_of_an_hour_come_back_and_a_restart_forgets_none(
    store: RunStore, clock: Clock, make_visitors: Callable[[], Visitors]
) -> None:
    visitors, queue = make_visitors(), stored(store)
    key = visitors.start("", HOME, training(steps=50), queue).key
    clock.pass_time(minutes=20)
    visitors.start(key, HOME, training(steps=40), queue)
    assert visitors.use(key).steps == 90
    for visitors_now in (visitors, make_visitors()):
        with pytest.raises(
            Busy, match=r"10 of 100 steps an hour left, and this takes 20.*40 min"
        ) as busy:
            visitors_now.start(key, HOME, training(steps=20), queue)
        assert busy.value.retry_after_s == 2400
    clock.pass_time(minutes=40)
    assert make_visitors().start(key, HOME, training(steps=60), queue).key == key


@pytest.mark.parametrize("backend", BACKENDS)
def test_rows_are_the_same_on_each_database(
    backend: str, postgresql: PostgresServer, tmp_path: Path, clock: Clock
) -> None:
    with database_url(backend, postgresql) as url, opened(tmp_path, url) as store:
        visitors = Visitors(store, SMALL, now=clock.time)
        started = visitors.start("", HOME, training(), stored(store, "interrupted"))
        later = Visitors(store, SMALL, now=clock.time)
        assert later.use(started.key) == visitors.use(started.key)
        assert later.unfinished() == [started.run.id]
        assert later.made_before(clock.now) == VisitorRows(store.database).all()
        later.forget([started.run.id])
        assert Visitors(store, SMALL).count == 0


def test_deleted_runs_count_but_are_not_kept(store: RunStore, visitors: Visitors) -> None:
    queue = stored(store)
    started = visitors.start("", HOME, training(steps=50), queue)
    store.delete(started.run.id)
    used = visitors.use(started.key)
    assert (used.steps, used.kept) == (50, ())


def test_a_visitor_keeps_at_most_four_runs(
    store: RunStore, clock: Clock, visitors: Visitors
) -> None:
    queue, key = stored(store), ""
    for _ in range(SMALL.kept):
        key = visitors.start(key, HOME, training(steps=10), queue).key
        clock.pass_time(hours=1)
    with pytest.raises(Busy, match=r"you keep 4 runs.*the oldest goes in 20 h"):
        visitors.start(key, HOME, training(steps=10), queue)
    store.delete(visitors.use(key).kept[0])
    visitors.start(key, HOME, training(steps=10), queue)


def test_dropping_the_cookie_gives_no_more_than_the_address_has(
    store: RunStore, clock: Clock, visitors: Visitors
) -> None:
    queue = stored(store)
    most = SMALL.steps_per_hour_of_address // 50
    for _ in range(most):
        visitors.start("", HOME, training(steps=50), queue)
    visitors.start("", HOME, training(steps=50), queue)
    with pytest.raises(Busy, match=r"300 steps within an hour, .* start this in 10 min"):
        visitors.start("", HOME, training(steps=50), queue)
    visitors.start("", SCHOOL, training(steps=50), queue)
    clock.pass_time(minutes=11)
    visitors.start("", HOME, training(steps=50), queue)


def test_what_is_refused_leaves_nothing_behind(
    store: RunStore, visitors: Visitors, jobs: Jobs
) -> None:
    with pytest.raises(InvalidInput, match="up to 60 steps"):
        start(visitors, jobs, training(steps=100_000))
    with pytest.raises(InvalidInput, match="there is no training"):
        start(visitors, jobs, TrainingStart(training().config, continue_from="nothing"))

    def full(what: Start) -> Run:
        what.runs(store, jobs.new_id)
        raise Busy(f"{MAX_OF_GUESTS} runs are waiting", 10)

    with pytest.raises(Busy):
        visitors.start("", HOME, training(), full)
    assert (visitors.count, VisitorRows(store.database).all(), store_count(store)) == (0, [], 0)


def test_nothing_is_started_from_a_hidden_run(store: RunStore, visitors: Visitors) -> None:
    first = visitors.start("", HOME, training(), stored(store)).run
    visitors.is_hidden = lambda run_id: run_id == first.id
    with pytest.raises(Forbidden, match="shown after the reveal"):
        visitors.start("", HOME, _Needing(first.id), stored(store))


class _Needing:
    """A start that rests on another run."""

    def __init__(self, run_id: str) -> None:
        self._run_id = run_id

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        (run,) = training().runs(store, new_id)
        return [Run(**{**vars(run), "continued_from": self._run_id})]


def test_two_starts_of_a_visitor_wait_or_go_on(
    store: RunStore, visitors: Visitors, jobs: Jobs
) -> None:
    first = start(visitors, jobs, training(steps=60, pace=0.5))
    second = start(visitors, jobs, training(), first.key)
    with pytest.raises(Busy, match="2 of your runs wait or go on"):
        start(visitors, jobs, training(), first.key)
    jobs.stop(second.run.id)
    third = start(visitors, jobs, training(), first.key)
    jobs.stop(first.run.id)
    wait_until_ended(store, third.run)


def test_an_address_that_drops_its_cookie_fills_no_more_places_than_a_class(
    store: RunStore, visitors: Visitors, jobs: Jobs
) -> None:
    blocker = jobs.start(endless())
    wait_for_progress(store, blocker)
    places = SMALL.unended_of_address
    for _ in range(places):
        start(visitors, jobs, training())
    with pytest.raises(Busy, match=f"{places} runs of visitors of your network"):
        start(visitors, jobs, training())
    start(visitors, jobs, training(), address=SCHOOL)
    jobs.stop(blocker.id)


def test_three_visitors_take_turns_after_the_operator(
    store: RunStore, visitors: Visitors, jobs: Jobs
) -> None:
    first = jobs.start(endless())
    wait_for_progress(store, first)
    a1 = start(visitors, jobs, training())
    a2 = start(visitors, jobs, training(), a1.key)
    b1 = start(visitors, jobs, training())
    b2 = start(visitors, jobs, training(), b1.key)
    c1 = start(visitors, jobs, training(), address=SCHOOL)
    of_operator = jobs.start(training())
    jobs.stop(first.id)
    started = [visitor_start.run for visitor_start in (a1, a2, b1, b2, c1)]
    ended = [wait_until_ended(store, run) for run in (*started, of_operator)]
    assert {run.state for run in ended} == {"finished"}
    order = [run.id for run in sorted(ended, key=lambda run: str(run.started_at))]
    expected = [of_operator, a1.run, c1.run, b1.run, a2.run, b2.run]
    assert order == [run.id for run in expected]
