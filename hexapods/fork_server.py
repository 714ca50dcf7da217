"""The fork server of `multiprocessing`: preloaded, watched, and gone without a trace.

Linux only: elsewhere the libraries that are used do not all survive a fork.
"""

import multiprocessing
import sys
import threading
import time
from collections.abc import Sequence
from functools import cache
from multiprocessing import forkserver

from hexapods.clean_start import clean_start
from hexapods.system_processes import continue_process, is_stopped, sigint_blocked

_PRELOADED = "hexapods.fork_server_end"
"""Module that each fork server imports."""
_CONTINUED_EVERY_S = 0.5


if sys.platform != "win32":
    from multiprocessing.context import ForkServerContext

    def fork_server_context() -> ForkServerContext:
        """Return the `multiprocessing` context whose processes are forks of the fork server."""
        # No public attribute has it.
        preloaded = vars(forkserver._forkserver)["_preload_modules"]  # noqa: SLF001
        if _PRELOADED not in preloaded:
            forkserver.set_forkserver_preload([*preloaded, _PRELOADED])
        _start_watch()
        return multiprocessing.get_context("forkserver")


def preload(modules: Sequence[str]) -> None:
    """Let the fork server begin to import modules, if it does not run yet.

    Args:
        modules: names of modules that most processes need.

    Raises:
        OSError: if the system cannot create a process.
    """
    forkserver.set_forkserver_preload([*modules, _PRELOADED])
    with sigint_blocked(), clean_start(imports_main=False):
        forkserver.ensure_running()


@cache
def _start_watch() -> None:
    """Continue a fork server that was stopped by a signal for `_CONTINUED_EVERY_S` (SIGCONT).

    While it is stopped, starting or joining a process blocks.
    """

    def watch() -> None:
        stopped: int | None = None
        while True:
            time.sleep(_CONTINUED_EVERY_S)
            # No public attribute has it.
            pid = vars(forkserver._forkserver)["_forkserver_pid"]  # noqa: SLF001
            is_still = pid is not None and is_stopped(pid)
            if is_still and pid == stopped:
                continue_process(pid)
            stopped = pid if is_still else None

    threading.Thread(target=watch, name="fork server's watch", daemon=True).start()
