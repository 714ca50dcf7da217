"""Clean-up: after a day nothing of a visitor is left, whatever the server did meanwhile."""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import pytest

from app.feature import DeleteRuns
from app.features.classroom.room_rows import RoomRows
from app.features.classroom.rooms import Rooms
from app.features.demo.expiry import Cleaner, Expiry
from app.features.demo.rows import UNREADABLE, VisitorRows
from app.features.demo.visitors import Visitors
from app.features.tournaments.tournament import Entrant
from app.features.tournaments.tournaments import Tournaments
from app.jobs.jobs import Jobs
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.run import IdempotencyKey
from hexapods.tournaments.entry import EntryConfig
from tests.features.demo.clock import Clock
from tests.features.demo.test_visitors import start
from tests.jobs.test_jobs import WALK, endless, training
from tests.jobs.waiting import wait_for_progress, wait_until, wait_until_ended
from tests.tournaments.sample_tournaments import rules_of


@pytest.fixture
def expiry(store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock) -> Expiry:
    return make_expiry(store, jobs, visitors, clock)


def make_expiry(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, rooms: Rooms | None = None
) -> Expiry:
    contests = Tournaments(store, now=clock.time)
    cleaners: list[Cleaner] = [] if rooms is None else [rooms, OfRooms(contests, rooms)]
    return Expiry(store, jobs, visitors, cleaners, now=clock.time, now_s=clock.seconds)


class OfRooms(NamedTuple):
    """The tournaments of rooms, as their feature deletes them."""

    tournaments: Tournaments
    rooms: Rooms

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> list[str]:
        self.tournaments.delete_left_behind(time, self.rooms.codes())
        return []


def race_of(training: TrainingStart) -> RaceStart:
    lanes = [LaneStart("q-learning", training=training), LaneStart("greedy")]
    return RaceStart(WALK, lanes, 5, 0)


def files_in(folder: Path) -> list[Path]:
    return [path for path in (folder / "artifacts").rglob("*") if path.is_file()]


def is_kept(store: RunStore, run_id: str) -> bool:
    try:
        store.get(run_id)
    except NotFound:
        return False
    return True


def test_a_day_later_no_row_and_no_file_is_left(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, tmp_path: Path
) -> None:
    expiry = make_expiry(store, jobs, visitors, clock)
    before = files_in(tmp_path)
    started = start(visitors, jobs, race_of(training()))
    race = wait_until_ended(store, started.run)
    (training_id,) = filter(None, race.lane_training_ids)
    assert len(files_in(tmp_path)) > len(before)
    clock.pass_time(hours=23, minutes=59)
    expiry.sweep()
    assert is_kept(store, race.id)
    clock.pass_time(minutes=1)
    expiry.sweep()
    assert not is_kept(store, race.id)
    assert not is_kept(store, training_id)
    assert files_in(tmp_path) == before
    assert VisitorRows(store.database).all() == []
    assert not visitors.is_known(started.key)


def test_a_server_that_was_down_deletes_when_it_starts(
    store: RunStore, jobs: Jobs, clock: Clock, make_visitors: Callable[[], Visitors]
) -> None:
    run = wait_until_ended(store, start(make_visitors(), jobs, training()).run)
    clock.pass_time(days=3)
    later = make_visitors()
    assert later.count == 1
    make_expiry(store, jobs, later, clock).sweep()
    assert not is_kept(store, run.id)
    assert VisitorRows(store.database).all() == []


class Restarted(NamedTuple):
    """Store, jobs and visitors of a server that has started again."""

    visitors: Visitors
    expiry: Expiry
    clock: Clock

    def sweep_after(self, **time: float) -> None:
        """Advance the clock, and clean up."""
        self.clock.pass_time(**time)
        self.expiry.sweep()


@pytest.fixture
def after(
    tmp_path: Path, store: RunStore, jobs: Jobs, clock: Clock, make_visitors: Callable[[], Visitors]
) -> Callable[[str], Restarted]:
    """Returns what a server finds that starts after a change of the database."""

    def changed(statement: str) -> Restarted:
        with closing(sqlite3.connect(tmp_path / DATABASE_FILE)) as database, database:
            assert database.execute(statement).rowcount
        later = make_visitors()
        return Restarted(later, make_expiry(store, jobs, later, clock), clock)

    return changed


