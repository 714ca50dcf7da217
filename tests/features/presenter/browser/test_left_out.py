"""The page without the feature: no way to present it, whatever a link or a key says."""

from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving

pytestmark = pytest.mark.timeout(300)


def test_the_page_cannot_be_presented(dashboard: Dashboard, tmp_path: Path) -> None:
    page = dashboard.page
    with serving(tmp_path, without="presenter") as server:
        dashboard.open(f"{server.address}?present&remote&depth=try")
        expect(page.get_by_role("banner")).to_be_visible()
        unknown = dashboard.panel.get_by_text("present= and remote=, which is no setting")
        expect(unknown).to_be_visible()
        page.locator("body").press("p")
        page.get_by_label("More", exact=True).first.click()
        expect(page.get_by_role("menuitem", name="Keys and help")).to_be_visible()
        expect(page.get_by_role("menuitem", name="Present")).to_have_count(0)
        expect(page.get_by_role("menuitem", name="Remote")).to_have_count(0)
        page.get_by_role("menuitem", name="Keys and help").click()
        help_text = page.get_by_role("dialog", name="Keys")
        expect(help_text).to_contain_text("show more: Watch, Try, Study")
        expect(help_text).not_to_contain_text("present")
