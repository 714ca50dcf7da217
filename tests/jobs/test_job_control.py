"""Job control between two steps: commands, pace, batches of records and checkpoints."""

import queue
import threading
import time
from collections.abc import Callable

import pytest

from app.jobs.job_control import CHECKPOINT_EVERY_S, JobControl, Stopped
from app.jobs.messages import Batch, Changed, Checkpointed, Command, Message
from hexapods.agents.protocol import Problem
from hexapods.agents.q_learning import QLearning
from hexapods.agents.tamer import Tamer
from hexapods.domain.grid import FootGrid
from hexapods.runs.records import EpisodeEnded
from hexapods.runs.seeding import generator


class FakePipe:
    """Fake of a job's pipe: collects sent messages, and queues commands."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self.control = JobControl(self.sent.append, self.commands)

    @property
    def records(self) -> int:
        return sum(len(m.records) for m in self.sent if isinstance(m, Batch))


@pytest.fixture
def pipe() -> FakePipe:
    return FakePipe()


def record(number: int) -> EpisodeEnded:
    return EpisodeEnded(number, number, 0.0, 0.0)


def run_later(act: Callable[[], None]) -> None:
    threading.Timer(0.1, act).start()


def test_records_are_batched_and_none_is_lost(pipe: FakePipe) -> None:
    began = time.monotonic()
    for number in range(2000):
        pipe.control.report(record(number), number)
        assert pipe.control.wait_for_turn(number)
    pipe.control.flush()
    assert pipe.records == 2000
    assert len(pipe.sent) <= 2 + 30 * (time.monotonic() - began)


def test_paused_job_continues_on_resume(pipe: FakePipe) -> None:
    pipe.control.report(record(0), 0)
    pipe.commands.put(Command("pause"))
    began = time.monotonic()
    run_later(lambda: pipe.commands.put(Command("resume")))
    assert pipe.control.wait_for_turn(1)
    assert time.monotonic() - began >= 0.09
    assert pipe.records == 1, "what there is was sent before"


def test_paused_job_can_be_stopped(pipe: FakePipe) -> None:
    pipe.commands.put(Command("pause"))
    run_later(lambda: pipe.commands.put(Command("stop")))
    assert not pipe.control.wait_for_turn(1)
    assert pipe.control.stopped


def test_pace_is_kept_from_the_first_step_on(pipe: FakePipe) -> None:
    pipe.control.keep_pace(2.0, step_s=0.1)
    began = time.monotonic()
    for number in range(1, 6):
        assert pipe.control.wait_for_turn(number)
        assert time.monotonic() - began >= number * 0.05 - 0.01


def test_new_pace_ends_the_wait(pipe: FakePipe) -> None:
    pipe.control.keep_pace(0.01, step_s=100.0)
    run_later(lambda: pipe.commands.put(Command("tune", 7, {"pace": "max"})))
    assert pipe.control.wait_for_turn(1), "three hours, were it not for the new pace"
    assert pipe.sent == [Changed(7, 1, {"pace": "max"})]


def test_step_does_not_begin_because_its_pace_was_moved(pipe: FakePipe) -> None:
    pipe.control.keep_pace(0.01, step_s=0.1)
    began = time.monotonic()
    for token, pace in enumerate([0.02, 0.05, 0.4]):
        pipe.commands.put(Command("tune", token, {"pace": pace}))
    assert pipe.control.wait_for_turn(1)
    assert len(pipe.sent) == 3
    assert time.monotonic() - began >= 0.24


def test_one_step_begins_at_once_if_a_new_pace_makes_it_overdue(pipe: FakePipe) -> None:
    pipe.control.keep_pace(0.01, step_s=0.1)
    time.sleep(0.25)
    pipe.commands.put(Command("tune", 1, {"pace": 0.5}))
    assert pipe.control.wait_for_turn(1)
    began = time.monotonic()
    assert pipe.control.wait_for_turn(2)
    assert time.monotonic() - began >= 0.19


def test_tune_changes_rates_and_records_the_change(pipe: FakePipe) -> None:
    grid = FootGrid()
    agent = QLearning(generator(0), Problem(((1, 4), (2, 5), (3, 6)), grid.cells))
    pipe.commands.put(Command("tune", 1, {"settings": {"alpha": 0.7, "epsilon": 0.25}}))
    assert pipe.control.wait_for_turn(12, agent)
    assert agent.epsilon == 0.25
    assert pipe.control.changes == [{"step": 12, "settings": {"alpha": 0.7, "epsilon": 0.25}}]


def test_presses_wait_for_the_end_of_an_evaluation_whose_table_they_change(
    pipe: FakePipe,
) -> None:
    agent = Tamer(generator(0), Problem(((1, 4), (2, 5), (3, 6)), FootGrid().cells))
    pipe.commands.put(Command("tune", 1, {"presses": [[2.5, 1.0]]}))
    pipe.control.execute_pending(3, agent)
    assert pipe.control.changes == []

    assert pipe.control.wait_for_turn(4, agent)
    assert pipe.control.changes == [{"step": 4, "presses": [[2.5, 1.0]]}]


def checkpoint_regularly(pipe: FakePipe) -> list[int]:
    """Turn checkpoints on; return a one-element list that holds the step they report."""
    step = [0]
    pipe.control.checkpoint_regularly(lambda: Checkpointed(b"", step[0]))
    return step


def checkpoints(pipe: FakePipe) -> list[int]:
    return [m.step for m in pipe.sent if isinstance(m, Checkpointed)]


def test_periodic_checkpoint_follows_the_records_it_includes(
    pipe: FakePipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    every_s = CHECKPOINT_EVERY_S / 10
    monkeypatch.setattr("app.jobs.job_control.CHECKPOINT_EVERY_S", every_s)
    step = checkpoint_regularly(pipe)
    began = time.monotonic()
    while time.monotonic() - began < 2 * every_s + 0.5:
        step[0] += 1
        pipe.control.report(record(step[0]), step[0])
        assert pipe.control.wait_for_turn(step[0])
        time.sleep(0.01)
    assert 1 <= len(checkpoints(pipe)) <= (time.monotonic() - began) / every_s
    first = next(n for n, m in enumerate(pipe.sent) if isinstance(m, Checkpointed))
    reported = [r for m in pipe.sent[:first] if isinstance(m, Batch) for r in m.records]
    assert len(reported) == checkpoints(pipe)[0]


def test_pause_sends_one_checkpoint(pipe: FakePipe) -> None:
    step = checkpoint_regularly(pipe)
    for number in range(1, 3):
        step[0] = number
        pipe.commands.put(Command("pause"))
        pipe.commands.put(Command("pause"))
        run_later(lambda: pipe.commands.put(Command("resume")))
        assert pipe.control.wait_for_turn(number)
    assert checkpoints(pipe) == [1, 2]


def test_leave_ends_the_loop_but_is_not_a_stop(pipe: FakePipe) -> None:
    pipe.commands.put(Command("checkpoint_and_exit"))
    assert not pipe.control.wait_for_turn(1)
    assert pipe.control.exiting
    assert not pipe.control.stopped
    with pytest.raises(Stopped):
        pipe.control.execute_pending(1, None)


def test_changes_are_replayed_after_the_same_steps(pipe: FakePipe) -> None:
    agent = QLearning(generator(0), Problem(((1, 4), (2, 5), (3, 6)), FootGrid().cells))
    included = [{"step": 2, "pace": "max"}]
    later_on = [
        {"step": 5, "settings": {"epsilon": 0.5}},
        {"step": 7, "settings": {"epsilon": 0.25}},
    ]
    pipe.control.restore_changes(included, later_on, 5, agent)
    assert agent.epsilon == 0.5, "it was made after this step, and after the checkpoint"
    epsilons = []
    for step in (6, 7, 8):
        assert pipe.control.wait_for_turn(step, agent)
        epsilons.append(agent.epsilon)
    assert epsilons == [0.5, 0.25, 0.25]
    assert pipe.control.changes == [*included, *later_on]
    assert pipe.sent == [], "the server has them already"
