"""The page in a real browser, in an iframe of a dashboard, with a real server and a real viser."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import combinations
from typing import Any

import pytest
from playwright.sync_api import Browser, ConsoleMessage, FloatRect, Frame, Page
from starlette.responses import HTMLResponse
from starlette.routing import Route

from app.limits.client_slots import ClientSlots
from app.viewer.hub import Hub
from hexapods.drawing.track import Position
from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser
from tests.conftest import new_page
from tests.viewer.serving import ServedHub, Upstream, serving, start_viser, wait_until

DASHBOARD = """
<!doctype html>
<script>
  window.heard = [];
  addEventListener("message", ({ data }) => heard.push(data));
  const show = (wanted) =>
    document.querySelector("iframe").contentWindow
      .postMessage({ type: "hexapods:show", ...wanted }, location.origin);
</script>
<iframe src="viewer/?view=1&theme=dark" width="480" height="270"></iframe>
"""

POSITIONS: dict[str, Position] = {"1": (1.0, 0.5, 0.0), "2": (2.0, 0.0, 0.0)}


class Scene:
    """viser's scene with one box, and its stream to a hub."""

    def __init__(self, viser_server: InProcessViser) -> None:
        self.viser_server = viser_server
        self.upstream = Upstream(viser_server)
        self.set_box(2)

    def set_box(self, side: float) -> None:
        dimensions = (side, side, side)
        self.viser_server.scene.add_box("/world/box", color=(255, 255, 255), dimensions=dimensions)


@contextmanager
def serving_scene(scene: Scene) -> Iterator[ServedHub]:
    more_routes = [
        Route("/", lambda _: HTMLResponse(DASHBOARD)),
        Route("/empty", lambda _: HTMLResponse("<!doctype html><iframe></iframe>")),
    ]
    hub = Hub(scene.upstream.frames, follow_position=POSITIONS.get)
    with serving(hub, more_routes=more_routes) as served:
        yield served


@pytest.fixture
def served(viser_server: InProcessViser) -> Iterator[ServedHub]:
    with serving_scene(Scene(viser_server)) as served:
        yield served


@pytest.fixture(scope="module")
def scene() -> Iterator[Scene]:
    viser_server = start_viser()
    yield Scene(viser_server)
    viser_server.stop()


@pytest.fixture(scope="module")
def watched_hub(scene: Scene) -> Iterator[ServedHub]:
    """The hub whose viewers are those of `dashboard` alone."""
    with serving_scene(scene) as served:
        yield served


@pytest.fixture(scope="module")
def shared_page(browser: Browser, watched_hub: ServedHub) -> Iterator[Page]:
    """A dashboard with its viewer; to load viser's client takes most of the time of these tests."""
    with browser.new_context(device_scale_factor=0.5) as context:
        page = context.new_page()
        page.goto(f"http://{watched_hub.host}/")
        page.wait_for_function("heard.some((message) => message.status === 'connected')")
        wait_for_node(page.frames[1], "/world/box")
        yield page


@pytest.fixture
def dashboard(shared_page: Page, scene: Scene) -> Page:
    """The shared page as it is at first."""
    scene.set_box(2)
    shared_page.evaluate("show({ view: '1', theme: 'dark', lanes: [], covered: [] })")
    wait_until_centred_on(shared_page.frames[1], 1, 0.5)
    shared_page.evaluate("heard.length = 0")
    return shared_page


@pytest.fixture
def viewer(dashboard: Page) -> Frame:
    return dashboard.frames[1]


def wait_for_node(frame: Frame | Page, name: str) -> None:
    """Wait until viser's client has a scene node."""
    frame.wait_for_function("name => window.__viserSceneTree?.getState()[name]?.message", arg=name)


def wait_until_centred_on(frame: Frame, x: float, y: float) -> None:
    frame.wait_for_function(
        """([x, y]) => {
            const [a, b] = __viserMutable.nodePoseData["/world"]?.position ?? [];
            return a === -x && b === -y;
        }""",
        arg=[x, y],
    )


def drawn_pixels(frame: Frame | Page) -> int:
    """Return the number of opaque pixels of the canvas."""
    return int(
        frame.evaluate(
            """async () => {
                const canvas = document.querySelector("canvas[data-engine]");
                // A WebGL canvas can be read only before the browser composites the frame.
                await new Promise(requestAnimationFrame);
                __viserMutable.requestRender();
                await new Promise(requestAnimationFrame);
                const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
                copy.drawImage(canvas, 0, 0);
                const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
                let opaque = 0;
                for (let i = 3; i < data.length; i += 4) opaque += data[i] > 0;
                return opaque;
            }"""
        )
    )


def received_messages(dashboard: Page, type_: str) -> list[dict[str, Any]]:
    return [message for message in dashboard.evaluate("heard") if message.get("type") == type_]


