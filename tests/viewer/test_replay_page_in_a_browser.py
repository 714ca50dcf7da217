"""The page that replays a run without a server, in a browser without a network."""

import io
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, ConsoleMessage, Frame, FrameLocator, Page, expect

from tests.cli.running import ROOT
from tests.exports.test_replay_page import page_of
from tests.stage.stage_parts import StageParts
from tests.viewer.test_replay_frames import LANES, frames_of

EXPORTS = ROOT / "docs" / "exports.md"
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
        addresses = [url.split("?")[0] for url in requested if url.startswith("file:")]
        files = {address.rsplit("/")[-1] for address in addresses}
        assert files == {"race.html", "host.html"}


@pytest.fixture
def race_file(parts: StageParts, tmp_path: Path) -> Path:
    file = tmp_path / "race.html"
    run = parts.finished_race(LANES)
    file.write_text(page_of(frames_of(parts), run.id, clocks=("paper", "free")))
    return file


def state_of(page: Page) -> dict[str, Any]:
    state: dict[str, Any] = page.evaluate(
        "() => ({ time: hexapods.time_s, end: hexapods.duration_s, paused: hexapods.paused })"
    )
    return state


def view_in(page: Page | FrameLocator) -> FrameLocator:
    """Return the 3D view, which the page of a file has in a frame while it is in sight."""
    return page.frame_locator("iframe.view")


def frame_of_view(page: Page) -> Frame:
    """Return the same, as a frame in which scripts run."""
    return page.frames[-1]


