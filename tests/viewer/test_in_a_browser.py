"""The viewer in a real browser, in a frame of a page that draws in it, with a real server."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, FloatRect, Frame, Page

from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import RecordedViser, recorded_viser
from tests.drawing.drawn_scene import frame_at_rest, race_of
from tests.drawing.test_scene import action_values
from tests.running_app import wait_until
from tests.viewer.viewer_host import draw, hosted_viewer, open_host, wait_for_node

FILLS = "/world/run/lane0/grid/others/fills"

CELL_PLACE = """([name, instance]) => {
    const { camera, canvas, nodeRefFromName } = window.__viserMutable;
    const { batched_positions } = window.__viserSceneTree.getState()[name].message.props;
    const { buffer, byteOffset, byteLength } = batched_positions;
    const floats = new Float32Array(buffer.slice(byteOffset, byteOffset + byteLength));
    const [x, y, z] = floats.slice(3 * instance, 3 * instance + 3);
    const { matrixWorld } = nodeRefFromName[name.slice(0, name.lastIndexOf("/"))];
    const at = camera.position.clone().set(x, y, z).applyMatrix4(matrixWorld).project(camera);
    return [((at.x + 1) / 2) * canvas.clientWidth, ((1 - at.y) / 2) * canvas.clientHeight];
}"""
"""Returns where an instance of a batch is in the picture [px]."""


class Stage:
    """A host of the viewer, and the viser server of which it draws what is drawn there."""

    def __init__(self, page: Page, viewer: Frame, server: RecordedViser, recording: Any) -> None:
        self.page, self.viewer, self.server = page, viewer, server
        self._recording = recording

    def update(self) -> None:
        """Draw in the viewer what has changed on the server."""
        draw(self.page, self._recording.take())

    def set_box(self, side: float) -> None:
        dimensions = (side, side, side)
        self.server.scene.add_box("/world/box", color=(255, 255, 255), dimensions=dimensions)
        self.update()

    def show(self, **wanted: Any) -> None:
        self.page.evaluate("wanted => show(wanted)", wanted)

    def received(self, type_: str) -> list[dict[str, Any]]:
        """Return the messages of the viewer to its host of a type."""
        return [message for message in self.page.evaluate("heard") if message.get("type") == type_]


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with hosted_viewer() as address:
        yield address


@pytest.fixture(scope="module")
def shared_stage(browser: Browser, address: str) -> Iterator[Stage]:
    """A host with its viewer; to load viser's client takes most of the time of these tests."""
    with (
        recorded_viser() as server,
        recorder(server) as recording,
        browser.new_context(device_scale_factor=0.5) as context,
    ):
        page = context.new_page()
        viewer = open_host(page, address)
        server.scene.add_frame("/world", show_axes=False)
        yield Stage(page, viewer, server, recording)


@pytest.fixture
def stage(shared_stage: Stage) -> Iterator[Stage]:
    """The shared host with one box, as it is at first."""
    shared_stage.set_box(2)
    wait_for_node(shared_stage.viewer, "/world/box")
    shared_stage.show(theme="dark", lanes=[], covered=[])
    shared_stage.page.evaluate("heard.length = 0")
    yield shared_stage
    shared_stage.server.scene.reset()
    shared_stage.server.scene.add_frame("/world", show_axes=False)
    shared_stage.update()


def drawn_pixels(frame: Frame) -> int:
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


def intersect(a: FloatRect, b: FloatRect) -> bool:
    return (
        a["x"] < b["x"] + b["width"]
        and b["x"] < a["x"] + a["width"]
        and a["y"] < b["y"] + b["height"]
        and b["y"] < a["y"] + a["height"]
    )


def test_picture_changes_with_what_is_drawn(stage: Stage) -> None:
    wait_until(lambda: drawn_pixels(stage.viewer) > 0)
    before = drawn_pixels(stage.viewer)

    stage.set_box(4)

    wait_until(lambda: drawn_pixels(stage.viewer) > 2 * before)


