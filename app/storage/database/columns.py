"""Column types with identical semantics in SQLite and PostgreSQL."""

import math
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import JSON, Column, ColumnElement, DateTime, Dialect, String, Table, true
from sqlalchemy.types import TypeDecorator

from hexapods.domain.text import storable

_NON_FINITE = "$float"
DELETED_AT = "deleted_at"
"""Name of the column of `deletion_time`."""


class PortableText(TypeDecorator[str]):
    """Text column; NUL and lone surrogates, which databases reject, are replaced by U+FFFD.

    Sorts by code point on both databases, so that run ids sort by time of creation.
    """

    impl = String
    cache_ok = True

    def load_dialect_impl(self, dialect: Dialect) -> Any:
        """Use collation "C" on PostgreSQL, whose default sorts by the rules of a language."""
        collation = "C" if dialect.name == "postgresql" else None
        return dialect.type_descriptor(String(collation=collation))

    def process_bind_param(self, value: str | None, dialect: Dialect) -> str | None:
        """Replace NUL and lone surrogates before a value is stored."""
        return None if value is None else storable(value)


class TagList(TypeDecorator[tuple[str, ...]]):
    """Column of tags: each on a line of its own, between line feeds, which no tag contains.

    So that a tag is found by a substring, on every database and whatever else a row contains.
    """

    impl = PortableText
    cache_ok = True

    def process_bind_param(self, value: Any, dialect: Dialect) -> str:
        """Encode tags before they are stored."""
        return "".join(f"\n{tag}\n" for tag in value)

    def process_result_value(self, value: str | None, dialect: Dialect) -> tuple[str, ...]:
        """Decode stored tags."""
        return decode_tags(value or "")


def decode_tags(text: str) -> tuple[str, ...]:
    """Decode tags that `TagList` encoded."""
    return tuple(filter(None, text.split("\n")))


class UtcTime(TypeDecorator[datetime]):
    """Time column: aware `datetime` in Python, UTC in the database."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Convert an aware time to UTC; raise `ValueError` for a naive one."""
        if value is not None and value.tzinfo is None:
            raise ValueError(f"{value} has no time zone")
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Return a stored time in UTC; SQLite drops the time zone."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class JsonWithNan(TypeDecorator[Any]):
    """JSON column that preserves NaN and infinities, stored as objects `{"$float": …}`."""

    impl = JSON(none_as_null=True)
    cache_ok = True

    def process_bind_param(self, value: Any, dialect: Dialect) -> Any:
        """Encode plain types before they are stored."""
        return _encode_json(value)

    def process_result_value(self, value: Any, dialect: Dialect) -> Any:
        """Decode stored plain types."""
        return decode_json(value)


def _encode_json(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return {_NON_FINITE: repr(value)}
    if isinstance(value, dict):
        return {key: _encode_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_encode_json(item) for item in value]
    return value


def decode_json(value: Any) -> Any:
    """Decode plain types that `JsonWithNan` encoded: restore NaN and infinities."""
    if isinstance(value, dict):
        if value.keys() == {_NON_FINITE}:
            return float(value[_NON_FINITE])
        return {key: decode_json(item) for key, item in value.items()}
    if isinstance(value, list):
        return [decode_json(item) for item in value]
    return value


def deletion_time() -> Column[datetime]:
    """Return the column with the time of a row's deletion, while the row can still be restored."""
    return Column(DELETED_AT, UtcTime)


def not_deleted(table: Table) -> ColumnElement[bool]:
    """Return the condition that a row was not deleted; of a table without deletion times true."""
    return table.c[DELETED_AT].is_(None) if DELETED_AT in table.c else true()
