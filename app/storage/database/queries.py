"""Rows as plain dictionaries, and those of runs: undecoded, so that one that is damaged harms none.

What SQLite holds in a column need not be of the column's type, and a database is not only written
by this version. A value that cannot be decoded would otherwise fail the whole query.
"""

import hashlib
import re
from collections.abc import Sequence
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Connection,
    Executable,
    LargeBinary,
    Select,
    String,
    cast,
    func,
    select,
    type_coerce,
)

from app.storage.database.columns import JsonWithNan, PortableText, UtcTime
from app.storage.database.schema import RUNS
from app.storage.errors import NotFound

Row = dict[str, Any]

MAX_CELL = 4_000_000
"""Characters of a column of a run that are read: one that has more cannot be shown."""
_ADDRESS = re.compile(r"(?!damaged-)[0-9A-Za-z_-]{1,64}", re.ASCII)


def found(connection: Connection, statement: Executable) -> Sequence[Row]:
    """What a statement finds."""
    return [{**row} for row in connection.execute(statement).mappings()]


def _undecoded(column: ColumnElement[Any], name: str) -> ColumnElement[Any]:
    """A column as the database has it: JSON and times as text, text cut where it is too long."""
    if name == "id":
        return type_coerce(column, String).label(name)
    if isinstance(column.type, JsonWithNan | UtcTime):
        return func.substr(cast(column, String), 1, MAX_CELL + 1).label(name)
    if isinstance(column.type, PortableText):
        return func.substr(type_coerce(column, String), 1, MAX_CELL + 1).label(name)
    return column.label(name)


RAW_RUN = tuple(_undecoded(column, column.name) for column in RUNS.c)
"""The columns of a run, for SELECT and RETURNING; `rows.any_run_of` decodes them."""


def select_runs() -> Select[Any]:
    """The rows of runs, undecoded."""
    return select(*RAW_RUN)


def row_of_run(connection: Connection, run_id: str, and_hold: bool = False) -> Row:
    """The row of a run, which nobody else changes before the transaction ends if it is held.

    Raises:
        NotFound: if there is none.
    """
    wanted = select_runs().where(is_run(connection, run_id))
    rows = found(connection, wanted.with_for_update() if and_hold else wanted)
    if not rows:
        raise NotFound(f"there is no run {run_id!r} (any more)")
    return rows[0]


def shown_id(stored: object) -> str:
    """The id of a row as the world knows it: its own, or a digest if it is fit for no address."""
    if isinstance(stored, str) and _ADDRESS.fullmatch(stored):
        return stored
    return f"damaged-{hashlib.sha256(_bytes(stored)).hexdigest()[:16]}"


def is_run(connection: Connection, run_id: str) -> ColumnElement[bool]:
    """That a row is of the run with this shown id."""
    stored = _stored_id(connection, run_id)
    return RUNS.c.id == run_id if stored is None else cast(RUNS.c.id, LargeBinary) == stored


def is_before(connection: Connection, run_id: str) -> ColumnElement[bool]:
    """That a row sorts before that with this shown id."""
    stored = _stored_id(connection, run_id)
    return RUNS.c.id < run_id if stored is None else cast(RUNS.c.id, LargeBinary) < stored


def _stored_id(connection: Connection, run_id: str) -> bytes | None:
    """The id in the database, where the shown one is but its digest."""
    if not run_id.startswith("damaged-"):
        return None
    stored = connection.execute(select(type_coerce(RUNS.c.id, String))).scalars()
    return next((_bytes(one) for one in stored if shown_id(one) == run_id), None)


def _bytes(stored: object) -> bytes:
    if isinstance(stored, bytes):
        return stored
    return str(stored).encode("utf-8", "surrogateescape")
