"""Renders films for a server: one at a time, in a process of lower priority."""

import os
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from app.domain.errors import HexapodError
from app.exports.recorded_lanes import RecordedWalks
from app.exports.video import VideoOptions, check_length, render_video
from app.storage.errors import Busy

MAX_SERVED_FRAMES = 900
"""Pictures of a film over REST, half a minute at 30 a second."""
_NICENESS = 10
_RETRY_S = 20


class VideoRenderer:
    """Renders in a process of its own, since OpenGL in software takes all cores. Thread-safe."""

    def __init__(self) -> None:
        """Create a renderer that is free; it starts a process for each film."""
        self._rendering = threading.Lock()

    def render(self, walks: RecordedWalks, options: VideoOptions) -> bytes:
        """Render the film of a run.

        Raises:
            Busy: if another one is being rendered.
            InvalidInput, MissingExtra: as `render_video`.
        """
        check_length(walks, options, MAX_SERVED_FRAMES)
        if not self._rendering.acquire(blocking=False):
            raise Busy("another film is being rendered; try again in a moment", _RETRY_S)
        try:
            with ProcessPoolExecutor(1, get_context("spawn"), _lower_priority) as pool:
                return pool.submit(render_video, walks, options).result()
        except BrokenProcessPool as error:
            raise HexapodError("the process that renders films ended; the log says why") from error
        finally:
            self._rendering.release()


def _lower_priority() -> None:
    if hasattr(os, "nice"):
        os.nice(_NICENESS)
