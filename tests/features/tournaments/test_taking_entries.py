"""Tournaments of a server: what is kept over a restart, also by PostgreSQL, and who enters when."""

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from app.features.tournaments.judge import in_turn
from app.features.tournaments.tournament import EnteredTable, Entrant, Tournament
from app.features.tournaments.tournaments import MAX_OPEN, MAX_TABLES_BYTES, Tournaments
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, NotFound
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import to_json
from hexapods.domain.settings import SettingValues
from hexapods.tournaments.entry import REFERENCES, EntryConfig
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.rules import MAX_ENTRIES, TournamentRules, commitment_of
from hexapods.tournaments.tournament_file import sha256_of
from tests.postgresql import PostgresServer
from tests.storage.stores import BACKENDS, database_url, opened, temporary_store

RULES = TournamentRules(
    gait="left-right-origin", simulator="kinematic", steps=100, draws=5, tables=True
)
NOW = datetime(2026, 11, 25, tzinfo=UTC)
ONE, OTHER, OPERATOR = Entrant(0), Entrant(1), Entrant(None, "A guest")


@pytest.fixture(params=BACKENDS)
def store(
    request: pytest.FixtureRequest, postgresql: PostgresServer, tmp_path: Path
) -> Iterator[RunStore]:
    with database_url(request.param, postgresql) as url, opened(tmp_path, url) as store:
        yield store


@pytest.fixture
def quick() -> Iterator[RunStore]:
    with temporary_store() as store:
        yield store


def practised(alpha: float) -> EntryConfig:
    return EntryConfig(agent="q-learning", settings=SettingValues({"alpha": alpha}))


def opened_one(tournaments: Tournaments, per_hour: int = 6) -> Tournament:
    return tournaments.create(RULES, "Cup", "ABCDEF", per_hour)


def judged(tournaments: Tournaments, tournament: Tournament, number: int) -> None:
    for draw in range(RULES.draws):
        tournaments.keep(tournament, number, draw, Judgement(0.1 * draw))


def test_one_that_was_deleted_comes_back_as_it_was(store: RunStore) -> None:
    tournaments = Tournaments(store)
    first = opened_one(tournaments)
    second = opened_one(tournaments)
    tournaments.enter(first.id, ONE, practised(0.25))
    tournaments.keep(first, 3, 1, Judgement(0.5))
    assert tournaments.trash(first.id) is not None
    assert tournaments.all() == Tournaments(store).all() == [second]
    assert not tournaments.is_waiting(first.id, 3)
    # The judgement of a draw that was under way is dropped.
    tournaments.keep(first, 3, 2, Judgement(0.75))
    tournaments.rank(first, [])
    for again in (tournaments, Tournaments(store)):
        assert again.restore(first.id) == first
        assert again.all() == [first, second]
    # One that ends after the tournament is back is kept of that one.
    tournaments.keep(first, 3, 0, Judgement(0.25))
    assert tournaments.get(first.id).entries[3].judgements == {
        0: Judgement(0.25),
        1: Judgement(0.5),
    }
    assert Tournaments(store).get(first.id) == tournaments.get(first.id)
    assert tournaments.get(first.id).next_number == 4


def test_a_tournament_that_was_left_behind_is_deleted_for_good(store: RunStore) -> None:
    tournaments = Tournaments(store)
    left = tournaments.create(RULES, "", "AAAA", 6)
    tournaments.delete_left_behind(tournaments.now(), [])
    with pytest.raises(NotFound, match="can be restored for 1 h"):
        tournaments.restore(left.id)


def test_tournaments_are_restored_after_a_restart(store: RunStore) -> None:
    tournaments = Tournaments(store)
    tournament = opened_one(tournaments)
    data = b"\x00\xff" * 100
    table = EnteredTable("a training", sha256_of(data), data)
    tournaments.enter(tournament.id, ONE, practised(0.25))
    with_table = EntryConfig(agent="q-learning", table=table.sha256)
    tournaments.enter(tournament.id, OTHER, with_table, table)
    tournaments.enter(tournament.id, ONE, with_table, table)
    tournaments.enter(tournament.id, OPERATOR, EntryConfig(agent="greedy"))
    judged(tournaments, tournament, 0)
    tournaments.keep(tournament, 3, 1, Judgement(0.123456789012345678))
    tournaments.keep(tournament, 3, 0, Judgement(0.0, "The physics diverged."))
    after = Tournaments(store)
    assert after.get(tournament.id) == tournament
    assert after.get(tournament.id).draws == tournament.draws
    assert after.table(tournament, table.sha256) == tournaments.table(tournament, table.sha256)
    assert [entrant.name for _, entrant in sorted(by_number(tournament).items())][:3] == list(
        REFERENCES
    )
    after.end(tournament.id, withdraw_waiting=True)
    again = Tournaments(store).get(tournament.id)
    assert again.state == "ending"
    assert [entry.number for entry in again.waiting] == [1, 2]
    assert [entry.is_withdrawn for entry in again.listed] == [False] * 3 + [True] * 4
    Tournaments(store).delete(tournament.id)
    empty = Tournaments(store)
    assert empty.all() == []
    for table_name in ("entries", "judgements", "tables"):
        count = text(f"SELECT count(*) FROM tournament_{table_name}")
        assert store.database.read(lambda c, q=count: c.execute(q).scalar_one()) == 0  # type: ignore[misc]