def colours(frame: Frame) -> int:
    """Return how many colours the picture has, in a grid of its pixels."""
    count: int = frame.evaluate(
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
    label = view_in(offline).locator(".labels > div", has_text="Greedy")
    expect(label).to_be_visible(timeout=60_000)
    assert colours(frame_of_view(offline)) > 50, "the robots are not drawn"
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
    offline.get_by_label("Clock").select_option("no clock")
    assert state_of(offline)["time"] == state_of(offline)["end"] < state["end"]
    offline.get_by_label("Clock").select_option("paper clock")

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
    label = view_in(frame).locator(".labels > div", has_text="Greedy")
    expect(label).to_be_visible(timeout=60_000)
    for message in (
        {
            "type": "hexapods:draw",
            "messages": [{"type": "RemoveSceneNodeMessage", "name": "/world"}],
        },
        {"type": "hexapods:show", "theme": "dark", "covered": "everything"},
        {"type": "hexapods:seek", "time_s": "now", "id": "when"},
        {"type": "hexapods:open"},
        None,
    ):
        offline.evaluate("message => say(message)", message)
    offline.evaluate("say({ type: 'hexapods:seek', time_s: 1.5 })")
    expect(frame.locator(".clock")).to_contain_text("1.5 of")
    expect(label).to_be_visible()
    message_heard = offline.evaluate("heard.findLast(({ type }) => type === 'hexapods:timeupdate')")
    assert (message_heard["time_s"], message_heard["paused"]) == (1.5, True)
    answered = offline.evaluate("heard.find(({ id }) => id === 'when')")
    assert answered["error"] == 'time_s must be a number, not "now"'
    offline.evaluate("say({ type: 'hexapods:state', id: 8 })")
    offline.wait_for_function("heard.find(({ id, clock }) => id === 8 && clock === 'paper')")
    offline.evaluate("say({ type: 'hexapods:play' })")
    expect(frame.get_by_role("button", name="Pause")).to_be_visible()
    offline.evaluate("say({ type: 'hexapods:pause' })")
    expect(frame.get_by_role("button", name="Play")).to_be_visible()
    assert {message["type"] for message in offline.evaluate("heard")} == {
        "hexapods:ready",
        "hexapods:timeupdate",
        "hexapods:state",
        "hexapods:error",
    }


def test_a_script_of_a_foreign_page_sets_camera_and_moment(offline: Page, race_file: Path) -> None:
    host = race_file.with_name("host.html")
    address = "race.html?t=noon&clock=free&follow=2&position=0.5,-0.3,0.4&look_at=0,0.1,0.1"
    host.write_text(HOST.replace("race.html", address))
    offline.goto(host.as_uri())
    frame = offline.frame_locator("iframe")
    sentence = 't must be a number, not "noon" (in the address)'
    expect(frame.get_by_role("alert")).to_have_text(sentence)
    expect(frame.get_by_text("Times: no clock.")).to_be_visible()
    wait_until(lambda: bool(offline.frames[1].evaluate("hexapods.view.isLive")))
    assert offline.evaluate("heard.find(({ error }) => error).error") == sentence
    assert offline.evaluate("heard.find(({ follow }) => follow).follow") == "2"
    inside = frame_of_view(offline)

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

    wait_until(lambda: near(camera()[0], [0.5, -0.3, 0.4]) and near(camera()[1], [0, 0.1, 0.1]))
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


def test_of_eighteen_views_on_a_page_those_in_sight_are_drawn(
    offline: Page, race_file: Path
) -> None:
    """Browsers keep 16 WebGL contexts for a page, with all its frames."""
    frame = '<iframe src="race.html" sandbox="allow-scripts" width="320" height="200"></iframe>'
    host = race_file.with_name("host.html")
    host.write_text(f"<!doctype html><body style='margin:0; line-height:0'>{18 * frame}")
    offline.set_viewport_size({"width": 330, "height": 420})
    offline.goto(host.as_uri())
    views = [frame for frame in offline.frames if frame.url.endswith("race.html")]
    assert len(views) == 18

    def is_live(view: Frame) -> bool:
        return bool(view.evaluate("window.hexapods?.view.isLive ?? false"))

    # Down to the end, and back to the first, which have been drawn before.
    for first in (0, 16, 0):
        scroll = "first => document.querySelectorAll('iframe')[first].scrollIntoView()"
        offline.evaluate(scroll, first)
        in_sight = views[first : first + 2]
        wait_until(lambda: all(is_live(view) for view in in_sight))  # noqa: B023  # waited for here
        picture = np.asarray(Image.open(io.BytesIO(offline.screenshot())).convert("RGB"))
        for half in np.split(picture[: len(picture) // 4 * 4], 2):
            assert len(np.unique(half.reshape(-1, 3), axis=0)) > 200, "a view in sight is blank"
    wait_until(lambda: sum(map(is_live, views)) <= 3)  # whole numbers
    assert views[17].evaluate("document.querySelector('.poster').hidden"), "its picture is kept"


def test_where_no_script_may_run_there_is_a_picture(flat_browser: Browser, race_file: Path) -> None:
    host = race_file.with_name("host.html")
    host.write_text(HOST.replace('sandbox="allow-scripts"', "sandbox"))
    page = flat_browser.new_page()
    page.goto(host.as_uri())
    frame = page.frame_locator("iframe")
    picture = frame.get_by_role("img", name=re.compile("^At the time-out: .*Greedy 0"))
    expect(picture).to_be_visible()
    assert picture.evaluate("image => image.naturalWidth") == 800
    expect(frame.get_by_text("it plays where scripts may run")).to_be_visible()
    page.close()


def test_the_documented_page_around_it_is_told_the_moment_and_what_is_not_valid(
    flat_browser: Browser, race_file: Path
) -> None:
    [block] = re.findall(
        r"^```html\n(.*?)^```$", EXPORTS.read_text("utf-8"), re.MULTILINE | re.DOTALL
    )
    host = race_file.with_name("host.html")
    host.write_text(block)
    page, lines = flat_browser.new_page(), list[str]()
    page.on("console", lambda message: lines.append(message.text))
    page.goto(host.as_uri())
    frame = page.frame_locator("iframe")
    expect(frame.get_by_text("This browser draws no 3D here")).to_be_visible()
    expect(frame.get_by_role("img", name=re.compile("Greedy"))).to_be_visible()
    wait_until(lambda: "4.5 false" in lines)
    assert '1 time_s must be a number, not "noon"' in lines
    assert frame.get_by_role("alert").count() == 0
    page.close()


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
        AssertionError: after 60 s.
    """
    deadline = time.monotonic() + 60
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.1)
