"""The judge: real processes that judge, are killed, take too long, or are not waited for."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import psutil
import pytest

from app.features.tournaments.judge import MAX_DEATHS, Judge, limit_s
from app.features.tournaments.tournament import Entrant, Tournament
from app.features.tournaments.tournaments import Tournaments
from app.storage.database.store import RunStore
from hexapods.system_processes import processor_s
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.judging import Judgement, judge
from hexapods.tournaments.rules import TournamentRules
from hexapods.tournaments.tournament_file import standings_of
from tests.quick_robot import HASTY
from tests.storage.stores import temporary_store
from tests.timeouts import ProgressTimeout

QUICK = TournamentRules(gait="left-right-origin", simulator="kinematic", steps=60, draws=5)
SLOW = TournamentRules(
    gait="left-right-origin", simulator="mujoco", robot=HASTY, steps=5_000, draws=5
)
"""Seconds for a draw of what learns, and less for those before it."""


@pytest.fixture
def store() -> Iterator[RunStore]:
    with temporary_store() as store:
        yield store


@contextmanager
def judging(tournaments: Tournaments, count: int = 1, **options: float) -> Iterator[Judge]:
    working = Judge(tournaments, count, 0, **options)
    working.start()
    try:
        yield working
    finally:
        working.close()


def until(is_so: Callable[[], bool], shown: Callable[[], object]) -> None:
    stall_check = ProgressTimeout()
    while not is_so():
        stall_check.check(shown())
        time.sleep(0.02)


def all_judged(tournament: Tournament) -> None:
    until(
        lambda: len(tournament.standings) == len(tournament.entries),
        lambda: tournament.progress.judged,
    )


def test_what_is_judged_is_what_the_library_judges(store: RunStore) -> None:
    tournaments = Tournaments(store)
    tournament = tournaments.create(QUICK, "", None, 6)
    tournaments.enter(tournament.id, Entrant(0), EntryConfig(agent="q-learning"))
    with judging(tournaments, 2):
        all_judged(tournament)
        tournaments.end(tournament.id)
        until(lambda: tournament.state == "ended", lambda: tournament.state)
    for entry in tournament.listed:
        expected = [judge(QUICK, entry.entry, draw) for draw in tournament.draws]
        assert list(entry.in_order()) == expected
    judged = {entry.number: entry.in_order() for entry in tournament.listed}
    assert list(tournament.standings) == standings_of(judged)
    assert {"standings", "versions", "machine", "robots"} == set(tournament.outcome)
    assert Tournaments(store).get(tournament.id) == tournament


def test_references_are_judged_as_soon_as_it_is_open(store: RunStore) -> None:
    tournaments = Tournaments(store)
    with judging(tournaments):
        time.sleep(0.2)  # it has nothing to do, and waits
        all_judged(tournaments.create(QUICK, "", None, 6))


def at_slow_draw(working: Judge, tournament: Tournament) -> int:
    """Wait until the linear model practises, and return the id of the process."""
    until(lambda: len(tournament.standings) == 2, lambda: tournament.progress)
    until(lambda: bool(working.pids), lambda: None)
    pid = working.pids[0]
    # The process may have ranked before.
    before_s = processor_s(pid)
    until(lambda: processor_s(pid) > before_s + 0.2, lambda: processor_s(pid))
    return pid


@pytest.mark.promises
def test_an_entry_that_ends_its_processes_has_failed(store: RunStore) -> None:
    tournaments = Tournaments(store)
    tournament = tournaments.create(SLOW, "", None, 6)
    judgements = tournament.entries[2].judgements
    with judging(tournaments) as working:
        for death in range(MAX_DEATHS):
            assert not judgements
            pid = at_slow_draw(working, tournament)
            os.kill(pid, signal.SIGKILL)
            until(lambda p=pid: p not in working.pids, lambda d=death: d)  # type: ignore[misc]
        until(lambda: bool(judgements), lambda: tournament.progress)
    assert judgements[0] == Judgement(0.0, f"{MAX_DEATHS} processes ended while they judged it.")


@pytest.mark.promises
def test_a_draw_that_takes_too_long_has_failed(store: RunStore) -> None:
    tournaments = Tournaments(store)
    tournament = tournaments.create(SLOW, "", None, 6)
    with judging(tournaments, limit_s=0.2):
        until(lambda: len(tournament.entries[2].judgements) == 5, lambda: tournament.progress)
    judged = tournament.entries[2].in_order()
    assert {judgement.failure for judgement in judged} == {"It took over 0.2 s of processor time."}
    assert {judgement.distance_m for judgement in judged} == {0.0}


def test_a_draw_has_more_time_where_searches_may_simulate_more() -> None:
    assert limit_s(SLOW, 120.0) == 120.0
    assert limit_s(replace(SLOW, transitions=5_000), 120.0) == 120.0
    assert limit_s(replace(SLOW, transitions=100_000), 120.0) == 300.0


@pytest.mark.promises
def test_judging_a_deleted_tournament_is_cancelled(store: RunStore) -> None:
    tournaments = Tournaments(store)
    tournament = tournaments.create(SLOW, "", None, 6)
    with judging(tournaments) as working:
        pid = at_slow_draw(working, tournament)
        tournaments.delete(tournament.id)
        until(lambda: not psutil.pid_exists(pid), lambda: pid)
        # It goes on with others.
        other = tournaments.create(QUICK, "", None, 6)
        tournaments.end(other.id)
        until(lambda: other.state == "ended", lambda: other.progress)
    assert Tournaments(store).all() == [other]


@pytest.mark.promises
def test_the_judge_stops_at_once_and_goes_on_later(store: RunStore) -> None:
    tournaments = Tournaments(store)
    tournament = tournaments.create(QUICK, "", None, 6)
    for seed in range(3):
        tournaments.enter(tournament.id, Entrant(seed), EntryConfig(agent="q-learning"))
    with judging(tournaments) as first:
        until(lambda: tournament.progress.judged > 4, lambda: tournament.progress)
        pids = first.pids
    assert not [pid for pid in pids if psutil.pid_exists(pid)]
    restarted = Tournaments(store)
    again = restarted.get(tournament.id)
    before = again.progress.judged
    assert before > 4
    with judging(restarted):
        all_judged(again)
    expected = {
        entry.number: tuple(judge(QUICK, entry.entry, draw) for draw in again.draws)
        for entry in again.listed
    }
    assert list(again.standings) == standings_of(expected)
