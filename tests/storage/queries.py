"""Count the statements that are sent to databases."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy import event
from sqlalchemy.engine import Engine


@contextmanager
def recorded_queries() -> Iterator[list[str]]:
    """Collect all statements of this process, `BEGIN` included, while the block lasts.

    Without those by which a store looks from time to time whether the database is still its own.
    """
    statements: list[str] = []

    def record(connection: Any, cursor: Any, statement: str, *rest: Any) -> None:
        del connection, cursor, rest
        if threading.current_thread().name != "ownership":
            statements.append(statement)

    event.listen(Engine, "before_cursor_execute", record)
    try:
        yield statements
    finally:
        event.remove(Engine, "before_cursor_execute", record)
