"""Robots with other legs, chosen where a training is set: what is known of them, and their walk."""

import re
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

SHORT = urlencode({"steps": 6, "evaluate_every": 0, "race_steps": 3, "simulator": "kinematic"})


def beforehand(dashboard: Dashboard) -> Locator:
    return dashboard.group("Known before it walks")


@pytest.mark.test
def test_a_creature_brings_its_gait_is_previewed_and_walks(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{SHORT}&depth=try&tab=train")
    robot = page.get_by_label("Robot", exact=True)
    expect(beforehand(dashboard)).to_contain_text("125 states, 12 moves · stands by")

    robot.select_option("starfish")
    expect(page.get_by_text("Groups 1+3, 2+5, 4")).to_be_visible()
    expect(beforehand(dashboard)).to_contain_text("stands by")
    robot.select_option("spider")
    expect(page.get_by_role("radio", name="Tetrapod")).to_be_checked()
    expect(page.get_by_role("radio", name="Tripod")).to_have_count(0)
    expect(beforehand(dashboard)).to_contain_text("25 states, 8 moves · stands by")

    dashboard.primary.click()
    expect(dashboard.headline).to_have_text(re.compile(r"wins|level"))
    race, training = dashboard.get("/api/v1/runs")["items"]
    assert race["config"]["robot"]["preset"] == "spider"
    assert training["config"]["gait"] == "tetrapod"


def test_a_body_that_tips_is_offered_its_learner_and_a_choice_of_ones_own_stays(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?depth=study&tab=train")
    learner = page.get_by_label("Learner", exact=True)
    recommendation = page.get_by_role("status").filter(has_text="for this body")
    expect(recommendation).to_contain_text("Linear model is recommended for this body. It stands")
    expect(learner).to_have_value("q-learning")

    page.get_by_role("radio", name="Bound").check(force=True)
    expect(learner).to_have_value("multilevel-model")
    expect(recommendation).to_contain_text(
        "Multilevel model is offered for this body. It tips while"
    )
    for theme in ("dark", "light"):
        page.emulate_media(color_scheme=theme)
        assert dashboard.violations() == []
    page.get_by_role("radio", name="Tripod").check(force=True)
    expect(learner).to_have_value("q-learning")

    learner.select_option("sarsa")
    page.get_by_role("radio", name="Bound").check(force=True)
    expect(recommendation).to_contain_text(
        "Multilevel model is recommended for this body. It tips while"
    )
    expect(learner).to_have_value("sarsa")
    recommendation.get_by_role("button", name="Take it").click()
    expect(learner).to_have_value("multilevel-model")
    page.get_by_role("radio", name="Tripod").check(force=True)
    expect(recommendation).to_contain_text("Linear model is recommended")
    expect(learner).to_have_value("multilevel-model")


def test_what_tips_is_offered_other_groups_and_legs_are_moved_between_them(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?robot=dog&gait=bound&depth=study&tab=train")
    preview = beforehand(dashboard)
    expect(preview.get_by_text("It tips while legs 1+2 and 3+4 swing")).to_be_visible()
    assert dashboard.violations() == []

    dashboard.button("Take groups with which it stands").click()
    expect(page.get_by_text("Groups 1+3, 2+4")).to_be_visible()
    expect(preview).to_contain_text("stands by")
    page.get_by_role("button", name="Leg 4, in group 2").press("Enter")
    expect(page.get_by_text("Groups 1+3, 2, 4")).to_be_visible()
    expect(preview).to_contain_text("125 states, 12 moves")
    page.reload()
    expect(page.get_by_text("Groups 1+3, 2, 4")).to_be_visible()

    world = dashboard.open_tab("World")
    world.get_by_label("Add a disturbance").select_option("Two limp legs")
    limp = world.get_by_role("group", name="Limp legs")
    expect(limp.get_by_role("button", name=re.compile(r"^Leg \d"))).to_have_count(4)
