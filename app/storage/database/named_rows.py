"""Rows of a table as named tuples: inserted, and all read, where a damaged one is left out."""

import json
import logging
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

from sqlalchemy import Column, Connection, String, Table, cast, insert, select
from sqlalchemy.sql.elements import ColumnElement

from app.storage.database.columns import JsonWithNan, PortableText, UtcTime, decode_json
from app.storage.database.engine import Database
from app.storage.database.rows import decode_time

_logger = logging.getLogger(__name__)
RowT = TypeVar("RowT", bound=tuple[Any, ...])


def insert_rows(connection: Connection, table: Table, rows: Sequence[Any]) -> None:
    """Insert named tuples, whose fields are the columns, within a transaction."""
    if rows:
        connection.execute(insert(table), [row._asdict() for row in rows])


class ReadRow(NamedTuple):
    """A row as far as it can be decoded.

    Attributes:
        values: by column.
        damaged: why a column cannot be decoded, by column.
    """

    values: dict[str, Any]
    damaged: dict[str, str]


def read_rows(database: Database, table: Table, *order: Column[Any]) -> list[ReadRow]:
    """Return all rows of a table, each as far as it can be decoded; what cannot is logged.

    Args:
        database: where the table is.
        table: the table.
        order: columns by which they are sorted.
    """
    query = select(*map(_undecoded, table.c)).order_by(*order)
    rows = database.read(lambda connection: connection.execute(query).mappings().all())
    found = []
    for row in rows:
        read = ReadRow({}, {})
        for column in table.c:
            try:
                read.values[column.name] = _decoded(column, row[column.name])
            except (ValueError, TypeError, RecursionError) as error:
                read.damaged[column.name] = str(error)
        if read.damaged:
            _logger.warning("a row of %s cannot be read: %s", table.name, read.damaged)
        found.append(read)
    return found


def all_rows(database: Database, table: Table, kind: type[RowT], *order: Column[Any]) -> list[RowT]:
    """Return all rows of a table that can be decoded; others are logged.

    Args:
        database: where the table is.
        table: the table.
        kind: named tuple whose fields are the columns.
        order: columns by which they are sorted.
    """
    rows = read_rows(database, table, *order)
    return [kind(**one.values) for one in rows if not one.damaged]


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
    # A decorated type says that it is any object.
    kind = str if isinstance(column.type, PortableText) else column.type.python_type
    if not isinstance(value, kind):
        raise TypeError(f"{column.name} is no {kind.__name__}")
    return value
