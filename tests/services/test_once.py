"""The same key is the same run, for a day."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from app.domain.errors import InvalidInput
from app.services.errors import Busy
from app.services.once import KEPT_S, MAX_KEPT, Once
from app.services.store import Run
from tests.services.stores import training


class Starts:
    def __init__(self) -> None:
        self.begun: list[Run] = []

    def __call__(self) -> Run:
        self.begun.append(training(f"run-{len(self.begun)}"))
        return self.begun[-1]


def test_without_a_key_each_starts() -> None:
    once, start = Once(), Starts()
    assert once.run(None, b"x", start) != once.run(None, b"x", start)


def test_a_key_starts_once_and_is_not_for_anything_else() -> None:
    once, start = Once(), Starts()
    run = once.run("key", b"x", start)
    assert once.run("key", b"x", start) is run
    assert once.run("other", b"x", start) is not run
    with pytest.raises(InvalidInput, match="Idempotency-Key"):
        once.run("key", b"y", start)
    assert len(start.begun) == 2


def test_who_comes_meanwhile_waits_for_the_same_run() -> None:
    once, starts, gate = Once(), Starts(), threading.Event()

    def slowly() -> Run:
        gate.wait()
        return starts()

    with ThreadPoolExecutor(8) as pool:
        asked = [pool.submit(once.run, "key", b"x", slowly) for _ in range(8)]
        gate.set()
        runs = {one.result().id for one in asked}
    assert runs == {"run-0"}


def test_what_could_not_be_started_can_be_tried_again() -> None:
    once, start = Once(), Starts()

    def refuse() -> Run:
        raise Busy("later", 1)

    with pytest.raises(Busy):
        once.run("key", b"x", refuse)
    assert once.run("key", b"x", start).id == "run-0"


def test_keys_are_forgotten_after_a_day_or_when_there_are_too_many() -> None:
    clock = [0.0]
    once, start = Once(lambda: clock[0]), Starts()
    first = once.run("key", b"x", start)
    clock[0] = KEPT_S
    assert once.run("key", b"x", start) is first
    clock[0] = KEPT_S + 1
    assert once.run("key", b"y", start) is not first
    for number in range(MAX_KEPT):
        once.run(f"key {number}", b"x", start)
    before = len(start.begun)
    once.run("key", b"z", start)
    assert len(start.begun) == before + 1
