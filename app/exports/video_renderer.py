"""Renders videos for a server: one at a time, in a process of lower priority."""

import os
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from app.exports.recorded_lanes import RecordedWalks
from app.exports.video import ShownPoses, VideoOptions, shown_poses, write_video
from app.jobs.process_pool import ProcessPool
from app.storage.errors import Busy
from hexapods.domain.errors import HexapodError

MAX_SERVED_FRAMES = 900
"""Frames of a video over REST, half a minute at 30 a second."""
TIMEOUT_S = 900.0
"""A second for each picture; a large one takes about 0.4 s in software."""
_IDLE_S = 10.0
_RETRY_S = 20


class _VideoTask(NamedTuple):
    shown: ShownPoses
    options: VideoOptions
    file: Path


class VideoRenderer:
    """Renders in a process of its own, since OpenGL in software takes all cores. Thread-safe."""

    def __init__(
        self, timeout_s: float = TIMEOUT_S, check: Callable[[], None] = lambda: None
    ) -> None:
        """Create a renderer that is free; the first video starts its process.

        Args:
            timeout_s: time after which a video is given up [s].
            check: raises once nobody needs the video any more; called ten times a second.
        """
        self._check = check
        self._rendering = threading.Lock()
        self._pool = ProcessPool(count=1, idle_s=_IDLE_S, timeout_s=timeout_s)

    def render(self, walks: RecordedWalks, options: VideoOptions) -> bytes:
        """Render the video of a run.

        Raises:
            Busy: if another one is being rendered, its process ends, it takes too long, or the
                renderer is closed.
            InvalidInput, MissingExtra: as `shown_poses` and `write_video`.
            HexapodError: if it cannot be encoded or written.
        """
        shown = shown_poses(walks, options, MAX_SERVED_FRAMES)
        if not self._rendering.acquire(blocking=False):
            raise Busy("another video is being rendered; try again in a moment", _RETRY_S)
        try:
            # Made here, so that it is removed even if the process is killed.
            with tempfile.TemporaryDirectory() as folder:
                video = _VideoTask(shown, options, Path(folder) / f"video{options.ending}")
                (failure,) = self._pool.map(_write, [video], self._check)
                if failure is not None:
                    raise HexapodError(f"a video failed: {failure}")
                return video.file.read_bytes()
        finally:
            self._rendering.release()

    def close(self) -> None:
        """Kill the process, and refuse further videos."""
        self._pool.close()


def _write(video: _VideoTask) -> str | None:
    """Write a video in a worker; return what failed, if it is none of the errors for users."""
    # Keeps the encoder in the process group of the worker, with which it is killed.
    os.environ["IMAGEIO_FFMPEG_NO_PREVENT_SIGINT"] = "1"
    try:
        write_video(*video)
    except HexapodError:
        raise
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return None
