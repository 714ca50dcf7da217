"""The common page at 320 px, on a phone that turns, in type of 200 %, and in forced colours."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.browser.poor_windows import each_poor_window, problems_in
from tests.browser.serving import Serving, finished, hold
from tests.browser.test_workspace import RACE, each_tab

pytestmark = pytest.mark.timeout(400)


def test_each_tab_can_be_used(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    with server.api() as api:
        hold(api, finished(api, "races", RACE), 5.0)
    dashboard.open(server.address)
    expect(dashboard.headline).to_have_text(re.compile("leads|level"))
    problems: dict[str, list[str]] = {}
    for window in each_poor_window(page):
        card = page.get_by_role("button", name="Card", exact=True)
        if card.is_visible():
            problems[f"card, {window.name}"] = problems_in(page, window, ".card-bar")
            # Else it is over the tab, which folds it.
            if card.get_attribute("aria-expanded") == "true":
                card.click()
        for depth, tab in each_tab(dashboard):
            problems[f"{depth} {tab}, {window.name}"] = problems_in(page, window)
        for title in ("Keys and help", "Open a room…"):
            page.get_by_label("More", exact=True).first.click()
            problems[f"menu, {window.name}"] = problems_in(page, window, ".more-menu")
            page.locator(".more-menu").get_by_text(title, exact=True).click()
            expect(page.locator("dialog:modal")).to_be_visible()
            problems[f"{title}, {window.name}"] = problems_in(page, window)
            page.keyboard.press("Escape")
            expect(page.locator("dialog:modal")).to_have_count(0)
    page.goto(server.link("runs"))
    expect(dashboard.run_names.first).to_be_visible()
    for window in each_poor_window(page):
        problems[f"Runs, {window.name}"] = problems_in(page, window)
    page.goto(server.link("experiments"))
    expect(page.get_by_role("heading", name="Experiments")).to_be_visible()
    for window in each_poor_window(page):
        problems[f"Experiments, {window.name}"] = problems_in(page, window)
    assert {where: what for where, what in problems.items() if what} == {}
