"""Shows the product's own modules what Python has on Windows, in every process of an environment.

Python imports `sitecustomize` at its start in each process with this folder in PYTHONPATH. Modules
of `app` and `hexapods` then see `sys.platform` as there, and none of the names and modules that are
missing there; all other modules keep those of this system. The event loop accepts connections by
itself, as that of Windows does, and does not call the listener's `accept`.
"""

import asyncio.selector_events
import builtins
import fcntl
import importlib.abc
import importlib.machinery
import multiprocessing
import multiprocessing.context
import os
import select
import signal
import socket
import subprocess  # noqa: F401 - before it could take the stand-in of `msvcrt` for a sign of Windows
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

_PACKAGES = ("app", "hexapods")
_NO_MODULES = {"fcntl", "grp", "pty", "pwd", "resource", "termios", "tty"}
_NO_OS = """chown confstr environb fchmod fchown fork forkpty getgid getgroups getloadavg getpgid
    getpgrp getpriority getsid getuid geteuid getegid kill killpg lchown mkfifo mknod nice openpty
    pathconf pipe2 posix_fallocate posix_spawn sched_getaffinity sched_setaffinity set_blocking
    setgid setpgid setpgrp setpriority setsid setuid statvfs sync sysconf uname wait wait3 wait4
    waitid O_CLOEXEC O_DIRECTORY O_NOFOLLOW O_NONBLOCK O_SYNC WNOHANG"""
_NO_SIGNAL = """SIGALRM SIGCHLD SIGCONT SIGHUP SIGKILL SIGPIPE SIGQUIT SIGSTOP SIGTSTP SIGUSR1
    SIGUSR2 SIGXCPU SIGXFSZ SIG_BLOCK SIG_SETMASK SIG_UNBLOCK alarm pthread_kill pthread_sigmask
    setitimer siginterrupt sigpending sigwait"""
_MISSING = {
    "multiprocessing": {"forkserver"},
    "multiprocessing.context": {"ForkContext", "ForkServerContext"},
    "os": set(_NO_OS.split()),
    "select": {"epoll", "poll"},
    "signal": set(_NO_SIGNAL.split()),
    "socket": {"AF_UNIX", "SO_REUSEPORT", "TCP_CONGESTION"},
}
_LK_NBLCK = 2
_usual_import = builtins.__import__


class _View(ModuleType):
    """A module without some of its names, and with others."""

    def __init__(self, module: ModuleType, missing: set[str], added: Mapping[str, Any]) -> None:
        super().__init__(module.__name__)
        self.__dict__.update(added)
        self._module, self._missing = module, missing

    def __getattr__(self, name: str) -> Any:
        if name in self._missing:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r} on Windows")
        return getattr(self._module, name)


def _lock(file: int, mode: int, size: int) -> None:
    """Lock bytes of a file from where it is, as `msvcrt.locking` does."""
    assert mode == _LK_NBLCK
    fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, size, os.lseek(file, 0, os.SEEK_CUR))


def _context(method: str | None = None) -> Any:
    if method not in (None, "spawn"):
        raise ValueError(f"cannot find context for {method!r}")
    return multiprocessing.get_context("spawn")


_MSVCRT = ModuleType("msvcrt")
_MSVCRT.__dict__.update(LK_NBLCK=_LK_NBLCK, locking=_lock)
_ADDED: Mapping[str, Mapping[str, Any]] = {
    "multiprocessing": {"get_context": _context, "get_all_start_methods": lambda: ["spawn"]},
    # Priority classes of Windows, which psutil takes as nice values here.
    "psutil": {"BELOW_NORMAL_PRIORITY_CLASS": 15, "IDLE_PRIORITY_CLASS": 19},
    "sys": {"platform": "win32"},
}
_views: dict[str, _View] = {}


def _view_of(module: ModuleType) -> ModuleType:
    name = module.__name__
    if name not in _MISSING and name not in _ADDED:
        return module
    if name not in _views:
        _views[name] = _View(module, _MISSING.get(name, set()), _ADDED.get(name, {}))
    return _views[name]


def _import(
    name: str,
    globals_: Mapping[str, Any] | None = None,
    locals_: Mapping[str, Any] | None = None,
    fromlist: Sequence[str] | None = (),
    level: int = 0,
) -> ModuleType:
    if name == "msvcrt":
        return _MSVCRT
    if name.partition(".")[0] in _NO_MODULES:
        raise ModuleNotFoundError(f"No module named {name!r} on Windows", name=name)
    if lacking := _MISSING.get(name, set()) & set(fromlist or ()):
        raise ImportError(f"cannot import {lacking} from {name!r} on Windows", name=name)
    return _view_of(_usual_import(name, globals_, locals_, fromlist or (), level))


class _Loader(importlib.machinery.SourceFileLoader):
    def exec_module(self, module: ModuleType) -> None:
        vars(module)["__builtins__"] = {**vars(builtins), "__import__": _import}
        super().exec_module(module)


class _Finder(importlib.abc.MetaPathFinder):
    """Finds what the usual finders find, and lets the product's modules import views of others."""

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if name.partition(".")[0] not in _PACKAGES:
            return None
        for finder in sys.meta_path:
            if finder is not self and (spec := finder.find_spec(name, path, target)) is not None:
                if isinstance(spec.loader, importlib.machinery.SourceFileLoader):
                    spec.loader = _Loader(name, spec.loader.path)
                return spec
        return None


class _Plain:
    """A socket whose class no one has derived from."""

    def __init__(self, wrapped: socket.socket) -> None:
        self._wrapped = wrapped

    def __getattr__(self, name: str) -> Any:
        return getattr(self._wrapped, name)

    def accept(self) -> tuple[socket.socket, Any]:
        return socket.socket.accept(self._wrapped)


_Loop: Any = asyncio.selector_events.BaseSelectorEventLoop
_ACCEPT = "_accept_connection"
_usual_accept = getattr(_Loop, _ACCEPT)


def _accept(loop: Any, factory: Any, listener: socket.socket, *options: Any, **others: Any) -> None:
    _usual_accept(loop, factory, _Plain(listener), *options, **others)


setattr(_Loop, _ACCEPT, _accept)
sys.meta_path.insert(0, _Finder())
if log := os.environ.get("AS_WINDOWS"):  # to be sure that each process is one of these
    with Path(log).open("a") as file:
        file.write(f"{os.getpid()}\n")
del select, signal
