"""Polling waits for effects of jobs, which run in processes of their own."""

import time
from collections.abc import Callable
from typing import Any

from app.storage.database.store import RunStore
from app.storage.run import NOT_ENDED, Run
from tests.timeouts import LONG_S, ProgressTimeout


def wait_until(is_so: Callable[[], Any]) -> None:
    """Poll until a predicate is true; fail after `LONG_S`."""
    deadline = time.monotonic() + LONG_S
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def wait_until_ended(store: RunStore, run: Run) -> Run:
    """Wait until a run has ended, and return it; fail if it makes no progress."""
    stall_check = ProgressTimeout()
    while (now := store.get(run.id)).state in NOT_ENDED:
        stall_check.check((now.state, now.done))
        time.sleep(0.02)
    return now


def wait_for_progress(store: RunStore, run: Run) -> None:
    """Wait until a run has done its first step."""
    wait_until(lambda: store.get(run.id).done > 0)
