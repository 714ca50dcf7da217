"""The page that replays a run without a server, in a browser without a network."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, expect

from tests.exports.test_replay_page import page_of
from tests.stage.stage_parts import StageParts
from tests.viewer.test_replay_frames import LANES, frames_of

HOST = """<!doctype html>
<script>
  window.heard = [];
  addEventListener("message", ({ data }) => heard.push(data));
  const say = (message) => document.querySelector("iframe").contentWindow.postMessage(message, "*");
</script>
<iframe src="race.html" sandbox="allow-scripts" width="640" height="400"></iframe>
"""


@pytest.fixture
def offline(browser: Browser) -> Iterator[Page]:
    """A tab without a network, which fails the test if it asked for anything else."""
    with browser.new_context(offline=True, device_scale_factor=0.5) as context:
        page = context.new_page()
        complaints, requested = list[str](), list[str]()
        page.on("pageerror", lambda error: complaints.append(str(error)))

        def on_console(message: ConsoleMessage) -> None:
            if message.type == "error":
                complaints.append(message.text)

        page.on("console", on_console)
        page.on("request", lambda request: requested.append(request.url))
        yield page
        assert complaints == []
        assert {url.split(":")[0] for url in requested} <= {"file", "blob", "data"}
        files = {url.rsplit("/")[-1] for url in requested if url.startswith("file:")}
        assert files == {"race.html", "host.html"}


@pytest.fixture
def race_file(parts: StageParts, tmp_path: Path) -> Path:
    file = tmp_path / "race.html"
    file.write_text(page_of(frames_of(parts), parts.finished_race(LANES).id))
    return file


def state_of(page: Page) -> dict[str, Any]:
    state: dict[str, Any] = page.evaluate(
        "() => ({ time: hexapods.time_s, end: hexapods.duration_s, paused: hexapods.paused })"
    )
    return state


def colours(page: Page) -> int:
    """Return how many colours the picture has, in a grid of its pixels."""
    count: int = page.evaluate(
        """() => new Promise((resolve) => {
          const { canvas, scene, requestRender } = window.__viserMutable;
          const place = scene.onAfterRender;
          scene.onAfterRender = (...all) => {
            place(...all);
            scene.onAfterRender = place;
            const copy = new OffscreenCanvas(64, 48).getContext("2d");
            copy.drawImage(canvas, 0, 0, 64, 48);
            const { data } = copy.getImageData(0, 0, 64, 48);
            const seen = new Set();
            for (let at = 0; at < data.length; at += 4) seen.add(data.slice(at, at + 3).join());
            resolve(seen.size);
          };
          requestRender();
        })"""
    )
    return count


def test_a_race_plays_from_its_file_and_in_a_foreign_page(offline: Page, race_file: Path) -> None:
    offline.goto(race_file.as_uri())
    player = offline.locator(".player")
    expect(player).to_be_visible(timeout=60_000)
    expect(offline.locator(".labels > div", has_text="Greedy")).to_be_visible(timeout=60_000)
    assert colours(offline) > 50, "the robots are not drawn"
    label = offline.locator(".labels > div", has_text="Greedy")
    expect(label).to_contain_text("0.00 m")

    offline.evaluate("hexapods.heard = 0")
    offline.evaluate("hexapods.addEventListener('timeupdate', () => (hexapods.heard += 1))")
    offline.evaluate("hexapods.seek(hexapods.duration_s)")
    expect(label).not_to_contain_text("0.00 m")
    state = state_of(offline)
    assert (state["time"], state["paused"]) == (state["end"], True)
    assert offline.evaluate("hexapods.heard") == 1
    moment = offline.get_by_label("Moment of the run").input_value()
    assert float(moment) == pytest.approx(state["end"])

    offline.get_by_role("button", name="One robot step back").click()
    assert state_of(offline)["time"] < state["end"]
    offline.get_by_label("Speed").select_option("16")
    offline.get_by_role("button", name="Play").click()
    expect(offline.get_by_role("button", name="Play")).to_be_visible(timeout=30_000)
    assert state_of(offline)["time"] == state["end"], "it plays to its end, and holds there"
    offline.evaluate("hexapods.seek(NaN); hexapods.setSpeed(-1); hexapods.seek(-5)")
    assert state_of(offline)["time"] == 0

    host = race_file.with_name("host.html")
    host.write_text(HOST)
    offline.goto(host.as_uri())
    frame = offline.frame_locator("iframe")
    expect(frame.locator(".player")).to_be_visible(timeout=60_000)
    label = frame.locator(".labels > div", has_text="Greedy")
    expect(label).to_be_visible(timeout=60_000)
    for message in (
        {
            "type": "hexapods:draw",
            "messages": [{"type": "RemoveSceneNodeMessage", "name": "/world"}],
        },
        {"type": "hexapods:show", "theme": "dark", "covered": "everything"},
        {"type": "hexapods:seek", "time_s": "now"},
        {"type": "hexapods:open"},
        None,
    ):
        offline.evaluate("message => say(message)", message)
    offline.evaluate("say({ type: 'hexapods:seek', time_s: 1.5 })")
    expect(frame.locator(".clock")).to_contain_text("1.5 of")
    expect(label).to_be_visible()
    message_heard = offline.evaluate("heard.findLast(({ type }) => type === 'hexapods:timeupdate')")
    assert (message_heard["time_s"], message_heard["paused"]) == (1.5, True)
    offline.evaluate("say({ type: 'hexapods:play' })")
    expect(frame.get_by_role("button", name="Pause")).to_be_visible()
    offline.evaluate("say({ type: 'hexapods:pause' })")
    expect(frame.get_by_role("button", name="Play")).to_be_visible()
    assert {message["type"] for message in offline.evaluate("heard")} == {
        "hexapods:ready",
        "hexapods:timeupdate",
    }


def test_a_script_of_a_foreign_page_sets_camera_and_moment(offline: Page, race_file: Path) -> None:
    host = race_file.with_name("host.html")
    host.write_text(HOST)
    offline.goto(host.as_uri())
    frame = offline.frame_locator("iframe")
    expect(frame.locator(".labels > div", has_text="Greedy")).to_be_visible(timeout=60_000)
    inside = offline.frames[1]

    def camera() -> list[list[float]]:
        """Return the camera's place and what it looks at, x right, y along the track, z up."""
        # The client's y is up, and its x is against the track.
        place: list[list[float]] = inside.evaluate(
            """() => {
              const { camera, cameraControl } = window.__viserMutable;
              const target = camera.position.clone();
              cameraControl.getTarget(target);
              return [camera.position, target].map(({ x, y, z }) => [-z, -x, y]);
            }"""
        )
        return place

    def centre() -> list[float]:
        """Return where the world is moved, so that what the camera follows is in the middle."""
        place: list[float] = inside.evaluate(
            "() => [...window.__viserMutable.nodePoseData['/world'].position].slice(0, 2)"
        )
        return place

    def say(**message: Any) -> None:
        offline.evaluate("message => say(message)", {"type": "hexapods:camera", **message})

    def near(first: list[float], second: list[float]) -> bool:
        return bool(np.abs(np.subtract(first, second)).max() < 1e-4)

    place, target = [0.6, -0.4, 0.3], [0.0, 0.1, 0.05]
    say(position=place, look_at=target)
    wait_until(lambda: near(camera()[0], place) and near(camera()[1], target))
    for message in (
        {"position": [0, 0]},
        {"position": [0, 0, "1"]},
        {"position": [0, 0, 1e9]},
        {"position": [1, 1, 1], "look_at": [1, 1, 1]},
        {"position": [0, 0, 2], "follow": "nobody"},
        {"look_at": None},
        {"follow": 99},
    ):
        say(**message)
    say(position=[0.5, -0.4, 0.3])
    wait_until(lambda: near(camera()[0], [0.5, -0.4, 0.3]))
    assert near(camera()[1], target), "none of the messages that are not valid had an effect"

    offline.evaluate("say({ type: 'hexapods:seek', time_s: 3 })")
    expect(frame.locator(".clock")).to_contain_text("3.0 of")
    say(follow=1)
    first = settled(centre)
    say(follow=2)
    wait_until(lambda: abs(centre()[0] - first[0]) > 0.3)
    assert near(camera()[1], target), "it looks at the same place beside what it follows"
    second = centre()
    say(follow="free")
    offline.evaluate("say({ type: 'hexapods:seek', time_s: 1 })")
    expect(frame.locator(".clock")).to_contain_text("1.0 of")
    assert near(centre(), second)


def settled(measure: Callable[[], list[float]]) -> list[float]:
    """Return a measure once it stays the same for some pictures."""
    before = measure()
    while True:
        time.sleep(0.3)
        now = measure()
        if now == before:
            return now
        before = now


def wait_until(is_so: Callable[[], bool]) -> None:
    """Wait until something is so.

    Raises:
        AssertionError: after 20 s.
    """
    deadline = time.monotonic() + 20
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.1)
