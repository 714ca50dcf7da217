"""Beside the settings: what thirty robots make of them, and how one goes on from there."""

import re
from typing import Any
from urllib.parse import urlencode

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

SHORT = urlencode({"steps": 60, "simulator": "kinematic", "evaluate_every": 0})


@pytest.mark.test
def test_a_slider_is_tried_out_and_gone_on_with(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{SHORT}&depth=study")
    # It is tried as it is once the tab is open, and again whenever a setting comes to rest.
    panel = dashboard.open_tab("What if")
    expect(panel).to_contain_text("Ideal (no slip)")
    before = dashboard.primary.bounding_box()

    page.get_by_role("slider", name="Learning rate α").fill("0.8")
    chosen = panel.get_by_role("img", name=re.compile(r"^These settings: \d+ of 30 walk\."))
    default = panel.get_by_role("img", name=re.compile(r"^The defaults: \d+ of 30 walk\."))
    expect(chosen).to_be_visible()
    expect(default).to_be_visible()
    expect(chosen.locator("circle")).to_have_count(30)
    assert dashboard.primary.bounding_box() == before
    assert dashboard.violations() == []

    chooses_learner(dashboard, "Linear model")
    expect(panel).to_contain_text("Ideal (no slip)")
    expect(chosen).to_have_accessible_name(re.compile(r" 30 of 30 walk\."))
    chooses_learner(dashboard, "Q-learning")

    practice = page.get_by_role("spinbutton", name="Practice, as a number")
    practice.fill("5000")
    expect(panel).to_contain_text("2000 steps at most")
    # The answer shown now is of other settings.
    expect(panel.locator(".trial.old")).to_be_visible()
    assert dashboard.violations() == []
    practice.fill("60")
    expect(panel).not_to_contain_text("at most")

    # It is a draft: the next run has it once it is used, and a link and another tab keep it.
    draft = panel.get_by_role("group", name="Draft")
    expect(draft).to_contain_text("Not in the next run: α 0.8 (next run 0.3)")
    train = dashboard.open_tab("Train")
    expect(train.get_by_role("slider", name="Learning rate α")).to_have_value("0.3")
    page.reload()
    panel = dashboard.open_tab("What if")
    expect(panel.get_by_role("slider", name="Learning rate α")).to_have_value("0.8")
    draft.get_by_role("button", name="Discard").click()
    expect(draft).to_have_count(0)
    expect(panel.get_by_role("slider", name="Learning rate α")).to_have_value("0.3")
    panel.get_by_role("slider", name="Learning rate α").fill("0.8")
    assert dashboard.violations() == []
    draft.get_by_role("button", name="Use this").click()
    expect(draft).to_have_count(0)

    dashboard.open_tab("Train")
    expect(dashboard.button("Practise 60 more, don’t race")).to_have_count(0)
    dashboard.button("Train, don’t race").click()
    dashboard.button("Practise 60 more, don’t race").click()
    dashboard.eventually(lambda: len(trainings(dashboard)) == 2, "the training that goes on")
    second, first = trainings(dashboard)
    assert second["config"]["continue_from"] == first["id"]
    assert second["config"]["settings"]["alpha"] == 0.8


def chooses_learner(dashboard: Dashboard, title: str) -> None:
    """Choose another learner where the next training is set, and come back."""
    dashboard.open_tab("Train").get_by_label("Learner", exact=True).select_option(title)
    dashboard.open_tab("What if")


def trainings(dashboard: Dashboard) -> list[dict[str, Any]]:
    items: list[dict[str, Any]] = dashboard.get("api/v1/trainings")["items"]
    return items


def test_an_unreachable_server_is_reported_and_asked_again(
    dashboard: Dashboard, server: Serving
) -> None:
    dashboard.open(server.link(depth="study"))
    panel = dashboard.open_tab("What if")
    expect(panel).to_contain_text("Ideal (no slip)")
    server.kill()
    expect(dashboard.connection).to_have_text("reconnecting")
    panel.get_by_role("slider", name="Learning rate α").fill("0.8")
    expect(panel.get_by_role("alert")).to_contain_text("does not answer")
    expect(panel.get_by_role("button", name="Try again")).to_be_visible()
    dashboard.complaints.clear()
