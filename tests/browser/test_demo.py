"""A demo as a stranger meets it: train, see the own robot, read what is left, and be refused."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

TOKEN = "a-token-for-tests"
PHONE: ViewportSize = {"width": 390, "height": 844}
FORM = {"simulator": "kinematic", "lanes": "q-learning,greedy", "steps": "100"}
"""Of a start of 200 steps: a practice, and a race of two lanes."""
BODY = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 10}


def test_a_visitor_trains_and_reads_the_allowance_that_is_left(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    with serving(tmp_path, token=TOKEN, demo=1, demo_steps_per_hour=500) as server:
        with server.api() as api:
            of_other = finished(api, "trainings", {**BODY, "name": "Of another"})
        dashboard.open(server.link(depth="try", **FORM))
        expect(dashboard.actions).to_contain_text("500 of 500 steps an hour left")
        expect(dashboard.actions).to_contain_text("public, and deleted after a day")
        assert dashboard.violations_in_both_themes() == []

        see_the_own_robot(dashboard, server)
        expect(dashboard.actions).to_contain_text("300 of 500 steps an hour left")
        dashboard.button("Start over").click()
        expect(dashboard.actions).to_contain_text("100 of 500 steps an hour left")
        expect(dashboard.button("Stop")).to_be_hidden()
        assert dashboard.complaints == []

        skip_the_practice(dashboard)
        dashboard.button("Start over").click()
        alert = dashboard.actions.get_by_role("alert")
        expect(alert).to_contain_text("You have 100 of 500 steps an hour left, and this takes 200")
        expect(alert).to_contain_text(re.compile(r"choose fewer, or start it in \d+ min"))
        assert dashboard.violations_in_both_themes() == []
        assert [complaint.split()[0] for complaint in dashboard.complaints] == ["429"]
        dashboard.complaints.clear()

        own_runs_alone_are_changed(dashboard, of_other["id"])
        with server.api(TOKEN) as operator:
            assert operator.get("stage").json()["origin"] in ("none", "automatic")
            assert operator.get(f"runs/{of_other['id']}").json()["name"] == "Of another"


def see_the_own_robot(dashboard: Dashboard, server: Serving) -> None:
    """The practice is shown as it is computed, then the race, on this page alone."""
    page = dashboard.page
    expect(dashboard.primary).to_have_text("Train 100 steps, then race")
    dashboard.primary.click()
    expect(page).to_have_url(re.compile(r"[?&]run="))
    slider = page.get_by_role("slider", name="Moment of your replay", exact=True)
    expect(slider).to_be_visible()
    first = slider.input_value()
    dashboard.eventually(lambda: slider.input_value() != first, "the robot walks")
    skip_the_practice(dashboard)
    expect(dashboard.labels).to_contain_text("Your robot")
    expect(dashboard.shown_run).to_contain_text("Race")
    expect(dashboard.headline).to_have_text(re.compile("wins|leads|level"))
    with server.api() as api:
        # The common stage may replay a race, as it does by itself; nobody has put a run on it.
        assert api.get("stage").json()["origin"] in ("none", "automatic")


def skip_the_practice(dashboard: Dashboard) -> None:
    """Go to the end of the replay of a practice, once it is all computed; its race follows."""
    slider = dashboard.page.get_by_role("slider", name="Moment of your replay", exact=True)
    # On a busy machine the race may be there already.
    shown = re.compile(r"^step \d+ of step 100$|\ss of ")
    expect(slider).to_have_attribute("aria-valuetext", shown)
    if "step" in (slider.get_attribute("aria-valuetext") or ""):
        slider.press("End")


def own_runs_alone_are_changed(dashboard: Dashboard, other_id: str) -> None:
    """Check that a visitor can rename and delete own runs in the list, and only repeat others."""
    page = dashboard.page
    page.goto(f"{page.url.partition('?')[0]}#runs")
    expect(dashboard.runs.first).to_be_visible()
    run_of_another = dashboard.runs.filter(has_text="Of another")
    run_of_another.get_by_label(re.compile("More|actions", re.IGNORECASE)).first.click()
    expect(run_of_another.get_by_role("button", name="Run again")).to_be_visible()
    for name in ("Rename", "Delete"):
        expect(run_of_another.get_by_role("button", name=name, exact=True)).to_have_count(0)
    page.keyboard.press("Escape")
    own_run = dashboard.runs.filter(has_text="Race").first
    own_run.get_by_label(re.compile("More|actions", re.IGNORECASE)).first.click()
    before = dashboard.runs.count()
    own_run.get_by_role("button", name="Delete", exact=True).click()
    expect(dashboard.runs).to_have_count(before - 1)
    assert other_id in str(dashboard.get("api/v1/runs"))


@pytest.mark.test
def test_on_a_phone(flat_browser: Browser, tmp_path: Path) -> None:
    with (
        serving(tmp_path, token=TOKEN, demo=1) as server,
        new_page(flat_browser, viewport=PHONE, has_touch=True, is_mobile=True) as page,
    ):
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(server.link(**FORM))
        expect(dashboard.actions).to_contain_text("20 000 of 20 000 steps an hour left")
        dashboard.primary.tap()
        expect(page).to_have_url(re.compile(r"[?&]run="))
        expect(dashboard.actions).to_contain_text("19 800 of 20 000")
        assert dashboard.scroll_width() <= PHONE["width"]
        assert dashboard.small_targets(40) == []
        assert dashboard.violations_in_both_themes() == []
        assert dashboard.complaints == []
