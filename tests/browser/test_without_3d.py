"""Where WebGL is absent a plan from above is shown; after a lost context the 3D picture is back."""

import re

import pytest
from playwright.sync_api import Browser, Frame, expect

from tests.browser.dashboard import Dashboard
from tests.browser.rooms import PHONE, RoomPage
from tests.browser.serving import Serving, finished, hold
from tests.conftest import new_page
from tests.running_app import wait_until

pytestmark = pytest.mark.timeout(300)

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}
RACE = {**WALK, "lanes": [{"agent": "greedy"}, {"agent": "two-step"}], "steps": 20}
LESSON = {"title": "Flat", "cards": [{"title": "One", "text": "Look.", "state": {"form": WALK}}]}
NO_3D = "No 3D graphics (WebGL) in this browser. This is a plan from above."
LOSE_CONTEXT = """() => {
    const context = document.querySelector("canvas[data-engine]")?.getContext("webgl2");
    if (window.hasLost || !context?.getExtension("WEBGL_lose_context")) return false;
    window.hasLost = true;
    setTimeout(() => context.getExtension("WEBGL_lose_context").loseContext(), 500);
    return true;
}"""
"""Loses the context of the 3D view, if it has one, once in each of its pages.

Half a second later: the page loads anew then, and would be asked again if it had not answered.
"""
TAKE_CAMERA = """() => {
    window.dispatchEvent(new KeyboardEvent("keydown", {key: "+", code: "BracketRight"}));
    __viserMutable.cameraControl.setLookAt(1, 2, 3, 0, 0.5, 0, false);
}"""
CAMERA = """() => {
    const {camera, cameraControl, nodeRefFromName} = window.__viserMutable ?? {};
    if (!cameraControl || !nodeRefFromName["/world/run/robots/0/torso"]) return null;
    return camera.position.toArray().map((part) => Math.round(100 * part));
}"""


def test_without_webgl_the_stage_and_the_projector_have_a_plan(
    flat_browser: Browser, server: Serving
) -> None:
    with new_page(flat_browser) as page, server.api() as api:
        dashboard = Dashboard(page)
        page.goto(server.address)
        expect(page.locator(".stage .plan").get_by_role("status")).to_have_text(NO_3D)
        expect(page.locator(".stage iframe")).to_have_count(0)
        # The start line has three robots, and so has the plan.
        expect(page.locator(".plan .robot")).to_have_count(3)

        race = finished(api, "races", RACE)
        hold(api, race, 4.0)
        plan = page.get_by_role("img", name=re.compile("^Plan of the track from above"))
        expect(plan).to_have_accessible_name(re.compile(r"Greedy \d\.\d\d.m; .*Two-step"))
        expect(page.locator(".plan .robot")).to_have_count(2)
        assert dashboard.violations() == []
        assert dashboard.complaints == []

        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        projector = RoomPage(page)
        projector.enter(server, code, "?projector")
        expect(page.locator(".robots .plan").get_by_role("status")).to_have_text(NO_3D)
        expect(page.locator(".plan .robot").first).to_be_visible()
        page.set_viewport_size(PHONE)
        page.goto(server.address)
        expect(page.locator(".plan .robot").first).to_be_visible()
        assert projector.complaints == []


@pytest.mark.looks_at_3d
def test_after_a_lost_context_the_robots_are_back_where_they_were(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    with server.api() as api:
        race = finished(api, "races", RACE)
        hold(api, race, 1.0)
    dashboard.open(server.address)
    view: Frame = page.frames[1]
    view.wait_for_function(CAMERA)
    directed = page.get_by_role("button", name="Directed camera")

    def has_taken() -> bool:
        view.evaluate(TAKE_CAMERA)
        return directed.is_visible()

    wait_until(has_taken)  # the view has robots before it hears of keys
    view.wait_for_function(f"() => ({CAMERA})().join() === '100,200,300'")
    stage = page.get_by_role("region", name="Stage")

    view.wait_for_function(LOSE_CONTEXT)
    expect(stage).to_contain_text("The 3D graphics were interrupted.")
    expect(stage).not_to_contain_text("The 3D graphics were interrupted.")
    view.wait_for_function(f"() => ({CAMERA})()?.join() === '100,200,300'")
    expect(dashboard.moment).to_have_value("1")

    # A machine that loses it again and again has a plan.
    for _ in range(2):
        view.wait_for_function(LOSE_CONTEXT)
    words = "The 3D graphics have failed. This is a plan from above."
    expect(stage.locator(".plan")).to_contain_text(words)
    expect(page.locator(".plan .robot")).to_have_count(2)
    stage.get_by_role("button", name="Try 3D again").click()
    expect(stage.locator("iframe")).to_be_visible()
    dashboard.complaints.clear()
