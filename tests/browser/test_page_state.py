"""A link opens the page as it was, "back" restores it, and what a link says in vain is told."""

import re

from playwright.sync_api import Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving


def practice(page: Page) -> str:
    """Return the text of the field of the steps of practice."""
    return page.get_by_role("spinbutton", name="Practice, as a number").input_value()


def test_a_link_opens_what_was_set_and_the_panels_that_were_shown(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(server.address)
    page.get_by_role("spinbutton", name="Practice, as a number").fill("750")
    page.get_by_role("button", name="Explain this step").click()
    page.get_by_text("What if?").click()
    panel = page.get_by_role("region", name="What if?")
    expect(panel.get_by_role("group")).not_to_have_attribute("open", "")
    # The link says what differs from the defaults, and no more.
    expect(page).to_have_url(f"{server.address}?steps=750&explain&what-if=closed")
    link = page.url
    page.goto("about:blank")

    dashboard.open(link)
    expect(dashboard.primary).to_have_text(re.compile("^Train 750 steps"))
    steps = page.get_by_role("region", name="Step by step")
    expect(steps.get_by_role("button", name="Close")).to_have_attribute("aria-expanded", "true")
    expect(panel.get_by_role("group")).not_to_have_attribute("open", "")
    assert page.url == link


def test_back_restores_the_view_its_filters_and_the_form(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    field = page.get_by_role("spinbutton", name="Practice, as a number")
    field.fill("750")
    page.get_by_role("link", name="Runs").click()
    page.get_by_label("Search names, ids, tags and notes").fill("nothing like this")
    expect(page).to_have_url(re.compile(r"\?steps=750#runs\?search=nothing\+like\+this$"))
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


def test_what_a_link_says_in_vain_is_told(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{shared_server.address}?steps=many&alhpa=0.5&t=soon#nowhere")
    told = page.get_by_role("status").filter(has_text="The link also says")
    for part in ("alhpa=0.5", "t=soon", "view=nowhere"):
        expect(told).to_contain_text(part)
    # A field of the form keeps its text, in the link too.
    expect(page.get_by_role("spinbutton", name="Practice, as a number")).to_have_value("many")
    expect(dashboard.primary).to_have_attribute("aria-disabled", "true")
    assert page.url == f"{shared_server.address}?steps=many"
    assert dashboard.violations() == []
    told.get_by_role("button", name="Dismiss").click()
    expect(told).to_have_count(0)
