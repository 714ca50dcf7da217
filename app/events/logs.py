"""Logging set-up: one line per record on standard error, as JSON or, on a terminal, key=value.

The rate of records and bytes is limited by `app.limits.log_limit`.
"""

import json
import logging
import sys
from datetime import UTC, datetime
from typing import Any, TextIO

from app.limits.log_limit import LimitedHandler
from app.storage.run_kind import run_kinds

_STANDARD_ATTRIBUTES = frozenset(vars(logging.makeLogRecord({}))) | {
    "message",
    "asctime",
    "taskName",
}


def install(level: str, stream: TextIO | None = None) -> None:
    """Install the only handler of the root logger.

    Args:
        level: minimum level of records.
        stream: where to write; standard error if None.
    """
    stream = stream or sys.stderr
    handler = LimitedHandler(stream)
    handler.setFormatter(LineFormatter(as_json=not stream.isatty()))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)


class LineFormatter(logging.Formatter):
    """Formats a record as one line: time, level, logger, message, then the fields of `extra`.

    Records about a run, or from the process or thread of its job, have its id as `run_id`.
    """

    def __init__(self, as_json: bool) -> None:
        super().__init__()
        self._as_json = as_json

    def format(self, record: logging.LogRecord) -> str:
        """Return the record as one line, with line breaks in it escaped."""
        fields: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        run_id = _run_id_of(record)
        if run_id is not None:
            fields["run_id"] = run_id
        fields |= {
            name: value for name, value in vars(record).items() if name not in _STANDARD_ATTRIBUTES
        }
        if record.exc_info:
            fields["traceback"] = self.formatException(record.exc_info)
        if self._as_json:
            return json.dumps(fields, default=str)
        return " ".join(f"{name}={_quoted(value)}" for name, value in fields.items())


def _run_id_of(record: logging.LogRecord) -> str | None:
    """Return the run id in the name of a job's process or thread, which is `<kind> <run id>`."""
    for name in (record.processName, record.threadName):
        kind, _, run_id = (name or "").partition(" ")
        if kind in run_kinds() and run_id:
            return run_id
    return None


def _quoted(value: object) -> str:
    text = str(value)
    # Unquoted only without spaces, quotes, `=` and terminal control characters.
    return (
        text
        if text.isascii() and text.isprintable() and not set(text) & set(' "=')
        else (json.dumps(text))
    )
