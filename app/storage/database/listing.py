"""Pages of runs: filters, sort orders, and cursors (keyset pagination).

Sort keys are compared in the database only, as types that any stored value can be converted to, so
that no damaged row fails or repeats a page.
"""

import base64
import binascii
import json
from collections.abc import Mapping, Sequence
from types import NoneType
from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, Connection, Double, String, and_, cast, func, or_, select
from sqlalchemy import type_coerce as coerced

from app.storage.database.queries import (
    Row,
    fetch_rows,
    public_id,
    select_runs,
    sorts_after,
    sorts_before,
)
from app.storage.database.schema import RUNS
from app.storage.run import Kind, Sort, State
from app.storage.run_kind import run_kinds
from hexapods.domain.errors import InvalidInput
from hexapods.domain.text import MAX_NAME

_NO_DISTANCE = -1.7e308
_KEY = "sort_key"


class Listing(NamedTuple):
    """Query of a list of runs: filters, sort order and page.

    Attributes:
        kind: only runs of this kind; None for all. Runs of unreadable kind are of every one.
        state: only runs in this state; None for all.
        limit: items per page.
        cursor: `Page.next_cursor` of the page before; None for the first page.
        search: only runs with this text in their name, id, tags or notes. In this, in tags and
            in the order of names the letters A to Z match in upper and lower case.
        tag: only runs with this tag; None for all.
        sort: `newest` or `oldest` first, by `name` from A to Z, or by `distance`, longest first.
        condition: only runs that meet it; None for all.
    """

    kind: Kind | None
    state: State | None
    limit: int
    cursor: str | None
    search: str | None
    tag: str | None
    sort: Sort
    condition: ColumnElement[bool] | None = None


class RowPage(NamedTuple):
    """Undecoded rows of a page, and the cursor of the next one; None on the last page."""

    rows: Sequence[Row]
    next_cursor: str | None


def fetch_page(connection: Connection, listing: Listing) -> RowPage:
    """Return a page of undecoded rows of runs.

    Raises:
        InvalidInput: if the cursor is not one of a list in this order.
    """
    query = select_runs().where(*_filters(connection, listing)).limit(listing.limit + 1)
    key = _sort_key(connection, listing.sort)
    if key is not None:
        query = query.add_columns(key.label(_KEY))
        query = query.order_by(key.asc() if listing.sort == "name" else key.desc())
    is_oldest_first = listing.sort == "oldest"
    query = query.order_by(RUNS.c.id.asc() if is_oldest_first else RUNS.c.id.desc())
    if listing.cursor is not None:
        query = query.where(_is_after_cursor(connection, listing.sort, key, listing.cursor))
    rows_and_next = fetch_rows(connection, query)
    rows = [{k: v for k, v in row.items() if k != _KEY} for row in rows_and_next[: listing.limit]]
    if len(rows_and_next) <= listing.limit:
        return RowPage(rows, None)
    last = rows_and_next[listing.limit - 1]
    return RowPage(rows, _encode_cursor(listing.sort, last.get(_KEY), public_id(last["id"])))


def _filters(connection: Connection, listing: Listing) -> list[ColumnElement[bool]]:
    conditions = []
    if listing.kind is not None:
        conditions.append(_is_of_kind(connection, listing.kind))
    if listing.condition is not None:
        conditions.append(listing.condition)
    if listing.state is not None:
        conditions.append(RUNS.c.state == listing.state)
    if listing.tag is not None:
        conditions.append(_contains(RUNS.c.tags, f"\n{listing.tag}\n"))
    if listing.search:
        columns = (RUNS.c.name, RUNS.c.id, RUNS.c.tags, RUNS.c.notes)
        conditions.append(or_(*(_contains(column, listing.search) for column in columns)))
    return conditions


def _contains(column: ColumnElement[Any], text: str) -> ColumnElement[bool]:
    return coerced(column, String).icontains(text, autoescape=True)


def _is_of_kind(connection: Connection, kind: Kind) -> ColumnElement[bool]:
    """Return the condition that a run is of this kind, or of an unknown (damaged) kind.

    The second part is added only if there are such runs, because it prevents the use of an index.
    """
    is_unknown = RUNS.c.kind.not_in(run_kinds())
    unknown = connection.execute(select(RUNS.c.id).where(is_unknown)).scalars().all()
    return or_(RUNS.c.kind == kind, is_unknown) if unknown else RUNS.c.kind == kind


def _sort_key(connection: Connection, sort: Sort) -> ColumnElement[Any] | None:
    """Return the expression that rows are sorted by before their id; None to sort by id only."""
    if sort == "distance":
        return func.coalesce(cast(RUNS.c.distance_m, Double), _NO_DISTANCE)
    if sort == "name":
        name = func.substr(func.lower(coerced(RUNS.c.name, String)), 1, MAX_NAME)
        # SQLite may hold bytes that are not UTF-8; in hexadecimal they sort the same.
        return name if connection.dialect.name == "postgresql" else func.hex(name)
    return None


def _is_after_cursor(
    connection: Connection, sort: Sort, key: ColumnElement[Any] | None, cursor: str
) -> ColumnElement[bool]:
    value, run_id = _decode_cursor(cursor, sort)
    if key is None:
        after = sorts_after if sort == "oldest" else sorts_before
        return after(connection, run_id)
    is_beyond = key > value if sort == "name" else key < value
    return or_(is_beyond, and_(key == value, sorts_before(connection, run_id)))


def cursor_before(run_id: str) -> str:
    """Return the cursor of the runs that are older than one of this id, newest first."""
    return _encode_cursor("newest", None, run_id)


def _encode_cursor(sort: Sort, key: object, run_id: str) -> str:
    return base64.urlsafe_b64encode(json.dumps([sort, key, run_id]).encode()).decode()


_KEY_TYPES: Mapping[Sort, type] = {
    "newest": NoneType,
    "oldest": NoneType,
    "name": str,
    "distance": float,
}


def _decode_cursor(cursor: str, sort: Sort) -> tuple[Any, str]:
    """Return the sort key and the id of the last run of the page before.

    Raises:
        InvalidInput: if the cursor is not one of a list in this order.
    """
    try:
        order, value, run_id = json.loads(base64.urlsafe_b64decode(cursor.encode("ascii")))
        is_of_order = order == sort and isinstance(value, _KEY_TYPES[sort])
        if not is_of_order or not isinstance(run_id, str) or not run_id:
            raise ValueError
        # No database takes NUL, or what is not UTF-8.
        if b"\0" in f"{value}{run_id}".encode():
            raise ValueError
    except (ValueError, TypeError, binascii.Error, RecursionError) as error:
        raise InvalidInput(
            "cursor must be the next_cursor of the page before, of a list in the same order",
            field="cursor",
        ) from error
    return value, run_id
