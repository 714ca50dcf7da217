"""What an experiment's process is told between two trials."""

import queue

import pytest

from app.jobs.experiment_worker import _Listener
from app.jobs.messages import Command


@pytest.fixture
def words() -> "queue.SimpleQueue[Command]":
    return queue.SimpleQueue()


def test_a_pause_holds_until_somebody_has_waited(words: "queue.SimpleQueue[Command]") -> None:
    """Else a cluster that winds down for a pause would take what is left for done."""
    listener = _Listener(words)
    assert listener.wait()
    assert listener.go_on()
    words.put(Command("pause"))
    assert not listener.go_on()
    words.put(Command("resume"))
    assert not listener.go_on()
    assert listener.held
    assert listener.wait()
    assert listener.go_on()
    assert not listener.held


@pytest.mark.parametrize("verb", ["stop", "leave"])
def test_an_end_comes_before_a_pause(verb: str, words: "queue.SimpleQueue[Command]") -> None:
    listener = _Listener(words)
    for said in (Command("pause"), Command("resume"), Command("pause"), Command(verb)):  # type: ignore[arg-type]
        words.put(said)
    assert not listener.wait()
    assert listener.stopped == (verb == "stop")
    assert listener.leaving == (verb == "leave")