def test_rules_that_were_stored_without_a_limit_of_transitions_have_that_of_then(
    store: RunStore,
) -> None:
    tournaments = Tournaments(store)
    tournament = opened_one(tournaments)
    rules = to_json(RULES)
    assert rules.pop("transitions") == 40_000
    statement = text("UPDATE tournaments SET rules = :rules")
    values = {"rules": json.dumps(rules)}
    store.database.write(lambda connection: connection.execute(statement, values))
    assert Tournaments(store).get(tournament.id) == tournament


def by_number(tournament: Tournament) -> dict[int, Entrant]:
    return {entry.number: entry.entrant for entry in tournament.listed}


def test_a_damaged_row_is_left_out(store: RunStore) -> None:
    tournaments = Tournaments(store)
    good, bad = opened_one(tournaments), opened_one(tournaments)
    tournaments.enter(good.id, ONE, practised(0.25))
    for damage, tournament in (
        ("""UPDATE tournaments SET rules = '{"gait": 5}' WHERE id = :id""", bad),
        (
            """UPDATE tournament_entries SET entry = '[]' WHERE tournament = :id AND number = 3""",
            good,
        ),
    ):
        statement, values = text(damage), {"id": tournament.id}
        store.database.write(lambda c, s=statement, v=values: c.execute(s, v))  # type: ignore[misc]
    left = Tournaments(store)
    assert [tournament_left.id for tournament_left in left.all()] == [good.id]
    assert len(left.get(good.id).entries) == 3
    # Its number is not given away again.
    assert left.enter(good.id, ONE, practised(0.5)).entry.number == 4
    with pytest.raises(NotFound):
        left.get(bad.id)


def test_equal_entries_of_an_entrant_are_one(quick: RunStore) -> None:
    tournaments = Tournaments(quick)
    tournament = opened_one(tournaments)
    first = tournaments.enter(tournament.id, ONE, EntryConfig(agent="q-learning"))
    assert first.is_new
    # The defaults, written out.
    same = EntryConfig(agent="q-learning", steps=RULES.steps, settings=first.entry.entry.settings)
    again = tournaments.enter(tournament.id, ONE, same)
    assert (again.entry, again.is_new) == (first.entry, False)
    assert tournaments.enter(tournament.id, OTHER, same).is_new
    assert tournaments.enter(tournament.id, OPERATOR, same).is_new
    assert tournaments.enter(tournament.id, ONE, EntryConfig(agent="q-learning", steps=99)).is_new


def test_entries_of_an_hour_are_counted_by_the_database(quick: RunStore) -> None:
    now = NOW
    tournaments = Tournaments(quick, now=lambda: now)
    tournament = opened_one(tournaments, per_hour=2)
    tournaments.enter(tournament.id, ONE, practised(0.1))
    now += timedelta(minutes=20)
    tournaments.enter(tournament.id, ONE, practised(0.2))
    with pytest.raises(Busy, match=r"2 entries of this hour.* 40 minutes") as refusal:
        tournaments.enter(tournament.id, ONE, practised(0.3))
    assert refusal.value.retry_after_s == 2400
    restarted = Tournaments(quick, now=lambda: now)
    with pytest.raises(Busy):
        restarted.enter(tournament.id, ONE, practised(0.3))
    assert not restarted.enter(tournament.id, ONE, practised(0.1)).is_new
    assert restarted.enter(tournament.id, OTHER, practised(0.3)).is_new
    for step in range(4):  # operators have no limit
        assert restarted.enter(tournament.id, OPERATOR, practised(0.1 * (step + 1))).is_new
    now += timedelta(minutes=40)
    assert restarted.enter(tournament.id, ONE, practised(0.3)).is_new
    assert restarted.get(tournament.id).left(ONE, now) == (0, NOW + timedelta(minutes=80))
    # A clock that is set back takes no entries from anybody.
    now -= timedelta(days=1)
    assert restarted.get(tournament.id).left(ONE, now) == (2, None)


