"""Processes that run trials for who waits for them, ready from one question to the next."""

import multiprocessing
import os
import queue
import threading
import time
from collections.abc import Sequence
from concurrent.futures import Future
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import NamedTuple

from app.domain.errors import HexapodError, InvalidInput
from app.experiments.trial import TrialConfig, TrialResult, run_trial
from app.jobs.process_setup import set_up_process
from app.storage.errors import Busy

IDLE_S = 60.0
PATIENCE_S = 60.0
NICENESS = 10
"""Someone waits for the answer, so that it goes before jobs."""
_CHUNK = 3
_CLOSE_S = 3.0

_Answer = list[TrialResult] | str


class _Question(NamedTuple):
    configs: Sequence[TrialConfig]
    answer: "Future[list[TrialResult]]"


class _Process(NamedTuple):
    process: SpawnProcess
    pipe: Connection


class _Gone(Exception):
    """A process ended, or takes too long."""


class TrialPool:
    """Some processes, started for the first question and ended when there was none for a while.

    They end with the server, however that ends.
    """

    def __init__(self, count: int | None = None, idle_s: float = IDLE_S) -> None:
        """Start nothing yet.

        Args:
            count: how many; one for each core by default.
            idle_s: how long they wait for a question.
        """
        self._count, self._idle_s = count or os.cpu_count() or 1, idle_s
        self._questions: queue.SimpleQueue[_Question | None] = queue.SimpleQueue()
        self._processes: list[_Process] = []
        # The kernel ends a process with the thread that started it, so that one thread starts all.
        self._keeper: threading.Thread | None = None
        self._lock = threading.Lock()
        self._closed = False

    @property
    def pids(self) -> list[int]:
        """Of the processes that there are now."""
        return [one.process.pid for one in list(self._processes) if one.process.pid is not None]

    def run(self, configs: Sequence[TrialConfig]) -> list[TrialResult]:
        """Run trials, and wait for them; one question after another, from any thread.

        Returns:
            their results, in order.

        Raises:
            InvalidInput: if a trial cannot be.
            Busy: if the processes end, or take too long, or are closed.
        """
        question = _Question(configs, Future())
        with self._lock:
            if self._closed:
                raise Busy("the server is stopping; try again later", 1)
            if self._keeper is None:
                self._keeper = threading.Thread(target=self._keep, name="trial pool", daemon=True)
                self._keeper.start()
            self._questions.put(question)
        return question.answer.result()

    def close(self) -> None:
        """End the processes; there are no more questions."""
        with self._lock:
            self._closed = True
            self._questions.put(None)
            keeper = self._keeper
        for one in list(self._processes):
            with suppress(ValueError):  # it is gone already
                one.process.kill()
        if keeper is not None:
            keeper.join(_CLOSE_S)

    def _keep(self) -> None:
        while True:
            try:
                question = self._questions.get(timeout=self._idle_s)
            except queue.Empty:
                self._end()
                continue
            if question is None:
                self._end()
                return
            try:
                question.answer.set_result(self._ask(question.configs))
            except HexapodError as error:
                question.answer.set_exception(error)
            except (_Gone, OSError) as error:
                self._end()
                said = f"the processes that try it are gone ({error}); try again"
                question.answer.set_exception(Busy(said, 1))

    def _ask(self, configs: Sequence[TrialConfig]) -> list[TrialResult]:
        while len(self._processes) < self._count:
            self._processes.append(_start())
        chunks = [configs[i : i + _CHUNK] for i in range(0, len(configs), _CHUNK)]
        answers: dict[int, list[TrialResult]] = {}
        idle = [one.pipe for one in self._processes]
        asked: dict[Connection, int] = {}
        wrong: str | None = None
        deadline = time.monotonic() + PATIENCE_S
        number = 0
        while number < len(chunks) or asked:
            # What is wrong with one trial is wrong with all.
            while idle and number < len(chunks) and wrong is None:
                idle[-1].send(chunks[number])
                asked[idle.pop()] = number
                number += 1
            if not asked:
                break
            for pipe in _ready(asked, deadline):
                answer = _received(pipe)
                if isinstance(answer, str):
                    wrong = answer
                else:
                    answers[asked[pipe]] = answer
                del asked[pipe]
                idle.append(pipe)
        if wrong is not None:
            raise InvalidInput(wrong)
        return [result for place in sorted(answers) for result in answers[place]]

    def _end(self) -> None:
        for one in self._processes:
            one.process.kill()
            one.process.join()
            one.process.close()
            one.pipe.close()
        self._processes.clear()


def _start() -> _Process:
    context = multiprocessing.get_context("spawn")
    pipe, its_pipe = context.Pipe()
    # A daemon, so that who never closes this is not kept from ending.
    process = context.Process(target=main, args=(its_pipe,), name="trials", daemon=True)
    process.start()
    its_pipe.close()
    return _Process(process, pipe)


def _ready(asked: dict[Connection, int], deadline: float) -> list[Connection]:
    found = wait(list(asked), timeout=max(0.0, deadline - time.monotonic()))
    if not found:
        raise _Gone(f"it takes over {PATIENCE_S:.0f} s")
    return [pipe for pipe in asked if pipe in found]


def _received(pipe: Connection) -> _Answer:
    try:
        answer: _Answer = pipe.recv()
    except (EOFError, OSError) as error:
        raise _Gone("one of them ended") from error
    return answer


def main(pipe: Connection) -> None:
    """Answer questions until nobody asks any more; this is one of the processes."""
    set_up_process(NICENESS)
    with suppress(EOFError, OSError):
        while True:
            pipe.send(_answer(pipe.recv()))
    os._exit(0)


def _answer(configs: Sequence[TrialConfig]) -> _Answer:
    try:
        return [run_trial(config) for config in configs]
    except HexapodError as error:
        return str(error)
    except Exception as error:  # an agent is anyone's code
        return f"something in it broke ({type(error).__name__}: {error})"