def socket_addresses(page: Page) -> list[str]:
    """Return a growing list of websocket addresses, from viser's console messages.

    Playwright does not report websockets of a worker.
    """
    addresses: list[str] = []
    announcement = re.compile(r"Connecting to: (\S+) with protocol")

    def note(message: ConsoleMessage) -> None:
        if match := announcement.match(message.text):
            addresses.append(match[1])

    page.on("console", note)
    return addresses


def intersect(a: FloatRect, b: FloatRect) -> bool:
    return (
        a["x"] < b["x"] + b["width"]
        and b["x"] < a["x"] + a["width"]
        and a["y"] < b["y"] + b["height"]
        and b["y"] < a["y"] + a["height"]
    )


def test_picture_changes_with_the_scene(viewer: Frame, scene: Scene) -> None:
    wait_until(lambda: drawn_pixels(viewer) > 0)
    before = drawn_pixels(viewer)

    scene.set_box(4)

    wait_until(lambda: drawn_pixels(viewer) > 2 * before)


def test_only_the_scene_is_visible_in_the_theme_of_the_dashboard_which_gets_the_keys(
    dashboard: Page, viewer: Frame
) -> None:
    shown = viewer.evaluate(
        """() => [...document.querySelectorAll("#root *, body > *")]
            .filter((element) => element.checkVisibility() && element.innerText?.trim())
            .map((element) => element.outerHTML.slice(0, 200))"""
    )

    assert shown == []
    assert viewer.locator("[title='About Viser']").is_hidden()

    def background() -> str:
        return str(viewer.evaluate("getComputedStyle(document.documentElement).backgroundColor"))

    assert background() == "rgb(11, 15, 20)"

    dashboard.evaluate("show({ theme: 'light' })")

    wait_until(lambda: background() == "rgb(238, 241, 245)")
    opaque = viewer.evaluate(
        """() => {
            const opaque = [];
            for (let e = document.querySelector("canvas"); e !== document.documentElement;
                 e = e.parentElement)
                if (getComputedStyle(e).backgroundColor !== "rgba(0, 0, 0, 0)") opaque.push(e.id);
            return opaque;
        }"""
    )
    assert opaque == []

    dashboard.locator("iframe").click()
    for key in (" ", "r", "3", "?", "Control+y", "ArrowUp", "Shift", "Escape"):
        dashboard.keyboard.press(key)

    dashboard.wait_for_function("heard.some((message) => message.key === 'Escape')")
    keys = received_messages(dashboard, "hexapods:key")
    assert [message["key"] for message in keys] == [" ", "r", "3", "?", "Escape"]
    assert keys[2] == {"type": "hexapods:key", "key": "3", "code": "Digit3", "shiftKey": False}


def test_view_changes_without_a_reload_and_survives_a_reconnection(
    dashboard: Page, viewer: Frame, watched_hub: ServedHub, scene: Scene
) -> None:
    wait_until_centred_on(viewer, 1, 0.5)
    viewer.evaluate("window.sameDocument = true")

    dashboard.evaluate("show({ view: '2' })")

    wait_until_centred_on(viewer, 2, 0)
    assert viewer.evaluate("window.sameDocument")
    assert watched_hub.hub.counters.viewers == 1

    viewer.evaluate("__viserMutable.nodePoseData['/world'].position = [9, 9, 9]")
    dashboard.evaluate("heard.length = 0")

    # The hub loses viser, and then makes its viewers reconnect.
    scene.upstream.lose()

    dashboard.wait_for_function("heard.some((message) => message.status === 'connected')")
    wait_until_centred_on(viewer, 2, 0)
    statuses = [message["status"] for message in received_messages(dashboard, "hexapods:status")]
    assert statuses[0] == "reconnecting"


def test_labels_follow_the_theme_and_do_not_overlap(
    dashboard: Page, viewer: Frame, scene: Scene
) -> None:
    camera = scene.viser_server.initial_camera
    camera.position, camera.look_at = (1.0, 0.5, 6.0), (1.0, 0.5, 0.0)
    covered = {"left": 0, "top": 0, "right": 480, "bottom": 60}
    dashboard.evaluate("wanted => show(wanted)", {"lanes": ["#E69F00"] * 6, "covered": [covered]})
    add_label = scene.viser_server.scene.add_label
    handles = [
        add_label(
            f"/world/lane{lane}/label",
            f"Robot {lane}\n0.10 m",
            position=(1.0 + 0.01 * lane, 0.5, 0.0),
            anchor="bottom-center",
        )
        for lane in range(6)
    ]
    line = add_label("/world/line", "Start", anchor="center-center")
    labels = viewer.locator(".labels > div:not([hidden])")
    wait_until(lambda: labels.count() >= 6)

    def boxes() -> list[FloatRect]:
        return [box for label in labels.all() if (box := label.bounding_box())]

    # In the frame, which is 8 px inside of its page.
    wait_until(lambda: all(box["y"] >= 68 for box in boxes()))
    assert [pair for pair in combinations(boxes(), 2) if intersect(*pair)] == []
    assert labels.first.evaluate("one => getComputedStyle(one).color") == "rgb(233, 237, 243)"

    handles[0].text = "Another"
    wait_until(lambda: "Another" in labels.all_inner_texts())
    handles[0].remove()
    wait_until(lambda: "Another" not in labels.all_inner_texts())

    for label in (*handles[1:], line):
        label.remove()
    wait_until(lambda: labels.count() == 0)


