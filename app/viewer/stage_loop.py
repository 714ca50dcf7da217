"""The drawing thread: advances the stage and draws its frames at a fixed rate."""

import logging
import threading
import time
from collections.abc import Callable

from app.events.bus import Channel
from app.stage.stage import Stage
from hexapods.drawing.scene import StageScene
from hexapods.shows.replay import FRAMES_PER_S, SCENES_PER_S
from hexapods.shows.scene_view import SceneView, scene_view

IDLE_FRAMES_PER_S = 10.0
_STILL_FRAMES = 15
"""Number of frames without motion before the rate drops; longer than a pause between steps."""

_logger = logging.getLogger(__name__)


class StageLoop:
    """Draws the stage 30 times a second, and publishes a `scene` event at most five times a second.

    Another run, and the end of a show, are published at once, as in `stage` events.
    `with loop:` runs it, once. Without motion the frame rate drops and no events are published.
    Without viewers it drops to that of the events: drawing a race takes a tenth of a core.

    Args:
        stage: advanced by each frame.
        scene: draws the frames.
        channel: receives the events.
        has_viewers: returns whether anyone sees the frames.
    """

    def __init__(
        self, stage: Stage, scene: StageScene, channel: Channel, has_viewers: Callable[[], bool]
    ) -> None:
        self._stage, self._scene, self._channel = stage, scene, channel
        self._has_viewers = has_viewers
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stage", daemon=True)
        self._published: SceneView | None = None
        self._published_s = -1.0
        self._published_run: tuple[str | None, bool] = None, False
        self._has_failed = False

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        due_s, still = time.monotonic(), 0
        while not self._stop.is_set():
            still = 0 if self._draw() else still + 1
            rate_if_seen = FRAMES_PER_S if still < _STILL_FRAMES else IDLE_FRAMES_PER_S
            due_s += 1 / (rate_if_seen if self._has_viewers() else SCENES_PER_S)
            # One late frame is caught up; more are skipped, since playback follows the clock.
            due_s = max(due_s, time.monotonic() - 1 / FRAMES_PER_S)
            self._stop.wait(max(0.0, due_s - time.monotonic()))

    def _draw(self) -> bool:
        now = time.monotonic()
        try:
            frame = self._stage.frame()
            moved = self._scene.draw(frame, now)
            # Not each phase: a fast show changes that in each frame.
            run = frame.run_id, frame.ended
            if run != self._published_run or now - self._published_s >= 1 / SCENES_PER_S:
                scene = scene_view(frame)
                if scene != self._published:
                    self._channel.publish("scene", scene)
                self._published, self._published_s, self._published_run = scene, now, run
        except Exception:
            # An error in one frame must not end the thread; it is logged once, not at each frame.
            if not self._has_failed:
                _logger.exception("drawing the stage failed, continuing")
            self._has_failed = True
            return False
        if self._has_failed:
            _logger.info("drawing the stage works again")
        self._has_failed = False
        return moved
