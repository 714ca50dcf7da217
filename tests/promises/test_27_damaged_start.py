"""Promise 27: no stored row can keep the server from starting, break a list, or stop a class.

Tables and columns come from the schema, so that a new one is tested, too. Every column of every
table gets each of its worst values, in a row of its own; all of one value are in the folder of one
server. Here some values, chosen at random; all of them by `make soak`.
"""

import json
import random
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

import httpx2
import pytest
from sqlalchemy import Column, Table

from app.cli.data_checks import advice
from app.installed_features import load
from app.storage.database.engine import decode_leniently
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.schema import ABOUT
from tests.cli.running import in_process
from tests.promises import full_folder
from tests.promises.full_folder import TAUGHT, TOKEN
from tests.promises.length import at_length
from tests.promises.raw import every_route
from tests.promises.worst_values import BROKEN_TEXT, OF_RUNS, STORED, is_certain_damage
from tests.served import Served
from tests.storage.all_tables import ALL_TABLES
from tests.storage.stores import opened

TABLES = [table for table in ALL_TABLES.values() if table is not ABOUT]
"""All but that of which a database has one row; that one is damaged in a test of its own."""
MADE_SEPARATELY = {"rooms", "robots"}
"""Tables of which the folder has a row for each column; rows of others are copied."""
VALUES = [None, *STORED, BROKEN_TEXT]
NOT_HUGE = [value for value in VALUES if not isinstance(value, str) or len(value) < 1_000_000]
"""Values of which a folder may have one in each column."""
A_FEW = at_length(2, None)
STREAMS = ("/events", "/viewer")
OPERATOR = {"Authorization": f"Bearer {TOKEN}"}


def sample(cases: list[Any], count: int | None) -> list[Any]:
    return cases if count is None else random.Random(27).sample(cases, count)


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with rows in every table; only to be read."""
    folder = tmp_path_factory.mktemp("template")
    with opened(folder, None) as store:
        full_folder.fill(store, max(len(ALL_TABLES[name].c) for name in MADE_SEPARATELY))
    with closing(sqlite3.connect(folder / DATABASE_FILE)) as file:
        for table in ALL_TABLES:
            assert file.execute(f"SELECT count(*) FROM {table}").fetchone() != (0,), table
    return folder


@pytest.fixture
def data_folder(template: Path, tmp_path: Path) -> Path:
    """This test's copy of the data folder."""
    shutil.copytree(template, tmp_path, dirs_exist_ok=True)
    return tmp_path


class Damage(NamedTuple):
    """A column that was damaged.

    Attributes:
        column: of the schema.
        stored: what it has now, as SQLite has converted it.
        key: of its row: the columns of the primary key that were not damaged.
    """

    column: Column[Any]
    stored: Any
    key: dict[str, Any]


def damage(file: sqlite3.Connection, column: Column[Any], value: Any, rowid: int) -> Damage | None:
    """Set a column of a row to an adverse value; None where the database does not take it."""
    table = column.table
    new = "CAST(? AS TEXT)" if value == BROKEN_TEXT else "?"
    try:
        file.execute(f"UPDATE {table} SET {column.name} = {new} WHERE rowid = ?", (value, rowid))
    except sqlite3.IntegrityError:
        assert value is None or column.primary_key
        return None
    names = [
        column.name,
        *(key_column.name for key_column in table.primary_key if key_column is not column),
    ]
    query = f"SELECT {', '.join(names)} FROM {table} WHERE rowid = ?"
    stored, *key = file.execute(query, (rowid,)).fetchone()
    return Damage(column, stored, dict(zip(names[1:], key, strict=True)))


def rows_to_damage(file: sqlite3.Connection, table: Table) -> list[int]:
    """Return as many rows of a table as it has columns: some that nothing needs, or copies."""
    count = len(table.c)
    if table.name in MADE_SEPARATELY:
        rows = file.execute(f"SELECT rowid FROM {table} ORDER BY rowid LIMIT ?", (count,))
        return [rowid for (rowid,) in rows]
    (row,) = file.execute(f"SELECT * FROM {table} ORDER BY rowid LIMIT 1").fetchall()
    return [insert_copy(file, table, row, number) for number in range(count)]


def insert_copy(file: sqlite3.Connection, table: Table, row: Any, number: int) -> int:
    """Insert a copy of a row that differs in what must be unique."""
    values = list(row)
    for index, column in enumerate(table.c):
        if column.unique or (column.primary_key and not column.foreign_keys):
            is_text = isinstance(values[index], str)
            values[index] = fresh(values[index], number) if is_text else 1_000 + number
    marks = ", ".join("?" * len(values))
    rowid = file.execute(f"INSERT INTO {table} VALUES ({marks})", values).lastrowid
    assert rowid is not None
    return rowid


def fresh(text: str, number: int) -> str:
    """Return another text of the same form."""
    return f"{text[:-3]}d{number:02}"


