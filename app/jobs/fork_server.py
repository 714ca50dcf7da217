"""The fork server: a process from which those of jobs and pools are forked, with all imported.

Importing what a job needs takes near half a second of a core. A fork starts in some hundredths of
it, and shares the memory of what is imported.
"""

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from functools import cache, partial
from multiprocessing import forkserver, resource_tracker, util
from multiprocessing.context import ForkServerContext, SpawnContext
from pathlib import Path
from typing import Any

from hexapods.processes import die_with_parent, set_process_name

_PRELOADED = ["app.jobs.worker", "hexapods.physics.mujoco_simulator"]
"""Modules that most processes need, those included that are otherwise imported late."""
_CONTINUED_EVERY_S = 1.0
_start_interpreter = util.spawnv_passfds


def process_context() -> "ForkServerContext | SpawnContext":
    """Return the `multiprocessing` context that creates processes.

    On Linux it starts a fork server where none runs. Elsewhere, where the libraries that are used
    do not all survive a fork, each process is started anew.
    """
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    _start_watch()
    forkserver.set_forkserver_preload(_PRELOADED)
    return multiprocessing.get_context("forkserver")


def start_fork_server() -> None:
    """Fork the fork server from this process, which need not import anything again; Linux only.

    Call it once, while no other thread runs. The fork server dies with the calling thread, and what
    it forked dies with it (`set_up_process`).

    Raises:
        OSError: if the system cannot create a process.
    """
    if sys.platform != "linux":
        return
    forkserver.set_forkserver_preload(_PRELOADED)
    resource_tracker.ensure_running()
    # `multiprocessing` starts an interpreter, which would import all modules again.
    util.spawnv_passfds = partial(_fork, _descriptors())
    try:
        forkserver.ensure_running()
    finally:
        util.spawnv_passfds = _start_interpreter


@cache
def _start_watch() -> None:
    """Send SIGCONT to a fork server that a signal has stopped, within `_CONTINUED_EVERY_S`.

    While it is stopped, starting or joining a process blocks.
    """

    def watch() -> None:
        while True:
            time.sleep(_CONTINUED_EVERY_S)
            # No public attribute has it.
            pid = vars(forkserver._forkserver)["_forkserver_pid"]  # noqa: SLF001
            if pid is not None:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGCONT)

    threading.Thread(target=watch, name="fork server's watch", daemon=True).start()


def _fork(
    kept: set[int], _executable: bytes, arguments: Sequence[Any], passed: Sequence[int]
) -> int:
    """Fork a process where `util.spawnv_passfds` starts an interpreter; return its id.

    Args:
        kept: file descriptors that were open before.
        arguments: of an interpreter; the last one is the code of the fork server.
        passed: file descriptors that it needs.
    """
    pid = os.fork()
    if pid:
        return pid
    try:
        util.spawnv_passfds = _start_interpreter
        # Its lock is held. A process that is forked here may start a fork server of its own.
        vars(forkserver._forkserver).update(vars(forkserver.ForkServer()))  # noqa: SLF001
        die_with_parent()
        set_process_name("fork server")
        # Its own copy of the pipe at whose end it notices that no other process has one any more.
        for descriptor in _descriptors().difference(kept, passed):
            os.close(descriptor)
        exec(arguments[-1], {})  # noqa: S102 - what the interpreter would have been given
    except Exception:
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(0)


def _descriptors() -> set[int]:
    """Return the open file descriptors, without that of the folder which lists them."""
    return {int(link.name) for link in list(Path("/proc/self/fd").iterdir()) if link.exists()}