DAMAGE = {
    "time": "UPDATE visitor_runs SET created_at = 'yesterday'",
    "time without a day": "UPDATE visitor_runs SET created_at = '2026'",
    "future": "UPDATE visitor_runs SET created_at = '9001-01-01 00:00:00'",
    "steps": "UPDATE visitor_runs SET steps = 'many'",
    "part": "UPDATE visitor_runs SET is_main = 'perhaps'",
    "visitor": "UPDATE visitor_runs SET visitor = CAST(x'ff' AS TEXT)",
    "all": "UPDATE visitor_runs SET visitor = 5, steps = 'x', is_main = 'x', created_at = 'x'",
    "run": "UPDATE runs SET config = 'x', state = 'x', created_at = 'x'",
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_no_damage_lets_a_run_outlive_its_day(
    damage: str,
    store: RunStore,
    visitors: Visitors,
    jobs: Jobs,
    after: Callable[[str], Restarted],
) -> None:
    run = wait_until_ended(store, start(visitors, jobs, race_of(training())).run)
    run_of_operator = wait_until_ended(store, jobs.start(training()))
    later = after(DAMAGE[damage])
    later.sweep_after(days=1)
    with pytest.raises(NotFound):
        store.find(run.id)
    assert store.find(run_of_operator.id).id == run_of_operator.id
    assert sum(store.counts().values()) == 1
    assert later.visitors.count == 0
    assert VisitorRows(store.database).all() == []


@pytest.mark.parametrize("run_id", ["CAST(x'ff' AS TEXT)", "x'00ff'", "'not an id'", "''"])
def test_a_row_with_no_id_of_a_run_keeps_no_other_run(
    run_id: str,
    store: RunStore,
    visitors: Visitors,
    jobs: Jobs,
    after: Callable[[str], Restarted],
) -> None:
    run = wait_until_ended(store, start(visitors, jobs, training()).run)
    columns = "visitor, steps, is_main, created_at"
    later = after(
        f"INSERT INTO visitor_runs (run_id, {columns}) SELECT {run_id}, {columns} FROM visitor_runs"
    )
    later.sweep_after(days=1)
    assert not is_kept(store, run.id)
    assert later.visitors.count == 0


def test_who_made_a_run_is_known_though_another_part_of_its_row_is_damaged(
    store: RunStore,
    visitors: Visitors,
    jobs: Jobs,
    after: Callable[[str], Restarted],
) -> None:
    started = start(visitors, jobs, training())
    run = wait_until_ended(store, started.run)
    later = after(DAMAGE["steps"])
    assert later.visitors.owns(started.key, run.id)
    later.sweep_after(hours=23)
    assert is_kept(store, run.id)


def test_a_run_of_a_visitor_who_cannot_be_read_is_shown_to_operators_who_can_end_it(
    store: RunStore,
    visitors: Visitors,
    jobs: Jobs,
    after: Callable[[str], Restarted],
) -> None:
    run = wait_until_ended(store, start(visitors, jobs, training()).run)
    later = after(DAMAGE["visitor"])
    assert list(later.visitors.by_visitor()) == [UNREADABLE]
    later.expiry.end_visitor(UNREADABLE)
    assert not is_kept(store, run.id)


def test_a_clock_that_is_set_back_deletes_nothing_early(
    store: RunStore, jobs: Jobs, clock: Clock, make_visitors: Callable[[], Visitors]
) -> None:
    clock.pass_time(hours=23)
    run = wait_until_ended(store, start(make_visitors(), jobs, training()).run)
    clock.pass_time(hours=-23)
    make_expiry(store, jobs, make_visitors(), clock).sweep()
    assert is_kept(store, run.id)


def test_what_still_runs_or_waits_is_stopped_and_deleted(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, expiry: Expiry
) -> None:
    blocker = jobs.start(endless())
    wait_for_progress(store, blocker)
    waiting = start(visitors, jobs, race_of(training())).run
    clock.pass_time(days=1)
    expiry.sweep()
    assert not is_kept(store, waiting.id)
    assert store.counts() == {"running": 1}
    jobs.stop(blocker.id)


def test_a_run_that_takes_too_long_is_stopped_and_says_so(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, expiry: Expiry
) -> None:
    run = start(visitors, jobs, training(steps=60, pace=0.1)).run
    wait_for_progress(store, run)
    jobs.annotate(run.id, {"notes": "slow"})
    expiry.sweep()
    clock.pass_time(seconds=299)
    expiry.sweep()
    assert store.get(run.id).state == "running"
    clock.pass_time(seconds=1)
    expiry.sweep()
    stopped = store.get(run.id)
    assert stopped.state == "stopped"
    assert stopped.notes == "slow\nStopped after 300 s, for which a run of this demo may compute."


def test_an_operators_run_that_rests_on_a_visitors_stays_whole(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, expiry: Expiry
) -> None:
    visitors_run = wait_until_ended(store, start(visitors, jobs, training()).run)
    lanes = [LaneStart("q-learning", training_id=visitors_run.id), LaneStart("greedy")]
    race = wait_until_ended(store, jobs.start(RaceStart(WALK, lanes, 5, 0)))
    continued = TrainingStart(training().config, continue_from=visitors_run.id)
    longer = wait_until_ended(store, jobs.start(continued))
    clock.pass_time(days=1)
    expiry.sweep()
    assert not is_kept(store, visitors_run.id)
    assert store.get(race.id).result is not None
    assert store.artifact_files(race.id)
    assert store.get(longer.id).state == "finished"
    again = wait_until_ended(
        store, jobs.start(TrainingStart(training().config, continue_from=longer.id))
    )
    assert again.state == "finished"


def test_an_operators_run_that_waits_for_a_visitors_keeps_it_until_it_has_started(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, expiry: Expiry
) -> None:
    visitors_run = wait_until_ended(store, start(visitors, jobs, training()).run)
    blocker = jobs.start(endless())
    wait_for_progress(store, blocker)
    lanes = [LaneStart("q-learning", training_id=visitors_run.id), LaneStart("greedy")]
    race = jobs.start(RaceStart(WALK, lanes, 5, 0))
    clock.pass_time(days=1)
    expiry.sweep()
    assert is_kept(store, visitors_run.id)
    assert visitors.count == 1
    jobs.stop(blocker.id)
    assert wait_until_ended(store, race).state == "finished"
    expiry.sweep()
    assert not is_kept(store, visitors_run.id)
    assert visitors.count == 0


def test_a_failed_deletion_is_tried_again(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock, expiry: Expiry
) -> None:
    run = start(visitors, jobs, training(steps=60, pace=0.5)).run
    wait_for_progress(store, run)
    clock.pass_time(days=1)
    expiry.sweep()
    wait_until(lambda: expiry.sweep() == [] and not is_kept(store, run.id))
    assert visitors.count == 0


def test_keys_of_requests_go_too(store: RunStore, jobs: Jobs, expiry: Expiry) -> None:
    run = jobs.start(training(), IdempotencyKey("one", "x"))
    wait_until_ended(store, run)
    expiry.sweep()
    assert store.keys.find("one") is not None


def test_a_visitor_is_ended_by_the_operator(
    store: RunStore, jobs: Jobs, visitors: Visitors, expiry: Expiry
) -> None:
    started = start(visitors, jobs, race_of(training(steps=40, pace=0.5)))
    other = start(visitors, jobs, training())
    (visitor_id,) = (visitor for visitor, runs in visitors.by_visitor().items() if len(runs) == 2)
    expiry.end_visitor(visitor_id)
    assert not visitors.is_known(started.key)
    assert visitors.is_known(other.key)
    wait_until_ended(store, other.run)
    assert store.counts() == {"finished": 1}
    with pytest.raises(NotFound, match="GET /api/v1/visitors"):
        expiry.end_visitor(visitor_id)


def test_a_tournament_goes_a_day_after_it_was_opened_in_a_room_that_is_gone(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock
) -> None:
    rooms, contests = Rooms(store, now=clock.time), Tournaments(store, now=clock.time)
    code = rooms.create(None).code
    rules = rules_of(steps=20)
    of_room, of_operator = contests.create(rules, "", code, 6), contests.create(rules, "", None, 6)
    contests.enter(of_room.id, Entrant(0), EntryConfig(agent="q-learning"))
    expiry = make_expiry(store, jobs, visitors, clock, rooms)
    rooms.end(code)
    rooms.delete(code)
    clock.pass_time(hours=20)
    expiry.sweep()
    assert len(Tournaments(store).all()) == 2
    clock.pass_time(hours=5)
    make_expiry(store, jobs, visitors, clock).sweep()
    assert len(Tournaments(store).all()) == 2, "a server that is no demo keeps it"
    expiry.sweep()
    assert [contest.id for contest in Tournaments(store).all()] == [of_operator.id]


def test_a_room_that_nobody_has_used_for_a_day_goes_with_its_runs(
    store: RunStore, jobs: Jobs, visitors: Visitors, clock: Clock
) -> None:
    rooms = Rooms(store, now=clock.time)
    expiry = make_expiry(store, jobs, visitors, clock, rooms)
    ended, used = rooms.create(None), rooms.create(None)
    rooms.join(ended.code)
    rooms.end(ended.code)
    clock.pass_time(hours=20)
    key = rooms.join(used.code).key
    clock.pass_time(hours=5)
    assert expiry.sweep() == [[ended.code], []]
    assert [room.code for room in Rooms(store).all()] == [used.code]
    assert rooms.seat(used.code, key) is not None
    assert datetime.now(UTC) < clock.now
    clock.pass_time(hours=20)
    assert expiry.sweep() == [[used.code], []]
    assert (
        Rooms(store).all(),
        RoomRows(store.database).participants(),
        RoomRows(store.database).runs(),
    ) == ([], [], [])
