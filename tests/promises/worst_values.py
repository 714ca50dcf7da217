"""Adverse values for columns of the database, and for fields of imported files."""

import json
import math
from collections.abc import Callable, Iterator
from datetime import datetime
from typing import Any

from sqlalchemy import BigInteger, Boolean, Column, Double

from app.storage.database.columns import JsonWithNan, PortableText, TagList, UtcTime
from app.storage.database.schema import RUNS
from tests.storage.all_tables import ALL_TABLES

_DEEP = "[" * 50_000 + "]" * 50_000
STORED: list[Any] = [
    "",
    "milk",
    "NaN",
    "null",
    "{}",
    "[]",
    "[null]",
    '{"a": NaN}',
    '{"distance_m": Infinity, "lanes": [], "claims": [], "files": []}',
    '{"lanes": [{"agent": 3}]}',
    '{"$float": "milk"}',
    '[{"step": 1e999}]',
    '{"gait": "left-right-origin", "robot": {"preset": "stiff"}, "wings": 2}',
    _DEEP,
    "9" * 5_000,
    "x" * 5_000_000,
    "../../../etc/passwd",
    "a/b?c#d",
    "\x00\x1b[2J\u202e\ud7ff",
    "2026-01-01",
    "9999-12-31T23:59:59-12:00",
    "0000-00-00 00:00:00",
    b"\x00\xff\xfe",
    -1,
    0,
    2**63 - 1,
    -(2**63),
    float("inf"),
    1e308,
]
"""For any column of SQLite, which is dynamically typed; by `CAST` also text that is not UTF-8, see
`BROKEN_TEXT`."""
OF_RUNS = [
    table
    for table in ALL_TABLES.values()
    if table is RUNS or any(key.references(RUNS) for key in table.foreign_keys)
]
"""Tables that have a run, and what goes with it."""
BROKEN_TEXT = b"\xff\xc3\x28"
IMPORTED: list[Any] = [
    None,
    True,
    "",
    "milk",
    "x" * 20_000,
    "=1+1",
    "a\u202eb",
    "a\u200bb",
    "a\x00b",
    [],
    [None],
    {},
    {"": {}},
    -1,
    -0.5,
    10**30,
    2**63,
    1e308,
    "9999-12-31T23:59:59-12:00",
    "0001-01-01T00:00:00+14:00",
    float("nan"),
    float("-inf"),
]
"""For any field of a JSON document."""


def paths_to_values(shown: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of every value in a JSON document; of lists the first two entries."""
    if path:
        yield path
    if isinstance(shown, dict):
        for name, value in shown.items():
            yield from paths_to_values(value, (*path, name))
    if isinstance(shown, list):
        for number, value in enumerate(shown[:2]):
            yield from paths_to_values(value, (*path, number))


def put_value(shown: Any, path: tuple[Any, ...], value: Any) -> None:
    """Set the value at a path."""
    for key in path[:-1]:
        shown = shown[key]
    shown[path[-1]] = value


def is_certain_damage(column: Column[Any], stored: Any) -> bool:
    """Whether a value is none of a column's type, whatever the column means.

    Args:
        column: of the schema.
        stored: the value as SQLite has it, which may have converted it; invalid UTF-8 escaped.
    """
    if stored is None:
        return not column.nullable
    return not _IS_OF_TYPE[type(column.type)](stored)


def _is_text(stored: Any) -> bool:
    return isinstance(stored, str) and stored == stored.encode("utf-8", "replace").decode()


def _is_time(stored: Any) -> bool:
    try:
        return 1970 <= datetime.fromisoformat(stored).year < 9999
    except (ValueError, TypeError):
        return False


def _is_json(stored: Any) -> bool:
    try:
        json.loads(stored if isinstance(stored, str | bytes) else repr(stored))
    except (ValueError, RecursionError):
        return False
    return True


_IS_OF_TYPE: dict[type, Callable[[Any], bool]] = {
    PortableText: _is_text,
    TagList: _is_text,
    BigInteger: lambda stored: isinstance(stored, int),
    Boolean: lambda stored: stored in (0, 1),
    Double: lambda stored: isinstance(stored, float) and math.isfinite(stored),
    UtcTime: _is_time,
    JsonWithNan: _is_json,
}
