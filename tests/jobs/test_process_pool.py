"""The pool of processes for requests that wait: it idles, is closed, and survives what fails."""

import pickle
import threading
import time

import psutil
import pytest

from app.jobs.process_pool import OutOfProcessorTime, ProcessPool, TookTooLong
from app.storage.errors import Busy
from hexapods.domain.errors import InvalidInput
from tests.jobs.waiting import wait_until
from tests.timeouts import LONG_S


def test_workers_exit_when_idle_and_when_closed() -> None:
    pool = ProcessPool(count=1, idle_s=0.3)
    assert pool.pids == [], "nobody has asked"
    assert pool.map(str, [-1, 2]) == ["-1", "2"]
    (first,) = pool.pids
    wait_until(lambda: not psutil.pid_exists(first))
    pool.map(abs, [-1])
    (second,) = pool.pids
    pool.close()
    assert not psutil.pid_exists(second)
    with pytest.raises(Busy, match="stopping"):
        pool.map(abs, [-1])


def test_closing_rejects_requests_that_wait_and_starts_no_more_workers() -> None:
    pool = ProcessPool(count=1)
    refused: list[float] = []

    def ask() -> None:
        with pytest.raises(Busy):
            pool.map(time.sleep, [LONG_S])
        refused.append(time.monotonic())

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    wait_until(lambda: pool.pids)
    pool.close()
    for thread in threads:
        thread.join(LONG_S / 2)
    assert len(refused) == 3
    assert pool.pids == []


def test_what_fails_or_takes_too_long_fails_one_request_only() -> None:
    pool = ProcessPool(count=1, timeout_s=1)
    with pytest.raises(InvalidInput, match=r"it broke \(ValueError"):
        pool.map(int, ["x"])
    # Which of them, and its words, depend on the version of Python.
    with pytest.raises((AttributeError, pickle.PicklingError), match="local object"):
        pool.map(lambda value: value, [1])
    assert pool.map(abs, [-1]) == [1]
    # More than the processes take at once, so that some calls are cancelled before they begin.
    with pytest.raises(TookTooLong, match="it took over 1 s"):
        pool.map(time.sleep, [LONG_S] * 10)
    assert pool.pids == []
    assert pool.map(abs, [-1]) == [1]
    pool.close()


def test_a_limit_of_processor_time_counts_work_and_no_waiting() -> None:
    pool = ProcessPool(count=1)
    pool.map(time.sleep, [1.0], limit_s=0.5)
    with pytest.raises(OutOfProcessorTime, match=r"over 0\.5 s of processor time"):
        pool.map(sum, [range(10**12)], limit_s=0.5)
    assert pool.pids == []
    assert pool.map(abs, [-1]) == [1]
    pool.close()


class GivenUp(Exception):
    """The client has left."""


def test_a_request_that_is_given_up_frees_the_processes() -> None:
    """One that is served, and one that waits for it; the next one is served."""
    pool = ProcessPool(count=1)
    is_given_up, given_up = threading.Event(), []

    def check() -> None:
        if is_given_up.is_set():
            raise GivenUp

    def ask() -> None:
        with pytest.raises(GivenUp):
            pool.map(time.sleep, [LONG_S], check)
        given_up.append(1)

    threads = [threading.Thread(target=ask) for _ in range(2)]
    for thread in threads:
        thread.start()
    wait_until(lambda: pool.pids)
    (pid,) = pool.pids
    is_given_up.set()
    for thread in threads:
        thread.join(LONG_S / 2)
    assert len(given_up) == 2
    assert pool.map(abs, [-1]) == [1]
    assert not psutil.pid_exists(pid)
    pool.close()
