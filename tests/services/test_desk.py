"""Between two steps: what is obeyed when, and what is sent."""

import queue
import threading
import time
from collections.abc import Callable

import pytest

from app.agents.protocol import Problem
from app.agents.q_learning import QLearning
from app.domain.grid import FootGrid
from app.runs.records import EpisodeEnded
from app.runs.seeding import generator
from app.services.desk import Desk
from app.services.orders import Batch, Changed, Message, Word


class Wire:
    """Both ends of a job's pipe, without the pipe."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.words: queue.SimpleQueue[Word] = queue.SimpleQueue()
        self.desk = Desk(self.sent.append, self.words)

    @property
    def records(self) -> int:
        return sum(len(m.records) for m in self.sent if isinstance(m, Batch))


@pytest.fixture
def wire() -> Wire:
    return Wire()


def record(number: int) -> EpisodeEnded:
    return EpisodeEnded(number, number, 0.0, 0.0)


def later(act: Callable[[], None]) -> None:
    threading.Timer(0.1, act).start()


def test_fast_records_are_sent_together_and_all(wire: Wire) -> None:
    began = time.monotonic()
    for number in range(2000):
        wire.desk.report(record(number), number)
        assert wire.desk.go_on(number)
    wire.desk.flush()
    assert wire.records == 2000
    assert len(wire.sent) <= 2 + 30 * (time.monotonic() - began)


def test_a_paused_job_goes_on_when_told(wire: Wire) -> None:
    wire.desk.report(record(0), 0)
    wire.words.put(Word("pause"))
    later(lambda: wire.words.put(Word("resume")))
    began = time.monotonic()
    assert wire.desk.go_on(1)
    assert time.monotonic() - began >= 0.09
    assert wire.records == 1, "what there is was sent before"


def test_a_paused_job_can_be_stopped(wire: Wire) -> None:
    wire.words.put(Word("pause"))
    later(lambda: wire.words.put(Word("stop")))
    assert not wire.desk.go_on(1)
    assert wire.desk.stopped


def test_pace_is_kept_and_can_be_left(wire: Wire) -> None:
    wire.desk.keep_pace(2.0, step_s=0.1)
    began = time.monotonic()
    for number in range(5):
        assert wire.desk.go_on(number)
    assert time.monotonic() - began >= 4 * 0.05 - 0.01
    wire.desk.keep_pace(0.01, step_s=0.3)
    assert wire.desk.go_on(5)
    later(lambda: wire.words.put(Word("tune", 7, {"pace": "max"})))
    assert wire.desk.go_on(6), "half a minute, were it not for the new pace"
    assert wire.sent == [Changed(7, 6, {"pace": "max"})]
    assert time.monotonic() - began < 20


def test_rates_are_changed_and_noted(wire: Wire) -> None:
    grid = FootGrid()
    agent = QLearning(generator(0), Problem(((1, 4), (2, 5), (3, 6)), grid.cells))
    wire.words.put(Word("tune", 1, {"alpha": 0.7, "epsilon": 0.25}))
    assert wire.desk.go_on(12, agent)
    assert agent.epsilon == 0.25
    assert wire.desk.changes == [{"step": 12, "alpha": 0.7, "epsilon": 0.25}]
