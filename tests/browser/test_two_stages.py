"""The page shows the stage at whose path it is opened."""

from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.stage.two_stages import SECOND, TOKENS, two_stages


@pytest.mark.looks_at_3d
def test_page_shows_the_stage_at_whose_path_it_is_opened(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    with two_stages(tmp_path) as port:
        address = f"http://127.0.0.1:{port}"
        # With a session of the first stage a visitor is a spectator of the second.
        for query, starts in (f"/?token={TOKENS['']}", 1), (f"{SECOND}/", 0), ("/", 1):
            dashboard.open(f"{address}{query}")
            expect(dashboard.primary).to_have_count(starts)
        dashboard.page.goto("about:blank")
