"""The page without the feature: the form offers robots, and says nothing of making them."""

import json
import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from app.features.robots.robot_import import import_robot
from app.settings import Settings
from app.storage.database.opening import open_store
from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving

pytestmark = pytest.mark.timeout(300)


def test_the_form_offers_stored_robots_and_no_way_to_change_them(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    settings, robot = Settings(data=tmp_path), {"preset": "dog", "femur_m": 0.09}
    settings.prepare_data()
    with open_store(settings) as store:
        import_robot(store, json.dumps({"robot": robot}).encode(), "Rex")
    with serving(tmp_path, without="robots") as server:
        dashboard.open(server.link(depth="study", tab="train", robot="dog", gait="trot"))
        expect(dashboard.panel.get_by_text("Dog", exact=True)).to_be_visible()
        dashboard.open_tab("World")
        dashboard.unfold("Robot")
        dashboard.panel.get_by_label("Robot", exact=True).select_option("Rex")
        expect(dashboard.button("Edit the body…")).to_have_count(0)
        expect(dashboard.button("Your robots…")).to_have_count(0)
        dashboard.open_tab("Train")
        expect(dashboard.panel.get_by_text("Rex", exact=True)).to_be_visible()
        expect(dashboard.panel.get_by_text(re.compile("stands by"))).to_be_visible()
