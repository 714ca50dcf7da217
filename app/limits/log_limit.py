"""Log rate limit: suppress and count repeated records, and bound bytes with a token bucket."""

import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import TextIO

REPEATS, WINDOW_S = 10, 60.0
"""Records of one kind written per window [s]; further ones are only counted."""
BURST_BYTES, BYTES_PER_S = 400_000, 500.0
"""Capacity and refill rate of the token bucket of bytes."""
_MAX_KINDS = 1000
_Kind = tuple[str, int, str, object]


@dataclass
class _Window:
    ends_s: float
    written: int = 0
    suppressed: int = 0


class LimitedHandler(logging.StreamHandler[TextIO]):
    """Stream handler that limits repeated records and bytes.

    Records are of one kind if logger, level, run and the first line of their message template are
    the same. A kind's suppressed records are reported in one summary record, at the first record
    of any kind after its window has ended.
    """

    def __init__(self, stream: TextIO, now: Callable[[], float] = time.monotonic) -> None:
        """Create a handler with a full bucket.

        Args:
            stream: to write to.
            now: monotonic clock [s].
        """
        super().__init__(stream)
        self._now = now
        self._windows: OrderedDict[_Kind, _Window] = OrderedDict()
        """By kind, in the order in which they end."""
        self._tokens, self._refilled_s = float(BURST_BYTES), now()
        self._dropped = 0
        self._limit_lock = threading.Lock()

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, or count it as suppressed."""
        with self._limit_lock:
            summaries = self._ended_windows()
            is_suppressed = self._is_repeated(record)
        for summary in summaries:
            self._write(summary)
        if not is_suppressed:
            self._write(record)

    def close(self) -> None:
        """Write the summaries of all windows, and close the handler."""
        with self._limit_lock:
            summaries = self._ended_windows(including_open=True)
        for summary in summaries:
            self._write(summary)
        super().close()

    def _is_repeated(self, record: logging.LogRecord) -> bool:
        kind = _kind_of(record)
        window = self._windows.get(kind)
        if window is None:
            window = self._windows[kind] = _Window(self._now() + WINDOW_S)
            if len(self._windows) > _MAX_KINDS:
                self._windows.popitem(last=False)
        if window.written >= REPEATS:
            window.suppressed += 1
            return True
        window.written += 1
        return False

    def _ended_windows(self, including_open: bool = False) -> list[logging.LogRecord]:
        """Remove ended windows, and return a summary for each that suppressed records."""
        now_s, records = self._now(), []
        while self._windows:
            kind, window = next(iter(self._windows.items()))
            if window.ends_s > now_s and not including_open:
                break
            self._windows.popitem(last=False)
            if window.suppressed:
                records.append(_summary(kind, window.suppressed))
        return records

    def _write(self, record: logging.LogRecord) -> None:
        size = len(self.format(record).encode("utf-8", "replace")) + 1
        with self._limit_lock:
            now_s = self._now()
            refilled = self._tokens + (now_s - self._refilled_s) * BYTES_PER_S
            self._tokens, self._refilled_s = min(float(BURST_BYTES), refilled), now_s
            if size > self._tokens:
                self._dropped += 1
                return
            self._tokens -= size
            dropped, self._dropped = self._dropped, 0
        if dropped:
            record.records_left_out = dropped
        super().emit(record)


def _kind_of(record: logging.LogRecord) -> _Kind:
    first_line = str(record.msg).partition("\n")[0]
    return record.name, record.levelno, first_line[:200], getattr(record, "run_id", None)


def _summary(kind: _Kind, suppressed: int) -> logging.LogRecord:
    name, level, message, run_id = kind
    fields = {
        "name": name,
        "levelno": level,
        "levelname": logging.getLevelName(level),
        "msg": "%d more like this were left out: %s",
        "args": (suppressed, message),
    }
    return logging.makeLogRecord(fields if run_id is None else {**fields, "run_id": run_id})
