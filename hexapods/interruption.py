"""Signals that let work end where it can go on, and what a command or a program says of it."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType


class Interrupted(KeyboardInterrupt):
    """A training was interrupted between two steps, and its checkpoint was written.

    Attributes:
        path: of the checkpoint, which `hexapods.resume` takes.
        step: number of steps done.
        steps: number of steps in all.
    """

    def __init__(self, path: Path, step: int, steps: int) -> None:
        super().__init__(
            f"interrupted after {step:,} of {steps:,} steps, which are kept: "
            f"hexapods.resume({str(path)!r}) goes on exactly there"
        )
        self.path, self.step, self.steps = path, step, steps


@contextmanager
def stop_signals(*numbers: signal.Signals) -> Iterator[threading.Event]:
    """Yield an event that the first of these signals sets; a second raises `KeyboardInterrupt`.

    In a thread that is not the main one, which cannot handle signals, nothing sets it.
    """
    stop_requested = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield stop_requested
        return

    def handle_signal(_number: int, _frame: FrameType | None) -> None:
        if stop_requested.is_set():
            raise KeyboardInterrupt
        stop_requested.set()

    before = {number: signal.signal(number, handle_signal) for number in numbers}
    try:
        yield stop_requested
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
