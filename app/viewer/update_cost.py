"""Benchmark of one update of the stage: time to draw it, and size of its frame for the hub."""

import asyncio
import contextlib
import statistics
import time
from collections.abc import Callable

from hexapods.assembly import build_walkers
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.server import InProcessViser, in_process_viser
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.shows.race_show import RaceShow
from hexapods.shows.scene_spec import PAPERS_LANES, race_scene
from hexapods.shows.show import RunLabel

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
    with in_process_viser() as server:
        elapsed_ms, sizes = asyncio.run(_draw_and_receive(server, _walking_race(), updates))
    return statistics.median(elapsed_ms), statistics.median(sizes[-updates:])


async def _draw_and_receive(
    server: InProcessViser, show: RaceShow, updates: int
) -> tuple[list[float], list[int]]:
    """Return the time of each update [ms], and the size of each received frame [bytes]."""
    sizes: list[int] = []
    receiving = asyncio.create_task(_receive(server, sizes.append))
    elapsed_ms = await asyncio.to_thread(_draw, server, show, updates, sizes)
    receiving.cancel()
    await asyncio.gather(receiving, return_exceptions=True)
    return elapsed_ms, sizes


async def _receive(server: InProcessViser, on_size: Callable[[int], None]) -> None:
    async with contextlib.aclosing(server.frames()) as frames:
        async for frame in frames:
            on_size(len(frame))


def _draw(server: InProcessViser, show: RaceShow, updates: int, sizes: list[int]) -> list[float]:
    scene = StageScene(server)
    scene.draw(show.frame(RunLabel(None, "Race")), now=0.0)
    _wait_until_quiet(sizes)
    elapsed_ms = []
    for number in range(1, updates + 1):
        started_s = time.perf_counter()
        show.seek(1.0 + 10.0 * number / updates)
        scene.draw(show.frame(RunLabel(None, "Race")), now=number * _UPDATE_INTERVAL_S)
        elapsed_ms.append(1000 * (time.perf_counter() - started_s))
        time.sleep(_UPDATE_INTERVAL_S)
    _wait_until_quiet(sizes)
    return elapsed_ms


def _wait_until_quiet(sizes: list[int]) -> None:
    """Wait until no frame has arrived for `_QUIET_S`."""
    before = -1
    while before != len(sizes):
        before = len(sizes)
        time.sleep(_QUIET_S)


def _walking_race() -> RaceShow:
    """Return a race without thinking times, so that every robot moves in every frame."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(gait="left-right-origin", simulator="kinematic", lanes=lanes)
    walkers = build_walkers(config, [None] * len(lanes))
    recorded = list(record_race(walkers, config, time.perf_counter))[-1]
    show = RaceShow(race_scene(config), config.steps, "free", lambda: recorded)
    show.advance(0.0, None, run_ended=True)
    return show
