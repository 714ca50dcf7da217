"""The page without a pointer: train, race, scrub, and run an experiment by keys alone."""

import re
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

SHORT = urlencode(
    {
        "steps": 20,
        "evaluate_every": 10,
        "race_steps": 3,
        "simulator": "kinematic",
        "lanes": "q-learning,greedy",
    }
)
SMALL = urlencode(
    {
        "experiment": "table1",
        "seeds": 2,
        "simulator": "kinematic",
        "gaits": "left-right-origin",
        "observations": "measured",
        "robots": "stiff",
    }
)
MAX_TABS = 150
"""More than the page has places to stop at."""


def tab_to(page: Page, target: Locator) -> None:
    """Press Tab until the target has the focus, which must be visible there."""
    expect(target).to_be_visible()
    for _ in range(MAX_TABS):
        page.keyboard.press("Tab")
        if target.evaluate("element => element === document.activeElement"):
            assert target.evaluate("element => element.matches(':focus-visible')")
            return
    raise AssertionError(f"Tab does not reach {target}")


def test_train_race_scrub_and_experiment(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{SHORT}#")
    tab_to(page, dashboard.primary)
    page.keyboard.press("Enter")
    expect(dashboard.headline).to_contain_text("had used")
    expect(dashboard.button("Play again for everyone")).to_be_visible()

    seek = page.get_by_role("slider", name="Moment that is shown")
    tab_to(page, seek)
    assert float(seek.input_value()) > 0
    page.keyboard.press("Home")
    expect(seek).to_have_value("0")
    page.keyboard.press("ArrowRight")

    tab_to(page, page.get_by_role("link", name="Experiments"))
    page.keyboard.press("Enter")
    tab_to(page, page.get_by_role("button", name="New experiment"))
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog", name="New experiment")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog", name="New experiment")).to_be_hidden()
    page.goto(f"{server.address}#experiments?{SMALL}")
    seeds = page.get_by_label("Seeds", exact=True)
    tab_to(page, seeds)
    page.keyboard.press("Control+A")
    page.keyboard.type("1")
    tab_to(page, page.get_by_role("button", name=re.compile("^Run Table 1: ")))
    page.keyboard.press("Enter")
    expect(dashboard.experiment_state("finished")).to_be_visible()
    [run] = dashboard.get("/api/v1/experiments")["items"]
    assert run["config"]["seeds"] == 1