def test_only_the_scene_is_visible_in_the_theme_of_the_dashboard_which_gets_the_keys(
    stage: Stage,
) -> None:
    viewer = stage.viewer
    shown = viewer.evaluate(
        """() => [...document.querySelectorAll("#root *, body > *")]
            .filter((element) => element.checkVisibility() && element.innerText?.trim())
            .map((element) => element.outerHTML.slice(0, 200))"""
    )

    assert shown == []
    assert viewer.locator("[title='About Viser']").is_hidden()

    def background() -> str:
        return str(viewer.evaluate("getComputedStyle(document.documentElement).backgroundColor"))

    wait_until(lambda: background() == "rgb(11, 15, 20)")

    stage.show(theme="light")

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

    stage.page.locator("iframe").click()
    for key in (" ", "r", "3", "?", "Control+y", "ArrowUp", "Shift", "Escape"):
        stage.page.keyboard.press(key)

    stage.page.wait_for_function("heard.some((message) => message.key === 'Escape')")
    keys = stage.received("hexapods:key")
    assert [message["key"] for message in keys] == [" ", "r", "3", "?", "Escape"]
    assert keys[2] == {"type": "hexapods:key", "key": "3", "code": "Digit3", "shiftKey": False}


def test_labels_follow_the_theme_and_do_not_overlap(stage: Stage) -> None:
    camera, add_label = stage.server.initial_camera, stage.server.scene.add_label
    camera.position, camera.look_at = (0.0, 0.0, 6.0), (0.0, 0.0, 0.0)
    covered = {"left": 0, "top": 0, "right": 480, "bottom": 60}
    stage.show(lanes=["#E69F00"] * 6, covered=[covered])
    handles = [
        add_label(
            f"/world/lane{lane}/label",
            f"Robot {lane}\n0.10 m",
            position=(0.01 * lane, 0.0, 0.0),
            anchor="bottom-center",
        )
        for lane in range(6)
    ]
    add_label("/world/line", "Start", anchor="center-center")
    stage.update()
    labels = stage.viewer.locator(".labels > div:not([hidden])")
    wait_until(lambda: labels.count() >= 6)

    def boxes() -> list[FloatRect]:
        return [box for label in labels.all() if (box := label.bounding_box())]

    # In the frame, which is 8 px inside of its page.
    wait_until(lambda: all(box["y"] >= 68 for box in boxes()))
    assert [pair for pair in combinations(boxes(), 2) if intersect(*pair)] == []
    assert labels.first.evaluate("label => getComputedStyle(label).color") == "rgb(233, 237, 243)"

    handles[0].text = "Another"
    stage.update()
    wait_until(lambda: "Another" in labels.all_inner_texts())
    handles[0].remove()
    stage.update()
    wait_until(lambda: "Another" not in labels.all_inner_texts())


def test_robots_are_called_as_the_page_says(stage: Stage) -> None:
    for lane, x in enumerate((-0.5, 0.5)):
        stage.server.scene.add_label(
            f"/world/named/lane{lane}/label",
            f"{lane + 1}. TAMER\n0.10 m",
            position=(x, 0.0, 0.0),
            anchor="bottom-center",
        )
    stage.update()
    labels = stage.viewer.locator(".labels > div:not([hidden])")

    def names() -> set[str]:
        return {text.split("\n")[0] for text in labels.all_inner_texts()}

    wait_until(lambda: {"1. TAMER", "2. TAMER"} <= names())
    stage.show(names=["The class"])
    wait_until(lambda: {"1. The class", "2. TAMER"} <= names())
    stage.show(names=[])
    wait_until(lambda: {"1. TAMER", "2. TAMER"} <= names())
    stage.server.scene.remove_by_name("/world/named")
    stage.update()
    wait_until(lambda: not {"1. TAMER", "2. TAMER"} & names())