def test_page_of_another_version_reloads_once(
    page: Page, served: ServedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    loads: list[str] = []
    page.on("load", lambda loaded: loads.append(loaded.url))
    attempts = socket_addresses(page)
    wait_until(lambda: served.hub.live)
    monkeypatch.setattr(stream, "SUBPROTOCOL", "viser-v999")

    page.goto(served.page)
    while len(loads) < 2 or len(attempts) < 4:
        page.wait_for_timeout(10)

    assert len(loads) == 2


@pytest.mark.parametrize(("places", "share", "status"), [(0, 5, "full"), (5, 0, "address full")])
def test_refusal_is_reported_to_the_dashboard(
    page: Page, viser_server: InProcessViser, places: int, share: int, status: str
) -> None:
    root = Route("/", lambda _: HTMLResponse(DASHBOARD))
    hub = Hub(viser_server.frames, slots=ClientSlots(places, share))
    with serving(hub, more_routes=[root]) as served:
        page.goto(f"http://{served.host}/")

        page.wait_for_function(f"heard.some((message) => message.status === '{status}')")


def test_foreign_pages_cannot_embed_the_viewer(served: ServedHub, browser: Browser) -> None:
    # The same server under another host name is another origin.
    with browser.new_context() as context:
        foreign = context.new_page()
        foreign.goto(f"http://{served.host}/empty")
        with foreign.expect_event("console", lambda said: "frame-ancestors" in said.text):
            foreign.evaluate(
                "address => { document.querySelector('iframe').src = address; }",
                f"http://localhost:{served.port}/viewer/",
            )
        assert served.hub.counters.viewers == 0


def test_messages_of_foreign_pages_are_ignored(page: Page, served: ServedHub) -> None:
    page.goto(f"http://{served.host}/empty")
    with page.expect_popup() as opening:
        page.evaluate(f"window.other = open('http://localhost:{served.port}/viewer/?view=2')")
    other = opening.value
    wait_for_node(other, "/world/box")
    page.evaluate("other.postMessage({ type: 'hexapods:show', theme: 'light' }, '*')")
    # Messages arrive in order, so once this one has arrived, so has the other.
    other.evaluate("addEventListener('message', () => { window.told = true; })")
    page.evaluate("other.postMessage(0, '*')")
    # Its content policy forbids the evaluation by which `wait_for_function` polls.
    wait_until(lambda: other.evaluate("window.told === true"))

    assert other.evaluate("document.documentElement.dataset.theme") is None


def test_all_requests_go_to_the_own_origin(page: Page, served: ServedHub) -> None:
    requested: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: requested.append(request.url))
    sockets = socket_addresses(page)
    page.on("pageerror", lambda error: errors.append(str(error)))

    page.goto(f"{served.page}?websocket=ws://evil.example&playbackPath=https://evil.example/x")
    wait_for_node(page, "/world/box")

    own_addresses = (f"http://{served.host}/", f"blob:http://{served.host}/", "data:")
    assert [url for url in requested if not url.startswith(own_addresses)] == []
    assert sockets == [f"ws://{served.host}/viewer/?view=leader"]
    assert errors == []
    page.reload()
    wait_for_node(page, "/world/box")


def test_an_attempt_to_connect_is_not_given_up_for_the_next_one(
    flat_browser: Browser, served: ServedHub
) -> None:
    """After a long outage browsers begin each attempt later than the client would begin anew."""
    script = """async () => {
      const lines = `const got = [];
        onmessage = ({ data: { type } }) => {
          if (type === "fail") postMessage({ type: "closed" });
          else if (type === "tell") postMessage({ type: "got", got });
          else got.push(type);
        };`;
      const worker = new Worker(URL.createObjectURL(new Blob([lines])));
      const answer = () => new Promise((resolve) => {
        worker.addEventListener("message", ({ data }) => resolve(data), { once: true });
      });
      const post = (...types) => types.forEach((type) => worker.postMessage({ type }));
      post("set_server", "retry", "retry", "fail");
      await answer();
      post("retry", "retry", "tell");
      return (await answer()).got;
    }"""
    with new_page(flat_browser) as page:
        page.goto(served.page)
        # The page itself may say meanwhile which stage it follows.
        attempts = [
            message_type for message_type in page.evaluate(script) if message_type != "send"
        ]
        assert attempts == ["set_server", "retry"]
