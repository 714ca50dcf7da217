"""The server goes away and comes back."""

import re
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
        expect(dashboard.connection).to_contain_text("live")
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
        expect(dashboard.connection).to_contain_text("live")
        assert loaded.value.ok
        expect(world.get_by_role("radio", name="Payload")).to_be_visible()
    dashboard.complaints.clear()
