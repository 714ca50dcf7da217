"""Every control is large enough to be met: 24 px (WCAG 2.2, 2.5.8), and 40 px for a thumb."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold, serving
from tests.browser.test_spectators import RACE, TOKEN
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

DESK: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}


def test_no_control_is_too_small(flat_browser: Browser, tmp_path: Path) -> None:
    """In the views of runs and experiments, and in the race as spectators have it."""
    with serving(tmp_path, token=TOKEN) as server, server.api(TOKEN) as api:
        hold(api, finished(api, "races", RACE), 5.0)
        for size, least_px in ((DESK, 24), (PHONE, 40)):
            touch = size == PHONE
            with new_page(flat_browser, viewport=size, has_touch=touch, is_mobile=touch) as page:
                dashboard = Dashboard(page, has_3d=False)
                assert too_small(dashboard, server, least_px) == {}
                assert dashboard.scroll_width() == size["width"]
                assert dashboard.complaints == []


def too_small(dashboard: Dashboard, server: Serving, least_px: int) -> dict[str, list[str]]:
    """Return the controls that are smaller, by the role and the view that have them."""
    page, by_view = dashboard.page, dict[str, list[str]]()
    for role, token in (("spectator", {}), ("operator", {"token": TOKEN})):
        dashboard.open(server.link(depth="study", tab="what-if", **token))
        expect(dashboard.headline).to_be_visible()
        for view, shown in (
            ("race", page.get_by_role("region", name="What if")),
            ("runs", dashboard.runs.first),
            ("experiments", page.get_by_role("heading", name="Experiments")),
        ):
            page.evaluate("view => { location.hash = view; }", view)
            expect(shown).to_be_visible()
            if small := dashboard.small_targets(least_px):
                by_view[f"{role} {view}"] = small
    return by_view
