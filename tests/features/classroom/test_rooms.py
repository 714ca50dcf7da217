"""Rooms: what is kept over a restart, also by PostgreSQL, and when an idle one is ended."""

import struct
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import Connection, TextClause, text

from app.api.answers import ComparisonView, SeedsView
from app.features.classroom.lesson import read_lesson
from app.features.classroom.room_registry import IDLE, MAX_OPEN
from app.features.classroom.room_rows import RoomRows, RoomRun, Seat
from app.features.classroom.rooms import Rooms
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, Forbidden, NotFound
from tests.postgresql import PostgresServer
from tests.storage.stores import BACKENDS, database_url, opened, training

LESSON = read_lesson(
    {
        "title": "x",
        "cards": [
            {"text": "a", "ask": {"kind": "number", "text": ""}},
            {"text": "b", "ask": {"kind": "curve", "text": ""}},
        ],
    }
)
_SEEDS = SeedsView(settings={}, steps_per_episode=50, distances_m=[0.25], walkers=1.0, iqm_m=0.25)
COMPARISON = ComparisonView(seeds=1, greedy_m=0.5, chosen=_SEEDS, default=_SEEDS, compute_s=0.0)


@pytest.fixture(params=BACKENDS)
def store(
    request: pytest.FixtureRequest, postgresql: PostgresServer, tmp_path: Path
) -> Iterator[RunStore]:
    with database_url(request.param, postgresql) as url, opened(tmp_path, url) as store:
        yield store


def test_rooms_are_restored_after_a_restart(store: RunStore) -> None:
    rooms = Rooms(store)
    code = rooms.create(LESSON, needs_approval=True).code
    first, second = rooms.join(code), rooms.join(code)
    rooms.predict(code, 0, 0, 0.25)
    rooms.show_card(code, 1)
    rooms.predict(code, 1, 1, [[0, 0], [1, 0.5]])
    rooms.reveal(code, 1)
    rooms.freeze(code, True)
    rooms.change_participant(code, 1, is_name_hidden=True, is_approved=True)
    rooms.leave(code, 0)
    before, after = rooms.get(code), Rooms(store).get(code)
    assert after == before
    assert after.predictions == {(0, 0): 0.25, (1, 1): [[0.0, 0.0], [1.0, 0.5]]}
    again = Rooms(store)
    assert again.seat(code, first.key) is None
    seat = again.seat(code, second.key)
    assert seat is not None
    assert (seat.name, seat.seed) == (second.participant.name, 1)
    again.end(code)
    with pytest.raises(Conflict, match="has ended"):
        Rooms(store).join(code)


def test_nothing_is_left_of_a_deleted_room(store: RunStore) -> None:
    rooms = Rooms(store)
    code, other = (rooms.create(LESSON).code for _ in range(2))
    joined = rooms.join(code)
    rooms.join(other)
    rooms.predict(code, 0, 0, 0.5)
    with pytest.raises(Conflict, match="end it first"):
        rooms.delete(code)
    rooms.end(code)
    rooms.delete(code)
    assert rooms.seat(code, joined.key) is None
    for rooms_now in (rooms, Rooms(store)):
        assert [room.code for room in rooms_now.all()] == [other]
        with pytest.raises(NotFound):
            rooms_now.get(code)
    assert RoomRows(store.database).predictions() == []
    assert [participant.room for participant in RoomRows(store.database).participants()] == [other]


def test_the_newest_of_many_what_ifs_is_the_same_after_a_restart(store: RunStore) -> None:
    rooms = Rooms(store)
    card = {"text": "c", "state": {"form": {"steps": 20}}, "go": "what-if"}
    code = rooms.create(read_lesson({"title": "x", "cards": [card]})).code
    rooms.join(code)
    for number in range(12):
        rooms.ask(code, 0, {"alpha": number / 100}, lambda: COMPARISON, card=0)
    assert [what_if.given["alpha"] for what_if in Rooms(store).get(code).runs_of(0, 0)] == [
        what_if.given["alpha"] for what_if in rooms.get(code).runs_of(0, 0)
    ]


