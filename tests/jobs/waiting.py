"""Waits for what jobs do in processes of their own."""

import time
from collections.abc import Callable
from typing import Any

from app.storage.store import UNENDED, Run, RunStore
from tests.patience import LONG_S, Patience


def until(is_so: Callable[[], Any]) -> None:
    """Wait for something."""
    deadline = time.monotonic() + LONG_S
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def ended(store: RunStore, run: Run) -> Run:
    """The run once it has ended."""
    patience = Patience()
    while (now := store.get(run.id)).state in UNENDED:
        patience.check((now.state, now.done))
        time.sleep(0.005)
    return now


def moving(store: RunStore, run: Run) -> None:
    """Wait until it has done something."""
    until(lambda: store.get(run.id).done > 0)
