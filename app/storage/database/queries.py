"""Queries that return rows as dictionaries, with the columns of runs undecoded.

SQLite columns may hold values of any type, and other versions may have written the database. A
value that cannot be decoded would fail the whole query, so `rows` decodes each run separately.
"""

import hashlib
import re
from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Connection,
    Executable,
    LargeBinary,
    Select,
    String,
    bindparam,
    cast,
    func,
    select,
    type_coerce,
)

from app.storage.database.columns import (
    JsonWithNan,
    PortableText,
    TagList,
    UtcTime,
    not_deleted,
)
from app.storage.database.schema import NON_FIELD_COLUMNS, RUNS
from app.storage.errors import NotFound

Row = dict[str, Any]

MAX_CELL_CHARS = 4_000_000
"""Maximum of characters read of a column of a run; a longer one counts as damaged."""
_DAMAGED = "damaged-"
"""Beginning of the public id of a row whose stored id is not URL-safe."""
_PUBLIC_ID = re.compile(rf"(?!{_DAMAGED})[0-9A-Za-z_-]{{1,64}}", re.ASCII)


def fetch_rows(
    connection: Connection, statement: Executable, parameters: Mapping[str, Any] | None = None
) -> Sequence[Row]:
    """Execute a statement with values of its parameters, and return its rows as dictionaries."""
    result = connection.execute(statement, parameters)
    names = tuple(result.keys())
    return [dict(zip(names, row, strict=True)) for row in result]


def _undecoded(column: ColumnElement[Any], name: str) -> ColumnElement[Any]:
    """Return a column without type decoding: JSON and times as text, truncated if too long."""
    if name == "id":
        return type_coerce(column, String).label(name)
    if isinstance(column.type, JsonWithNan | UtcTime):
        return func.substr(cast(column, String), 1, MAX_CELL_CHARS + 1).label(name)
    if isinstance(column.type, PortableText | TagList):
        return func.substr(type_coerce(column, String), 1, MAX_CELL_CHARS + 1).label(name)
    return column.label(name)


RAW_RUN = tuple(
    _undecoded(column, column.name) for column in RUNS.c if column not in set(NON_FIELD_COLUMNS)
)
"""Undecoded columns of a run, for SELECT and RETURNING; `rows.try_decode_run` decodes them."""


NOT_DELETED = not_deleted(RUNS)
"""Condition that a run was not deleted; one that was is in the table while it can be restored."""


def select_runs() -> Select[Any]:
    """Return a SELECT of the undecoded rows of runs, without those that were deleted."""
    return select(*RAW_RUN).where(NOT_DELETED)


_RUN = select_runs().where(RUNS.c.id == bindparam("run_id"))
"""One statement for all ids: its cache key is computed once, which takes longer than the query."""


def fetch_run_row(connection: Connection, run_id: str, for_update: bool = False) -> Row:
    """Return the undecoded row of a run.

    Args:
        connection: with an open transaction.
        run_id: public id of the run.
        for_update: lock the row until the transaction ends (SELECT … FOR UPDATE).

    Raises:
        NotFound: if there is no such run.
    """
    query, parameters = _RUN, {"run_id": run_id}
    if run_id.startswith(_DAMAGED):
        query, parameters = select_runs().where(has_public_id(connection, run_id)), {}
    query = query.with_for_update() if for_update else query
    rows = fetch_rows(connection, query, parameters)
    if not rows:
        raise NotFound(f"there is no run {run_id!r} (any more)")
    return rows[0]


def public_id(stored: object) -> str:
    """Return the id of a row as used outside of the database: a digest if it is not URL-safe."""
    if isinstance(stored, str) and _PUBLIC_ID.fullmatch(stored):
        return stored
    return f"{_DAMAGED}{hashlib.sha256(_bytes(stored)).hexdigest()[:16]}"


def has_public_id(connection: Connection, run_id: str) -> ColumnElement[bool]:
    """Return the condition that a row has this public id."""
    stored = _stored_id(connection, run_id)
    return RUNS.c.id == run_id if stored is None else cast(RUNS.c.id, LargeBinary) == stored


def sorts_before(connection: Connection, run_id: str) -> ColumnElement[bool]:
    """Return the condition that a row's id sorts before the one with this public id."""
    stored = _stored_id(connection, run_id)
    return RUNS.c.id < run_id if stored is None else cast(RUNS.c.id, LargeBinary) < stored


def sorts_after(connection: Connection, run_id: str) -> ColumnElement[bool]:
    """Return the condition that a row's id sorts after the one with this public id."""
    stored = _stored_id(connection, run_id)
    return RUNS.c.id > run_id if stored is None else cast(RUNS.c.id, LargeBinary) > stored


def _stored_id(connection: Connection, run_id: str) -> bytes | None:
    """Return the stored id whose digest is this public id; None if the id is not a digest."""
    if not run_id.startswith(_DAMAGED):
        return None
    stored = connection.execute(select(type_coerce(RUNS.c.id, String))).scalars()
    return next((_bytes(stored_id) for stored_id in stored if public_id(stored_id) == run_id), None)


def _bytes(stored: object) -> bytes:
    if isinstance(stored, bytes):
        return stored
    return str(stored).encode("utf-8", "surrogateescape")
