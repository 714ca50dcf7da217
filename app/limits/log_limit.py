"""Keeps the log small whatever happens: repeated records are counted, and bytes are rationed."""

import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import TextIO

REPEATS, WINDOW_S = 10, 60.0
"""So many records of one kind are written in each window; the others are counted."""
BURST_BYTES, BYTES_PER_S = 400_000, 500.0
"""What may be written at once, and how fast that fills again."""
_MAX_KINDS = 1000
_Kind = tuple[str, int, str, object]


@dataclass
class _Window:
    ends_s: float
    written: int = 0
    left_out: int = 0


class LimitedHandler(logging.StreamHandler[TextIO]):
    """Writes records to a stream, as far as there is room for them.

    Records are of one kind if logger, level, run and the first line of their message before its
    arguments are the same. What was left out is said in one record a kind, when its window has
    ended and anything is logged.
    """

    def __init__(self, stream: TextIO, now: Callable[[], float] = time.monotonic) -> None:
        """Write to a stream.

        Args:
            stream: to write to.
            now: the clock, in seconds.
        """
        super().__init__(stream)
        self._now = now
        self._windows: OrderedDict[_Kind, _Window] = OrderedDict()
        """By kind, those that end first at the front."""
        self._bytes, self._filled_s = float(BURST_BYTES), now()
        self._lost = 0
        self._counting = threading.Lock()

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, or count it."""
        with self._counting:
            summaries = self._ended_windows()
            is_counted = self._is_repeated(record)
        for summary in summaries:
            self._write(summary)
        if not is_counted:
            self._write(record)

    def close(self) -> None:
        """Say what was left out, and close."""
        with self._counting:
            summaries = self._ended_windows(and_others=True)
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
            window.left_out += 1
            return True
        window.written += 1
        return False

    def _ended_windows(self, and_others: bool = False) -> list[logging.LogRecord]:
        """Forget the windows that have ended, and make a record of each that left something out."""
        now_s, records = self._now(), []
        while self._windows:
            kind, window = next(iter(self._windows.items()))
            if window.ends_s > now_s and not and_others:
                break
            self._windows.popitem(last=False)
            if window.left_out:
                records.append(_summary(kind, window.left_out))
        return records

    def _write(self, record: logging.LogRecord) -> None:
        size = len(self.format(record).encode("utf-8", "replace")) + 1
        with self._counting:
            now_s = self._now()
            filled = self._bytes + (now_s - self._filled_s) * BYTES_PER_S
            self._bytes, self._filled_s = min(float(BURST_BYTES), filled), now_s
            if size > self._bytes:
                self._lost += 1
                return
            self._bytes -= size
            lost, self._lost = self._lost, 0
        if lost:
            record.records_left_out = lost
        super().emit(record)


def _kind_of(record: logging.LogRecord) -> _Kind:
    first_line = str(record.msg).partition("\n")[0]
    return record.name, record.levelno, first_line[:200], getattr(record, "run_id", None)


def _summary(kind: _Kind, left_out: int) -> logging.LogRecord:
    name, level, message, run_id = kind
    said = {
        "name": name,
        "levelno": level,
        "levelname": logging.getLevelName(level),
        "msg": "%d more like this were left out: %s",
        "args": (left_out, message),
    }
    return logging.makeLogRecord(said if run_id is None else {**said, "run_id": run_id})
