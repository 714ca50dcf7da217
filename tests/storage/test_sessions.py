"""Operators' sessions: persistence, expiry, binding to the token, and their maximum number."""

from datetime import UTC, datetime, timedelta

from app.storage.database.store import RunStore
from app.storage.sessions import MAX_SESSIONS, SESSION_S, Sessions

TOKEN, OTHER = "a-token-for-tests", "another-token-for-tests"


def test_sessions_survive_a_restart_but_not_a_new_token(store: RunStore) -> None:
    sessions = Sessions(store.sessions, TOKEN)
    first, second = sessions.open(), sessions.open()
    sessions.close(second)
    assert first != second
    again = Sessions(store.sessions, TOKEN)
    assert [again.is_open(session) for session in (first, second, "", "guess")] == [True] + 3 * [
        False
    ]
    stored = store.sessions.load()
    assert len(stored) == 1
    assert first not in str(stored)
    assert TOKEN not in str(stored)
    assert not Sessions(store.sessions, OTHER).is_open(first)
    assert store.sessions.load() == []
    assert not Sessions(store.sessions, TOKEN).is_open(first)


def test_sessions_expire_and_are_deleted(store: RunStore) -> None:
    now, rows = [datetime(2026, 1, 1, tzinfo=UTC)], store.sessions
    sessions = Sessions(rows, TOKEN, lambda: now[0])
    opened_one = sessions.open()
    now[0] += timedelta(seconds=SESSION_S - 1)
    assert sessions.is_open(opened_one)
    now[0] += timedelta(seconds=1)
    assert not sessions.is_open(opened_one)
    sessions.open()
    assert len(rows.load()) == 1
    now[0] += timedelta(days=365)
    Sessions(rows, TOKEN, lambda: now[0])
    assert rows.load() == []


def test_oldest_session_is_closed_beyond_the_maximum(store: RunStore) -> None:
    rows = store.sessions
    sessions = Sessions(rows, TOKEN)
    first = sessions.open()
    later_sessions = [sessions.open() for _ in range(MAX_SESSIONS)]
    assert not sessions.is_open(first)
    assert all(map(sessions.is_open, later_sessions))
    assert len(rows.load()) == MAX_SESSIONS
