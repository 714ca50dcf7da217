"""Every control is large enough to be met: 24 px (WCAG 2.2, 2.5.8), and 40 px for a thumb."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import finished, hold, serving
from tests.browser.test_spectators import RACE, TOKEN
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

DESK: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}


@pytest.mark.parametrize(("size", "least_px"), [(DESK, 24), (PHONE, 40)], ids=["desk", "phone"])
def test_no_control_is_too_small(
    size: ViewportSize, least_px: int, flat_browser: Browser, tmp_path: Path
) -> None:
    """In the views of runs and experiments, and in the race as spectators have it."""
    has_touch = size == PHONE
    with (
        serving(tmp_path, token=TOKEN) as server,
        server.api(TOKEN) as api,
        new_page(flat_browser, viewport=size, has_touch=has_touch, is_mobile=has_touch) as page,
    ):
        hold(api, finished(api, "races", RACE), 5.0)
        dashboard = Dashboard(page, has_3d=False)
        found: dict[str, list[str]] = {}
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
                page.wait_for_timeout(300)
                if too_small := dashboard.small_targets(least_px):
                    found[f"{role} {view}"] = too_small
            assert dashboard.scroll_width() == size["width"]
        assert found == {}
        assert dashboard.complaints == []
