"""Promise 15: clock jumps of a day are harmless: no false failures, durations monotonic.

The wall clock is patched for all code of the server's process; jobs' processes keep the real one.
"""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime, timedelta, tzinfo
from pathlib import Path

import pytest

from app.events.bus import EventBus
from app.jobs.jobs import Jobs
from app.jobs.submissions import TrainingStart
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import Run
from hexapods.runs.config import training_config
from tests.storage.stores import opened, training
from tests.timeouts import LONG_S

pytestmark = pytest.mark.test

DAY = timedelta(days=1)
both_ways = pytest.mark.parametrize("jump", [DAY, -DAY], ids=["forward", "back"])


class Clock:
    """Patched wall clock that a test can set forward or back."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.ahead = timedelta()
        clock, real_ns = self, time.time_ns

        class Jumping(datetime):
            @classmethod
            def now(cls, tz: tzinfo | None = None) -> "Jumping":
                return cls.fromtimestamp(real_ns() / 1e9, tz) + clock.ahead

        monkeypatch.setattr(
            time, "time_ns", lambda: real_ns() + int(self.ahead.total_seconds() * 1e9)
        )
        monkeypatch.setattr(time, "time", lambda: time.time_ns() / 1e9)
        for name, module in list(sys.modules.items()):
            if (
                name.startswith(("app.", "hexapods."))
                and getattr(module, "datetime", None) is datetime
            ):
                monkeypatch.setattr(module, "datetime", Jumping)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


@contextmanager
def server(folder: Path) -> Iterator[tuple[RunStore, Jobs]]:
    with opened(folder, None) as store:
        jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
        jobs.open()
        try:
            yield store, jobs
        finally:
            jobs.close()


def practice(jobs: Jobs, steps: int = 40) -> Run:
    config = training_config(
        gait="left-right-origin", simulator="kinematic", steps=steps, pace=20, evaluate_every=0
    )
    return jobs.start(TrainingStart(config))


def until(is_so: Callable[[], bool]) -> None:
    deadline = time.monotonic() + LONG_S
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.005)


@both_ways
def test_a_clock_jump_during_a_run(jump: timedelta, clock: Clock, tmp_path: Path) -> None:
    with server(tmp_path) as (store, jobs):
        began_s = time.monotonic()
        first, second = practice(jobs), practice(jobs)
        until(lambda: store.get(first.id).done > 0)
        clock.ahead = jump
        until(lambda: store.get(second.id).state == "finished")
        took_s = time.monotonic() - began_s
        for run in (store.get(first.id), store.get(second.id)):
            assert (run.state, run.error) == ("finished", None)
            assert run.started_at is not None
            assert run.ended_at is not None
            assert run.created_at <= run.started_at
            assert 0.5 < (run.ended_at - run.started_at).total_seconds() < took_s
        third = practice(jobs, steps=1)
        until(lambda: store.get(third.id).state == "finished")
        assert [run.id for run in store.list().items] == [third.id, second.id, first.id]


@both_ways
def test_a_clock_jump_across_a_restart(jump: timedelta, clock: Clock, tmp_path: Path) -> None:
    with server(tmp_path) as (store, jobs):
        before = practice(jobs, steps=1)
        until(lambda: store.get(before.id).state == "finished")
    with opened(tmp_path, None) as store:
        store.create(training("0", state="running", started_at=store.get(before.id).started_at))
    clock.ahead = jump
    with server(tmp_path) as (store, jobs):
        left = store.get("0")
        assert left.state == "interrupted"
        assert left.started_at is not None
        assert left.ended_at is not None
        assert left.started_at <= left.ended_at
        after = practice(jobs, steps=1)
        until(lambda: store.get(after.id).state == "finished")
        assert [run.id for run in store.list().items] == [after.id, before.id, "0"]
        assert store.get(before.id).state == "finished"
