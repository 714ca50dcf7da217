"""Processes of `multiprocessing` that import neither the caller's program nor what shadows Python.

By itself each imports the program that starts it, for what is pickled of its main module: without
`if __name__ == "__main__":` that begins the program again, and from standard input there is no
file. It also looks for modules in the working folder first, where any may be called `signal.py`.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import spawn, util
from typing import Any

_MAIN = ("init_main_from_name", "init_main_from_path")
"""Keys of `multiprocessing`'s preparation data that name the main module to import."""
_OPTIONS = "_args_from_interpreter_flags"
"""Function that returns the options of the interpreter for a process; no public one has them."""
_SAFE_PATH = "-P"
"""Option of the interpreter: it does not look for modules in the working folder."""

_usual_preparation, _usual_options = spawn.get_preparation_data, vars(util)[_OPTIONS]


class _Start(threading.local):
    """Thread-local flags: how the processes that this thread starts are prepared."""

    is_clean = False
    imports_main = True


_start = _Start()


@contextmanager
def clean_start(*, imports_main: bool) -> Iterator[None]:
    """Start processes within the context with a safe module path, and without the main module.

    This holds for processes that this thread starts.

    Args:
        imports_main: whether they import the main module all the same.
    """
    before = _start.is_clean, _start.imports_main
    _start.is_clean, _start.imports_main = True, imports_main
    try:
        yield
    finally:
        _start.is_clean, _start.imports_main = before


def _preparation_data(name: str) -> dict[str, Any]:
    data = _usual_preparation(name)
    if not _start.is_clean or _start.imports_main:
        return data
    return {key: value for key, value in data.items() if key not in _MAIN}


def _options() -> list[str]:
    options: list[str] = _usual_options()
    return [*options, _SAFE_PATH] if _start.is_clean and _SAFE_PATH not in options else options


# `multiprocessing` has no options for it. Other threads start processes as before; and there is no
# lock, which a process that is forked meanwhile would find locked for ever.
spawn.get_preparation_data = _preparation_data
setattr(util, _OPTIONS, _options)