def doctor(folder: Path) -> str:
    """Return what `hexapods doctor` says of the stored data."""
    done = in_process("doctor", "--data", str(folder), "--json", folder=folder, HEXAPODS_PORT="0")
    assert done.stderr == ""
    checks = {check["name"]: check for check in json.loads(done.stdout)["checks"]}
    said: str = checks["data"]["said"]
    assert "install" not in said
    return said


def check_named(damages: list[Damage], said: str) -> None:
    """Check that what is damage for certain is named, by its table and what is left of its key."""
    for damage in damages:
        if is_certain_damage(damage.column, damage.stored):
            assert is_named(damage, said), damage


def is_named(damage: Damage, said: str) -> bool:
    parts = [f"{damage.column.table.name} ", *(f"{name} {key}" for name, key in damage.key.items())]
    return any(all(word in row for word in parts) for row in said.split(";"))


def ids_of(folder: Path) -> dict[str, list[str]]:
    """Return by name of a path's parameter the ids that a client may ask for."""
    columns = {
        "run_id": ("runs", "id"),
        "robot_id:robot": ("robots", "id"),
        "lesson_id": ("lessons", "id"),
        "code": ("rooms", "code"),
        "tournament_id": ("tournaments", "id"),
    }
    with closing(sqlite3.connect(folder / DATABASE_FILE)) as file:
        file.text_factory = bytes
        rows = {
            name: file.execute(f"SELECT {column} FROM {table}").fetchall()
            for name, (table, column) in columns.items()
        }
    ids = {
        name: [
            identifier.decode()
            for (identifier,) in values
            if isinstance(identifier, bytes) and is_asked_for(identifier)
        ]
        for name, values in rows.items()
    }
    constants = {"name": "operations", "name:path": "summary.json", "level": "0", "number": "0"}
    return {**ids, **{name: [value] for name, value in constants.items()}}


def is_asked_for(stored: bytes) -> bool:
    return stored.isascii() and stored.isalnum() and len(stored) <= 64


def check_answers(server: Served, ids: dict[str, list[str]]) -> None:
    """Check that every route that reads answers, whatever exists is asked for."""
    for route in every_route():
        if route.method != "GET" or route.path.endswith(STREAMS) or route.path == "/viewer/":
            continue
        for path in filled(route.path, ids):
            answer = server.client.get(path, headers=OPERATOR)
            assert answer.status_code < 500, (path, answer.text)


def filled(path: str, ids: dict[str, list[str]]) -> Iterator[str]:
    """Yield a path with each of the ids in the place of its parameter, and one of the others."""
    if "{" not in path:
        yield path
        return
    before, _, rest = path.partition("{")
    name, _, after = rest.partition("}")
    assert ids[name], f"a path with nothing to ask for: {path}"
    for identifier in ids[name]:
        for end in filled(after, {key: values[:1] for key, values in ids.items()}):
            yield f"{before}{identifier}{end}"


def check_class_goes_on(server: Served) -> None:
    """Check that a participant can join the room that is open, and answer."""
    rooms = server.client.get("/api/v1/rooms", headers=OPERATOR).json()["items"]
    (code,) = [room["code"] for room in rooms if room["title"] == TAUGHT]
    with httpx2.Client(base_url=f"{server.address}/api/v1/rooms/{code}", trust_env=False) as pupil:
        joined = pupil.post("/participants")
        assert joined.status_code == 201, joined.text
        answered = pupil.post("/predictions", json={"card": 0, "value": 0.5})
        assert answered.status_code == 201, answered.text
        assert pupil.get("/results").status_code == 200


def damage_each_column(folder: Path, value: Any) -> list[Damage]:
    """Set every column of every table to a value, each in a row of its own."""
    damages: list[Damage | None] = []
    with closing(sqlite3.connect(folder / DATABASE_FILE, isolation_level=None)) as file:
        decode_leniently(file)
        for table in TABLES:
            rows = rows_to_damage(file, table)
            for column, rowid in zip(table.c, rows, strict=True):
                damages.append(damage(file, column, value, rowid))
    return [damaged for damaged in damages if damaged is not None]


def damaged_rows_of(server: Served) -> int:
    """Return how many damaged rows of all tables the metrics tell."""
    lines = server.client.get("/metrics", headers=OPERATOR).text.splitlines()
    counters = [line for line in lines if line.startswith("hexapods_rows_damaged{")]
    assert len(counters) == len(ALL_TABLES) - len(OF_RUNS) + 1  # runs are told
    return round(sum(float(line.split()[-1]) for line in counters))


