"""The server goes away and comes back; a proxy holds streams back."""

import http.client
import re
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving

pytestmark = pytest.mark.timeout(300)


@pytest.mark.looks_at_3d
def test_the_last_picture_stays_until_it_is_back(dashboard: Dashboard, tmp_path: Path) -> None:
    page = dashboard.page
    first = Serving(tmp_path)
    dashboard.open(first.link(depth="try", steps=2000, pace=1))
    dashboard.primary.click()
    left = dashboard.actions.get_by_text(re.compile(r"\d (s|min) left"))
    expect(left).to_be_visible()
    expect(page.locator(".time-bar .play")).to_be_visible()
    port = first.port
    first.kill()

    expect(page.get_by_text("Reconnecting. This is the last picture.")).to_be_visible()
    expect(dashboard.connection).to_have_text("reconnecting")
    expect(dashboard.view.locator("canvas").first).to_be_visible()
    # What went on may have ended, and nothing acts.
    expect(dashboard.actions).to_contain_text("Last known: practising")
    expect(dashboard.actions).to_contain_text("until the server is back")
    expect(left).to_have_count(0)
    expect(dashboard.panel).to_contain_text("This is the last that is known.")
    for button in (dashboard.button("Stop"), page.locator(".time-bar .play")):
        expect(button).to_have_attribute("aria-disabled", "true")
    assert dashboard.violations() == []
    # Without an answer the browser says so by itself, and cannot be kept from it.
    dashboard.complaints.clear()

    with serving(tmp_path, port, token="for-the-operator", spectators="token"):
        expect(page.get_by_role("heading", name="This page needs a link")).to_be_visible()
    dashboard.complaints.clear()

    with serving(tmp_path, port):
        expect(dashboard.connection).to_contain_text("connected")
        expect(page.get_by_text("Reconnecting.")).to_have_count(0)
        dashboard.wait_for_stage()
        dashboard.complaints.clear()


def test_what_could_not_be_loaded_is_loaded_when_it_is_back(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    page = dashboard.page
    first = Serving(tmp_path, token="for-the-operator")
    page.route("**/spectators.js", lambda route: route.abort())
    with page.expect_event("requestfailed", lambda request: request.url.endswith("/spectators.js")):
        dashboard.open(first.address)
    page.unroute_all(behavior="wait")
    assert dashboard.complaints == []
    first.kill()
    expect(dashboard.connection).to_have_text("reconnecting")
    # What is told of it pushes nothing over the edge of a phone.
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.get_by_label("More", exact=True)).to_be_in_viewport(ratio=1)
    page.set_viewport_size({"width": 1280, "height": 720})
    dashboard.choose_depth("Try")
    world = dashboard.open_tab("World")
    expect(world.get_by_role("status")).to_have_text("Waiting for the server to load the world.")

    with (
        page.expect_response("**/spectators.js") as loaded,
        serving(tmp_path, first.port, token="for-the-operator"),
    ):
        expect(dashboard.connection).to_contain_text("connected")
        assert loaded.value.ok
        expect(world.get_by_role("radio", name="Payload")).to_be_visible()
    dashboard.complaints.clear()


@contextmanager
def proxy_that_holds_streams_back(port: int) -> Iterator[str]:
    """Run a proxy before a server that passes an answer on once it has all of it."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def _pass_on(self) -> None:
            body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            with closing(http.client.HTTPConnection("127.0.0.1", port)) as upstream:
                upstream.request(self.command, self.path, body, dict(self.headers))
                answer = upstream.getresponse()
                content = answer.read()
            self.send_response(answer.status)
            for name, value in answer.getheaders():
                if name.lower() not in ("transfer-encoding", "content-length", "connection"):
                    self.send_header(name, value)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        do_GET = do_PUT = do_POST = _pass_on  # noqa: N815 - named by the base class

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    class Proxy(ThreadingHTTPServer):
        daemon_threads = True

        def handle_error(self, *_: object) -> None:
            """Say nothing: pages give streams up that bring nothing."""

    proxy = Proxy(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=proxy.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{proxy.server_port}/"
    finally:
        proxy.shutdown()
        proxy.server_close()
        thread.join()


@pytest.mark.looks_at_3d
def test_where_streams_are_held_back_the_stage_is_followed_all_the_same(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    with server.api() as api, proxy_that_holds_streams_back(server.port) as address:
        dashboard.open(address)
        lanes = [{"agent": "greedy"}, {"agent": "greedy"}]
        body = {"gait": "left-right-origin", "simulator": "kinematic", "lanes": lanes, "steps": 30}
        api.post("races", json=body).raise_for_status()
        shown = page.get_by_role("group", name="Shown run", exact=True)
        expect(shown).to_contain_text(re.compile(r"^Race: Greedy.*step \d+ of 30$"))
        expect(dashboard.connection).to_contain_text("connected")
        expect(page.get_by_text("Reconnecting")).to_have_count(0)
        said = page.get_by_text("This network holds live updates back: asking every 2 s")
        expect(said).to_be_visible()
        # A command reaches the page within a few seconds.
        api.put("stage", json={"time_s": 1.0, "playing": False}).raise_for_status()
        expect(dashboard.moment).to_have_value("1")
