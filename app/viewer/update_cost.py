"""What one update of the stage costs, as the hub sees it."""

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

_BETWEEN_S = 1 / 60
_SETTLED_S = 0.5


def measure_stage_update(updates: int = 200) -> tuple[float, float]:
    """Milliseconds to make, and bytes to send, one update with three robots that walk.

    Each is the median over updates that viser's reader receives; the time is that of
    the drawing thread from the stage's frame to viser's queue.

    Args:
        updates: how many are measured.
    """
    show = _walking_show()
    with in_process_viser() as server, _Receiver(server) as receiver:
        scene = StageScene(server)
        scene.draw(show.frame(RunLabel(None, "Race")), now=0.0)
        receiver.wait_until_quiet()
        spent_ms = []
        for number in range(1, updates + 1):
            began = time.perf_counter()
            show.seek(1.0 + 10.0 * number / updates)
            scene.draw(show.frame(RunLabel(None, "Race")), now=number * _BETWEEN_S)
            spent_ms.append(1000 * (time.perf_counter() - began))
            time.sleep(_BETWEEN_S)
        receiver.wait_until_quiet()
        sizes = receiver.sizes[-updates:]
    return statistics.median(spent_ms), statistics.median(sizes)


def _walking_show() -> RaceShow:
    """A race without thinking, so that every robot moves in every frame."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(gait="left-right-origin", simulator="kinematic", lanes=lanes)
    walkers = build_walkers(config, [None] * len(lanes))
    recorded = list(record_race(walkers, config, time.perf_counter))[-1]
    show = RaceShow(race_scene(config), config.steps, "free", lambda: recorded)
    show.advance(0.0, None, run_ended=True)
    return show


class _Receiver:
    """A reader of viser's stream that only counts what it gets."""

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
        """Wait until nothing has come for a while."""
        before = -1
        while before != len(self.sizes):
            before = len(self.sizes)
            time.sleep(_SETTLED_S)

    def _run(self) -> None:
        with contextlib.suppress(asyncio.CancelledError):
            self._loop.run_until_complete(self._receiving)
        self._loop.close()

    async def _receive(self) -> None:
        async with contextlib.aclosing(self._server.frames()) as frames:
            async for frame in frames:
                self.sizes.append(len(frame))
