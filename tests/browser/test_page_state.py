"""A link opens the page as it was, "back" restores it, and what a link says in vain is told."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold

RACE = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 4,
    "lanes": [{"agent": "greedy"}],
}


def practice(page: Page) -> str:
    """Return the text of the field of the steps of practice."""
    return page.get_by_role("spinbutton", name="Practice, as a number").input_value()


@pytest.mark.test
def test_a_link_opens_what_was_set_and_what_was_shown(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(server.address)
    dashboard.choose_depth("Study")
    dashboard.open_tab("Train")
    page.get_by_role("spinbutton", name="Practice, as a number").fill("750")
    dashboard.open_tab("Gait")
    page.keyboard.press("2")
    # The link says what differs from the defaults, and no more.
    expect(page).to_have_url(f"{server.address}?steps=750&depth=study&tab=gait&camera=2")
    link = page.url
    page.keyboard.press("\\")
    expect(dashboard.panel).to_have_count(0)
    expect(page).to_have_url(f"{link}&hidden=panel")
    page.goto("about:blank")

    dashboard.open(link)
    expect(dashboard.primary).to_have_text(re.compile("^Train 750 steps"))
    expect(page.get_by_role("tab", name="Gait", selected=True)).to_be_visible()
    assert page.url == link


def test_back_restores_the_view_its_filters_and_the_form(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.link(depth="try", tab="train"))
    field = page.get_by_role("spinbutton", name="Practice, as a number")
    field.fill("750")
    page.get_by_role("link", name="Runs").click()
    page.get_by_label("Search names, ids, tags and notes").fill("nothing like this")
    expect(page).to_have_url(re.compile(r"\?steps=750&.*#runs\?search=nothing\+like\+this$"))
    page.get_by_role("link", name="Race", exact=True).click()
    field.fill("20")

    page.go_back()
    expect(page.get_by_label("Search names, ids, tags and notes")).to_have_value(
        "nothing like this"
    )
    page.go_back()
    expect(dashboard.primary).to_have_text(re.compile("^Train 750 steps"))
    assert practice(page) == "750"
    page.go_forward()
    page.go_forward()
    expect(dashboard.primary).to_have_text(re.compile("^Train 20 steps"))
    # The bare link of a view leaves its filters as they were.
    page.get_by_role("link", name="Runs").click()
    expect(page.get_by_label("Search names, ids, tags and notes")).to_have_value(
        "nothing like this"
    )


def test_invalid_fields_of_a_link_are_reported(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    wrong = {"depth": "deep", "tab": "chart", "t": "soon", "alhpa": "0.5", "steps": "many"}
    dashboard.open(shared_server.link("nowhere", **wrong))
    message = page.get_by_role("status").filter(has_text="The link also says")
    for words in ("alhpa=0.5", "t=soon", "depth=deep", "tab=chart", "view=nowhere"):
        expect(message).to_contain_text(words)
    # What is valid is told where that is a word of a few.
    views = "race, runs, compare, lessons, experiments"
    for valid in ("watch, try, study", "board, train, world, why", views):
        expect(message).to_contain_text(valid)
    # A field of the form keeps its text, in the link too; the page beside it is as ever.
    expect(dashboard.scoreboard).to_be_visible()
    expect(dashboard.primary).to_have_attribute("aria-disabled", "true")
    expect(page).to_have_url(f"{shared_server.address}?steps=many")
    assert dashboard.violations() == []
    message.get_by_role("button", name="Dismiss").click()
    expect(message).to_have_count(0)
    dashboard.choose_depth("Try")
    dashboard.open_tab("Train")
    assert practice(page) == "many"


def test_a_link_to_a_run_that_is_not_says_so_and_speaks_of_no_other(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        race = finished(api, "races", RACE)
        hold(api, race, 1e6)
        page.goto(shared_server.link(run="gone", t=1))
        alert = page.get_by_role("alert").filter(has_text="gone")
        expect(alert).to_be_visible()
        # The stage shows a race, of which this page says nothing.
        expect(dashboard.scoreboard).to_contain_text("No run is shown")
        expect(dashboard.headline).to_have_text("No run is shown")
        expect(dashboard.shown_run).not_to_contain_text(race["name"])
        expect(page).not_to_have_title(re.compile("Greedy|Loading"))
        expect(dashboard.standings).to_have_count(0)
        assert dashboard.violations() == []
        # The page asks for the run, its replay and its scene.
        dashboard.eventually(lambda: len(dashboard.complaints) == 3, "three answers of 404")
        dashboard.complaints.clear()
        dashboard.button("Back to the stage").click()
        expect(alert).to_have_count(0)
        expect(dashboard.standings).to_be_visible()
        assert "run=" not in page.url

        # A moment after the end is the end.
        page.goto(shared_server.link(run=race["id"], t=999))
        expect(page.get_by_label("Moment of your replay")).to_be_visible()
        expect(dashboard.headline).to_have_text(re.compile("wins"))