def test_what_ifs_are_there_after_a_restart(store: RunStore) -> None:
    card = {"text": "c", "state": {"form": {"steps": 20}}, "go": "what-if"}
    rooms = Rooms(store)
    code = rooms.create(read_lesson({"title": "x", "cards": [card, {"text": "d"}]})).code
    rooms.join(code)
    calls: list[str] = []

    def compute() -> ComparisonView:
        calls.append("once")
        # The teacher goes on meanwhile; what was asked is kept.
        rooms.show_card(code, 1)
        return COMPARISON

    assert rooms.ask(code, 0, {"alpha": 0.5}, compute, card=0) == COMPARISON
    after = Rooms(store)
    assert after.get(code) == rooms.get(code)
    (stored,) = after.get(code).runs_of(0, 0)
    assert (stored.answer, stored.given, stored.is_shown) == (COMPARISON, {"alpha": 0.5}, False)
    with pytest.raises(Forbidden, match="is at card 1"):
        after.ask(code, 0, {}, compute, card=0)
    after.show_card(code, 0)
    assert after.ask(code, 0, {"alpha": 0.5}, compute, card=0) == COMPARISON
    assert len(calls) == 1
    after.reveal(code, 0)
    assert Rooms(store).get(code).runs_of(0, 0)[0].is_shown


def test_a_run_that_a_kill_left_unstored_is_nobodys(store: RunStore) -> None:
    """It is linked to its participant before it is stored."""
    rooms = Rooms(store)
    code = rooms.create(LESSON).code
    rooms.join(code)
    linked = RoomRun(
        run_id="0never1stored2",
        room=code,
        seed=0,
        card=0,
        given={},
        is_main=True,
        is_shown=False,
        created_at=datetime.now(UTC),
    )
    RoomRows(store.database).add_runs([linked])
    assert Rooms(store).get(code).runs == {}
    store.create(training(linked.run_id))
    assert list(Rooms(store).get(code).runs) == [linked.run_id]


def test_a_damaged_row_is_left_out(store: RunStore) -> None:
    rooms = Rooms(store)
    good, bad = (rooms.create(LESSON).code for _ in range(2))
    rooms.join(bad)
    damage = text("""UPDATE rooms SET lesson = '{"title": 5}' WHERE code = :code""")
    store.database.write(lambda connection: connection.execute(damage, {"code": bad}))
    left = Rooms(store)
    assert [room.code for room in left.all()] == [good]
    with pytest.raises(NotFound):
        left.get(bad)


def test_what_a_damaged_row_has_is_not_given_away_again(store: RunStore) -> None:
    """Nor is a run shown to all of which it is not known to whom it is shown."""
    rooms = Rooms(store)
    code = rooms.create(LESSON).code
    rooms.join(code)
    rooms.join(code)
    rooms.predict(code, 0, 0, 0.25)
    run = RoomRun("0a1run", code, 0, 0, {}, True, False, datetime.now(UTC))
    store.create(training(run.run_id))
    RoomRows(store.database).add_runs([run])
    for damage in (
        "UPDATE participants SET name = '\u200b' WHERE seed = 1",
        "UPDATE predictions SET value = '[]'",
        "UPDATE room_runs SET given = '[]'",
    ):
        store.database.write(lambda connection, damage=damage: connection.execute(text(damage)))  # type: ignore[misc]
    left = Rooms(store)
    assert list(left.get(code).participants) == [0]
    assert left.join(code).participant.seed == 2
    left.predict(code, 0, 0, 0.5)
    assert Rooms(store).get(code).predictions == {(0, 0): 0.5}
    assert left.is_hidden(run.run_id, [(code, 0)])


def test_an_idle_room_makes_place_for_another(store: RunStore) -> None:
    now = datetime(2026, 11, 25, tzinfo=UTC)
    rooms = Rooms(store, now=lambda: now)
    codes = [rooms.create(LESSON).code for _ in range(MAX_OPEN)]
    with pytest.raises(Busy, match="which is the most"):
        rooms.create(LESSON)
    now += IDLE - timedelta(minutes=1)
    rooms.join(codes[0])
    now += timedelta(minutes=2)
    assert [room.code for room in rooms.idle_rooms()] == codes[1:]


