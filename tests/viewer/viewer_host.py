"""Test set-up: the viewer in a frame of a page that draws in it, as the dashboard does."""

import base64
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import Frame, Page
from starlette.applications import Starlette
from starlette.responses import HTMLResponse
from starlette.routing import Route

from app.viewer.viewer_page import viewer_routes
from hexapods.drawing.viser_internals.recorder import Recorded
from tests.running_app import running

HOST = """
<!doctype html>
<script>
  window.heard = [];
  addEventListener("message", ({ data }) => heard.push(data));
  const post = (message) =>
    document.querySelector("iframe").contentWindow.postMessage(message, location.origin);
  const show = (wanted) => post({ type: "hexapods:show", ...wanted });
  const ARRAYS = { "<f4": Float32Array, "<u4": Uint32Array, "<i4": Int32Array, "|u1": Uint8Array };
  const resolve = (value) => {
    if (Array.isArray(value)) return value.map(resolve);
    if (value === null || typeof value !== "object") return value;
    if ("base64" in value) {
      const bytes = Uint8Array.from(atob(value.base64), (letter) => letter.charCodeAt(0));
      return new ARRAYS[value.dtype](bytes.buffer);
    }
    return Object.fromEntries(Object.entries(value).map(([name, item]) => [name, resolve(item)]));
  };
  const draw = (messages) => post({ type: "hexapods:draw", messages: messages.map(resolve) });
</script>
<iframe src="viewer/?theme=dark" width="480" height="270"></iframe>
"""


@contextmanager
def hosted_viewer() -> Iterator[str]:
    """Serve the host at `/`, and an empty page at `/empty`; yield their address."""
    routes = [
        Route("/", lambda _: HTMLResponse(HOST)),
        Route("/empty", lambda _: HTMLResponse("<!doctype html><iframe></iframe>")),
        *viewer_routes(),
    ]
    with running(Starlette(routes=routes)) as port:
        yield f"http://127.0.0.1:{port}"


def open_host(page: Page, address: str) -> Frame:
    """Open the host, and return the frame of the viewer once it is ready."""
    page.goto(f"{address}/")
    page.wait_for_function("heard.some((message) => message.status === 'connected')")
    return page.frames[1]


def draw(page: Page, recorded: Recorded) -> None:
    """Draw in the viewer of a host what was drawn on a viser server."""
    page.evaluate(
        "messages => draw(messages)",
        [with_arrays(message, recorded.arrays) for message in recorded.messages],
    )


def with_arrays(value: Any, arrays: list[memoryview]) -> Any:
    """Return a message, or a part of one, as JSON that has its arrays."""
    if isinstance(value, dict) and "__binary_index" in value:
        data = base64.b64encode(arrays[value["__binary_index"]]).decode()
        return {"dtype": value["dtype"], "base64": data}
    if isinstance(value, dict):
        return {key: with_arrays(item, arrays) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [with_arrays(item, arrays) for item in value]
    return value


def wait_for_node(frame: Frame, name: str) -> None:
    """Wait until viser's client has a scene node."""
    frame.wait_for_function("name => window.__viserSceneTree?.getState()[name]?.message", arg=name)