def test_entries_over_a_limit_are_refused_with_the_limit(quick: RunStore) -> None:
    tournaments = Tournaments(quick)
    tournament = opened_one(tournaments)
    for message, entry in (
        ("steps must be from 1 to 100", EntryConfig(agent="q-learning", steps=101)),
        ("unknown agent 'nobody'", EntryConfig(agent="nobody")),
        (
            "setting of q-learning",
            EntryConfig(agent="q-learning", settings=SettingValues({"x": 1})),
        ),
    ):
        with pytest.raises(InvalidInput, match=message):
            tournaments.enter(tournament.id, ONE, entry)
    big = EnteredTable("a", "cd" * 32, b"0" * MAX_TABLES_BYTES)
    with pytest.raises(Conflict, match="MB, which is the most"):
        tournaments.enter(tournament.id, ONE, EntryConfig(agent="sarsa", table=big.sha256), big)
    for number in range(MAX_ENTRIES - len(REFERENCES)):
        entry = practised(0.5 * (number + 1) / MAX_ENTRIES)
        tournaments.enter(tournament.id, OPERATOR, entry)
    with pytest.raises(Conflict, match=f"has {MAX_ENTRIES} entries"):
        tournaments.enter(tournament.id, ONE, practised(0.9))
    for _ in range(MAX_OPEN - 1):
        opened_one(tournaments)
    with pytest.raises(Busy, match="which is the most; end one"):
        opened_one(tournaments)
    tournaments.delete(tournament.id)
    opened_one(tournaments)


def test_after_the_end_nothing_enters(quick: RunStore) -> None:
    tournaments = Tournaments(quick)
    tournament = opened_one(tournaments)
    tournaments.enter(tournament.id, ONE, practised(0.25))
    assert tournaments.end(tournament.id).state == "ending"
    assert tournaments.end(tournament.id).waiting
    with pytest.raises(Conflict, match="no more entries") as refusal:
        tournaments.enter(tournament.id, ONE, practised(0.5))
    assert refusal.value.state == "ending"
    tournaments.end(tournament.id, withdraw_waiting=True)
    tournaments.keep(tournament, 3, 0, Judgement(0.1))  # it is withdrawn
    assert tournament.entries[3].judgements == {}
    assert commitment_of(tournament.secret) == tournament.commitment


def test_those_with_the_fewest_judged_entries_are_next(quick: RunStore) -> None:
    tournaments = Tournaments(quick)
    tournament = opened_one(tournaments)
    first = [tournaments.enter(tournament.id, ONE, practised(0.1 * n)).entry for n in (1, 2, 3)]
    second = [tournaments.enter(tournament.id, OTHER, practised(0.1 * n)).entry for n in (1, 2)]

    def turns() -> list[int]:
        return [entry.number for entry in in_turn(tournament)]

    assert turns() == [0, 1, 2, 3, 4, 5, 6, 7]
    for number in range(3):
        judged(tournaments, tournament, number)
    judged(tournaments, tournament, first[0].number)
    assert turns() == [6, 7, 4, 5]
    judged(tournaments, tournament, second[0].number)
    assert turns() == [4, 5, 7]
    # What has begun is ended first.
    tournaments.keep(tournament, 7, 0, Judgement(0.1))
    assert turns() == [7, 4, 5]


def test_many_enter_at_once(quick: RunStore) -> None:
    tournaments = Tournaments(quick)
    tournament = opened_one(tournaments)

    def enter(seed: int) -> int:
        entries = [practised(0.1 * (n + 1)) for n in range(3)]
        numbers = [tournaments.enter(tournament.id, Entrant(seed), e).entry.number for e in entries]
        assert numbers == sorted(numbers)
        return len(numbers)

    with ThreadPoolExecutor(64) as pool:
        assert list(pool.map(enter, range(64))) == [3] * 64
    assert [entry.number for entry in tournament.listed] == list(range(3 + 64 * 3))
    assert Tournaments(quick).get(tournament.id) == tournament
    for number in range(3):
        judged(tournaments, tournament, number)
    order: list[int | None] = []
    while waiting := in_turn(tournament):
        order.append(waiting[0].entrant.seed)
        judged(tournaments, tournament, waiting[0].number)
    for turn in range(3):  # each has had one before any has a second one
        assert set(order[64 * turn : 64 * (turn + 1)]) == set(range(64))