def test_answers_and_cards_keep_a_room_from_being_idle(store: RunStore) -> None:
    now = datetime(2026, 11, 25, tzinfo=UTC)
    rooms = Rooms(store, now=lambda: now)
    codes = [rooms.create(LESSON).code for _ in range(6)]
    for code in codes[:2]:
        rooms.join(code)
    now += IDLE - timedelta(minutes=1)
    rooms.predict(codes[0], 0, 0, 0.5)
    rooms.show_card(codes[2], 1)
    rooms.freeze(codes[3], True)
    rooms.leave(codes[1], 0)
    now += timedelta(minutes=2)
    assert [room.code for room in rooms.idle_rooms()] == codes[4:]
    assert set(rooms.last_used_before(now - IDLE)) == set(codes[4:])
    # What was shown is not stored with its time, so that a restart counts as use.
    again = Rooms(store, now=lambda: now)
    assert again.idle_rooms() == []
    assert codes[0] not in again.last_used_before(now - IDLE)
    now += IDLE + timedelta(minutes=1)
    assert len(again.idle_rooms()) == 6


def _execute(change: TextClause, values: dict[str, str], connection: Connection) -> object:
    return connection.execute(change, values)


def test_nothing_is_left_of_a_removed_participant_but_hidden_runs(store: RunStore) -> None:
    rooms = Rooms(store)
    code = rooms.create(LESSON).code
    first, second = rooms.join(code), rooms.join(code)
    rooms.predict(code, 0, 0, 0.25)
    rooms.predict(code, 1, 0, 0.5)
    linked = RoomRun("0run1of2other", code, 1, 0, {}, True, False, datetime.now(UTC))
    store.create(training(linked.run_id))
    RoomRows(store.database).add_runs([linked])
    rooms = Rooms(store)
    taken: list[Seat] = []
    rooms.on_seat_taken = taken.append
    assert rooms.remove_participant(code, 1) == [linked.run_id]
    assert taken == [(code, 1)]
    for after in (rooms, Rooms(store)):
        room = after.get(code)
        assert list(room.participants) == [0]
        assert (room.predictions, room.runs, room.next_seed) == ({(0, 0): 0.25}, {}, 2)
        assert (after.seat(code, first.key), after.seat(code, second.key)) == (
            room.participants[0],
            None,
        )
        assert after.is_hidden(linked.run_id, [(code, 0)])
        assert after.runs_in(code) == [linked.run_id]
        with pytest.raises(Forbidden, match="join it again"):
            after.predict(code, 1, 0, 1.0)
    assert rooms.join(code, second.key).participant.seed == 2
    with pytest.raises(NotFound):
        rooms.remove_participant(code, 1)


def test_who_joins_and_leaves_all_day_uses_up_nothing(store: RunStore) -> None:
    """Neither names, of which there are 2500, nor rows of the database."""
    rooms = Rooms(store)
    code = rooms.create(LESSON).code
    for _ in range(5):
        seed = rooms.join(code).participant.seed
        rooms.leave(code, seed)
    assert RoomRows(store.database).participants() == []
    assert rooms.get(code).participants == {}
    assert seed == 4


def test_nothing_of_a_deleted_room_is_left_in_the_file(tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        rooms = Rooms(store)
        code = rooms.create(LESSON).code
        name = rooms.join(code).participant.name
        rooms.predict(code, 0, 0, 0.123456789)
        # A number alone is stored as eight bytes.
        traces = [code.encode(), name.encode(), struct.pack(">d", 0.123456789)]
        before = _bytes_below(tmp_path)
        rooms.end(code)
        rooms.delete(code)
    after = _bytes_below(tmp_path)
    assert [trace in before for trace in traces] == [True, True, True]
    assert [trace in after for trace in traces] == [False, False, False]


def _bytes_below(folder: Path) -> bytes:
    return b"".join(file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file())
