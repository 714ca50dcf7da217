"""Check of `hexapods doctor` for a demo's visitors."""

import sqlite3
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

from app.features.demo.rows import VisitorRows, VisitorRun
from app.storage.database.opening import DATABASE_FILE
from tests.cli.examining import examined, failures, known_machine
from tests.storage.stores import opened

__all__ = ["known_machine"]


def test_runs_of_visitors_whose_rows_are_damaged_are_named(tmp_path: Path) -> None:
    with opened(tmp_path / "data", None) as store:
        row = VisitorRun("1m8agbvj657z5", 64 * "a", 100, True, datetime.now(UTC))
        VisitorRows(store.database).add([row])
    assert failures(examined(tmp_path)) == {}
    with closing(sqlite3.connect(tmp_path / "data" / DATABASE_FILE)) as database, database:
        database.execute("UPDATE visitor_runs SET created_at = 'yesterday', visitor = 'x'")
    said = failures(examined(tmp_path))["data"]
    assert said.startswith("1 row of visitor_runs cannot be read: ")
    assert "visitor_runs run_id 1m8agbvj657z5: created_at: " in said
    assert "the next start of a server deletes these runs in time" in said
