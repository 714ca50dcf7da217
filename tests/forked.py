"""`hexapods` in a process of its own, forked from one that has imported it.

Importing takes most of the time in which a server starts; a fork is a server like any other. What
depends on what happens at the import, such as `PYTHONPATH`, gets an interpreter of its own.
"""

import multiprocessing
import os
import subprocess
import sys
import threading
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from multiprocessing import forkserver, process, resource_tracker, util
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO
from unittest import mock

from app.cli import main
from hexapods.system_processes import die_with_parent

HEXAPODS = [sys.executable, "-c", "import sys; from app.cli import main; sys.exit(main())"]
_ROOT = str(Path(__file__).parents[1])
_AT_START = {name: os.environ.get(name) for name in ("PYTHONPATH", "MUJOCO_GL")}
"""Variables that are read while modules are imported."""


class Forked:
    """A command of `hexapods`; the part of `subprocess.Popen` that the tests use.

    Attributes:
        pid: process id.
        stdout: what it prints.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        env: Mapping[str, str],
        stderr: IO[str] | int | None = None,
        cwd: Path | None = None,
    ) -> None:
        """Start it.

        Args:
            arguments: of the command line.
            env: its environment.
            stderr: where its errors go: a file, `subprocess.STDOUT`, or None for where those of
                the tests go.
            cwd: its working folder; by default that of the tests.
        """
        read, write = os.pipe()
        self.stdout = os.fdopen(read, encoding="utf-8")
        # The fork gets the descriptors of connections; a connection closes its own.
        with Connection(write) as printed, Connection(os.dup(_descriptor(stderr, write))) as failed:
            self._process = multiprocessing.get_context("forkserver").Process(
                target=_run, args=(list(arguments), dict(env), cwd or Path.cwd(), printed, failed)
            )
            self._process.start()
        self.pid = self._process.pid or 0

    def poll(self) -> int | None:
        """Return its exit code, negative after a signal; None while it runs."""
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        """Return its exit code once it has ended.

        Raises:
            subprocess.TimeoutExpired: if it has not within that time [s].
        """
        self._process.join(timeout)
        if (code := self.poll()) is None:
            raise subprocess.TimeoutExpired("hexapods", timeout or 0)
        return code

    def send_signal(self, number: int) -> None:
        """Send it a signal, if it still runs."""
        # The fork server waits for it, and tells of its end a moment later.
        if self.poll() is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)


def start_hexapods(
    arguments: Sequence[str],
    env: Mapping[str, str],
    stderr: IO[str] | int | None = None,
    cwd: Path | None = None,
) -> "Forked | subprocess.Popen[str]":
    """Start a command, its standard output in a pipe; arguments as of `Forked`."""
    if all(env.get(name, was) == was for name, was in _AT_START.items()):
        return Forked(arguments, env, stderr, cwd)
    return subprocess.Popen(
        [*HEXAPODS, *arguments],
        env={"PYTHONPATH": _ROOT, **env},
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
        cwd=cwd,
    )


def _descriptor(stderr: IO[str] | int | None, stdout: int) -> int:
    if stderr == subprocess.STDOUT:
        return stdout
    return 2 if stderr is None or isinstance(stderr, int) else stderr.fileno()


def start_fork_server() -> None:
    """Start a fork server that imports all that a server needs, before one with less is started.

    Its resource tracker clears up silently after servers that a test kills.
    """
    with mock.patch.dict(os.environ, PYTHONWARNINGS="ignore:resource_tracker"):
        resource_tracker.ensure_running()
    forkserver.set_forkserver_preload(["tests.preloaded"])
    forkserver.ensure_running()


def _run(
    arguments: Sequence[str],
    env: Mapping[str, str],
    cwd: Path,
    printed: Connection,
    failed: Connection,
) -> None:
    """Be the command, in the fork, and end with a test run that is killed."""
    # The fork server ends when no process has this descriptor any more, and this one with it.
    os.close(vars(forkserver._forkserver)["_forkserver_alive_fd"])
    die_with_parent()
    os.dup2(printed.fileno(), 1)
    os.dup2(failed.fileno(), 2)
    printed.close()
    failed.close()
    # Python's own have looked at what the descriptors were before.
    sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
    sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False, buffering=1)
    os.environ.clear()
    os.environ.update(env)
    os.chdir(cwd)
    # Where its children look for modules.
    process.ORIGINAL_DIR = str(cwd)  # type: ignore[attr-defined]
    vars(util)["spawnv_passfds"] = _start_interpreter
    sys.exit(main(arguments))


_spawn_interpreter = util.spawnv_passfds


def _start_interpreter(path: bytes, args: Sequence[str], passed: Sequence[int]) -> int:
    """Start a Python interpreter, as `multiprocessing` asks for; fork it if it is a fork server.

    The command's own fork server so has imported what its jobs need as soon as it starts, and what
    an experiment's job imports when it first needs it, which takes a second of the processor.

    Args:
        path: of the interpreter.
        args: its command line, of which the last one is the program.
        passed: the descriptors that it gets beside the standard ones.
    """
    # Of other threads a fork would keep the locks.
    if "forkserver" not in args[-1] or threading.active_count() > 1:
        pid: int = _spawn_interpreter(path, args, passed)
        return pid
    sys.stdout.flush()
    if (pid := os.fork()) != 0:
        return pid
    code = 1
    try:
        last = 2
        for descriptor in sorted(passed):
            os.closerange(last + 1, descriptor)
            last = descriptor
        os.closerange(last + 1, os.sysconf("SC_OPEN_MAX"))
        # As of a new interpreter: the lock of the first is held, and its parts are the parent's.
        vars(forkserver)["_forkserver"].__init__()
        vars(resource_tracker)["_resource_tracker"].__init__()
        exec(args[-1], {})  # `multiprocessing`'s own program
    except SystemExit:
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)
