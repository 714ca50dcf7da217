"""Rows of a table as named tuples: inserted, and all read, where a damaged one is left out."""

import json
import logging
from collections.abc import Sequence
from typing import Any, TypeVar

from sqlalchemy import Column, Connection, String, Table, cast, insert, select
from sqlalchemy.sql.elements import ColumnElement

from app.storage.database.columns import JsonWithNan, UtcTime, decode_json
from app.storage.database.engine import Database
from app.storage.database.rows import decode_time

_logger = logging.getLogger(__name__)
RowT = TypeVar("RowT", bound=tuple[Any, ...])


def insert_rows(connection: Connection, table: Table, rows: Sequence[Any]) -> None:
    """Insert named tuples, whose fields are the columns, within a transaction."""
    if rows:
        connection.execute(insert(table), [row._asdict() for row in rows])


def all_rows(database: Database, table: Table, kind: type[RowT], *order: Column[Any]) -> list[RowT]:
    """Return all rows of a table that can be decoded; others are logged.

    Args:
        database: where the table is.
        table: the table.
        kind: named tuple whose fields are the columns.
        order: columns by which they are sorted.
    """
    query = select(*map(_undecoded, table.c)).order_by(*order)
    rows = database.read(lambda connection: connection.execute(query).mappings().all())
    found = []
    for row in rows:
        try:
            found.append(kind(**{one.name: _decoded(one, row[one.name]) for one in table.c}))
        except (ValueError, TypeError, RecursionError):
            _logger.warning("a row of %s cannot be read", table.name, exc_info=True)
    return found


def _undecoded(column: Column[Any]) -> ColumnElement[Any]:
    """Return a column without type decoding, so that no damaged value fails the query."""
    if isinstance(column.type, JsonWithNan | UtcTime):
        return cast(column, String).label(column.name)
    return column


def _decoded(column: Column[Any], value: Any) -> Any:
    """Return the value of an undecoded column.

    Raises:
        ValueError, TypeError, RecursionError: if it is none of the column's type.
    """
    if value is None and column.nullable:
        return None
    if isinstance(column.type, JsonWithNan):
        return decode_json(json.loads(value))
    if isinstance(column.type, UtcTime):
        return decode_time(column.name, value)
    if not isinstance(value, column.type.python_type):
        raise TypeError(f"{column.name} is no {column.type.python_type.__name__}")
    return value
