"""The drawing thread: start, stop, errors while drawing, published scenes."""

import asyncio
import json
import logging
import threading
import time
from typing import Any

import pytest

from app.events.bus import Channel, EventBus
from app.stage.stage import Stage
from app.viewer.stage_loop import IDLE_FRAMES_PER_S, StageLoop
from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.server import in_process_viser
from hexapods.shows.stage_frame import StageFrame
from tests.stage.stage_parts import StageParts
from tests.viewer.serving import wait_until


class FailingScene(StageScene):
    """A scene that raises in its first frames."""

    failures = 3

    def draw(self, frame: StageFrame, now: float = 0.0) -> bool:
        if self.failures:
            self.failures -= 1
            raise RuntimeError("a fault in a frame")
        return super().draw(frame, now)


class CountingScene(StageScene):
    """A scene that counts its frames."""

    frames = 0

    def draw(self, frame: StageFrame, now: float = 0.0) -> bool:
        self.frames += 1
        return super().draw(frame, now)


def test_loop_draws_within_its_block(parts: StageParts) -> None:
    before = set(threading.enumerate())  # a server of other tests may draw its own stage
    with in_process_viser() as server:
        scene = StageScene(server)
        with StageLoop(parts.stage, scene, Channel(EventBus()), lambda: True):
            wait_until(lambda: scene.follow_position("leader"))

    assert "stage" not in {thread.name for thread in {*threading.enumerate()} - before}


def test_error_in_a_frame_is_logged_once_and_drawing_continues(
    caplog: pytest.LogCaptureFixture, parts: StageParts
) -> None:
    with in_process_viser() as server, caplog.at_level(logging.INFO):
        scene = FailingScene(server)
        with StageLoop(parts.stage, scene, Channel(EventBus()), lambda: True):
            wait_until(lambda: scene.follow_position("leader"))

    messages = [record.message for record in caplog.records if "stage" in record.name]
    assert messages == ["drawing the stage failed, continuing", "drawing the stage works again"]


def test_moving_race_publishes_scenes(parts: StageParts) -> None:
    run = parts.finished_race()
    stage = Stage(parts.store, parts.recordings, parts.channel)
    stage.set(run_id=run.id)

    async def first_scenes() -> list[dict[str, Any]]:
        events, scenes = parts.bus.subscribe(), []
        async for event in events:
            if event.event == "scene":
                scenes.append(json.loads(event.data))
            if len(scenes) == 3:
                events.close()
        return scenes

    with in_process_viser() as server:
        scene = StageScene(server)
        with StageLoop(stage, scene, parts.channel, lambda: True):
            scenes = asyncio.run(first_scenes())
            wait_until(lambda: (scene.follow_position("1") or (0, 0))[1] > 0.001)

    assert [scene["run_id"] for scene in scenes] == [run.id] * 3
    times = [scene["time_s"] for scene in scenes]
    assert times == sorted(times)
    assert len(set(times)) == 3


def test_end_of_a_show_is_published_at_once(
    monkeypatch: pytest.MonkeyPatch, parts: StageParts
) -> None:
    monkeypatch.setattr("app.viewer.stage_loop.SCENES_PER_S", 1e-3)
    run = parts.finished_race()
    stage = Stage(parts.store, parts.recordings, parts.channel)
    stage.set(run_id=run.id, speed=8.0)

    async def scenes_until_the_end() -> list[tuple[str, str]]:
        events, scenes = parts.bus.subscribe(names=frozenset({"scene"})), []
        async for event in events:
            scene = json.loads(event.data)
            scenes.append((scene["run_id"], scene["phase"]))
            if scene["ended"]:
                events.close()
        return scenes

    with (
        in_process_viser() as server,
        StageLoop(stage, StageScene(server), parts.channel, lambda: True),
    ):
        scenes = asyncio.run(asyncio.wait_for(scenes_until_the_end(), 30))

    assert scenes[-1] == (run.id, "photo-finish")
    assert len(scenes) <= 2


def test_without_viewers_a_motion_is_drawn_at_the_rate_of_stillness(parts: StageParts) -> None:
    run = parts.finished_race()
    stage = Stage(parts.store, parts.recordings, parts.channel)
    stage.set(run_id=run.id)
    with in_process_viser() as server:
        scene = CountingScene(server)
        began = time.monotonic()
        with StageLoop(stage, scene, parts.channel, lambda: False):
            wait_until(lambda: (scene.follow_position("1") or (0, 0))[1] > 0.001)
        # With one frame at the start, and one that is caught up.
        assert scene.frames <= (time.monotonic() - began) * IDLE_FRAMES_PER_S + 2
