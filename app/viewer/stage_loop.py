"""The thread that keeps the picture moving."""

import logging
import threading
import time

from app.events.bus import EventBus
from app.stage.stage import Stage
from app.viewer.scene import StageScene

FRAMES_PER_S, IDLE_FRAMES_PER_S, SCENES_PER_S = 30.0, 10.0, 5.0
_STILL_FRAMES = 15
"""A pause between two steps is no reason to go slower."""

_logger = logging.getLogger(__name__)


class StageLoop:
    """Draws the stage 30 times a second, and tells the page what is on it five times.

    `with loop:` runs it. While nothing moves it goes slower and says nothing.
    """

    def __init__(self, stage: Stage, scene: StageScene, bus: EventBus) -> None:
        self._stage, self._scene, self._bus = stage, scene, bus
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stage", daemon=True)
        self._told: dict[str, object] | None = None
        self._told_s = -1.0
        self._failing = False

    def start(self) -> None:
        """Begin; once only."""
        self._thread.start()

    def stop(self) -> None:
        """End, and wait for it. May be called twice, or without a start."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def __enter__(self) -> "StageLoop":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _run(self) -> None:
        due_s, still = time.monotonic(), 0
        while not self._stop.is_set():
            still = 0 if self._draw() else still + 1
            due_s += 1 / (FRAMES_PER_S if still < _STILL_FRAMES else IDLE_FRAMES_PER_S)
            # One late frame is made up for; more are left out, the show goes by the clock anyway.
            due_s = max(due_s, time.monotonic() - 1 / FRAMES_PER_S)
            self._stop.wait(max(0.0, due_s - time.monotonic()))

    def _draw(self) -> bool:
        now = time.monotonic()
        try:
            frame = self._stage.frame()
            moved = self._scene.draw(frame, now)
            if now - self._told_s >= 1 / SCENES_PER_S:
                scene = frame.scene()
                if scene != self._told:
                    self._bus.publish("scene", scene)
                self._told, self._told_s = scene, now
        except Exception:
            # A fault in one frame must not end the show; but say it once, not 30 times a second.
            if not self._failing:
                _logger.exception("drawing the stage failed, going on")
            self._failing = True
            return False
        if self._failing:
            _logger.info("drawing the stage works again")
        self._failing = False
        return moved
