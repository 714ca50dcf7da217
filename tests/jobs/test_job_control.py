"""Between two steps: what is obeyed when, and what is sent."""

import queue
import threading
import time
from collections.abc import Callable

import pytest

from app.agents.protocol import Problem
from app.agents.q_learning import QLearning
from app.domain.grid import FootGrid
from app.jobs.job_control import CHECKPOINT_EVERY_S, JobControl, Stopped
from app.jobs.messages import Batch, Changed, Checkpointed, Command, Message
from app.runs.records import EpisodeEnded
from app.runs.seeding import generator


class Wire:
    """Both ends of a job's pipe, without the pipe."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.words: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self.desk = JobControl(self.sent.append, self.words)

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
    wire.words.put(Command("pause"))
    began = time.monotonic()
    later(lambda: wire.words.put(Command("resume")))
    assert wire.desk.go_on(1)
    assert time.monotonic() - began >= 0.09
    assert wire.records == 1, "what there is was sent before"


def test_a_paused_job_can_be_stopped(wire: Wire) -> None:
    wire.words.put(Command("pause"))
    later(lambda: wire.words.put(Command("stop")))
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
    later(lambda: wire.words.put(Command("tune", 7, {"pace": "max"})))
    assert wire.desk.go_on(6), "half a minute, were it not for the new pace"
    assert wire.sent == [Changed(7, 6, {"pace": "max"})]
    assert time.monotonic() - began < 20


def test_rates_are_changed_and_noted(wire: Wire) -> None:
    grid = FootGrid()
    agent = QLearning(generator(0), Problem(((1, 4), (2, 5), (3, 6)), grid.cells))
    wire.words.put(Command("tune", 1, {"alpha": 0.7, "epsilon": 0.25}))
    assert wire.desk.go_on(12, agent)
    assert agent.epsilon == 0.25
    assert wire.desk.changes == [{"step": 12, "alpha": 0.7, "epsilon": 0.25}]


def keep_safe(wire: Wire) -> list[int]:
    """Let it send checkpoints; returns the steps that it has so far."""
    step = [0]
    wire.desk.keep_safe(lambda: Checkpointed(b"", step[0]))
    return step


def checkpoints(wire: Wire) -> list[int]:
    return [m.step for m in wire.sent if isinstance(m, Checkpointed)]


def test_a_checkpoint_comes_every_few_seconds_after_all_that_it_stands_for(wire: Wire) -> None:
    step = keep_safe(wire)
    began = time.monotonic()
    while time.monotonic() - began < 2 * CHECKPOINT_EVERY_S + 0.5:
        step[0] += 1
        wire.desk.report(record(step[0]), step[0])
        assert wire.desk.go_on(step[0])
        time.sleep(0.01)
    assert 1 <= len(checkpoints(wire)) <= (time.monotonic() - began) / CHECKPOINT_EVERY_S
    first = next(n for n, m in enumerate(wire.sent) if isinstance(m, Checkpointed))
    told = [r for m in wire.sent[:first] if isinstance(m, Batch) for r in m.records]
    assert len(told) == checkpoints(wire)[0]


def test_before_a_long_wait_there_is_one_and_then_no_more(wire: Wire) -> None:
    step = keep_safe(wire)
    for number in range(1, 3):
        step[0] = number
        wire.words.put(Command("pause"))
        wire.words.put(Command("pause"))
        later(lambda: wire.words.put(Command("resume")))
        assert wire.desk.go_on(number)
    assert checkpoints(wire) == [1, 2]


def test_who_is_to_leave_stops_without_being_stopped(wire: Wire) -> None:
    wire.words.put(Command("leave"))
    assert not wire.desk.go_on(1)
    assert wire.desk.leaving
    assert not wire.desk.stopped
    with pytest.raises(Stopped):
        wire.desk.listen(1, None)


def test_changes_are_made_again_after_the_same_steps(wire: Wire) -> None:
    agent = QLearning(generator(0), Problem(((1, 4), (2, 5), (3, 6)), FootGrid().cells))
    made = [{"step": 2, "pace": "max"}]
    later_on = [{"step": 5, "epsilon": 0.5}, {"step": 7, "epsilon": 0.25}]
    wire.desk.repeat(made, later_on, 5, agent)
    assert agent.epsilon == 0.5, "it was made after this step, and after the checkpoint"
    seen = []
    for step in (6, 7, 8):
        assert wire.desk.go_on(step, agent)
        seen.append(agent.epsilon)
    assert seen == [0.5, 0.25, 0.25]
    assert wire.desk.changes == [*made, *later_on]
    assert wire.sent == [], "the server has them already"
