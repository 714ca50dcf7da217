"""Commands that the process of an experiment executes between two trials."""

import queue

import pytest

from app.features.experiments.worker import _TrialControl
from app.jobs.messages import Command


@pytest.fixture
def commands() -> "queue.SimpleQueue[Command]":
    return queue.SimpleQueue()


def test_draining_lasts_until_the_next_wait(commands: "queue.SimpleQueue[Command]") -> None:
    """Otherwise a quick resume would make a draining engine look finished."""
    control = _TrialControl(commands)
    assert control.wait()
    assert control.may_continue()
    commands.put(Command("pause"))
    assert not control.may_continue()
    commands.put(Command("resume"))
    assert not control.may_continue()
    assert control.draining
    assert control.wait()
    assert control.may_continue()
    assert not control.draining


@pytest.mark.parametrize("verb", ["stop", "checkpoint_and_exit"])
def test_stop_or_leave_overrides_pause(verb: str, commands: "queue.SimpleQueue[Command]") -> None:
    control = _TrialControl(commands)
    for command in (Command("pause"), Command("resume"), Command("pause"), Command(verb)):  # type: ignore[arg-type]
        commands.put(command)
    assert not control.wait()
    assert control.stopped == (verb == "stop")
    assert control.exiting == (verb == "checkpoint_and_exit")
