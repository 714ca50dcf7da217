"""Faster start of the commands."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_garbage_collection() -> Iterator[None]:
    """Disable garbage collection during imports, and exempt the imported objects from it.

    Modules last as long as the process. Their objects are so many that looking for garbage among
    them takes up to a third of the time in which a server starts, and again when it ends.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if was_enabled:
            gc.enable()
