"""Reads the rows of every table but that of runs: row by row, where a damaged one is left out.

SQLite columns may hold values of any type, and other versions may have written the database. So no
row is decoded by the query: each is, column by column, by the types of the schema, and then as what
it stands for. One that cannot be is left out, and logged; `damaged_rows` returns all of them. Rows
that were deleted, and can still be restored, are left out, too.
"""

import json
import logging
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    Connection,
    Double,
    String,
    Table,
    and_,
    cast,
    delete,
    func,
    insert,
    not_,
    select,
    type_coerce,
)
from sqlalchemy.sql.elements import ColumnElement
from sqlalchemy.types import NullType

from app.storage.database.columns import (
    DELETED_AT,
    JsonWithNan,
    PortableText,
    TagList,
    UtcTime,
    decode_json,
    decode_tags,
    not_deleted,
)
from app.storage.database.engine import Database
from app.storage.database.queries import MAX_CELL_CHARS
from app.storage.database.rows import decode_time
from hexapods.domain.text import counted, visible

MAX_NAMED = 30
"""Damaged rows of a table that are named at once."""
_MAX_REASON, _MAX_KEY = 200, 80
_MAX_LOGGED = 10_000
_ROWS_AT_ONCE = 1_000
_logger = logging.getLogger(__name__)
Values = dict[str, Any]


class DamagedRow(NamedTuple):
    """A row that is left out, as it cannot be read.

    Attributes:
        table: its table.
        key: the columns of its primary key with their values, as text.
        damaged: what is wrong with it.
        values: what can be read of it, by column.
    """

    table: str
    key: str
    damaged: str
    values: Values

    def __str__(self) -> str:
        return f"{self.table} {self.key}: {self.damaged}"


class DecodedRows(NamedTuple):
    """Rows of a table, as far as they can be decoded.

    Attributes:
        sound: those that can be read, decoded.
        damaged: the others.
    """

    sound: list[Any]
    damaged: list[DamagedRow]


def read_rows(
    database: Database,
    table: Table,
    decode: Callable[..., Any],
    *order: ColumnElement[Any],
    where: ColumnElement[bool] | None = None,
) -> DecodedRows:
    """Return the rows of a table, and log those that are damaged, each of them once.

    Args:
        database: where the table is.
        table: the table.
        decode: returns what a row stands for; its arguments are the columns, without the time of
            its deletion. Whatever it raises, the row is damaged. `damaged_rows` uses it from then
            on.
        order: by what they are sorted.
        where: condition of those that are read; None for all.
    """
    database.decoders[table.name] = decode
    rows = database.read(lambda connection: rows_in(connection, table, decode, *order, where=where))
    unlogged = [reason for reason in map(str, rows.damaged) if reason not in database.logged_damage]
    if unlogged and len(database.logged_damage) < _MAX_LOGGED:
        database.logged_damage.update(unlogged)
        # A record of its own for each table, of which the log writes only so many alike.
        message = f"{counted(len(unlogged), 'damaged row')} of {table.name} left out: %s"
        _logger.warning(message, "; ".join(unlogged[:MAX_NAMED]))
    return rows


def damaged_rows(database: Database, table: Table) -> list[DamagedRow]:
    """Return the damaged rows of a table, also those that belong to nothing, or were deleted.

    What a row stands for is checked where this process has read the table before.
    """
    decode = database.decoders.get(table.name, Values)

    def work(connection: Connection) -> list[DamagedRow]:
        damaged = rows_in(connection, table, decode, keeps_sound=False, with_deleted=True).damaged
        for column in table.c:
            for reference in column.foreign_keys:
                parent = reference.column
                has_parent = select(parent).where(parent == column).exists()
                orphans = rows_in(connection, table, Values, where=not_(has_parent)).sound
                why = f"its {column.name} is none of {parent.table.name}"
                damaged += [DamagedRow(table.name, _key(table, row), why, row) for row in orphans]
        return damaged

    return database.read(work)


