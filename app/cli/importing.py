"""Import many modules in less time."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def importing() -> Iterator[None]:
    """Collect no garbage during the imports of the context, nor what they made afterwards.

    Modules last as long as the process. Their objects are so many that looking for garbage among
    them takes up to a third of the time in which a server starts, and again when it ends.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
