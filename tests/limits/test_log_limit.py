"""Log rate limit: repeated records are suppressed and counted, and bytes are limited."""

import io
import logging
from collections.abc import Iterator

import pytest

from app.limits.log_limit import BURST_BYTES, BYTES_PER_S, REPEATS, WINDOW_S, LimitedHandler


@pytest.fixture
def clock() -> list[float]:
    return [1000.0]


@pytest.fixture
def stream() -> io.StringIO:
    return io.StringIO()


@pytest.fixture
def log(stream: io.StringIO, clock: list[float]) -> Iterator[logging.Logger]:
    logger = logging.getLogger("tests.log_limit")
    handler = LimitedHandler(stream, lambda: clock[0])
    logger.addHandler(handler)
    logger.propagate = False
    yield logger
    logger.removeHandler(handler)
    handler.close()


def test_repeated_records_are_suppressed_and_counted(
    log: logging.Logger, stream: io.StringIO, clock: list[float]
) -> None:
    for number in range(1000):
        log.warning("call %d failed\nwith details", number)
    log.warning("something else")
    lines = stream.getvalue().splitlines()
    assert len(lines) == 2 * REPEATS + 1
    clock[0] += WINDOW_S
    log.warning("and so on")
    new_lines = stream.getvalue().splitlines()[len(lines) :]
    assert new_lines == [
        f"{1000 - REPEATS} more like this were left out: call %d failed",
        "and so on",
    ]


def test_records_of_different_runs_are_not_repeats(
    log: logging.Logger, stream: io.StringIO
) -> None:
    for number in range(50):
        log.warning("it is %s", "running", extra={"run_id": str(number)})
    assert len(stream.getvalue().splitlines()) == 50


def test_bytes_are_limited_by_a_token_bucket(
    log: logging.Logger, stream: io.StringIO, clock: list[float]
) -> None:
    for number in range(2000):
        log.warning(f"{number} {'x' * 1000}")
    assert BURST_BYTES - 2000 < len(stream.getvalue()) <= BURST_BYTES
    clock[0] += 2000 / BYTES_PER_S
    log.warning("it is heard again")
    assert stream.getvalue().endswith("it is heard again\n")


def test_suppressed_records_are_reported_on_close(stream: io.StringIO) -> None:
    handler = LimitedHandler(stream)
    for _ in range(REPEATS + 5):
        handler.handle(logging.makeLogRecord({"msg": "again", "levelno": logging.INFO}))
    handler.close()
    assert stream.getvalue().endswith("5 more like this were left out: again\n")
