"""Turns of requests: one at a time, operators first, and nobody waits who has left."""

import threading
import time
from collections.abc import Callable

import pytest

from app.jobs.turns import Turns
from app.storage.errors import Busy
from tests.jobs.waiting import wait_until
from tests.timeouts import LONG_S

MAX_WAITING = 4


def nothing() -> None:
    pass


def started(work: Callable[[], None]) -> threading.Thread:
    thread = threading.Thread(target=work)
    thread.start()
    return thread


def test_operators_go_first_and_others_in_order() -> None:
    turns, order = Turns("questions", MAX_WAITING), []

    def ask(name: str) -> Callable[[], None]:
        def wait_and_note() -> None:
            with turns.turn(nothing, is_operator=name.startswith("operator")):
                order.append(name)

        return wait_and_note

    with turns.turn(nothing):
        threads = []
        for name in ("spectator 1", "spectator 2", "operator 1", "operator 2"):
            threads.append(started(ask(name)))
            wait_until(lambda: turns.waiting == len(threads))
    for thread in threads:
        thread.join(LONG_S)
    assert order == ["operator 1", "operator 2", "spectator 1", "spectator 2"]


def test_an_operator_ends_the_turn_of_a_spectator() -> None:
    turns, done = Turns("questions", MAX_WAITING), []

    def ask() -> None:
        with turns.turn(nothing):
            done.append("operator")

    def until_ended(check: Callable[[], None]) -> None:
        deadline_s = time.monotonic() + LONG_S
        while time.monotonic() < deadline_s:
            check()
            time.sleep(0.01)

    with turns.turn(nothing, is_operator=False) as check:
        check()
        thread = started(ask)
        with pytest.raises(Busy, match="the operator asked"):
            until_ended(check)
    thread.join(LONG_S)
    assert done == ["operator"]


def test_a_client_that_has_left_or_finds_the_queue_full_waits_no_more() -> None:
    turns, has_left, left = Turns("questions", MAX_WAITING), threading.Event(), []

    def check() -> None:
        if has_left.is_set():
            raise Busy("left", 1)

    def ask() -> None:
        with pytest.raises(Busy, match="left"), turns.turn(check, is_operator=False):
            raise AssertionError
        left.append(1)

    with turns.turn(nothing, is_operator=False):
        threads = [started(ask) for _ in range(MAX_WAITING)]
        wait_until(lambda: turns.waiting == MAX_WAITING)
        with pytest.raises(Busy, match="are waiting"), turns.turn(nothing, is_operator=False):
            raise AssertionError
        has_left.set()
        for thread in threads:
            thread.join(LONG_S)
    assert len(left) == MAX_WAITING
    with turns.turn(nothing, is_operator=False):
        assert turns.waiting == 0