def rows_in(
    connection: Connection,
    table: Table,
    decode: Callable[..., Any],
    *order: ColumnElement[Any],
    where: ColumnElement[bool] | None = None,
    keeps_sound: bool = True,
    with_deleted: bool = False,
) -> DecodedRows:
    """Return the rows of a table within a transaction; arguments as of `read_rows`.

    Of tables that may have very many rows only the damaged ones can be kept. Rows that were deleted
    are among them where that is wanted.
    """
    query = select(*map(_undecoded, table.c)).order_by(*order)
    if not with_deleted:
        query = query.where(not_deleted(table))
    if where is not None:
        query = query.where(where)
    rows = DecodedRows([], [])
    for row in connection.execute(query.execution_options(yield_per=_ROWS_AT_ONCE)).mappings():
        values, reasons = _decoded_columns(table, row)
        values.pop(DELETED_AT, None)
        if not reasons:
            try:
                decoded = decode(**values)
            except Exception as error:  # what another version has written may raise anything
                reasons.append(_reason(error))
            else:
                rows.sound.extend([decoded] if keeps_sound else [])
                continue
        rows.damaged.append(DamagedRow(table.name, _key(table, row), "; ".join(reasons), values))
    return rows


def put_rows(connection: Connection, table: Table, rows: Sequence[Values]) -> None:
    """Insert rows within a transaction.

    Each in the place of one with the same primary key: after an outage it may have been committed
    with its reply lost, and one that is damaged is known to nobody.
    """
    for row in rows:
        is_same = [column == row[column.name] for column in table.primary_key]
        connection.execute(delete(table).where(and_(*is_same)))
    if rows:
        connection.execute(insert(table), list(rows))


def _decoded_columns(table: Table, row: Any) -> tuple[Values, list[str]]:
    """Return the columns of a row that can be decoded, and why others cannot."""
    values, reasons = Values(), list[str]()
    for column in table.c:
        try:
            values[column.name] = _decoded(column, row[column.name])
        except Exception as error:  # as in `rows_in`
            reasons.append(f"{column.name}: {_reason(error)}")
    return values, reasons


def _undecoded(column: Column[Any]) -> ColumnElement[Any]:
    """Return a column without type decoding, so that no damaged value fails the query."""
    if isinstance(column.type, JsonWithNan | UtcTime):
        text: ColumnElement[Any] = cast(column, String)
    elif isinstance(column.type, PortableText | TagList):
        text = type_coerce(column, String)
    else:
        return type_coerce(column, NullType()).label(column.name)
    return func.substr(text, 1, MAX_CELL_CHARS + 1).label(column.name)


def _decoded(column: Column[Any], value: Any) -> Any:
    """Return the value of an undecoded column.

    Raises:
        ValueError, TypeError, RecursionError: if it is none of the column's type.
    """
    if value is not None:
        return _DECODERS[type(column.type)](value)
    if column.nullable:
        return None
    raise ValueError("it is missing")


def _whole(value: Any) -> int:
    if not isinstance(value, int):
        raise ValueError("it is no whole number")
    return value


def _truth(value: Any) -> bool:
    if value not in (0, 1):
        raise ValueError("it is neither true nor false")
    return bool(value)


def _number(value: Any) -> float:
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError("it is no finite number")
    return float(value)


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError("it is no text")
    if len(value) > MAX_CELL_CHARS:
        raise ValueError("it is too long")
    value.encode()  # invalid UTF-8 is read as lone surrogates
    return value


_DECODERS: Mapping[type, Callable[[Any], Any]] = {
    BigInteger: _whole,
    Boolean: _truth,
    Double: _number,
    JsonWithNan: lambda value: decode_json(json.loads(_text(value))),
    PortableText: _text,
    TagList: lambda value: decode_tags(_text(value)),
    UtcTime: lambda value: decode_time("time", _text(value)),
}
"""By type of the schema; of a type without an entry no row could be read."""


def _key(table: Table, row: Any) -> str:
    """Return the primary key of a row, undecoded, as text."""
    names = [column.name for column in table.primary_key]
    return " ".join(f"{name} {visible(str(row[name])[:_MAX_KEY])}" for name in names)


def _reason(error: Exception) -> str:
    reason = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
    return visible(reason)[:_MAX_REASON]