def test_leg_and_cell_that_are_clicked_are_told_to_the_host(stage: Stage) -> None:
    spec = race_of(1)
    lane = replace(frame_at_rest(spec).lanes[0], action_values=action_values(spec))
    stage.server.scene.remove_by_name("/world/box")
    StageScene(stage.server).draw(replace(frame_at_rest(spec), lanes=(lane,)))
    camera = stage.server.initial_camera
    camera.position, camera.look_at = (0.0, -0.01, 0.8), (0.0, 0.0, 0.0)
    stage.update()
    wait_for_node(stage.viewer, FILLS)

    stage.show(legsOf=0)
    stage.page.wait_for_function("heard.some(({ legs }) => legs?.length === 6)")
    feet = {leg["leg"]: leg for leg in stage.received("hexapods:legs")[-1]["legs"]}
    assert sorted(feet) == [1, 2, 3, 4, 5, 6]
    stage.show(legsOf=None)
    frame = stage.page.locator("iframe")
    frame.click(position={"x": feet[3]["x"], "y": feet[3]["y"]})
    stage.page.wait_for_function("heard.some(({ pick }) => pick)")
    pick = stage.received("hexapods:pick")[0]["pick"]
    assert (pick["lane"], pick["what"], pick["leg"]) == (0, "leg", 3)

    x, y = stage.viewer.evaluate(CELL_PLACE, [FILLS, 7])
    frame.click(position={"x": x, "y": y})
    stage.page.wait_for_function("heard.some(({ type }) => type === 'hexapods:click')")
    click = stage.received("hexapods:click")[-1]
    assert click == {"type": "hexapods:click", "node": FILLS, "instance": 7}


def test_foreign_pages_cannot_embed_the_viewer(address: str, browser: Browser) -> None:
    # The same server under another host name is another origin.
    foreign_address = f"http://localhost:{urlsplit(address).port}"
    with browser.new_context() as context:
        foreign = context.new_page()
        foreign.goto(f"{address}/empty")
        with foreign.expect_event("console", lambda said: "frame-ancestors" in said.text):
            foreign.evaluate(
                "address => { document.querySelector('iframe').src = address; }",
                f"{foreign_address}/viewer/",
            )


def test_messages_of_other_pages_are_ignored(stage: Stage, address: str) -> None:
    port = urlsplit(address).port
    for other_address in (address, f"http://localhost:{port}"):
        with stage.page.expect_popup() as opening:
            stage.page.evaluate("address => open(address)", f"{other_address}/empty")
        other = opening.value
        other.wait_for_load_state()
        other.evaluate("opener.frames[0].postMessage({type: 'hexapods:show', theme: 'light'}, '*')")
        other.close()
    # Messages arrive in order, so once this one has arrived, so have the others.
    stage.show(isProjected=True)
    root = stage.viewer.locator("html")
    wait_until(lambda: root.get_attribute("data-projected") is not None)

    assert root.get_attribute("data-theme") == "dark"
    stage.show(isProjected=False)


def test_viewer_that_is_opened_by_itself_goes_to_the_page(page: Page, address: str) -> None:
    page.goto(f"{address}/viewer/?theme=light")

    page.wait_for_url(f"{address}/")


def test_viewer_has_no_socket_and_requests_nothing_of_other_servers(
    page: Page, address: str
) -> None:
    requested: list[str] = []
    errors: list[str] = []
    said: list[str] = []
    page.on("request", lambda request: requested.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    # Playwright does not report websockets of a worker; viser's client announces them.
    page.on("console", lambda message: said.append(message.text))
    hostile = "websocket=ws://evil.example&playbackPath=https://evil.example/x"
    page.route(
        f"{address}/",
        lambda route, request: route.fulfill(
            response=(response := route.fetch()),
            body=response.text().replace("viewer/?", f"viewer/?{hostile}&"),
        ),
    )

    viewer = open_host(page, address)
    with recorded_viser() as server, recorder(server) as recording:
        server.scene.add_box("/world/box", dimensions=(1, 1, 1))
        draw(page, recording.take())
    wait_for_node(viewer, "/world/box")

    assert "evil" not in viewer.url
    own_addresses = (f"{address}/", f"blob:{address}/", "data:")
    assert [url for url in requested if not url.startswith(own_addresses)] == []
    assert [text for text in said if "Connecting to" in text] == []
    assert errors == []
