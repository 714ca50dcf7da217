"""Renders files for a server: one at a time, in a process of lower priority."""

import os
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from app.jobs.process_pool import ProcessPool
from app.storage.errors import Busy
from hexapods.domain.errors import HexapodError

TIMEOUT_S = 900.0
"""A second for each picture of a video; a large one takes about 0.4 s in software."""
_IDLE_S = 10.0
_RETRY_S = 20


class _FileTask(NamedTuple):
    write: Callable[[Path], None]
    file: Path


class FileRenderer:
    """Renders in a process of its own, since OpenGL in software takes all cores. Thread-safe."""

    def __init__(
        self, timeout_s: float = TIMEOUT_S, check: Callable[[], None] = lambda: None
    ) -> None:
        """Create a renderer that is free; the first file starts its process.

        Args:
            timeout_s: time after which a file is given up [s].
            check: raises once nobody needs the file any more; called ten times a second.
        """
        self._check = check
        self._rendering = threading.Lock()
        self._pool = ProcessPool(count=1, idle_s=_IDLE_S, timeout_s=timeout_s)

    def render(self, write: Callable[[Path], None], name: str) -> bytes:
        """Return the content of a file that a function writes; see `Execution.write_file`.

        Args:
            write: writes the file; it can be pickled.
            name: of the file, whose stem says what it is.

        Raises:
            Busy: if another one is being rendered, its process ends, it takes too long, or the
                renderer is closed.
            HexapodError: what `write` raises, or if it fails otherwise.
        """
        what = Path(name).stem
        if not self._rendering.acquire(blocking=False):
            raise Busy(f"another {what} is being rendered; try again in a moment", _RETRY_S)
        try:
            # Made here, so that it is removed even if the process is killed.
            with tempfile.TemporaryDirectory() as folder:
                task = _FileTask(write, Path(folder) / name)
                (failure,) = self._pool.map(_write, [task], self._check)
                if failure is not None:
                    raise HexapodError(f"a {what} failed: {failure}")
                return task.file.read_bytes()
        finally:
            self._rendering.release()

    def close(self) -> None:
        """Kill the process, and refuse further files."""
        self._pool.close()


def _write(task: _FileTask) -> str | None:
    """Write a file in a worker; return what failed, if it is none of the errors for users."""
    # Keeps a video's encoder in the process group of the worker, with which it is killed.
    os.environ["IMAGEIO_FFMPEG_NO_PREVENT_SIGINT"] = "1"
    try:
        task.write(task.file)
    except HexapodError:
        raise
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return None
