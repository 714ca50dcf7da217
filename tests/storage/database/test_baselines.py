"""Distances of baselines: stored once for all jobs, and measured again where a row is damaged."""

from pathlib import Path

import pytest
from sqlalchemy import text

from app.storage.database import baselines
from tests.postgresql import PostgresServer
from tests.storage.stores import BACKENDS, database_url, opened


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_distance_is_kept_to_the_last_bit(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            store.baselines.add("a", 0.1 + 0.2)
            store.baselines.add("a", 7.0)
            store.baselines.add("b", -0.25)
        with opened(tmp_path, url) as store:
            assert store.baselines.get(["a", "c"]) == {"a": 0.1 + 0.2}
            assert store.baselines.get([]) == {}


def test_the_oldest_make_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(baselines, "MAX_ROWS", 3)
    with opened(tmp_path, None) as store:
        for number in range(6):
            store.baselines.add(f"{number}", float(number))
        assert store.baselines.get([f"{n}" for n in range(6)]) == {"3": 3.0, "4": 4.0, "5": 5.0}


@pytest.mark.parametrize("value", ["'far'", "NULL", "9e999", "x'ff'"])
def test_a_damaged_row_is_missing(value: str, tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        store.baselines.add("a", 1.0)
        change = text(f"UPDATE OR IGNORE baselines SET distance_m = {value}")
        store.database.write(lambda connection: connection.execute(change))
        assert store.baselines.get(["a"]) in ({}, {"a": 1.0} if value == "NULL" else {})