@pytest.mark.timeout(at_length(300, 7200))
@pytest.mark.parametrize("value", sample(NOT_HUGE, A_FEW), ids=lambda value: repr(value)[:20])
def test_no_row_can_keep_the_server_from_starting(
    value: Any, data_folder: Path, launch: Callable[..., Served]
) -> None:
    ids = ids_of(data_folder)
    damages = damage_each_column(data_folder, value)
    assert {damaged.column.table for damaged in damages} >= set(TABLES if value is not None else ())
    said = doctor(data_folder)
    check_named(damages, said)
    log = data_folder / "log"
    with log.open("w") as file:
        server = launch(log=file, HEXAPODS_TOKEN=TOKEN)
        check_answers(server, ids)
        check_class_goes_on(server)
        assert bool(damaged_rows_of(server)) == ("cannot be read" in said)
    if " of rooms cannot be read" in said:
        assert " of rooms left out: rooms code" in log.read_text()


@pytest.mark.timeout(at_length(300, 7200))
@pytest.mark.parametrize("shift", sample(list(range(max(len(table.c) for table in TABLES))), A_FEW))
def test_no_row_that_others_need_can_keep_the_server_from_starting(
    shift: int, data_folder: Path, launch: Callable[..., Served]
) -> None:
    """One column of the first row of each table has one of the values, on which others rest."""
    draw = random.Random(shift)
    ids = ids_of(data_folder)
    damages: list[Damage | None] = []
    with closing(sqlite3.connect(data_folder / DATABASE_FILE, isolation_level=None)) as file:
        decode_leniently(file)
        for table in TABLES:
            newest = table.name in MADE_SEPARATELY  # the room that is open, with all it has
            (rowid,) = file.execute(f"SELECT {'max' if newest else 'min'}(rowid) FROM {table}")
            column = list(table.c)[shift % len(table.c)]
            damages.append(damage(file, column, draw.choice(VALUES), rowid[0]))
    check_named([damaged for damaged in damages if damaged is not None], doctor(data_folder))
    check_answers(launch(HEXAPODS_TOKEN=TOKEN), ids)


@pytest.mark.timeout(at_length(300, 7200))
@pytest.mark.parametrize(
    "value", sample(VALUES, 1 if A_FEW else None), ids=lambda value: repr(value)[:20]
)
def test_the_row_of_the_database_itself_can_be_damaged(
    value: Any, data_folder: Path, launch: Callable[..., Served]
) -> None:
    """The next start mends it, and finds the files of all runs again."""
    with closing(sqlite3.connect(data_folder / DATABASE_FILE, isolation_level=None)) as file:
        decode_leniently(file)
        damages = [damage(file, column, value, 1) for column in ABOUT.c]
    # Its key is damaged too, of which what cannot be printed is left out; it is the only row.
    check_named(
        [damaged._replace(key={}) for damaged in damages if damaged is not None],
        doctor(data_folder),
    )
    server = launch(HEXAPODS_TOKEN=TOKEN)
    path = f"/api/v1/races/{full_folder.RACE}/recording"
    assert server.client.get(path, headers=OPERATOR).status_code == 200
    assert server.end() == 0
    assert "about" not in doctor(data_folder)


MEANING: list[tuple[str, str, str]] = [
    ("tournaments", "outcome", "[]"),
    ("tournaments", "outcome", '{"standings": 3}'),
    ("tournaments", "secret", "milk"),
    ("tournament_entries", "number", "9223372036854775807"),
    ("tournament_judgements", "draw", "1000000"),
    ("tournament_tables", "data", "milk"),
    ("room_runs", "given", "[]"),
    ("room_runs", "answer", '{"chosen": {"iqm_m": "far"}}'),
    ("participants", "seed", "9223372036854775807"),
    ("participants", "name", "a\x1b[2Jb"),
    ("predictions", "value", '{"a": 1}'),
    ("rooms", "revealed", '["a", 1]'),
    ("rooms", "code", "../x"),
    ("lessons", "document", '{"title": 5}'),
    ("robots", "guesses", '[{"a": 1}]'),
    ("robots", "id", "../x"),
    ("visitor_runs", "visitor", "milk"),
]
"""Values of their column's type that stand for nothing."""


def test_what_a_row_cannot_stand_for_is_damage_too(
    data_folder: Path, launch: Callable[..., Served]
) -> None:
    ids = ids_of(data_folder)
    damages: list[Damage | None] = []
    with closing(sqlite3.connect(data_folder / DATABASE_FILE, isolation_level=None)) as file:
        for table in ALL_TABLES.values():
            cases = [case for case in MEANING if case[0] == table.name]
            rows = rows_to_damage(file, table) if cases else []
            for (_, column, value), rowid in zip(cases, rows, strict=False):
                damages.append(damage(file, table.c[column], value, rowid))
    said = doctor(data_folder)
    for damaged in damages:
        assert damaged is not None
        assert is_named(damaged, said), damaged
    server = launch(HEXAPODS_TOKEN=TOKEN)
    check_answers(server, ids)
    check_class_goes_on(server)


def test_every_table_has_an_advice() -> None:
    assert advice(load().classes).keys() == ALL_TABLES.keys()
