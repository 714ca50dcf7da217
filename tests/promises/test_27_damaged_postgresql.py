"""Promise 27 on PostgreSQL, which takes only values of a column's type, but any of these."""

import random
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import BigInteger, Boolean, Column, Double, text
from sqlalchemy.exc import IntegrityError
from starlette.testclient import TestClient

from app.events.damage import damaged_rows
from app.server import create_app
from app.settings import Settings
from app.storage.database.columns import JsonWithNan, PortableText, TagList, UtcTime
from app.storage.database.schema import ABOUT
from app.storage.database.store import RunStore
from tests.api.calls import ADDRESS
from tests.postgresql import PostgresServer
from tests.promises import full_folder
from tests.promises.full_folder import TOKEN
from tests.promises.length import at_length
from tests.promises.raw import every_route
from tests.storage.all_tables import ALL_TABLES
from tests.storage.stores import opened

TABLES = [table for table in ALL_TABLES.values() if table is not ABOUT]
_TEXTS = ["''", "'../x'", "E'a\\x1b[2Jb'", "repeat('x', 100000)"]
VALUES: dict[type, list[str]] = {
    PortableText: _TEXTS,
    TagList: _TEXTS,
    BigInteger: ["-1", "0", "9223372036854775807", "-9223372036854775808"],
    Boolean: ["true", "false"],
    Double: ["'NaN'", "'Infinity'", "'-Infinity'", "1e308"],
    UtcTime: ["'infinity'", "'-infinity'", "'4713-01-01 BC'"],
    JsonWithNan: ["'null'", "'3'", "'\"x\"'", "'[]'", "'{}'", '\'{"$float": "milk"}\''],
}
CERTAIN = {*VALUES[UtcTime], "'NaN'", "'Infinity'", "'-Infinity'", '\'{"$float": "milk"}\''}
"""No value that the server could have stored."""
SHIFTS = range(at_length(2, 3 * max(len(table.c) for table in TABLES)))


@contextmanager
def damaged(store: RunStore, column: Column[Any], value: str) -> Iterator[bool]:
    """Set a column of the first row of its table, until the context ends; whether it was taken."""
    table, name = column.table.name, column.name
    kind = column.type.compile(store.database.engine.dialect).partition(" COLLATE")[0]
    row = f"ctid = (SELECT min(ctid) FROM {table})"
    with store.database.engine.connect() as connection:
        query = text(f"SELECT {name}::text FROM {table} WHERE {row}")
        former = connection.execute(query).scalars().all()
        try:
            update = f"UPDATE {table} SET {name} = {value} WHERE {row} RETURNING ctid::text"
            where = connection.execute(text(update)).scalar()
            connection.commit()
        except IntegrityError:
            where = None
    if where is None:  # it is not taken, or the clean-up of a demo has deleted the row
        yield False
        return
    try:
        yield True
    finally:
        with store.database.engine.begin() as connection:
            update = f"UPDATE {table} SET {name} = CAST(:old AS {kind}) WHERE ctid = '{where}'"
            connection.execute(text(update), {"old": former[0]})


@pytest.mark.timeout(at_length(300, 7200))
def test_no_row_can_keep_the_server_from_starting(
    postgresql: PostgresServer, tmp_path: Path
) -> None:
    with postgresql.database() as url, opened(tmp_path, url) as store:
        full_folder.fill(store, 1)
        for shift in SHIFTS:
            check_start(store, random.Random(shift), shift, tmp_path)


def check_start(store: RunStore, draw: random.Random, shift: int, folder: Path) -> None:
    """Damage one column of each table, and start an app."""
    certain = []
    with ExitStack() as stack:
        for table in TABLES:
            column = list(table.c)[shift % len(table.c)]
            value = draw.choice(VALUES[type(column.type)] + ["NULL"] * bool(column.nullable))
            if stack.enter_context(damaged(store, column, value)) and value in CERTAIN:
                certain.append(table.name)
        app = create_app(Settings(data=folder, token=TOKEN, job_niceness=0), store)
        named = {table for table, rows in damaged_rows(store).items() if rows}
        assert named >= set(certain)
        with TestClient(app, base_url=ADDRESS) as client:
            for path in READS:
                answer = client.get(path, headers={"Authorization": f"Bearer {TOKEN}"})
                assert answer.status_code < 500, (path, answer.text)


READS = [
    route.path
    for route in every_route()
    if route.method == "GET" and "{" not in route.path and not route.path.endswith("/events")
]
