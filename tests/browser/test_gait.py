"""The gait analysis: footfalls that follow the moment shown, seek at a click, and as a table."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import finished, hold, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

TOKEN = "for-the-operator"
RACE = {
    "gait": "left-right-origin",
    "steps": 12,
    "lanes": [{"agent": "greedy"}, {"agent": "informed"}],
}


@pytest.mark.test
def test_footfalls_of_a_race(dashboard: Dashboard, flat_browser: Browser, tmp_path: Path) -> None:
    with serving(tmp_path, token=TOKEN) as server, server.api(TOKEN) as api:
        hold(api, finished(api, "races", RACE), 2.0)
        follows_and_seeks(dashboard, server.link(token=TOKEN, depth="study", tab="gait"))
        with new_page(flat_browser) as page:
            Dashboard(page, has_3d=False).open(server.link(depth="study", tab="gait"))
            panel = gait(page)
            footfalls = panel.get_by_role("img", name=re.compile("^Footfalls of Greedy"))
            expect(footfalls).to_be_visible()
            expect(panel.get_by_role("slider")).to_have_count(0)


def gait(page: Page) -> Locator:
    return page.get_by_role("region", name="Gait analysis", exact=True)


def follows_and_seeks(dashboard: Dashboard, address: str) -> None:
    page = dashboard.page
    dashboard.open(address)
    panel = gait(page)
    footfalls = panel.get_by_role("slider", name="Footfalls of Greedy")
    # In 2 s under the paper clock Greedy walks 1.5 s, as each step takes 1.36 motions.
    expect(footfalls).to_have_attribute(
        "aria-valuetext", re.compile(r"^1\.\d s of robot time, step 5")
    )
    expect(panel.locator(".stance")).to_have_count(12)

    footfalls.press("ArrowRight")
    expect(footfalls).to_have_attribute("aria-valuetext", re.compile("step 6"))
    dashboard.button("Whole walk").click()
    box = footfalls.bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 20)
    expect(footfalls).to_have_attribute(
        "aria-valuetext", re.compile(r"^3\.1 s of robot time, step 10")
    )

    figures = panel.get_by_role("region", name="Figures of the gait")
    expect(figures.get_by_role("row", name=re.compile("^Duty factor"))).to_contain_text("0.7")
    expect(figures.get_by_role("row", name=re.compile("^Energy"))).to_contain_text(
        re.compile(r"\d\.\d\sJ")
    )
    panel.get_by_text("As a table", exact=True).click()
    leg = panel.get_by_role("row", name=re.compile("^Greedy, leg 1 0.7"))
    expect(leg).to_contain_text(re.compile(r"\d\.\d\d–\d\.\d\d"))
    assert dashboard.violations() == []
    page.emulate_media(color_scheme="dark")
    page.set_viewport_size({"width": 360, "height": 780})
    assert dashboard.violations() == []
    assert dashboard.scroll_width() == 360
