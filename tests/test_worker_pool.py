"""The executor whose processes may die: what that does to the calls that follow."""

import os
from concurrent.futures import BrokenExecutor

import pytest

from hexapods.processes import SetUp
from hexapods.worker_pool import WorkerPool
from tests.timeouts import LONG_S


def test_a_call_that_was_cancelled_while_a_process_died_holds_up_no_other() -> None:
    pool = WorkerPool(1, SetUp(name="test worker"))
    try:
        dies, cancelled, last = (
            pool.submit(os._exit, 1),
            pool.submit(abs, -1),
            pool.submit(abs, -2),
        )
        assert cancelled.cancel()
        with pytest.raises(BrokenExecutor):
            dies.result(LONG_S)
        assert last.result(LONG_S) == 2
    finally:
        pool.shutdown(cancel_futures=True)
