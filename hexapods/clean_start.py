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

_LOCK = threading.Lock()
_MAIN = ("init_main_from_name", "init_main_from_path")
"""What a process is told of the main module that it is to import."""
_OPTIONS = "_args_from_interpreter_flags"
"""Function that returns the options of the interpreter for a process; no public one has them."""
_SAFE_PATH = "-P"
"""Option of the interpreter: it does not look for modules in the working folder."""


@contextmanager
def clean_start(*, imports_main: bool) -> Iterator[None]:
    """Let processes that this thread starts meanwhile begin without what is not theirs.

    Args:
        imports_main: whether they import the main module all the same.
    """
    # `multiprocessing` has no options for it. Other threads may start processes of their own.
    thread = threading.get_ident()
    with _LOCK:
        preparation, options = spawn.get_preparation_data, vars(util)[_OPTIONS]

        def get_preparation_data(name: str) -> dict[str, Any]:
            data = preparation(name)
            if threading.get_ident() == thread and not imports_main:
                data = {key: value for key, value in data.items() if key not in _MAIN}
            return data

        def get_options() -> list[str]:
            interpreter: list[str] = options()
            is_added = threading.get_ident() == thread and _SAFE_PATH not in interpreter
            return [*interpreter, _SAFE_PATH] if is_added else interpreter

        spawn.get_preparation_data = get_preparation_data
        setattr(util, _OPTIONS, get_options)
        try:
            yield
        finally:
            spawn.get_preparation_data = preparation
            setattr(util, _OPTIONS, options)
