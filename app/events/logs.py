"""The log: one line a record on standard error, JSON for programs and key=value for people.

Its size is limited: see `log_limit`.
"""

import json
import logging
import sys
from datetime import UTC, datetime
from typing import Any, TextIO

from app.limits.log_limit import LimitedHandler
from app.storage.store import KINDS

_KNOWN = frozenset(vars(logging.makeLogRecord({}))) | {"message", "asctime", "taskName"}


def install(level: str, stream: TextIO | None = None) -> None:
    """Let every logger of the process write there, and nowhere else.

    Args:
        level: below which records are left out.
        stream: standard error if None.
    """
    stream = stream or sys.stderr
    handler = LimitedHandler(stream)
    handler.setFormatter(LineFormatter(as_json=not stream.isatty()))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
    # viser's, which speaks of an address that is for nobody.
    logging.getLogger("websockets").setLevel(logging.WARNING)


class LineFormatter(logging.Formatter):
    """A record as one line: time, level, logger and message, then what was given as `extra`.

    A record that is about a run, or comes from its job, has its id as `run_id`.
    """

    def __init__(self, as_json: bool) -> None:
        super().__init__()
        self._as_json = as_json

    def format(self, record: logging.LogRecord) -> str:
        """The line, whatever line breaks the message has."""
        said: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        run_id = _run_of(record)
        if run_id is not None:
            said["run_id"] = run_id
        said |= {name: value for name, value in vars(record).items() if name not in _KNOWN}
        if record.exc_info:
            said["traceback"] = self.formatException(record.exc_info)
        if self._as_json:
            return json.dumps(said, default=str)
        return " ".join(f"{name}={_quoted(value)}" for name, value in said.items())


def _run_of(record: logging.LogRecord) -> str | None:
    """The run that a job's process or thread works on: both are named by it."""
    for name in (record.processName, record.threadName):
        kind, _, run_id = (name or "").partition(" ")
        if kind in KINDS and run_id:
            return run_id
    return None


def _quoted(value: object) -> str:
    text = str(value)
    # Bare where nothing in it could be taken for more than one word, or be obeyed by a terminal.
    return (
        text
        if text.isascii() and text.isprintable() and not set(text) & set(' "=')
        else (json.dumps(text))
    )
