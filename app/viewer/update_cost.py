"""Benchmark of one update of the stage: time to draw it, and size of its frame for the hub."""

import asyncio
import contextlib
import statistics
import threading
import time

from app.assembly import build_walkers
from app.runs.config import LaneConfig, RaceConfig
from app.runs.racing import record_race
from app.stage.race_show import RaceShow
from app.stage.scene_spec import PAPERS_LANES, race_scene
from app.stage.show import RunLabel
from app.viewer.in_process import InProcessViser, in_process_viser
from app.viewer.scene import StageScene

_UPDATE_INTERVAL_S = 1 / 60
_QUIET_S = 0.5


def measure_stage_update(updates: int = 200) -> tuple[float, float]:
    """Measure the cost of one update with three walking robots.

    Args:
        updates: number of updates measured.

    Returns:
        median time of the drawing thread from the stage's frame to viser's queue [ms], and median
        size of the frames that viser's reader receives [bytes].
    """
    show = _walking_race()
    with in_process_viser() as server, _Receiver(server) as receiver:
        scene = StageScene(server)
        scene.draw(show.frame(RunLabel(None, "Race")), now=0.0)
        receiver.wait_until_quiet()
        elapsed_ms = []
        for number in range(1, updates + 1):
            started_s = time.perf_counter()
            show.seek(1.0 + 10.0 * number / updates)
            scene.draw(show.frame(RunLabel(None, "Race")), now=number * _UPDATE_INTERVAL_S)
            elapsed_ms.append(1000 * (time.perf_counter() - started_s))
            time.sleep(_UPDATE_INTERVAL_S)
        receiver.wait_until_quiet()
        sizes = receiver.sizes[-updates:]
    return statistics.median(elapsed_ms), statistics.median(sizes)


def _walking_race() -> RaceShow:
    """Return a race without thinking times, so that every robot moves in every frame."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(gait="left-right-origin", simulator="kinematic", lanes=lanes)
    walkers = build_walkers(config, [None] * len(lanes))
    recorded = list(record_race(walkers, config, time.perf_counter))[-1]
    show = RaceShow(race_scene(config), config.steps, "free", lambda: recorded)
    show.advance(0.0, None, run_ended=True)
    return show


class _Receiver:
    """A reader of viser's stream that records the size of each frame."""

    def __init__(self, server: InProcessViser) -> None:
        self.sizes: list[int] = []
        self._server = server
        self._loop = asyncio.new_event_loop()
        self._receiving = self._loop.create_task(self._receive())
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "_Receiver":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._receiving.cancel)
        self._thread.join()

    def wait_until_quiet(self) -> None:
        """Wait until no frame has arrived for `_QUIET_S`."""
        before = -1
        while before != len(self.sizes):
            before = len(self.sizes)
            time.sleep(_QUIET_S)

    def _run(self) -> None:
        with contextlib.suppress(asyncio.CancelledError):
            self._loop.run_until_complete(self._receiving)
        self._loop.close()

    async def _receive(self) -> None:
        async with contextlib.aclosing(self._server.frames()) as frames:
            async for frame in frames:
                self.sizes.append(len(frame))
